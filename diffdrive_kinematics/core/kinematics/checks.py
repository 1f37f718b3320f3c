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
    """
    Return whether all values are finite and within +-``LARGEST``.

    Parameters
    ----------
    *values : float
        Values of any unit.

    Returns
    -------
    bool
        True where no value is NaN, infinite or absurdly large.

    Examples
    --------
    >>> is_sane(1.0, -2.5), is_sane(1.0, math.nan), is_sane(1e13)
    (True, False, False)

    """
    for value in values:
        if not -LARGEST <= value <= LARGEST:
            return False
    return True


def check_finite(name: str, value: float) -> float:
    """
    Return ``value`` as a float, or raise if it is NaN or infinite.

    Parameters
    ----------
    name : str
        What the user calls the value; the error names it.
    value : float
        Value to check.

    Returns
    -------
    float
        The value.

    Raises
    ------
    ValueError
        If the value is NaN or infinite.

    Examples
    --------
    >>> check_finite('x', 2)
    2.0
    >>> check_finite('x', math.inf)
    Traceback (most recent call last):
    ValueError: x is inf, expected a finite number

    """
    number = float(value)
    if not math.isfinite(number):
        raise ValueError(f'{name} is {value!r}, expected a finite number')
    return number


def check_positive(name: str, value: float) -> float:
    """
    Return ``value`` as a float, or raise unless it is finite and above 0.

    Parameters
    ----------
    name : str
        What the user calls the value; the error names it.
    value : float
        Value to check.

    Returns
    -------
    float
        The value.

    Raises
    ------
    ValueError
        If the value is not finite, or is 0 or below.

    Examples
    --------
    >>> check_positive('wheel_radius', 0.1)
    0.1
    >>> check_positive('wheel_radius', 0.0)
    Traceback (most recent call last):
    ValueError: wheel_radius is 0.0, expected a finite number above 0

    """
    number = float(value)
    if not (math.isfinite(number) and number > 0.0):
        raise ValueError(f'{name} is {value!r}, expected a finite number above 0')
    return number


def check_non_negative(name: str, value: float) -> float:
    """
    Return ``value`` as a float, or raise unless it is finite and 0 or above.

    Parameters
    ----------
    name : str
        What the user calls the value; the error names it.
    value : float
        Value to check.

    Returns
    -------
    float
        The value.

    Raises
    ------
    ValueError
        If the value is not finite or is below 0.

    Examples
    --------
    >>> check_non_negative('slip variance', 0.0)
    0.0
    >>> check_non_negative('slip variance', -1e-6)
    Traceback (most recent call last):
    ValueError: slip variance is -1e-06, expected a finite number, 0 or above

    """
    number = float(value)
    if not (math.isfinite(number) and number >= 0.0):
        raise ValueError(f'{name} is {value!r}, expected a finite number, 0 or above')
    return number


def check_above(name: str, value: float, bound: float) -> float:
    """
    Return ``value`` as a float, or raise unless it is finite and above ``bound``.

    Parameters
    ----------
    name : str
        What the user calls the value; the error names it.
    value : float
        Value to check.
    bound : float
        Largest value that is refused.

    Returns
    -------
    float
        The value.

    Raises
    ------
    ValueError
        If the value is not finite, or is not above the bound.

    Examples
    --------
    >>> check_above('bias', -0.5, -1.0)
    -0.5
    >>> check_above('bias', -1.0, -1.0)
    Traceback (most recent call last):
    ValueError: bias is -1.0, expected a finite number above -1.0

    """
    number = float(value)
    if not (math.isfinite(number) and number > bound):
        raise ValueError(f'{name} is {value!r}, expected a finite number above {bound!r}')
    return number


def check_rate(name: str, value: float) -> float:
    """
    Return ``value`` as a float, or raise unless it is a rate from 1e-6 to 1e6 Hz.

    Parameters
    ----------
    name : str
        What the user calls the value; the error names it.
    value : float
        Rate [Hz] to check.

    Returns
    -------
    float
        The rate [Hz].

    Raises
    ------
    ValueError
        If the value is NaN or out of range.

    Examples
    --------
    >>> check_rate('publish_rate', 50)
    50.0
    >>> check_rate('publish_rate', 0.0)
    Traceback (most recent call last):
    ValueError: publish_rate is 0.0, expected a rate from 1e-6 to 1e6 Hz

    """
    return _check_within(name, value, 1e-6, 1e6, 'a rate from 1e-6 to 1e6 Hz')


def check_duration(name: str, value: float) -> float:
    """
    Return ``value`` as a float, or raise unless it is a duration from 0 to 1e9 s.

    Parameters
    ----------
    name : str
        What the user calls the value; the error names it.
    value : float
        Duration [s] to check.

    Returns
    -------
    float
        The duration [s].

    Raises
    ------
    ValueError
        If the value is NaN or out of range.

    Examples
    --------
    >>> check_duration('cmd_vel_timeout', 0.5)
    0.5
    >>> check_duration('cmd_vel_timeout', -0.5)
    Traceback (most recent call last):
    ValueError: cmd_vel_timeout is -0.5, expected a duration from 0 to 1e9 s

    """
    return _check_within(name, value, 0.0, 1e9, 'a duration from 0 to 1e9 s')


def check_length(name: str, value: float) -> float:
    """
    Return ``value`` as a float, or raise unless it is a length from 1e-6 to 1e6 m.

    Parameters
    ----------
    name : str
        What the user calls the value; the error names it.
    value : float
        Length [m] to check.

    Returns
    -------
    float
        The length [m].

    Raises
    ------
    ValueError
        If the value is NaN or out of range.

    Examples
    --------
    >>> check_length('side', 4.0)
    4.0
    >>> check_length('side', 0.0)
    Traceback (most recent call last):
    ValueError: side is 0.0, expected a length from 1e-6 to 1e6 m

    """
    return _check_within(name, value, 1e-6, 1e6, 'a length from 1e-6 to 1e6 m')


def _check_within(name: str, value: float, low: float, high: float, expected: str) -> float:
    number = float(value)
    if not low <= number <= high:
        raise ValueError(f'{name} is {value!r}, expected {expected}')
    return number
