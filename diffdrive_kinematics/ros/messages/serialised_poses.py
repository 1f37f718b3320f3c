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
The codec of bytes for messages of many poses: paths, samples of the pose, boundaries.

A message object of 1000 poses costs milliseconds each time that it is published, and one of
100,000 half a second; an array is the message already, but for what stands in front of it.
"""

import struct

from diffdrive_kinematics.core.kinematics import Array, NANOSECONDS, Pose
from diffdrive_kinematics.ros.messages.cdr import HEADER, stamped_sequence
from diffdrive_kinematics.ros.messages.messages import quaternion_of
import numpy as np
from numpy.typing import NDArray
from std_msgs.msg import Header


class PathCodec:
    """
    A Path that grows at its end, and loses its oldest poses beyond a length.

    Every pose ends where a double does, so all but the first begin alike.
    """

    def __init__(self, frame_id: str, most: int) -> None:
        self._frame_id, self._most = frame_id, most
        self._stamp = (0, 0)
        encoded = frame_id.encode() + b'\0'
        self._name = struct.pack('=I', len(encoded)) + encoded
        begin = len(stamped_sequence(*self._stamp, frame_id, 0)) - len(HEADER)
        in_frame = f'=iI{len(self._name)}s'
        used = struct.calcsize(in_frame)
        self._first = struct.Struct(f'{in_frame}{-(begin + used) % 8}x')
        self._pose = struct.Struct(f'{in_frame}{-used % 8}x7d')
        self._numbers_at = self._pose.size - struct.calcsize('=7d')
        self._poses = bytearray()

    def __len__(self) -> int:
        """Return the number of poses."""
        return len(self._poses) // self._pose.size

    def clear(self) -> None:
        """Forget all poses."""
        self._poses.clear()

    def add(self, time_ns: int, pose: Pose) -> None:
        """Add a pose with its time [ns], which is that of the path as well."""
        self._stamp = time_ns // NANOSECONDS, time_ns % NANOSECONDS
        if len(self) >= self._most:
            del self._poses[:self._pose.size]
        self._poses += self._pose.pack(
            *self._stamp, self._name, pose.x, pose.y, 0.0, 0.0, 0.0, *quaternion_of(pose.theta))

    def encode(self) -> bytes:
        """Return the message."""
        front = stamped_sequence(*self._stamp, self._frame_id, len(self))
        if not self._poses:
            return front
        first = self._first.pack(*struct.unpack_from('=iI', self._poses), self._name)
        return b''.join((front, first, memoryview(self._poses)[self._numbers_at:]))


def encode_poses(header: Header, rows: Array) -> bytes:
    """Return a PoseArray of rows, shape (N, 7): x, y, z [m] and the quaternion x, y, z, w."""
    return _message(header, rows)


def encode_polygon(header: Header, x: Array, y: Array) -> bytes:
    """Return a PolygonStamped of vertices [m]; its numbers travel as float32."""
    rows = np.zeros((len(x), 3), np.float32)
    rows[:, 0], rows[:, 1] = x, y
    return _message(header, rows)


def _message(header: Header, rows: 'NDArray[np.floating]') -> bytes:
    """Return a header and a sequence of structures that have but numbers of one type."""
    front = stamped_sequence(header.stamp.sec, header.stamp.nanosec, header.frame_id, len(rows))
    if not len(rows):
        return front
    padding = bytes((len(HEADER) - len(front)) % rows.itemsize)
    return b''.join((front, padding, memoryview(np.ascontiguousarray(rows)).cast('B')))
