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
Covariance of the pose to first order in the slip, along an arc.

The slip of a wheel is gathered along its way: ``dq = k |dd|`` is the variance that an element of
its travel adds.  An error of the travel at one point of the arc moves the end of the arc by the
gradient g of the rest of the arc, lever arms included, so the arc adds
``sum over the wheels of k |d| * integral_0^1 g(t) g(t)^T dt``.  Integrated like this the
covariance does not depend on how a path is cut into steps (Chong & Kleeman 1997); the usual form,
one Jacobian per step (Siegwart & Nourbakhsh, eq. 5.9), is 25 % low across a straight step.

It is linear in k, which is what a fit of k needs, and right while the heading is well known; what
odometry publishes is exact (:mod:`.arc_moments`).  A bias is no part of it: pass the travel
``(1 + b) d`` of the mean, and where k counts by nominal metre ``k / (1 + b)``.
"""

import math
from typing import Tuple

from diffdrive_kinematics.core.kinematics import (
    advance, check_non_negative, Pose, pose_change_from_travel, WheelGeometry)
from diffdrive_kinematics.core.noise.arc_means import arc_means
from diffdrive_kinematics.core.noise.pose_covariance import PoseCovariance


def slip_covariance(
        geometry: WheelGeometry, heading: float, d_left: float, d_right: float,
        k_left: float, k_right: float) -> PoseCovariance:
    """
    Return the covariance that slip adds along an arc, in the fixed frame.

    The integral over the arc in closed form.  In the axes of the arc's middle direction, with
    h = turn / 2, s from -1 (start) to 1 (end) and d_o the travel of the other wheel, an error of
    travel at s moves the end by ``g = (cos(h) / 2 -+ d_o / (2 L) e(s), +-(d_l + d_r) sinc(h) /
    (4 L) -+ d_o / (2 L) sin(h s) / h, +-1 / L)``, ``e(s) = (cos(h s) - cos(h)) / h``, upper signs
    for the right wheel: the Jacobian of the arc that is left, written so that nothing is singular
    on the straight line.  Valid for any turn; one arc and its parts give the same.

    Parameters
    ----------
    geometry : WheelGeometry
        Size and spacing of the wheels.
    heading : float
        Heading theta [rad] at the start of the arc.
    d_left, d_right : float
        Travel [m] of the wheels along the arc, the bias included; of any sign.
    k_left, k_right : float
        Slip variance per metre of that travel [m].

    Returns
    -------
    PoseCovariance
        What the arc adds to :func:`moved_covariance`.

    Raises
    ------
    ValueError
        If a slip variance is not finite or below 0.

    Examples
    --------
    After a straight metre, ``Var theta = (k_l + k_r) d / L^2`` and ``Var y`` is d^2 / 3 of it:

    >>> added = slip_covariance(WheelGeometry(0.5, 0.125), 0.0, 1.0, 1.0, 1e-4, 1e-4)
    >>> f'{added.tt:.2e} {added.yy:.2e}'
    '8.00e-04 2.67e-04'

    """
    q_left = check_non_negative('left slip variance', k_left) * abs(d_left)
    q_right = check_non_negative('right slip variance', k_right) * abs(d_right)
    distance, turn = pose_change_from_travel(geometry, d_left, d_right)
    half, per_length = 0.5 * turn, 1.0 / geometry.separation
    e_mean, e_square, sine_square = arc_means(half)
    cosine = math.cos(half)
    across = 0.5 * per_length * distance * (math.sin(half) / half if half else 1.0)
    lever_left, lever_right = 0.5 * per_length * d_right, -0.5 * per_length * d_left
    along_left = 0.5 * cosine + lever_left * e_mean
    along_right = 0.5 * cosine + lever_right * e_mean
    both = q_left + q_right
    difference = q_right * along_right - q_left * along_left
    middle = PoseCovariance(
        q_left * _mean_square(cosine, lever_left, e_mean, e_square)
        + q_right * _mean_square(cosine, lever_right, e_mean, e_square),
        across * difference,
        per_length * difference,
        across * across * both
        + (q_left * lever_left * lever_left + q_right * lever_right * lever_right) * sine_square,
        across * per_length * both,
        per_length * per_length * both)
    return middle.rotated(heading + half)


def _mean_square(cosine: float, lever: float, e_mean: float, e_square: float) -> float:
    """Return the mean of ``(cosine / 2 + lever e)^2`` along the arc."""
    return 0.25 * cosine * cosine + lever * (cosine * e_mean + lever * e_square)


def moved_covariance(
        covariance: PoseCovariance, before: Pose, after: Pose,
        added: PoseCovariance) -> PoseCovariance:
    """
    Return ``F P F^T`` plus what the motion adds.

    ``F = [[1, 0, -(y' - y)], [0, 1, x' - x], [0, 0, 1]]``: an error of the heading before the
    motion swings the whole motion (Smith, Self & Cheeseman 1990).

    Parameters
    ----------
    covariance : PoseCovariance
        P of the pose before, in the fixed frame.
    before, after : Pose
        Mean pose before and after the motion (floats), in the same frame.
    added : PoseCovariance
        Of :func:`slip_covariance`, for the heading before.

    Returns
    -------
    PoseCovariance
        Of the pose after, in the fixed frame.

    Examples
    --------
    A heading that is known to 0.1 rad makes 0.5 m across 5 m straight ahead:

    >>> from diffdrive_kinematics.core.noise import NO_COVARIANCE
    >>> start = NO_COVARIANCE._replace(tt=0.1**2)
    >>> moved = moved_covariance(start, Pose(0.0, 0.0, 0.0), Pose(5.0, 0.0, 0.0), NO_COVARIANCE)
    >>> round(math.sqrt(moved.yy), 6)
    0.5

    """
    dx, dy = float(after.x) - float(before.x), float(after.y) - float(before.y)
    xx, xy, xt, yy, yt, tt = covariance
    x_with_t, y_with_t = xt - dy * tt, yt + dx * tt
    return PoseCovariance(
        xx - dy * (xt + x_with_t) + added.xx,
        xy - dy * yt + dx * x_with_t + added.xy,
        x_with_t + added.xt,
        yy + dx * (yt + y_with_t) + added.yy,
        y_with_t + added.yt,
        tt + added.tt)


def propagated_covariance(
        covariance: PoseCovariance, pose: Pose, geometry: WheelGeometry, d_left: float,
        d_right: float, k_left: float, k_right: float) -> Tuple[Pose, PoseCovariance]:
    """
    Return the mean pose and its covariance after an arc, both in the frame of ``pose``.

    One step of a travel d and n steps of d/n give the same.

    Parameters
    ----------
    covariance : PoseCovariance
        Of the pose before.
    pose : Pose
        Mean pose before; floats.
    geometry : WheelGeometry
        Size and spacing of the wheels.
    d_left, d_right : float
        Travel [m] of the wheels along the arc, the bias included; of any sign.
    k_left, k_right : float
        Slip variance per metre of that travel [m].

    Returns
    -------
    pose : Pose
        Mean pose after; the heading is not wrapped.
    covariance : PoseCovariance
        Its covariance.

    Raises
    ------
    ValueError
        If a slip variance is not finite or below 0.

    Examples
    --------
    >>> from diffdrive_kinematics.core.noise import NO_COVARIANCE
    >>> pose, covariance = propagated_covariance(
    ...     NO_COVARIANCE, Pose(0.0, 0.0, 0.0), WheelGeometry(0.5, 0.125), 1.0, 1.0, 1e-4, 1e-4)
    >>> f'x = {pose.x:.1f} m, sigma_theta = {math.sqrt(covariance.tt):.4f} rad'
    'x = 1.0 m, sigma_theta = 0.0283 rad'

    """
    after = advance(pose, *pose_change_from_travel(geometry, d_left, d_right))
    added = slip_covariance(geometry, float(pose.theta), d_left, d_right, k_left, k_right)
    return after, moved_covariance(covariance, pose, after, added)
