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

"""A pose in the plane, and its covariance, from what others say in three dimensions."""

import math
from typing import Sequence, Tuple

from diffdrive_kinematics.core.kinematics import Array, is_sane, LARGEST, Pose
from diffdrive_kinematics.core.noise.pose_covariance import PoseCovariance
import numpy as np

UNIT_TOLERANCE = 1e-2
RELATIVE_TOLERANCE = 1e-6
NEGLIGIBLE = 1e-100
PLANE = (0, 1, 5)  # x, y, yaw of (x, y, z, roll, pitch, yaw)

Quaternion = Tuple[float, float, float, float]


def yaw_from_quaternion(quaternion: Quaternion) -> float:
    """
    Return the yaw of a rotation; a small error of its length is divided out.

    Parameters
    ----------
    quaternion : tuple of float
        Rotation as (x, y, z, w), of length 1 within 1 %.

    Returns
    -------
    float
        Yaw in [-pi, pi] [rad].

    Raises
    ------
    ValueError
        If a number is not finite, or the length is off 1 by more than 1 %.

    Examples
    --------
    >>> round(yaw_from_quaternion((0.0, 0.0, math.sin(0.25), math.cos(0.25))), 6)
    0.5

    """
    length = math.hypot(*quaternion)
    if not abs(length - 1.0) <= UNIT_TOLERANCE:
        raise ValueError(
            f'orientation (x, y, z, w) is {quaternion!r}, expected a quaternion of length 1')
    x, y, z, w = (value / length for value in quaternion)
    return math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))


def planar_pose(x: float, y: float, quaternion: Quaternion) -> Pose:
    """
    Return the pose in the plane of a position and an orientation.

    Parameters
    ----------
    x, y : float
        Position [m].
    quaternion : tuple of float
        Orientation as (x, y, z, w), of length 1 within 1 %.

    Returns
    -------
    Pose
        Its theta is the yaw of the orientation [rad].

    Raises
    ------
    ValueError
        If a number is not finite or is absurdly large, or the quaternion is not of length 1.

    Examples
    --------
    >>> planar_pose(1.0, 2.0, (0.0, 0.0, 0.0, 1.0))
    Pose(x=1.0, y=2.0, theta=0.0)

    """
    if not is_sane(x, y):
        raise ValueError(
            f'position (x, y) is {(x, y)!r}, expected finite numbers within +-{LARGEST:g} m')
    return Pose(x, y, yaw_from_quaternion(quaternion))


def planar_covariance(covariance: Sequence[float]) -> PoseCovariance:
    """
    Return the covariance of (x, y, yaw) in one of (x, y, z, roll, pitch, yaw).

    Parameters
    ----------
    covariance : sequence of float
        The 36 elements of the larger one, row by row, as in geometry_msgs [m^2, m rad, rad^2].

    Returns
    -------
    PoseCovariance
        Rows and columns 0, 1 and 5 of it.

    Raises
    ------
    ValueError
        If that block is not finite, not symmetric, or gives a variance below 0 to any direction.

    Examples
    --------
    >>> planar_covariance(np.diag([0.01, 0.02, 0.0, 0.0, 0.0, 0.03]).ravel().tolist())
    PoseCovariance(xx=0.01, xy=0.0, xt=0.0, yy=0.02, yt=0.0, tt=0.03)

    """
    block = np.reshape(covariance, (6, 6))[np.ix_(PLANE, PLANE)]
    tolerance = RELATIVE_TOLERANCE * float(np.abs(block).max())
    sane = is_sane(*block.flat) and np.allclose(block, block.T, rtol=0.0, atol=tolerance)
    if not sane or _smallest_share(block) < -RELATIVE_TOLERANCE:
        raise ValueError(
            f'covariance of (x, y, yaw) is {block.tolist()!r}, expected a symmetric matrix of '
            'finite numbers that gives no direction a variance below 0')
    return PoseCovariance.from_matrix(0.5 * (block + block.T))


def _smallest_share(block: Array) -> float:
    """Return the smallest eigenvalue of the correlations, which have no units; 0 where none."""
    deviations = np.sqrt(np.maximum(np.diag(block), 0.0))
    if np.any(np.diag(block) < 0.0):
        return -1.0
    certain = deviations == 0.0
    if np.any(np.abs(block[certain]) > NEGLIGIBLE):
        return -1.0
    scaled = np.where(certain, 1.0, deviations)
    return float(np.linalg.eigvalsh(block / np.outer(scaled, scaled))[0])
