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
Exact moments of the pose under slip, from an arc and from arc after arc.

Published and true heading differ by phi, published and true position by zeta, a complex number
x + iy.  Slip makes phi Gaussian, so the mean of ``e^{i phi}`` is known, and with it those moments
of the position that a filter asks for: no linearisation, whatever the yaw.

Along an arc, t from 0 to 1, slip adds evenly: Q to the variance of the distance of the centre, V
to that of the heading, C to their covariance.  What has to happen after t turns with the heading
error at t, and its mean, in the frame of the start, is

    ``rho(t) = (s + iC/2) integral_t^1 e^{i Delta r} e^{-V (r - t)/2} dr``

for an arc of length s and turn Delta (C/2: the error of the distance turns with the heading while
it is made, Stratonovich).  Slip at t moves the mean of the end, given all up to t, by its share of
distance along the track and its share of heading times ``i rho``, turned by phi(t).  The end is
the integral of that over independent slip (Clark & Ocone; Nualart, Malliavin Calculus, sec. 1.3),
so its covariance is the integral of the squares: one integral over the arc.  It is a closed form
(:mod:`.turning_moments`), which loses digits where the turn is small: there it is quadrature
(:mod:`.integrated_moments`).  Where V is large, and the turn is not, an arc is two halves of it.

Arcs follow one another by :func:`followed`: only moments of ``e^{i phi}``, and what the position
has to do with it, are needed.  Everything is kept about the mean, so nothing cancels on a
straight; what is published is about the pose that the wheels say, the mean error squared
included.
"""

import math
from typing import Tuple

from diffdrive_kinematics.core.kinematics import (
    advance, check_non_negative, Pose, pose_change_from_travel, WheelGeometry)
from diffdrive_kinematics.core.noise.body_slip import body_variances, BodySlip, NO_BODY_SLIP
from diffdrive_kinematics.core.noise.integrated_moments import integrated_moments, REACH
from diffdrive_kinematics.core.noise.pose_moments import followed, PoseMoments
from diffdrive_kinematics.core.noise.turning_moments import turning_moments

TURNING = 0.3  # [rad], from where the closed form keeps digits enough
PIVOTING = 0.05  # [rad], from where it does on small radii: s^2 V < TIGHT Q Delta^2, which is a
TIGHT = 1e3  # radius below 16 separations


def slip_on_arc(
        geometry: WheelGeometry, d_left: float, d_right: float, k_left: float, k_right: float,
        body: BodySlip = NO_BODY_SLIP) -> Tuple[float, float, float]:
    """
    Return what slip adds on an arc: Q, C and V.

    Parameters
    ----------
    geometry : WheelGeometry
        Distance of the wheels.
    d_left, d_right : float
        Travel [m] of the wheels along the arc, the bias included; of any sign.
    k_left, k_right : float
        Slip variance per metre of that travel [m].
    body : BodySlip
        What slips beside the wheels.

    Returns
    -------
    distance : float
        Q, variance of the distance of the centre [m^2].
    both : float
        C, covariance of distance and heading [m rad].
    heading : float
        V, variance of the heading [rad^2].

    Examples
    --------
    >>> slip_on_arc(WheelGeometry(0.5, 0.125), 1.0, 1.0, 0.25, 0.25)
    (0.125, 0.0, 2.0)
    >>> slip_on_arc(WheelGeometry(0.5, 0.125), 1.0, 1.0, 0.0, 0.0, BodySlip(0.25))
    (0.25, 0.0, 0.0)

    """
    left, right = k_left * abs(d_left), k_right * abs(d_right)
    separation = geometry.separation
    both, heading = 0.25 * (left + right), (left + right) / (separation * separation)
    if body:
        added = body_variances(body, *pose_change_from_travel(geometry, d_left, d_right))
        both, heading = both + added[0], heading + added[1]
    return both, 0.5 * (right - left) / separation, heading


def arc_moments(
        distance: float, turn: float, slip: Tuple[float, float, float], *,
        swings: bool = True) -> PoseMoments:
    """
    Return the moments that an arc makes of a pose that is known, in the frame of its start.

    Parameters
    ----------
    distance : float
        Length s of the arc [m], negative in reverse.
    turn : float
        Change of the heading Delta [rad].
    slip : tuple of float
        Q [m^2], C [m rad] and V [rad^2] of the arc.
    swings : bool
        Whether to find the swings, which only what follows needs; they may be NaN otherwise.

    Returns
    -------
    PoseMoments
        Of its end.

    Examples
    --------
    On a straight the mean falls short by about ``V s / 4``:

    >>> round(arc_moments(20.0, 0.0, (0.0, 0.0, 0.01)).mean_error.real, 3)
    -0.05

    """
    q, c, v = slip
    angle = abs(turn)
    if angle > TURNING or angle > PIVOTING and distance * distance * v < TIGHT * q * angle * angle:
        return turning_moments(distance, turn, slip, swings=swings)
    if angle + 4.0 * v > REACH:
        part = arc_moments(0.5 * distance, 0.5 * turn, (0.5 * q, 0.5 * c, 0.5 * v))
        quarter = 0.25 * turn
        way = 0.5 * distance * (math.sin(quarter) / quarter if quarter else 1.0)
        middle = complex(math.cos(3.0 * quarter), math.sin(3.0 * quarter))
        return followed(part, 0.5 * turn, way * middle, part)
    return integrated_moments(distance, turn, slip, swings=swings)


def propagated_moments(
        moments: PoseMoments, pose: Pose, geometry: WheelGeometry, d_left: float, d_right: float,
        k_left: float, k_right: float, body: BodySlip = NO_BODY_SLIP) -> Tuple[Pose, PoseMoments]:
    """
    Return the published pose and its moments after an arc, both in the frame of ``pose``.

    One step of a travel d and n steps of d/n give the same.

    Parameters
    ----------
    moments : PoseMoments
        Of the pose before.
    pose : Pose
        Published pose before; floats.
    geometry : WheelGeometry
        Size and spacing of the wheels.
    d_left, d_right : float
        Travel [m] of the wheels along the arc, the bias included; of any sign.
    k_left, k_right : float
        Slip variance per metre of that travel [m].
    body : BodySlip
        What slips beside the wheels.

    Returns
    -------
    pose : Pose
        Published pose after; the heading is not wrapped.
    moments : PoseMoments
        Of it.

    Raises
    ------
    ValueError
        If a slip variance is not finite or below 0.

    Examples
    --------
    >>> from diffdrive_kinematics.core.noise import CERTAIN
    >>> pose, moments = propagated_moments(
    ...     CERTAIN, Pose(0.0, 0.0, 0.0), WheelGeometry(0.5, 0.125), 1.0, 1.0, 1e-4, 1e-4)
    >>> f'x = {pose.x:.1f} m, sigma_theta = {math.sqrt(moments.spread.tt):.4f} rad'
    'x = 1.0 m, sigma_theta = 0.0283 rad'

    """
    distance, turn = pose_change_from_travel(geometry, d_left, d_right)
    after = advance(pose, distance, turn)
    slip = slip_on_arc(
        geometry, d_left, d_right, check_non_negative('left slip variance', k_left),
        check_non_negative('right slip variance', k_right), body)
    way = complex(float(after.x) - float(pose.x), float(after.y) - float(pose.y))
    return after, followed(moments, float(pose.theta), way, arc_moments(distance, turn, slip))
