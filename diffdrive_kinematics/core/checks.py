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
Checks of single values, with errors that say what, how much, and what was expected.

Every check takes the name under which the user knows the value, returns the value as a float,
and raises ``ValueError``.  Finiteness is judged before bounds, so NaN never slips through one.
"""

import math

__all__ = [
    'LARGEST', 'check_above', 'check_duration', 'check_finite', 'check_length',
    'check_non_negative', 'check_positive', 'check_rate', 'is_sane']

LARGEST = 1e12
"""Bound of every rate, speed and travel: far above any wheel, far below overflow."""


def is_sane(*values: float) -> bool:
    """Return whether all values are finite and within +-``LARGEST``."""
    for value in values:
        if not -LARGEST <= value <= LARGEST:
            return False
    return True


def check_finite(name: str, value: float) -> float:
    """Return ``value`` as a float, or raise if it is NaN or infinite."""
    number = float(value)
    if not math.isfinite(number):
        raise ValueError(f'{name} is {value!r}, expected a finite number')
    return number


def check_positive(name: str, value: float) -> float:
    """Return ``value`` as a float, or raise unless it is finite and above 0."""
    number = float(value)
    if not (math.isfinite(number) and number > 0.0):
        raise ValueError(f'{name} is {value!r}, expected a finite number above 0')
    return number


def check_non_negative(name: str, value: float) -> float:
    """Return ``value`` as a float, or raise unless it is finite and 0 or above."""
    number = float(value)
    if not (math.isfinite(number) and number >= 0.0):
        raise ValueError(f'{name} is {value!r}, expected a finite number, 0 or above')
    return number


def check_above(name: str, value: float, bound: float) -> float:
    """Return ``value`` as a float, or raise unless it is finite and above ``bound``."""
    number = float(value)
    if not (math.isfinite(number) and number > bound):
        raise ValueError(f'{name} is {value!r}, expected a finite number above {bound!r}')
    return number


def check_rate(name: str, value: float) -> float:
    """Return ``value`` as a float, or raise unless it is a rate [Hz] from 1e-6 to 1e6."""
    return _check_within(name, value, 1e-6, 1e6, 'a rate from 1e-6 to 1e6 Hz')


def check_duration(name: str, value: float) -> float:
    """Return ``value`` as a float, or raise unless it is a duration [s] from 0 to 1e9."""
    return _check_within(name, value, 0.0, 1e9, 'a duration from 0 to 1e9 s')


def check_length(name: str, value: float) -> float:
    """Return ``value`` as a float, or raise unless it is a length [m] from 1e-6 to 1e6."""
    return _check_within(name, value, 1e-6, 1e6, 'a length from 1e-6 to 1e6 m')


def _check_within(name: str, value: float, low: float, high: float, expected: str) -> float:
    number = float(value)
    if not low <= number <= high:
        raise ValueError(f'{name} is {value!r}, expected {expected}')
    return number
