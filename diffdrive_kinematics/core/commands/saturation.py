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
The bound of the wheel rates: in the twist that is asked for, and on the way to it.

What is asked for is saturated by one common factor, so that the path keeps its shape.  On the way
there v and w ramp each by its own limits, and the bound says how far one may be with the other.
"""

import math
from typing import NamedTuple, Tuple

from diffdrive_kinematics.core.kinematics import WheelGeometry

ROUNDING = 2e-15  # what is saturated is within the bound in spite of its last digits


class SaturatedRates(NamedTuple):
    """
    Wheel rates within the bound, and the factor that brought them there.

    Parameters
    ----------
    left, right : float
        Wheel rates [rad/s].
    factor : float
        From 0 to 1 [1]; 1: they were within the bound.

    Examples
    --------
    See :func:`saturate`.

    """

    left: float
    right: float
    factor: float


def saturate(left: float, right: float, max_wheel_rate: float) -> SaturatedRates:
    """
    Scale both wheel rates by one factor until neither exceeds ``max_wheel_rate``.

    The ratio of the rates, and with it the turning radius (LaValle eq. 2.7), stays what was
    asked for; only the speed along the path falls.

    Parameters
    ----------
    left, right : float
        Wheel rates that are asked for [rad/s].
    max_wheel_rate : float
        Bound of both [rad/s]; NaN or infinity: none.

    Returns
    -------
    SaturatedRates
        Wheel rates within the bound, and the factor.

    Examples
    --------
    >>> saturate(8.0, 4.0, max_wheel_rate=4.0)
    SaturatedRates(left=4.0, right=2.0, factor=0.5)

    """
    peak = max(abs(left), abs(right))
    if not peak > max_wheel_rate:  # also where the bound is NaN
        return SaturatedRates(left, right, 1.0)
    factor = max_wheel_rate / peak
    return SaturatedRates(
        _scaled(left, factor, max_wheel_rate), _scaled(right, factor, max_wheel_rate), factor)


def _scaled(rate: float, factor: float, bound: float) -> float:
    """Scale, and keep the last digit's rounding from passing the bound."""
    return math.copysign(min(abs(rate) * factor, bound), rate)


class WheelBound(NamedTuple):
    """
    The twists whose wheels are within a bound: a parallelogram about 0.

    Parameters
    ----------
    left, right : float
        Largest speeds [m/s] of the floor under the wheels.
    half : float
        Half of the wheel separation [m].

    Examples
    --------
    >>> bound = wheel_bound(WheelGeometry(0.5, 0.125), max_wheel_rate=8.0)
    >>> [round(speed, 6) for speed in bound.speeds(w=1.0)]
    [-0.75, 0.75]
    >>> [round(rate, 6) for rate in bound.yaw_rates(v=0.75)]
    [-1.0, 1.0]

    """

    left: float
    right: float
    half: float

    def speeds(self, w: float) -> Tuple[float, float]:
        """
        Return the lowest and highest forward speed beside a yaw rate.

        ``|v - w L/2| <= left`` and ``|v + w L/2| <= right``, solved for v.

        Parameters
        ----------
        w : float
            Yaw rate [rad/s].

        Returns
        -------
        low : float
            Lowest forward speed [m/s].
        high : float
            Highest forward speed [m/s]; below ``low`` where no speed is within the bound.

        Examples
        --------
        See :class:`WheelBound`.

        """
        turn = self.half * w
        return max(turn - self.left, -turn - self.right), min(turn + self.left, self.right - turn)

    def yaw_rates(self, v: float) -> Tuple[float, float]:
        """
        Return the lowest and highest yaw rate beside a forward speed.

        ``|v - w L/2| <= left`` and ``|v + w L/2| <= right``, solved for w.

        Parameters
        ----------
        v : float
            Forward speed [m/s].

        Returns
        -------
        low : float
            Lowest yaw rate [rad/s].
        high : float
            Highest yaw rate [rad/s]; below ``low`` where no yaw rate is within the bound.

        Examples
        --------
        See :class:`WheelBound`.

        """
        return (max(v - self.left, -v - self.right) / self.half,
                min(v + self.left, self.right - v) / self.half)


def wheel_bound(geometry: WheelGeometry, max_wheel_rate: float) -> WheelBound:
    """
    Return the twists for which no wheel exceeds a rate.

    Parameters
    ----------
    geometry : WheelGeometry
        Size and spacing of the wheels.
    max_wheel_rate : float
        Bound of both wheel rates [rad/s].

    Returns
    -------
    WheelBound
        The twists, with 2e-15 of the bound more, so that what :func:`saturate` returns is within.

    Examples
    --------
    See :class:`WheelBound`.

    """
    rate = max_wheel_rate * (1.0 + ROUNDING)
    return WheelBound(
        geometry.left_radius * rate, geometry.right_radius * rate, 0.5 * geometry.separation)
