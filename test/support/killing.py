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

"""Processes that are killed, and the shared memory that they leave behind."""

from diffdrive_kinematics.testing.guardian import delete_shared_memory, shared_memory_of


def segments_of(pid):
    """Return the names of what a process has in shared memory, without its ports."""
    return {name for name in shared_memory_of(pid) if '_port' not in name}


def kill(popen):
    """
    Kill a process, and delete its segment of Fast DDS in shared memory, which stays behind.

    Ports stay, as their numbers are given out again while others still have them open: there are
    no more of them than processes at a time.
    """
    if popen.poll() is not None:
        return
    found = segments_of(popen.pid)
    popen.kill()
    popen.wait()
    for name in found:
        delete_shared_memory(name)
