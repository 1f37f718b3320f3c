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

"""Parts of states and commands: names, units, bounds; functions of floats and arrays alike."""

import math
from typing import NamedTuple

from diffdrive_kinematics.core.kinematics import Scalar
import numpy as np


class Quantity(NamedTuple):
    """
    A component of a state or a command.

    Parameters
    ----------
    name : str
        What it is called.
    unit : str
        Its unit.
    low : float
        Least value.
    high : float
        Largest value.

    Examples
    --------
    >>> Quantity('phi', 'rad', -0.5, 0.5).high
    0.5

    """

    name: str
    unit: str
    low: float = -math.inf
    high: float = math.inf


def both_ways(name: str, unit: str, bound: float) -> Quantity:
    """
    Return a quantity with one bound both ways.

    Parameters
    ----------
    name : str
        What it is called.
    unit : str
        Its unit.
    bound : float
        Largest value, above 0.

    Returns
    -------
    Quantity
        From -bound to bound.

    Raises
    ------
    ValueError
        If the bound is not above 0.

    Examples
    --------
    >>> both_ways('s', 'm/s', 2.0)
    Quantity(name='s', unit='m/s', low=-2.0, high=2.0)

    """
    if not bound > 0.0:
        raise ValueError(f'the bound of {name} is {bound!r} {unit}, expected above 0')
    return Quantity(name, unit, -bound, bound)


def clipped(value: Scalar, low: Scalar, high: Scalar) -> Scalar:
    """
    Return what of a range is nearest to a value.

    Parameters
    ----------
    value : float or numpy.ndarray
        The value.
    low : float or numpy.ndarray
        Least value of the range.
    high : float or numpy.ndarray
        Largest value of the range.

    Returns
    -------
    float or numpy.ndarray
        A value of the range.

    Examples
    --------
    >>> clipped(3.0, 0.0, 2.0)
    2.0

    """
    if isinstance(value, np.ndarray) or isinstance(low, np.ndarray):
        return np.clip(value, low, high)
    return min(max(value, low), high)


def function_of(function: str, angle: Scalar) -> Scalar:
    """
    Return tan, sin, cos or fabs of a float as a float, of an array as an array.

    Parameters
    ----------
    function : str
        Name that it has in math and in numpy.
    angle : float or numpy.ndarray
        What it is taken of [rad].

    Returns
    -------
    float or numpy.ndarray
        Its value.

    Examples
    --------
    >>> function_of('cos', 0.0)
    1.0

    """
    value: Scalar = getattr(np if isinstance(angle, np.ndarray) else math, function)(angle)
    return value


def steering_bound(bound: float) -> float:
    """
    Return the bound of a steering angle, or raise.

    Parameters
    ----------
    bound : float
        Largest angle [rad].

    Returns
    -------
    float
        The bound.

    Raises
    ------
    ValueError
        If it is not between 0 and pi / 2.

    Examples
    --------
    >>> steering_bound(0.5)
    0.5

    """
    if not 0.0 < bound < 0.5 * math.pi:
        raise ValueError(f'max_steering is {bound!r} rad, expected between 0 and pi / 2')
    return bound
