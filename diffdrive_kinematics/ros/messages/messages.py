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

"""Stamps and poses of messages, judged and as the core has them; both codecs use them."""

import math
from typing import Tuple

from builtin_interfaces.msg import Time
from diffdrive_kinematics.core.kinematics import NANOSECONDS, Pose
from diffdrive_kinematics.core.noise import planar_covariance, planar_pose, PoseCovariance
from geometry_msgs.msg import Pose as PoseMessage, PoseWithCovarianceStamped

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


def given_pose(message: PoseWithCovarianceStamped, frame_id: str) -> Tuple[Pose, PoseCovariance]:
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


def quaternion_of(theta: float) -> Tuple[float, float]:
    """Return (z, w) of the quaternion of a heading [rad]; its x and y are 0."""
    return math.sin(0.5 * theta), math.cos(0.5 * theta)
