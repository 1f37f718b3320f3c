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
Conversions between ROS messages and the core's values.

Messages that are sent often are bytes of which the numbers are overwritten (see ``wire``).
"""

import math
from typing import Iterable, Optional, Sequence, Tuple

from builtin_interfaces.msg import Time
from diffdrive_kinematics.core.kinematics import Pose
from diffdrive_kinematics.core.noise import (
    planar_covariance, planar_pose, PoseCovariance, TwistCovariance)
from diffdrive_kinematics.core.odometry import BaseState
from diffdrive_kinematics.ros.messages.cdr import (
    Layout, NANOSECONDS, read_stamped_twist, read_twist, Template)
from geometry_msgs.msg import Pose as PoseMessage, PoseWithCovarianceStamped, Twist, TwistStamped
from rclpy.serialization import deserialize_message

__all__ = [
    'OdometryMessage', 'TwistMessage', 'check_stamp', 'check_time', 'command_in', 'given_pose',
    'nanoseconds', 'pose_in_plane', 'quaternion_of', 'set_stamp']

LAST_SECOND = 2**31 - 1


def nanoseconds(stamp: Time) -> int:
    """Return a stamp as an integer of nanoseconds."""
    return stamp.sec * NANOSECONDS + stamp.nanosec


def check_stamp(sec: int, nanosec: int) -> None:
    """Raise ``ValueError`` for a stamp that is none, or after which no other could be told."""
    if nanosec >= NANOSECONDS or sec == LAST_SECOND:
        raise ValueError(
            f'stamp is (sec, nanosec) {(sec, nanosec)!r}, expected nanosec below '
            f'{NANOSECONDS} and sec below {LAST_SECOND}')


def check_time(stamp: Time) -> None:
    """Raise ``ValueError`` for a time that is no stamp, or before the epoch."""
    check_stamp(stamp.sec, stamp.nanosec)
    if stamp.sec < 0:
        raise ValueError(f'time is {stamp.sec} s, expected 0 or later')


def set_stamp(stamp: Time, time_ns: int) -> None:
    """Write a time [ns] into a stamp."""
    stamp.sec, stamp.nanosec = divmod(time_ns, NANOSECONDS)


def pose_in_plane(pose: PoseMessage) -> Pose:
    """
    Return a pose in the plane.

    Raises
    ------
    ValueError
        If a number is not finite or is absurdly large, or the orientation is none.

    """
    at, q = pose.position, pose.orientation
    return planar_pose(at.x, at.y, (q.x, q.y, q.z, q.w))


def given_pose(message: PoseWithCovarianceStamped, frame_id: str) -> Tuple[
        Pose, PoseCovariance]:
    """
    Return pose and covariance in the plane of a message in a frame.

    Raises
    ------
    ValueError
        If the frame is another one, or pose or covariance are none.

    """
    if message.header.frame_id != frame_id:
        raise ValueError(f'frame_id is {message.header.frame_id!r}, expected {frame_id!r}')
    return pose_in_plane(message.pose.pose), planar_covariance(message.pose.covariance)


def command_in(data: bytes, stamped: bool) -> Tuple[int, float, float]:
    """Return (stamp [ns], 0 for none; v; w) of a serialised Twist, or TwistStamped."""
    if not stamped:
        plain = read_twist(data)
        if plain is None:
            twist = deserialize_message(data, Twist)
            return 0, twist.linear.x, twist.angular.z
        return 0, plain[0], plain[1]
    fields = read_stamped_twist(data)
    if fields is None:
        message = deserialize_message(data, TwistStamped)
        twist = message.twist
        return nanoseconds(message.header.stamp), twist.linear.x, twist.angular.z
    sec, nanosec, v, w = fields
    return sec * NANOSECONDS + nanosec, v, w


class TwistMessage:
    """A serialised TwistStamped in a frame, or, without one, a Twist."""

    def __init__(self, frame_id: Optional[str]) -> None:
        layout = Layout()
        self._stamped = frame_id is not None
        if frame_id is not None:
            layout.header(frame_id)
        at = layout.numbers('d', [0.0] * 6)
        self._template = Template(layout)
        self._numbers = self._template.doubles(at, 6)

    def encode(self, stamp_ns: int, v: float, w: float) -> bytes:
        """Return the message with a stamp, where it has one, and a twist [m/s, rad/s]."""
        if self._stamped:
            self._template.stamp(stamp_ns)
        self._numbers[0], self._numbers[5] = v, w
        return self._template.message()


POSE_BLOCK = (0, 1, 5, 6, 7, 11, 30, 31, 35)
TWIST_BLOCK = (0, 5, 30, 35)
POSE_AT, POSE_COVARIANCE_AT, TWIST_AT, TWIST_COVARIANCE_AT = 0, 7, 43, 49
ODOMETRY_DOUBLES = 85


class OdometryMessage:
    """
    A serialised Odometry with its frames and covariances.

    The pose is in ``frame_id``, the twist in ``child_frame_id`` (nav_msgs/Odometry), and so are
    their covariances, in the order (x, y, z, roll, pitch, yaw).
    """

    def __init__(self, frame_id: str, child_frame_id: str) -> None:
        self.frame_id, self.child_frame_id = frame_id, child_frame_id
        layout = Layout()
        layout.header(frame_id)
        layout.text(child_frame_id)
        at = layout.numbers('d', [0.0] * ODOMETRY_DOUBLES)
        self._template = Template(layout)
        self._numbers = self._template.doubles(at, ODOMETRY_DOUBLES)
        self._pose_covariance: Optional[Tuple[float, ...]] = None

    def set_diagonals(self, pose: Sequence[float], twist: Sequence[float]) -> None:
        """Set the variances of pose and twist, six each, and all covariances to zero."""
        for at, diagonal in ((POSE_COVARIANCE_AT, pose), (TWIST_COVARIANCE_AT, twist)):
            self._write(at, range(36), (0.0,) * 36)
            self._write(at, range(0, 36, 7), diagonal)
        self._pose_covariance = None

    def set_pose_covariance(self, covariance: PoseCovariance, floor: float) -> None:
        """Set the block of x, y and yaw, with a floor of its variances."""
        if covariance is not self._pose_covariance:
            self._pose_covariance = covariance
            xx, xy, xt, yy, yt, tt = covariance
            self._write(POSE_COVARIANCE_AT, POSE_BLOCK, (
                xx + floor, xy, xt, xy, yy + floor, yt, xt, yt, tt + floor))

    def set_twist_covariance(self, covariance: TwistCovariance) -> None:
        """Set the block of forward speed and yaw rate."""
        vv, vw, ww = covariance
        self._write(TWIST_COVARIANCE_AT, TWIST_BLOCK, (vv, vw, vw, ww))

    def _write(self, at: int, block: Iterable[int], values: Iterable[float]) -> None:
        for index, value in zip(block, values):
            self._numbers[at + index] = value

    def encode(self, stamp_ns: int, reading: BaseState) -> bytes:
        """Return the message with a stamp and what the base reads."""
        self._template.stamp(stamp_ns)
        numbers, (x, y, theta) = self._numbers, reading.pose
        numbers[POSE_AT], numbers[POSE_AT + 1] = x, y
        numbers[POSE_AT + 5], numbers[POSE_AT + 6] = quaternion_of(theta)
        numbers[TWIST_AT], numbers[TWIST_AT + 5] = reading.twist
        return self._template.message()


def quaternion_of(theta: float) -> Tuple[float, float]:
    """Return (z, w) of the quaternion of a heading [rad]; its x and y are 0."""
    return math.sin(0.5 * theta), math.cos(0.5 * theta)
