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

"""Saturation of the wheel rates by one common factor, so that the path keeps its shape."""

import math
from typing import NamedTuple

__all__ = ['SaturatedRates', 'saturate']


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
