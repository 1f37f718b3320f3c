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

Messages are built once and refilled.  rclpy does not check field types unless
ROS_PYTHON_CHECK_FIELDS=1, so every number is put in as a float.
"""

import math
from typing import Callable, List, MutableSequence, Optional, Sequence, Tuple

from builtin_interfaces.msg import Time
from diffdrive_kinematics.core.arc import Pose
from diffdrive_kinematics.core.covariance import PoseCovariance, TwistCovariance
from diffdrive_kinematics.core.encoders import Encoder, PositionTrack
from diffdrive_kinematics.core.odometry import BaseReading
from diffdrive_kinematics.core.planar import planar_covariance, planar_pose
from diffdrive_kinematics.core.wheel_motion import Pair, WheelSample
from diffdrive_kinematics.nodes.wheel_joints import WheelJoints
from geometry_msgs.msg import Pose as PoseMessage, PoseWithCovarianceStamped, TwistStamped
from nav_msgs.msg import Odometry
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64MultiArray

__all__ = [
    'OdometryMessage', 'TwistMessage', 'WheelCommandMessage', 'WheelMessage', 'WheelReader',
    'check_stamp', 'given_pose', 'nanoseconds', 'pose_in_plane', 'set_stamp']

NANOSECONDS = 1_000_000_000
LAST_SECOND = 2**31 - 1


def nanoseconds(stamp: Time) -> int:
    """Return a stamp as an integer of nanoseconds."""
    return stamp.sec * NANOSECONDS + stamp.nanosec


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


def check_stamp(stamp: Time) -> None:
    """Raise ``ValueError`` for a stamp that is none, or after which no other could be told."""
    if stamp.nanosec >= NANOSECONDS or stamp.sec == LAST_SECOND:
        raise ValueError(
            f'stamp is (sec, nanosec) {(stamp.sec, stamp.nanosec)!r}, expected nanosec below '
            f'{NANOSECONDS} and sec below {LAST_SECOND}')


class WheelReader:
    """
    Reads wheel motion from JointState: joints in any order, several wheels a side.

    A side's rate and position are the means over its wheels.  ``header.frame_id``, which has no
    other meaning in a JointState, tells one run of a publisher of this package from another.
    Positions that wrap around with the range of the encoders [rad] are followed, each joint by
    itself; range 0: they do not wrap.
    """

    def __init__(
            self, joints: WheelJoints, *, positions: bool = True,
            encoder_range: float = 0.0) -> None:
        self._joints = joints
        self._with_positions = positions
        self._fresh_track = self._track = PositionTrack(encoder_range)
        self._source = ''
        self._known_names: List[str] = []
        self._indices: Tuple[Tuple[int, ...], Tuple[int, ...]] = ((), ())

    def read(
            self, message: JointState, now_ns: Callable[[], int]) -> Optional[WheelSample]:
        """
        Return the wheel sample of a message; None where none of our joints is in it.

        A zero stamp means now.  Values that are NaN for all our joints count as absent, since
        joint_state_broadcaster fills in NaN for what a robot does not measure.

        Raises
        ------
        ValueError
            If some of our joints are missing, lengths do not match, values are not finite, or
            the stamp is none.

        """
        if message.name != self._known_names:
            indices = self._find(message.name)
            if indices is None:
                return None
            self._indices, self._known_names = indices, list(message.name)
        check_stamp(message.header.stamp)
        rates = self._pair('velocity', message.velocity)
        positions = None
        if self._with_positions:
            positions = self._pair('position', self._followed(message))
        if rates is not None and positions is not None:
            rates = None if _is_nan(rates) else rates
            positions = None if _is_nan(positions) and rates else positions
        return WheelSample(nanoseconds(message.header.stamp) or now_ns(), rates, positions,
                           source=message.header.frame_id)

    def _find(
            self, names: Sequence[str]) -> Optional[Tuple[Tuple[int, ...], Tuple[int, ...]]]:
        wanted = self._joints.all_names()
        missing = [name for name in wanted if name not in names]
        if len(missing) == len(wanted):
            return None
        if missing:
            raise ValueError(
                f'name is {list(names)!r}, only some of our joints, expected also {missing!r}')
        names = list(names)
        left, right = (tuple(names.index(name) for name in side) for side in self._joints.names)
        return left, right

    def _followed(self, message: JointState) -> Sequence[float]:
        """Return the positions of a message without their wraps; each source counts anew."""
        positions = message.position
        if not self._track.period or len(positions) != len(self._known_names):
            return positions
        ours = [positions[i] for side in self._indices for i in side]
        if not all(map(math.isfinite, ours)):
            return positions
        source = message.header.frame_id
        track = self._track if source == self._source else self._fresh_track
        self._track, self._source = track.followed(ours), source
        followed = list(positions)
        for index, position in zip(
                (i for side in self._indices for i in side), self._track.positions):
            followed[index] = position
        return followed

    def _pair(self, field: str, values: Sequence[float]) -> Optional[Pair]:
        if not values:
            return None
        if len(values) != len(self._known_names):
            raise ValueError(
                f'{field} has {len(values)} values, expected {len(self._known_names)}, one for '
                'each name')
        left, right = (
            sum(values[i] for i in side) / len(side) for side in self._indices)
        return self._joints.signed((left, right))


def _is_nan(pair: Pair) -> bool:
    return math.isnan(pair[0]) and math.isnan(pair[1])


class WheelMessage:
    """
    A JointState for all wheels that is filled anew for each sample.

    ``source`` tells this run of this publisher from any other, so that positions that begin to
    count anew are not taken for motion (see ``WheelReader``).  ``encoder`` reads the positions.
    """

    def __init__(
            self, joints: WheelJoints, source: str = '', encoder: Encoder = Encoder()) -> None:
        self._joints, self._encoder = joints, encoder
        self.message = JointState(name=joints.all_names())
        self.message.header.frame_id = source

    def filled(
            self, stamp_ns: int, rates: Optional[Pair], positions: Optional[Pair]) -> JointState:
        """Return the message with a stamp, rates [rad/s] and positions [rad]; None: absent."""
        set_stamp(self.message.header.stamp, stamp_ns)
        joints = self._joints
        self.message.velocity = [] if rates is None else joints.spread(joints.signed(rates))
        self.message.position = [] if positions is None else joints.spread(
            self._read(joints.signed(positions)))
        return self.message

    def _read(self, angles: Pair) -> Pair:
        return self._encoder.reading(angles[0]), self._encoder.reading(angles[1])


class WheelCommandMessage:
    """A Float64MultiArray of wheel rates, left wheels then right wheels."""

    def __init__(self, joints: WheelJoints) -> None:
        self._joints = joints
        self.message = Float64MultiArray()

    def filled(self, rates: Pair) -> Float64MultiArray:
        """Return the message with rates [rad/s]."""
        self.message.data = self._joints.spread(self._joints.signed(rates))
        return self.message


class TwistMessage:
    """A TwistStamped in a frame."""

    def __init__(self, frame_id: str) -> None:
        self.message = TwistStamped()
        self.message.header.frame_id = frame_id

    def filled(self, stamp_ns: int, v: float, w: float) -> TwistStamped:
        """Return the message with a stamp and a twist [m/s, rad/s]."""
        set_stamp(self.message.header.stamp, stamp_ns)
        self.message.twist.linear.x = float(v)
        self.message.twist.angular.z = float(w)
        return self.message


POSE_BLOCK = (0, 1, 5, 6, 7, 11, 30, 31, 35)
TWIST_BLOCK = (0, 5, 30, 35)


def _write(matrix: MutableSequence[float], block: Sequence[int], values: Sequence[float]) -> None:
    """Write single elements, which for so few is faster than a slice of numpy."""
    for index, value in zip(block, values):
        matrix[index] = value


class OdometryMessage:
    """
    An Odometry with its frames and covariances, in the order (x, y, z, roll, pitch, yaw).

    The pose is in ``frame_id``, the twist in ``child_frame_id`` (nav_msgs/Odometry), and so are
    their covariances.  They are written only where they have changed.
    """

    def __init__(self, frame_id: str, child_frame_id: str) -> None:
        self.frame_id = frame_id
        self.message = Odometry(child_frame_id=child_frame_id)
        self.message.header.frame_id = frame_id
        self._pose_covariance: Optional[Tuple[float, ...]] = None
        self._twist_covariance: Optional[Tuple[float, ...]] = None

    def set_diagonals(self, pose: Sequence[float], twist: Sequence[float]) -> None:
        """Set the variances of pose and twist, six each, and all covariances to zero."""
        for matrix, diagonal in (
                (self.message.pose.covariance, pose), (self.message.twist.covariance, twist)):
            matrix[:] = 0.0
            matrix[::7] = diagonal
        self._pose_covariance = self._twist_covariance = None

    def set_pose_covariance(self, covariance: PoseCovariance, floor: float) -> None:
        """Set the block of x, y and yaw, with a floor of its variances."""
        if covariance != self._pose_covariance:
            self._pose_covariance = covariance
            xx, xy, xt, yy, yt, tt = covariance
            _write(self.message.pose.covariance, POSE_BLOCK, (
                xx + floor, xy, xt, xy, yy + floor, yt, xt, yt, tt + floor))

    def set_twist_covariance(self, covariance: TwistCovariance) -> None:
        """Set the block of forward speed and yaw rate."""
        if covariance != self._twist_covariance:
            self._twist_covariance = covariance
            vv, vw, ww = covariance
            _write(self.message.twist.covariance, TWIST_BLOCK, (vv, vw, vw, ww))

    def filled(self, stamp_ns: int, reading: BaseReading) -> Odometry:
        """Return the message with a stamp and what the base reads."""
        set_stamp(self.message.header.stamp, stamp_ns)
        pose = self.message.pose.pose
        pose.position.x = float(reading.pose.x)
        pose.position.y = float(reading.pose.y)
        pose.orientation.z = math.sin(0.5 * reading.pose.theta)
        pose.orientation.w = math.cos(0.5 * reading.pose.theta)
        twist = self.message.twist.twist
        twist.linear.x = float(reading.twist[0])
        twist.angular.z = float(reading.twist[1])
        return self.message
