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

``P = k_l A_l + k_r A_r + k_d A_d + k_t A_t + k_x A_x + s_p^2 N_p + s_h^2 N_h + s_t^2 N_t``,

where ``A_w`` is the covariance of the package for ``k_w = 1`` (see :func:`.covariance_along`;
d, t and x are the slip of the body, see :class:`.BodySlip`), and s_p and s_h are the white noise
of the reference's position (each axis) and heading, s_t that of its stamps, which moves a pose by
its twist.  Both ends carry it: ``N_p = diag(2, 2, 0)``, and ``N_h = j j^T + diag(0, 0, 1)`` with
``j = (y, -x, -1)``, as an error of the heading at the start swings the whole displacement (x, y).
"""

from dataclasses import dataclass

from diffdrive_kinematics.core.kinematics import Array, between, Pose, WheelGeometry, wrap_angle
from diffdrive_kinematics.core.noise import arcs_along, body_covariance_along, covariance_along
import numpy as np
from numpy.typing import ArrayLike

NO_TWISTS = ((0.0, 0.0), (0.0, 0.0))


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
    body : numpy.ndarray, shape (3, 3, 3)
        A_d, A_t and A_x: covariances for constants of 1 m, 1 rad and 1 rad^2/m of the body.
    position, heading, time : numpy.ndarray, shape (3, 3)
        N_p, N_h and N_t: covariance for a reference noise of 1 m^2, 1 rad^2 and 1 s^2.

    Examples
    --------
    See :func:`slip_window`.

    """

    error: Array
    left: Array
    right: Array
    body: Array
    position: Array
    heading: Array
    time: Array


def slip_window(
        geometry: WheelGeometry, travel: ArrayLike, before: Pose, after: Pose, *,
        twists: ArrayLike = NO_TWISTS) -> SlipWindow:
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
    twists : array_like, shape (2, 2)
        Speed [m/s] and yaw rate [rad/s] at the start and at the end, of which the noise of the
        stamps makes errors.

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
    arcs = arcs_along(geometry, moving)
    pose, (left, right) = arcs.end, covariance_along(arcs)
    measured = np.array(between(Pose(*map(float, before)), Pose(*map(float, after))))
    odometry = np.array([pose.x, pose.y, pose.theta])
    error = measured - odometry
    error[2] = wrap_angle(float(error[2]))
    return SlipWindow(
        error, left, right, body_covariance_along(arcs), np.diag([2.0, 2.0, 0.0]),
        _heading_noise(float(pose.x), float(pose.y)),
        _time_noise(pose, np.asarray(twists, dtype=np.float64)))


def _heading_noise(x: float, y: float) -> Array:
    lever = np.array([y, -x, -1.0])
    return np.outer(lever, lever) + np.diag([0.0, 0.0, 1.0])


def _time_noise(pose: Pose, twists: Array) -> Array:
    """Return N_t, where a stamp that is late moves an end by its twist."""
    (v_start, w_start), (v_end, w_end) = twists
    start = np.array([w_start * pose.y - v_start, -w_start * pose.x, -w_start])
    end = np.array([v_end * np.cos(pose.theta), v_end * np.sin(pose.theta), w_end])
    noise: Array = np.outer(start, start) + np.outer(end, end)
    return noise
