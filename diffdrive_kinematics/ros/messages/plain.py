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
The plain codec: messages as objects, to and from values of the core.

``encode`` returns a message that can be published; ``decode`` takes a message, or the bytes of
one, and returns a value.  :mod:`~diffdrive_kinematics.ros.messages.serialised` says the same
without objects; :mod:`~diffdrive_kinematics.ros.messages.codec` decides which one is used.
"""

from typing import (
    Any, Callable, Iterable, Mapping, MutableSequence, NamedTuple, Optional, Sequence, Tuple,
    Union)

from diffdrive_kinematics.core.kinematics import NANOSECONDS, Pose
from diffdrive_kinematics.core.noise import PoseCovariance, TwistCovariance
from diffdrive_kinematics.core.odometry import BaseState
from diffdrive_kinematics.ros.messages.messages import nanoseconds, quaternion_of, set_stamp
from geometry_msgs.msg import Pose as PoseMessage, TransformStamped, Twist, TwistStamped
from nav_msgs.msg import Odometry
from rclpy.serialization import deserialize_message
from sensor_msgs.msg import JointState
from std_msgs.msg import Header

POSE_BLOCK = (0, 1, 5, 6, 7, 11, 30, 31, 35)
TWIST_BLOCK = (0, 5, 30, 35)


class StampedTwist(NamedTuple):
    """Speed [m/s] and yaw rate [rad/s] of a command, and its stamp [ns]; 0: it has none."""

    stamp_ns: int
    v: float
    w: float


class JointValues(NamedTuple):
    """What a JointState says of joints, in the units of the joints; empty: nothing."""

    frame_id: str
    names: Tuple[str, ...]
    sec: int
    nanosec: int
    position: Sequence[float]
    velocity: Sequence[float]


def header_of(frame_id: str, stamp_ns: int) -> Header:
    """Return a header."""
    header = Header(frame_id=frame_id)
    set_stamp(header.stamp, stamp_ns)
    return header


def pose_message(pose: Pose) -> PoseMessage:
    """Return a pose in the plane as a message."""
    message = PoseMessage()
    message.position.x, message.position.y = pose.x, pose.y
    message.orientation.z, message.orientation.w = quaternion_of(pose.theta)
    return message


class TwistCodec:
    """A TwistStamped in a frame, or, without one, a Twist."""

    def __init__(self, frame_id: Optional[str]) -> None:
        self._frame_id = frame_id
        self.message_type = Twist if frame_id is None else TwistStamped

    @classmethod
    def of(cls, values: Mapping[str, Any]) -> 'TwistCodec':
        """Return the codec of the commands of a node, by the values of its parameters."""
        return cls(values['base_frame_id'] if values['enable_stamped_cmd_vel'] else None)

    def encode(self, stamp_ns: int, v: float, w: float) -> Union[Twist, TwistStamped]:
        """Return the message with a stamp, where it has one, and a twist [m/s, rad/s]."""
        twist = Twist()
        twist.linear.x, twist.angular.z = v, w
        if self._frame_id is None:
            return twist
        return TwistStamped(header=header_of(self._frame_id, stamp_ns), twist=twist)

    def decode(self, message: Union[bytes, Twist, TwistStamped]) -> StampedTwist:
        """Return what the message commands, whatever its frame."""
        read, stamp_ns = as_message(message, self.message_type), 0
        if self._frame_id is not None:
            read, stamp_ns = read.twist, nanoseconds(read.header.stamp)
        return StampedTwist(stamp_ns, read.linear.x, read.angular.z)


class JointStateCodec:
    """A JointState without efforts."""

    def encode(self, values: JointValues) -> JointState:
        """Return the message."""
        message = JointState(
            name=list(values.names), position=values.position, velocity=values.velocity)
        message.header.frame_id = values.frame_id
        message.header.stamp.sec, message.header.stamp.nanosec = values.sec, values.nanosec
        return message

    def encoder_of_two(self, frame_id: str, names: Tuple[str, ...]) -> Callable[..., Any]:
        """Return what makes the message of a stamp, and of positions and velocities of two."""
        return lambda stamp_ns, left, right, left_rate, right_rate: self.encode(JointValues(
            frame_id, names, *divmod(stamp_ns, NANOSECONDS), (left, right),
            (left_rate, right_rate)))

    def decode(self, message: Union[bytes, JointState]) -> JointValues:
        """Return what the message says of all its joints, whatever their lengths."""
        message = as_message(message, JointState)
        header = message.header
        return JointValues(
            header.frame_id, tuple(message.name), header.stamp.sec, header.stamp.nanosec,
            message.position, message.velocity)

    def shape_of(self, message: bytes) -> Any:
        """Return what reads messages like it; None: only this codec does."""


class OdometryCodec:
    """
    An Odometry with its frames and covariances.

    The pose is in ``frame_id``, the twist in ``child_frame_id`` (nav_msgs/Odometry), and so are
    their covariances, in the order (x, y, z, roll, pitch, yaw).
    """

    def __init__(self, frame_id: str, child_frame_id: str) -> None:
        self.frame_id, self.child_frame_id = frame_id, child_frame_id
        self._pose: MutableSequence[float] = [0.0] * 36
        self._twist: MutableSequence[float] = [0.0] * 36

    def set_diagonals(self, pose: Sequence[float], twist: Sequence[float]) -> None:
        """Set the variances of pose and twist, six each, and all covariances to zero."""
        for matrix, diagonal in ((self._pose, pose), (self._twist, twist)):
            _write(matrix, range(36), (0.0,) * 36)
            _write(matrix, range(0, 36, 7), diagonal)

    def set_pose_covariance(self, covariance: PoseCovariance, floor: float) -> None:
        """Set the block of x, y and yaw, with a floor of its variances."""
        xx, xy, xt, yy, yt, tt = covariance
        _write(self._pose, POSE_BLOCK, (
            xx + floor, xy, xt, xy, yy + floor, yt, xt, yt, tt + floor))

    def set_twist_covariance(self, covariance: TwistCovariance) -> None:
        """Set the block of forward speed and yaw rate."""
        vv, vw, ww = covariance
        _write(self._twist, TWIST_BLOCK, (vv, vw, vw, ww))

    def encode(self, stamp_ns: int, state: BaseState) -> Any:
        """Return the message with a stamp and the state of the base."""
        return self.encoded(stamp_ns, *state.pose, *state.twist)

    def encoded(self, stamp_ns: int, x: float, y: float, theta: float, v: float, w: float) -> Any:
        """Return the message with a stamp, a pose and a twist."""
        message = Odometry(
            header=header_of(self.frame_id, stamp_ns), child_frame_id=self.child_frame_id)
        message.pose.pose = pose_message(Pose(x, y, theta))
        message.pose.covariance[:] = self._pose
        message.twist.twist.linear.x, message.twist.twist.angular.z = v, w
        message.twist.covariance[:] = self._twist
        return message


def _write(matrix: MutableSequence[float], block: Iterable[int], values: Iterable[float]) -> None:
    for index, value in zip(block, values):
        matrix[index] = value


class TransformCodec:
    """A TFMessage of one transform; needs tf2_msgs."""

    def __init__(self, frame_id: str, child_frame_id: str) -> None:
        self.frames = frame_id, child_frame_id

    def encode(self, stamp_ns: int, pose: Pose) -> Any:
        """Return the message with a stamp and the pose of the child frame."""
        from tf2_msgs.msg import TFMessage
        return TFMessage(transforms=[self.transform(stamp_ns, pose)])

    def transform(self, stamp_ns: int, pose: Pose) -> TransformStamped:
        """Return the transform alone."""
        frame_id, child_frame_id = self.frames
        message = TransformStamped(
            header=header_of(frame_id, stamp_ns), child_frame_id=child_frame_id)
        message.transform.translation.x, message.transform.translation.y = pose.x, pose.y
        message.transform.rotation.z, message.transform.rotation.w = quaternion_of(pose.theta)
        return message


def as_message(message: Any, message_type: type) -> Any:
    """Return a message, which may be serialised."""
    return deserialize_message(message, message_type) if isinstance(message, bytes) else message
