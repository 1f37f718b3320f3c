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

"""
Messages about where a robot may be, serialised: samples of its pose, and the boundary of all.

A message object of 100,000 poses takes half a second to fill and to serialise; an array is the
message already, but for what stands in front of it.
"""

from diffdrive_kinematics.ros.messages.cdr import HEADER, stamped_sequence
import numpy as np
from numpy.typing import NDArray
from std_msgs.msg import Header

__all__ = ['polygon_message', 'poses_message']

Array = NDArray[np.float64]


def poses_message(header: Header, rows: Array) -> bytes:
    """Return a PoseArray of rows, shape (N, 7): x, y, z [m] and the quaternion x, y, z, w."""
    return _message(header, rows)


def polygon_message(header: Header, x: Array, y: Array) -> bytes:
    """Return a PolygonStamped of vertices [m]; its numbers travel as float32."""
    rows = np.zeros((len(x), 3), np.float32)
    rows[:, 0], rows[:, 1] = x, y
    return _message(header, rows)


def _message(header: Header, rows: 'NDArray[np.floating]') -> bytes:
    """Return a header and a sequence of structures that have but numbers of one type."""
    front = stamped_sequence(
        header.stamp.sec, header.stamp.nanosec, header.frame_id, len(rows))
    if not len(rows):
        return front
    padding = bytes((len(HEADER) - len(front)) % rows.itemsize)
    return b''.join((front, padding, memoryview(np.ascontiguousarray(rows)).cast('B')))
