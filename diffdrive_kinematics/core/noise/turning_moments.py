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
Exact moments of the pose after an arc that turns, in closed form: one cost for any turn.

With ``kappa = i Delta - V/2`` the integral ``rho`` of :mod:`.arc_moments` is
``(s + iC/2) (e^{kappa + V t/2} - e^{i Delta t}) / kappa``.  So all that is integrated over the arc
is a sum of exponentials, and their integrals are ``phi(z) = (e^z - 1) / z``.
"""

import math
from typing import Tuple

from diffdrive_kinematics.core.noise.heading_moments import GAUSSIAN
from diffdrive_kinematics.core.noise.pose_covariance import PoseCovariance
from diffdrive_kinematics.core.noise.pose_moments import PoseMoments

UNKNOWN = complex(math.nan, math.nan)


def turning_moments(
        distance: float, turn: float, slip: Tuple[float, float, float], *,
        swings: bool = True) -> PoseMoments:
    """
    Return the moments that an arc makes of a pose that is known, in the frame of its start.

    It divides by the turn three times, so a small turn loses digits: about ``1e-16 / turn^2`` of
    the variance across.

    Parameters
    ----------
    distance : float
        Length s of the arc [m], negative in reverse.
    turn : float
        Change of the heading Delta [rad], not 0.
    slip : tuple of float
        Q [m^2], C [m rad] and V [rad^2] of the arc.
    swings : bool
        Whether to find the swings; they are NaN otherwise.

    Returns
    -------
    PoseMoments
        Of its end.

    Examples
    --------
    A pivot whose heading is known to 0.1 rad at the end, with wheels that slip alike, moves by
    what slips along the track:

    >>> moments = turning_moments(0.0, math.tau, (1e-4, 0.0, 0.01))
    >>> round(moments.spread.xx, 6), round(moments.spread.yy, 6)
    (5e-05, 5e-05)

    """
    q, c, v = slip
    rate, ahead = complex(-0.5 * v, turn), complex(math.cos(turn), math.sin(turn))
    lost = math.expm1(-0.5 * v)
    damping = 1.0 + lost
    square = damping * damping
    damped = ahead * damping  # e^kappa
    drive = complex(distance, 0.5 * c)
    lever = drive / rate
    both, own = 1j * v * lever, c - 1j * v * lever
    even = -lost * (1.0 + damping) / v if v else 1.0  # phi(-V)
    once = (damped - 1.0) / rate  # phi(kappa)
    thrice = (damped * square - 1.0) / complex(-1.5 * v, turn)
    twice = (damped * damped * square - 1.0) / complex(-2.0 * v, 2.0 * turn)
    to_end = lever * (damped * thrice - twice)
    total = q - 2.0 * c * (lever * (once - 1.0)).imag + v * abs(lever)**2 * (
        even + 1.0 - 2.0 * once.real)
    difference = q * twice + 2j * c * to_end - v * lever * (
        lever * damped * (damped * even - thrice) - to_end)
    with_heading = own * once + both * damped
    mean = (distance * (ahead * lost + 0.5 * v * (ahead - 1.0) / complex(0.0, turn)) / rate
            + 0.5j * c * once)
    spread = PoseCovariance(
        0.5 * (total + difference.real), 0.5 * difference.imag, with_heading.real,
        0.5 * (total - difference.real), with_heading.imag, v)
    if not swings:
        return PoseMoments(spread, mean, UNKNOWN, UNKNOWN, GAUSSIAN)
    swing = own * (ahead - damping) / complex(0.5 * v, turn) + both * ahead * even
    kept = damping * (own * thrice + both * damped * even)
    return PoseMoments(
        spread, mean, complex(0.5 * (swing.imag - kept.imag), 0.5 * (swing.real + kept.real)),
        complex(0.5 * (kept.real - swing.real), 0.5 * (swing.imag + kept.imag)), GAUSSIAN)
