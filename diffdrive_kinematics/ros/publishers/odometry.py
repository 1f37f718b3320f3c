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

"""Odometry of a base, the path it has driven, and where its belief's frame is in the world."""

import math
from typing import Any, Mapping, Optional, Tuple

from diffdrive_kinematics.core.kinematics import compose, inverse, Pose
from diffdrive_kinematics.core.noise import twist_covariance
import diffdrive_kinematics.core.odometry as core
from diffdrive_kinematics.core.odometry import OdometryHistory, WheelPair
from diffdrive_kinematics.ros.messages.codec import OdometryCodec, PathCodec
from diffdrive_kinematics.ros.messages.messages import check_stamp, nanoseconds, pose_in_plane
from diffdrive_kinematics.ros.publishers.tf import frame_prefix, TransformPublisher
from diffdrive_kinematics.ros.runtime.node import DiffDriveNode
from nav_msgs.msg import Odometry, Path


class OdometryPublisher:
    """
    Publishes odometry, with fixed diagonals or with the covariance that the slip makes.

    Parameters
    ----------
    node : DiffDriveNode
        That publishes.
    values : mapping
        Its parameters.  Without an ``odom_topic`` there is nothing but the frames.

    """

    def __init__(self, node: DiffDriveNode[Any], values: Mapping[str, Any]) -> None:
        prefix = frame_prefix(values, node.get_namespace())
        self.frames = prefix + values['odom_frame_id'], prefix + values['base_frame_id']
        self.codec = OdometryCodec(*self.frames)
        self.publisher = node.runtime.publish_unless_off(Odometry, values['odom_topic'])
        self._twist_of: Optional[WheelPair] = None  # whose covariance the message has
        self.configure(values)

    def configure(self, values: Mapping[str, Any]) -> None:
        """Set what stays: the fixed diagonals, or the floor where nothing is observed."""
        pose, twist = values['pose_covariance_diagonal'], values['twist_covariance_diagonal']
        self.pose_slips, self._twist_slips = not any(pose), not any(twist)
        self.floor = floor = values['covariance_floor']
        self._period = 1.0 / values['publish_rate']  # in which the twist is measured [s]
        self._twist_of = None
        self.codec.set_diagonals(*(
            diagonal if any(diagonal) else (floor,) * 6 for diagonal in (pose, twist)))

    def set_twist_covariance(self, rates: WheelPair, odometry: core.Odometry) -> None:
        """Set the covariance of the twist, where it comes from the slip."""
        if self._twist_slips and rates != self._twist_of:
            self._twist_of = rates
            self.codec.set_twist_covariance(twist_covariance(
                odometry.geometry, rates, *odometry.slip_variances, self._period, self.floor,
                odometry.body_slip))

    def publish(self, now_ns: int, reading: core.BaseState, odometry: core.Odometry) -> None:
        """Publish what a base reads now; slip up to now makes its covariance."""
        if self.publisher is None:
            return
        if self.pose_slips:
            self.codec.set_pose_covariance(odometry.covariance_at(now_ns), self.floor)
        self.set_twist_covariance(reading.rates, odometry)
        self.publisher.publish(self.codec.encode(now_ns, reading))


class BeliefCorrection:
    """
    Publishes where the frame of the belief is, so that the robot is seen where it really is.

    Parameters
    ----------
    frames : pair of str
        Of the base that knows the truth, and of the robot.
    transform : TransformPublisher
        Where to publish it.
    odometry : Odometry
        Of the base.

    """

    def __init__(
            self, frames: Tuple[str, str], transform: TransformPublisher,
            odometry: core.Odometry) -> None:
        self._frames, self._transform = frames, transform
        self._history = OdometryHistory((odometry,))

    def follow(self, odometry: core.Odometry) -> None:
        """Note how the odometry has gone on."""
        self._history = self._history.followed(odometry)

    def begin_anew(self, odometry: core.Odometry) -> None:
        """Forget what was before."""
        self._history = OdometryHistory((odometry,))

    def publish(self, belief: Odometry) -> None:
        """Publish what corrects a belief; ``ValueError`` where its stamp or frames are wrong."""
        own, base = self._frames
        if belief.child_frame_id != base:
            raise ValueError(f'child_frame_id is {belief.child_frame_id!r}, expected {base!r}')
        if belief.header.frame_id in ('', own):
            raise ValueError(
                f'frame_id is {belief.header.frame_id!r}, expected another frame than {own!r}')
        stamp = belief.header.stamp
        check_stamp(stamp.sec, stamp.nanosec)
        stamp_ns = nanoseconds(stamp)
        if not stamp_ns:
            raise ValueError('stamp is 0, expected the time of the pose')
        believed = pose_in_plane(belief.pose.pose)
        if self._history.past[-1].motion is None:
            return
        truth = self._history.pose_at(stamp_ns)
        self._transform.publish(
            stamp_ns, (own, belief.header.frame_id), compose(truth, inverse(believed)))


class PathPublisher:
    """
    Keeps the last poses of a base, and publishes them where they have changed.

    Parameters
    ----------
    node : DiffDriveNode
        The node that publishes.
    values : mapping
        Its parameters: ``path_topic``, ``path_length``, ``path_spacing``, ``path_rate``.
    frame_id : str
        Of the poses.

    """

    def __init__(self, node: DiffDriveNode[Any], values: Mapping[str, Any], frame_id: str) -> None:
        self._spacing = values['path_spacing']
        self._message = PathCodec(frame_id, values['path_length'])
        self._last: Optional[Pose] = None
        self._subscribers = 0
        self._publisher = node.runtime.publish(Path, values['path_topic'])
        node.runtime.every(values['path_rate'], self._publish)

    def begin_anew(self) -> None:
        """Forget the way so far: a robot that was put elsewhere did not drive there."""
        self._message.clear()
        self._last = None

    def add(self, time_ns: int, pose: Pose) -> None:
        """Add a pose where it is far enough from the last one."""
        if self._last is not None and math.hypot(
                pose.x - self._last.x, pose.y - self._last.y) < self._spacing:
            return
        self._last = pose
        self._message.add(time_ns, pose)
        self._subscribers = 0

    def _publish(self) -> None:
        """Publish the path where it has changed, or somebody subscribes anew."""
        subscribers = self._publisher.get_subscription_count()
        if len(self._message) and subscribers > self._subscribers:
            self._publisher.publish(self._message.encode())
        self._subscribers = subscribers
