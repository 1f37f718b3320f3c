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

"""What is wrong for a while: said once when it begins, and once when it has ended."""

from typing import Any


class Finding:
    """
    What is wrong, in words; empty: nothing.

    Parameters
    ----------
    node : DiffDriveNode
        That says so.

    """

    def __init__(self, node: Any) -> None:
        self._node, self.text = node, ''

    def note(self, text: str, over: str = '') -> None:
        """Note what is wrong now; ``over`` is what is said where that has ended."""
        before, self.text = self.text, text
        if text and not before:
            self._node.get_logger().warning(text)
        elif before and not text and over:
            self._node.get_logger().info(over)
