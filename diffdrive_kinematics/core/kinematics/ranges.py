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

"""The unit of stamps; checks of rates, durations and lengths against what they can be at all."""

NANOSECONDS = 1_000_000_000
"""In a second.  Stamps are whole nanoseconds; everything else is in SI units."""


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
