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
The codec of bytes: what the plain codec says, without message objects, in a tenth of the time.

Numbers are written into bytes that are made once for each shape of message, and read by a struct
made once for each shape that has come.  What comes in another form is read by the plain codec.
Of many poses (paths, samples of the pose, boundaries) an array is the message already, but for
what stands in front of it; a message object of 1000 poses costs milliseconds.
"""

import math
import struct
from typing import Optional, Sequence

from diffdrive_kinematics.core.kinematics import Array, NANOSECONDS, Pose
from diffdrive_kinematics.core.noise import PoseCovariance, TwistCovariance
from diffdrive_kinematics.ros.messages import plain
from diffdrive_kinematics.ros.messages.cdr import (
    HEADER, Layout, STAMP_AT, stamped_sequence, Template, write_stamp)
from diffdrive_kinematics.ros.messages.messages import quaternion_of
from diffdrive_kinematics.ros.messages.plain import StampedTwist
from diffdrive_kinematics.ros.messages.serialised_joints import JointStateCodec
import numpy as np
from numpy.typing import NDArray
from std_msgs.msg import Header

__all__ = [
    'JointStateCodec', 'OdometryCodec', 'PathCodec', 'TransformCodec', 'TwistCodec',
    'encode_polygon', 'encode_poses']

TWIST_DOUBLES, ODOMETRY_DOUBLES = 6, 85
POSE_COVARIANCE_AT, TWIST_AT, TWIST_COVARIANCE_AT = 7, 43, 49
_read_twist = struct.Struct('=d32xd').unpack_from  # linear.x and angular.z
_read_stamp_and_length = struct.Struct('=iII').unpack_from
_write_pose = struct.Struct('=2d24x2d').pack_into  # x, y, and z and w of the quaternion
_write_twist = struct.Struct('=d32xd').pack_into  # of x and yaw
_write_rows = struct.Struct('=2d24x3d24xd').pack_into  # of x and y in a covariance
_write_row = struct.Struct('=2d24xd').pack_into  # of yaw
ROW_OF_YAW = 5 * 6 * 8


class TwistCodec(plain.TwistCodec):
    """A TwistStamped in a frame, or, without one, a Twist, which is read without an object."""

    def decode(self, message: bytes) -> StampedTwist:
        """Return what the message commands, whatever its frame."""
        return _twist_in(message, self._frame_id is not None) or super().decode(message)


def _twist_in(data: bytes, stamped: bool) -> Optional[StampedTwist]:
    """Return what a Twist or TwistStamped commands; None: it is in another form."""
    if data[:STAMP_AT] != HEADER or len(data) < STAMP_AT + 12:
        return None
    stamp_ns, first = 0, STAMP_AT
    if stamped:
        sec, nanosec, length = _read_stamp_and_length(data, STAMP_AT)
        after = STAMP_AT + 12 + length
        stamp_ns, first = sec * NANOSECONDS + nanosec, after + (STAMP_AT - after) % 8
    if len(data) < first + 8 * TWIST_DOUBLES:
        return None
    return StampedTwist(stamp_ns, *_read_twist(data, first))


class OdometryCodec(plain.OdometryCodec):
    """An Odometry with its frames and covariances, which are written into its bytes."""

    def __init__(self, frame_id: str, child_frame_id: str) -> None:
        super().__init__(frame_id, child_frame_id)
        layout = Layout()
        layout.header(frame_id)
        layout.text(child_frame_id)
        self._at = layout.numbers('d', [0.0] * ODOMETRY_DOUBLES)
        template = Template(layout)
        self._data, numbers = template.data, template.doubles(self._at, ODOMETRY_DOUBLES)
        self._pose = numbers[POSE_COVARIANCE_AT:TWIST_AT]
        self._twist = numbers[TWIST_COVARIANCE_AT:]
        self._last: Optional[PoseCovariance] = None

    def set_diagonals(self, pose: Sequence[float], twist: Sequence[float]) -> None:
        """Set the variances of pose and twist, six each, and all covariances to zero."""
        super().set_diagonals(pose, twist)
        self._last = None

    def set_pose_covariance(self, covariance: PoseCovariance, floor: float) -> None:
        """Set the block of x, y and yaw, with a floor of its variances."""
        if covariance is not self._last:
            self._last = covariance
            xx, xy, xt, yy, yt, tt = covariance
            at = self._at + 8 * POSE_COVARIANCE_AT
            _write_rows(self._data, at, xx + floor, xy, xt, xy, yy + floor, yt)
            _write_row(self._data, at + ROW_OF_YAW, xt, yt, tt + floor)

    def set_twist_covariance(self, covariance: TwistCovariance) -> None:
        """Set the block of forward speed and yaw rate."""
        (vv, vw, ww), at = covariance, self._at + 8 * TWIST_COVARIANCE_AT
        _write_twist(self._data, at, vv, vw)
        _write_twist(self._data, at + ROW_OF_YAW, vw, ww)

    def encoded(
            self, stamp_ns: int, x: float, y: float, theta: float, v: float, w: float) -> bytes:
        """Return the message with a stamp, a pose and a twist."""
        data, at, half = self._data, self._at, 0.5 * theta
        write_stamp(data, STAMP_AT, *divmod(stamp_ns, NANOSECONDS))
        _write_pose(data, at, x, y, math.sin(half), math.cos(half))
        _write_twist(data, at + 8 * TWIST_AT, v, w)
        return bytes(data)


class TransformCodec(plain.TransformCodec):
    """A TFMessage of one transform; does without tf2_msgs."""

    def __init__(self, frame_id: str, child_frame_id: str) -> None:
        super().__init__(frame_id, child_frame_id)
        layout = Layout()
        layout.numbers('I', [1])
        self._stamp_at = layout.header(frame_id)
        layout.text(child_frame_id)
        at = layout.numbers('d', [0.0] * 7)
        self._template = Template(layout)
        self._numbers = self._template.doubles(at, 7)

    def encode(self, stamp_ns: int, pose: Pose) -> bytes:
        """Return the message with a stamp and the pose of the child frame."""
        self._template.stamp(stamp_ns, self._stamp_at)
        self._numbers[0], self._numbers[1] = pose.x, pose.y
        self._numbers[5], self._numbers[6] = quaternion_of(pose.theta)
        return self._template.message()


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
