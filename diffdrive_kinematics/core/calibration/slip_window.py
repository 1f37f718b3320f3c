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
Slip windows: stretches of wheel travel between reference poses, and what their error is made of.

In the frame of its start, a window's error is the reference's relative pose minus that of wheel
odometry.  If the systematic errors have been calibrated away, it is Gaussian with

``P = k_l A_l + k_r A_r + s_p^2 N_p + s_h^2 N_h``,

where ``A_w`` is the covariance of the package for ``k_w = 1`` (see
:func:`.covariance_along`), and s_p and s_h are the white noise of the reference's position (each
axis) and heading.  Both ends carry it: ``N_p = diag(2, 2, 0)``, and ``N_h = j j^T + diag(0, 0,
1)`` with ``j = (y, -x, -1)``, as an error of the heading at the start swings the whole
displacement (x, y).
"""

from dataclasses import dataclass

from diffdrive_kinematics.core.kinematics import between, Pose, WheelGeometry, wrap_angle
from diffdrive_kinematics.core.noise import covariance_along
import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ['SlipWindow', 'slip_window']

Array = NDArray[np.float64]


@dataclass(frozen=True)
class SlipWindow:
    """
    One window: its error, and what each unit of variance adds to the error's covariance.

    Arrays are in the frame of the window's start; covariances are of (x [m], y [m], theta [rad]).

    Parameters
    ----------
    error : numpy.ndarray, shape (3,)
        Relative pose of the reference minus that of wheel odometry, theta wrapped.
    left, right : numpy.ndarray, shape (3, 3)
        A_l and A_r: covariance for a slip constant of 1 m.
    position, heading : numpy.ndarray, shape (3, 3)
        N_p and N_h: covariance for a reference noise of 1 m^2 and 1 rad^2.

    Examples
    --------
    See :func:`slip_window`.

    """

    error: Array
    left: Array
    right: Array
    position: Array
    heading: Array


def slip_window(
        geometry: WheelGeometry, travel: ArrayLike, before: Pose, after: Pose) -> SlipWindow:
    """
    Return the window of wheel travel between two reference poses.

    Parameters
    ----------
    geometry : WheelGeometry
        Calibrated; only its separation counts.
    travel : array_like, shape (n, 2)
        Calibrated travel (d_l, d_r) [m] of each of n >= 1 intervals, in order.
    before, after : Pose
        Reference poses of the robot's centre (between the wheels) at the start and the end,
        floats, in one fixed frame.

    Returns
    -------
    SlipWindow
        Its error, and the covariances of which that of the error is made.

    Raises
    ------
    ValueError
        If the shape is another one, a number is not finite, or no wheel travelled.

    Examples
    --------
    A straight metre by the wheels, at the end of which a tracker sees the robot 2 mm to the left:

    >>> window = slip_window(
    ...     WheelGeometry(0.5, 0.125), np.full((20, 2), 0.05),
    ...     before=Pose(0.0, 0.0, 0.0), after=Pose(1.0, 0.002, 0.0))
    >>> abs(window.error.round(6))
    array([0.   , 0.002, 0.   ])

    """
    rows = np.asarray(travel, dtype=np.float64)
    if rows.ndim != 2 or rows.shape[1] != 2 or not len(rows):
        raise ValueError(f'travel has shape {rows.shape}, expected (n, 2) with n at least 1')
    if not np.isfinite(rows).all():
        raise ValueError('travel has numbers that are not finite, expected finite ones')
    if not np.isfinite(np.array([before, after], dtype=np.float64)).all():
        raise ValueError(f'reference poses are {before} and {after}, expected finite numbers')
    moving = rows[(rows != 0.0).any(axis=1)]
    if not len(moving):
        raise ValueError('travel is 0 throughout, expected a window in which a wheel turns')
    pose, (left, right) = covariance_along(geometry, moving)
    measured = _relative(before, after)
    odometry = np.array([pose.x, pose.y, pose.theta])
    error = measured - odometry
    error[2] = wrap_angle(float(error[2]))
    return SlipWindow(
        error, left, right, np.diag([2.0, 2.0, 0.0]),
        _heading_noise(float(pose.x), float(pose.y)))


def _relative(before: Pose, after: Pose) -> Array:
    """Return the pose ``after`` in the frame of ``before``, shape (3,); theta not wrapped."""
    return np.array(between(Pose(*map(float, before)), Pose(*map(float, after))))


def _heading_noise(x: float, y: float) -> Array:
    lever = np.array([y, -x, -1.0])
    return np.outer(lever, lever) + np.diag([0.0, 0.0, 1.0])
