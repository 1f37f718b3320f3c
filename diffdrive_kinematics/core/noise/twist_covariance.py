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

"""The covariance of the mean twist over a period, as slip disturbs it."""

from typing import NamedTuple, Tuple

from diffdrive_kinematics.core.kinematics import (
    check_non_negative, check_positive, twist_from_wheel_rates, WheelGeometry)
from diffdrive_kinematics.core.noise.body_slip import body_variances, BodySlip, NO_BODY_SLIP


class TwistCovariance(NamedTuple):
    """
    Covariance of a twist (v, w).

    Parameters
    ----------
    vv : float
        Var v [m^2/s^2].
    vw : float
        Cov(v, w) [m rad/s^2].
    ww : float
        Var w [rad^2/s^2].

    Examples
    --------
    >>> TwistCovariance(vv=1e-4, vw=0.0, ww=1e-3).vv
    0.0001

    """

    vv: float
    vw: float
    ww: float


def twist_covariance(
        geometry: WheelGeometry, rates: Tuple[float, float], k_left: float, k_right: float,
        period: float, floor: float = 1e-9, body: BodySlip = NO_BODY_SLIP) -> TwistCovariance:
    """
    Return the covariance of the mean twist over a period, as slip disturbs it.

    With ``q = k |u| R T`` the variance of a wheel's travel in the period T,
    ``Var v = (q_l + q_r) / (4 T^2)``, ``Var w = (q_l + q_r) / (L^2 T^2)`` and
    ``Cov(v, w) = (q_r - q_l) / (2 L T^2)``; the slip of the body adds ``k_d |v| / T`` and
    ``(k_t |w| + k_x |v|) / T``.  It falls with T, so a filter that integrates a twist each period
    gathers the variance of the path whatever the rate.

    Parameters
    ----------
    geometry : WheelGeometry
        Size and spacing of the wheels.
    rates : pair of float
        Wheel rates (left, right) [rad/s].
    k_left, k_right : float
        Slip variance per metre [m].
    period : float
        Time T [s] between two twists.
    floor : float
        Added to both variances, (m/s)^2 and (rad/s)^2, so that a robot at rest reports no zero.
    body : BodySlip
        What slips beside the wheels.

    Returns
    -------
    TwistCovariance
        Of the forward speed and the yaw rate.

    Raises
    ------
    ValueError
        If a slip variance or the floor is not finite or below 0, or the period not above 0.

    Examples
    --------
    At 1 m/s, reported at 10 Hz:

    >>> found = twist_covariance(WheelGeometry(0.5, 0.125), (8.0, 8.0), 1e-4, 1e-4, period=0.1)
    >>> f'{found.vv:.1e} {found.ww:.1e}'
    '5.0e-04 8.0e-03'

    """
    left, right = abs(rates[0]) * geometry.left_radius, abs(rates[1]) * geometry.right_radius
    rate_left = check_non_negative('left slip variance', k_left) * left
    rate_right = check_non_negative('right slip variance', k_right) * right
    scale = 1.0 / check_positive('period', period)
    check_non_negative('floor', floor)
    both, separation = scale * (rate_left + rate_right), geometry.separation
    along, heading = 0.25 * both, both / separation**2
    if body:
        added = body_variances(body, *twist_from_wheel_rates(geometry, *rates))
        along, heading = along + scale * added[0], heading + scale * added[1]
    return TwistCovariance(
        along + floor, 0.5 * scale * (rate_right - rate_left) / separation, heading + floor)
