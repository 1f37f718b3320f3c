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
What the limits of one axis of the twist are: velocity, acceleration, deceleration and jerk.

Names, signs and defaults are those of ros2_controllers' ``diff_drive_controller``, so that a
YAML file keeps its meaning.  NaN means no limit.

============================  =====  ========================================================
limit                         sign   where NaN
============================  =====  ========================================================
``max_velocity``              >= 0   no limit
``min_velocity``              <= 0   ``-max_velocity``
``max_acceleration``          > 0    no limit; speeding up while going forward
``max_acceleration_reverse``  < 0    ``-max_acceleration``; speeding up in reverse
``max_deceleration``          < 0    ``max_acceleration_reverse``; slowing down, forward
``max_deceleration_reverse``  > 0    ``-max_deceleration``; slowing down in reverse
``max_jerk``                  > 0    no limit; rise of the acceleration
``min_jerk``                  < 0    ``-max_jerk``; fall of the acceleration
============================  =====  ========================================================
"""

from dataclasses import dataclass
from functools import cached_property
import math
from typing import Tuple

NAN = math.nan


@dataclass(frozen=True)
class LimitRanges:
    """
    Limits of one axis and their defaults; units are m or rad, and s.  See the table above.

    Parameters
    ----------
    max_velocity, min_velocity : float
        Highest and lowest velocity [m/s or rad/s].
    max_acceleration, max_acceleration_reverse : float
        Rates of speeding up, forward and in reverse [m/s^2 or rad/s^2].
    max_deceleration, max_deceleration_reverse : float
        Rates of slowing down, forward and in reverse [m/s^2 or rad/s^2].
    max_jerk, min_jerk : float
        Rise and fall of the acceleration per second [m/s^3 or rad/s^3].

    Raises
    ------
    ValueError
        If a limit has the wrong sign: one that forbids standing still, or a rate of 0, which
        would mean never to speed up or, worse, never to slow down.

    Examples
    --------
    >>> limits = LimitRanges(max_velocity=1.0, max_acceleration=0.5, max_deceleration=-2.0)
    >>> limits.velocity_range, limits.forward_rates, limits.reverse_rates
    ((-1.0, 1.0), (0.5, 2.0), (0.5, 2.0))

    """

    max_velocity: float = NAN
    min_velocity: float = NAN
    max_acceleration: float = NAN
    max_acceleration_reverse: float = NAN
    max_deceleration: float = NAN
    max_deceleration_reverse: float = NAN
    max_jerk: float = NAN
    min_jerk: float = NAN

    def __post_init__(self) -> None:
        if self.max_velocity < 0.0:
            raise ValueError(f'max_velocity is {self.max_velocity!r}, expected 0 or above, or NaN')
        if self.min_velocity > 0.0:
            raise ValueError(f'min_velocity is {self.min_velocity!r}, expected 0 or below, or NaN')
        for name in ('max_acceleration', 'max_deceleration_reverse', 'max_jerk'):
            if getattr(self, name) <= 0.0:
                raise ValueError(f'{name} is {getattr(self, name)!r}, expected above 0, or NaN')
        for name in ('max_acceleration_reverse', 'max_deceleration', 'min_jerk'):
            if getattr(self, name) >= 0.0:
                raise ValueError(f'{name} is {getattr(self, name)!r}, expected below 0, or NaN')

    @cached_property
    def velocity_range(self) -> Tuple[float, float]:
        """Lowest and highest velocity, infinite where there is no limit."""
        high = _or(self.max_velocity, math.inf)
        return _or(self.min_velocity, -high), high

    @cached_property
    def forward_rates(self) -> Tuple[float, float]:
        """Magnitudes of (speeding up, slowing down) while the velocity is positive."""
        return _or(self.max_acceleration, math.inf), _or(-self.max_deceleration, self._reverse_up)

    @cached_property
    def reverse_rates(self) -> Tuple[float, float]:
        """Magnitudes of (speeding up, slowing down) while the velocity is negative."""
        down = _or(self.max_deceleration_reverse, self.forward_rates[1])
        return self._reverse_up, down

    @cached_property
    def _reverse_up(self) -> float:
        return _or(-self.max_acceleration_reverse, _or(self.max_acceleration, math.inf))

    @cached_property
    def jerk_range(self) -> Tuple[float, float]:
        """Lowest and highest jerk, infinite where there is no limit."""
        high = _or(self.max_jerk, math.inf)
        return _or(self.min_jerk, -high), high

    @cached_property
    def ramps(self) -> bool:
        """Whether a change of velocity takes time: an acceleration or a jerk is limited."""
        return self.eases or any(map(math.isfinite, (*self.forward_rates, *self.reverse_rates)))

    @cached_property
    def eases(self) -> bool:
        """Whether a change of acceleration takes time: a jerk is limited."""
        return any(map(math.isfinite, self.jerk_range))


def _or(value: float, default: float) -> float:
    return default if math.isnan(value) else value
