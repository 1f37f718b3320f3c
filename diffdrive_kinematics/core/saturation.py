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

from diffdrive_kinematics.core.geometry import WheelGeometry

__all__ = ['SaturatedRates', 'WheelBound', 'saturate', 'wheel_bound']

ROUNDING = 2e-15  # what is saturated is within the bound in spite of its last digits


class SaturatedRates(NamedTuple):
    """Wheel rates [rad/s] within the bound, and the factor in [0, 1] that brought them there."""

    left: float
    right: float
    factor: float


def saturate(left: float, right: float, max_wheel_rate: float) -> SaturatedRates:
    """
    Scale both wheel rates [rad/s] by one factor until neither exceeds ``max_wheel_rate``.

    The ratio of the rates, and with it the turning radius (LaValle eq. 2.7), stays what was
    asked for; only the speed along the path falls.  NaN or infinity as bound means no bound.
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

    """

    left: float
    right: float
    half: float

    def speeds(self, w: float) -> Tuple[float, float]:
        """Return the lowest and highest forward speed [m/s] beside a yaw rate [rad/s]."""
        turn = self.half * w
        return max(turn - self.left, -turn - self.right), min(turn + self.left, self.right - turn)

    def yaw_rates(self, v: float) -> Tuple[float, float]:
        """Return the lowest and highest yaw rate [rad/s] beside a forward speed [m/s]."""
        return (max(v - self.left, -v - self.right) / self.half,
                min(v + self.left, self.right - v) / self.half)


def wheel_bound(geometry: WheelGeometry, max_wheel_rate: float) -> WheelBound:
    """Return the twists for which no wheel exceeds ``max_wheel_rate`` [rad/s]."""
    rate = max_wheel_rate * (1.0 + ROUNDING)
    return WheelBound(
        geometry.left_radius * rate, geometry.right_radius * rate, 0.5 * geometry.separation)
