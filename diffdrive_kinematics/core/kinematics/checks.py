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

Every check takes the name under which the user knows the value, returns the value as a float (a
count as an int), and raises ``ValueError``.  A value passes where it lies between two bounds, so
NaN never does.
"""

import math

import numpy as np

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
    return _checked(name, value, -math.inf < float(value) < math.inf, 'a finite number')


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
    return _checked(name, value, 0.0 < float(value) < math.inf, 'a finite number above 0')


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
    return _checked(name, value, 0.0 <= float(value) < math.inf, 'a finite number, 0 or above')


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
    return _checked(
        name, value, bound < float(value) < math.inf, f'a finite number above {bound!r}')


def check_count(name: str, value: int, least: int = 1) -> int:
    """
    Return ``value`` as an int, or raise unless it is an integer and at least ``least``.

    Parameters
    ----------
    name : str
        What the user calls the value; the error names it.
    value : int
        Value to check.
    least : int
        Least value that passes.

    Returns
    -------
    int
        The value.

    Raises
    ------
    ValueError
        If the value is no integer (a bool or 2.0, too), or is below the least.

    Examples
    --------
    >>> check_count('threads', 4)
    4
    >>> check_count('threads', math.nan)
    Traceback (most recent call last):
    ValueError: threads is nan, expected an integer, 1 or above

    """
    whole = isinstance(value, (int, np.integer)) and not isinstance(value, bool)
    if not whole or value < least:
        raise ValueError(f'{name} is {value!r}, expected an integer, {least!r} or above')
    return int(value)


def _checked(name: str, value: float, holds: bool, expected: str) -> float:
    if not holds:
        raise ValueError(f'{name} is {value!r}, expected {expected}')
    return float(value)
