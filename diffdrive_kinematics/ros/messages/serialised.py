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
"""

import struct
from typing import Any, Dict, Optional, Sequence, Tuple

from diffdrive_kinematics.core.kinematics import NANOSECONDS, Pose
from diffdrive_kinematics.core.noise import PoseCovariance
from diffdrive_kinematics.core.odometry import BaseState
from diffdrive_kinematics.ros.messages import plain
from diffdrive_kinematics.ros.messages.cdr import HEADER, Layout, STAMP_AT, Template
from diffdrive_kinematics.ros.messages.messages import quaternion_of
from diffdrive_kinematics.ros.messages.plain import JointValues, StampedTwist
from rclpy.serialization import deserialize_message
from sensor_msgs.msg import JointState

__all__ = [
    'JointStateCodec', 'OdometryCodec', 'TransformCodec', 'TwistCodec', 'WheelCommandCodec']

MOST_SHAPES = 16
AFTER_STAMP = 3  # values: those of the header of four bytes, of sec and of nanosec
TWIST_DOUBLES, ODOMETRY_DOUBLES = 6, 85
POSE_AT, POSE_COVARIANCE_AT, TWIST_AT, TWIST_COVARIANCE_AT = 0, 7, 43, 49
_read_twist = struct.Struct('=d32xd').unpack_from  # linear.x and angular.z
_read_stamp_and_length = struct.Struct('=iII').unpack_from


class TwistCodec(plain.TwistCodec):
    """A TwistStamped in a frame, or, without one, a Twist."""

    def __init__(self, frame_id: Optional[str]) -> None:
        super().__init__(frame_id)
        layout = Layout()
        if frame_id is not None:
            layout.header(frame_id)
        at = layout.numbers('d', [0.0] * TWIST_DOUBLES)
        self._template = Template(layout)
        self._numbers = self._template.doubles(at, TWIST_DOUBLES)

    def encode(self, stamp_ns: int, v: float, w: float) -> bytes:
        """Return the message with a stamp, where it has one, and a twist [m/s, rad/s]."""
        if self._frame_id is not None:
            self._template.stamp(stamp_ns)
        self._numbers[0], self._numbers[5] = v, w
        return self._template.message()

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


class JointStateCodec(plain.JointStateCodec):
    """A JointState without efforts."""

    def __init__(self) -> None:
        self._written: Dict[Tuple[str, Sequence[str], int, int], _JointStateTemplate] = {}
        self._read: Dict[int, _JointStateShape] = {}

    def encode(self, values: JointValues) -> bytes:
        """Return the message."""
        frame_id, names, sec, nanosec, position, velocity = values
        shape = frame_id, names, len(position), len(velocity)
        template = self._written.get(shape)
        if template is None:
            template = _keep(self._written, shape, _JointStateTemplate(*shape))
        template.stamp(sec * NANOSECONDS + nanosec)
        for numbers, given in ((template.position, position), (template.velocity, velocity)):
            for index, value in enumerate(given):
                numbers[index] = value
        return template.message()

    def decode(self, message: bytes) -> JointValues:
        """Return what the message says of all its joints, whatever their lengths."""
        shape = self._read.get(len(message))
        found = shape.values(message) if shape else None
        if found:
            return found
        known = deserialize_message(message, JointState)
        _keep(self._read, len(message), _JointStateShape(known))  # the next one will be like it
        return super().decode(known)


def _keep(shapes: Dict[Any, Any], key: Any, shape: Any) -> Any:
    """Remember a shape and return it; of many the old ones are forgotten."""
    if len(shapes) >= MOST_SHAPES:
        shapes.clear()
    shapes[key] = shape
    return shape


def _joint_names(frame_id: str, names: Sequence[str]) -> Layout:
    """Return the layout of a JointState up to its positions."""
    layout = Layout()
    layout.header(frame_id)
    layout.numbers('I', [len(names)])
    for name in names:
        layout.text(name)
    return layout


class _JointStateTemplate(Template):
    """The bytes of a JointState with so many positions and velocities."""

    def __init__(
            self, frame_id: str, names: Sequence[str], positions: int, velocities: int) -> None:
        layout = _joint_names(frame_id, names)
        at = [layout.sequence('d', [0.0] * count) for count in (positions, velocities, 0)]
        super().__init__(layout)
        self.position = self.doubles(at[0], positions)
        self.velocity = self.doubles(at[1], velocities)


class _JointStateShape:
    """Reads messages that differ only in their stamp and numbers from the one it is made of."""

    def __init__(self, message: JointState) -> None:
        self._frame_id, self._names = message.header.frame_id, tuple(message.name)
        layout = _joint_names(self._frame_id, self._names)
        self._texts = slice(AFTER_STAMP, len(layout.values))
        self._position, self._velocity, effort = (
            self._sequence(layout, numbers)
            for numbers in (message.position, message.velocity, message.effort))
        self._known = tuple(layout.values)
        self._counts = [each.start - 1 for each in (self._position, self._velocity, effort)]
        self._unpack = struct.Struct(layout.format).unpack_from
        self._size = layout.size

    @staticmethod
    def _sequence(layout: Layout, numbers: Sequence[float]) -> slice:
        """Append a sequence of doubles; return which of the values they are."""
        layout.sequence('d', numbers)
        return slice(len(layout.values) - len(numbers), len(layout.values))

    def values(self, data: bytes) -> Optional[JointValues]:
        """Return what a serialised message says; None: it is of another shape."""
        if len(data) < self._size:
            return None
        fields, known = self._unpack(data), self._known
        if fields[self._texts] != known[self._texts] or any(
                fields[index] != known[index] for index in self._counts):
            return None
        return JointValues(self._frame_id, self._names, fields[1], fields[2],
                           fields[self._position], fields[self._velocity])


class WheelCommandCodec(plain.WheelCommandCodec):
    """A Float64MultiArray of rates of so many joints."""

    def __init__(self, count: int) -> None:
        layout = Layout()
        layout.sequence('I', [])  # dimensions
        layout.numbers('I', [0])  # offset of the data
        at = layout.sequence('d', [0.0] * count)
        self._template = Template(layout)
        self._rates = self._template.doubles(at, count)

    def encode(self, rates: Sequence[float]) -> bytes:
        """Return the message with a rate [rad/s] of each joint."""
        for index, rate in enumerate(rates):
            self._rates[index] = rate
        return self._template.message()


class OdometryCodec(plain.OdometryCodec):
    """An Odometry with its frames and covariances, which are written into its bytes."""

    def __init__(self, frame_id: str, child_frame_id: str) -> None:
        super().__init__(frame_id, child_frame_id)
        layout = Layout()
        layout.header(frame_id)
        layout.text(child_frame_id)
        at = layout.numbers('d', [0.0] * ODOMETRY_DOUBLES)
        self._template = Template(layout)
        self._numbers = self._template.doubles(at, ODOMETRY_DOUBLES)
        self._pose = self._numbers[POSE_COVARIANCE_AT:TWIST_AT]
        self._twist = self._numbers[TWIST_COVARIANCE_AT:]
        self._last: Optional[PoseCovariance] = None

    def set_diagonals(self, pose: Sequence[float], twist: Sequence[float]) -> None:
        """Set the variances of pose and twist, six each, and all covariances to zero."""
        super().set_diagonals(pose, twist)
        self._last = None

    def set_pose_covariance(self, covariance: PoseCovariance, floor: float) -> None:
        """Set the block of x, y and yaw, with a floor of its variances."""
        if covariance is not self._last:
            self._last = covariance
            super().set_pose_covariance(covariance, floor)

    def encode(self, stamp_ns: int, state: BaseState) -> bytes:
        """Return the message with a stamp and the state of the base."""
        self._template.stamp(stamp_ns)
        numbers, (x, y, theta) = self._numbers, state.pose
        numbers[POSE_AT], numbers[POSE_AT + 1] = x, y
        numbers[POSE_AT + 5], numbers[POSE_AT + 6] = quaternion_of(theta)
        numbers[TWIST_AT], numbers[TWIST_AT + 5] = state.twist
        return self._template.message()


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
