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

_left = set()


def segments_of(pid):
    """Return the names of what a process has in shared memory, without its ports."""
    return {name for name in shared_memory_of(pid) if '_port' not in name}


def kill(popen):
    """
    Kill a process; its segment of Fast DDS in shared memory, which stays behind, is noted.

    Ports stay, as their numbers are given out again while others still have them open: there are
    no more of them than processes at a time.
    """
    if popen.poll() is None:
        _left.update(segments_of(popen.pid))
        popen.kill()
        popen.wait()


def delete_left():
    """
    Delete the segments of processes that were killed, once who heard these has ended, too.

    A reader that still has messages in a segment dies of a segmentation fault without it.
    """
    while _left:
        delete_shared_memory(_left.pop())
