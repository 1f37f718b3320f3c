# Copyright 2026 diffdrive_kinematics contributors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""Whether what is seen now and then lasts."""

import time

LASTS_S = 0.3
STALL_S = 0.15


class Lasting:
    """
    Tells whether something holds for good: for a while without a break, and without a stall.

    After a stall it may hold only because what came meanwhile is yet to be read.
    """

    def __init__(self) -> None:
        self._looked_s = self._since_s = 0.0

    def __call__(self, holds: bool) -> bool:
        """Note whether it holds now, and return whether it has held for long enough."""
        now_s, before_s = time.monotonic(), self._looked_s
        self._looked_s = now_s
        if not holds or now_s - before_s > STALL_S:
            self._since_s = now_s
        return now_s - self._since_s > LASTS_S
