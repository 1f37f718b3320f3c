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

"""A ROS domain that no other test uses."""

import os
import socket

__all__ = ['FreeDomain']

PORT_BASE = 32768
"""As ``domain_coordinator`` has it: who has the port, has the domain."""

DOMAINS = 100


class FreeDomain:
    """A domain id from 1 to 100 that this process holds until it is closed, or ends."""

    def __init__(self) -> None:
        for offset in range(DOMAINS):
            self.id = (os.getpid() + offset) % DOMAINS + 1
            self._socket = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
            try:
                self._socket.bind(('', PORT_BASE + self.id))
                return
            except OSError:
                self._socket.close()
        raise RuntimeError(f'all {DOMAINS} ROS domains are in use, expected a free one')

    def close(self) -> None:
        """Let others have the domain."""
        self._socket.close()
