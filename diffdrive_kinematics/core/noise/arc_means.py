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

"""Means along an arc, of which the covariance of its end is made to first order."""

import math
from typing import Tuple

from diffdrive_kinematics.core.kinematics import Array, Number
import numpy as np


def polynomial(coefficients: Tuple[float, ...], variable: Number) -> Number:
    """
    Return the value of a polynomial.

    Parameters
    ----------
    coefficients : tuple of float
        Coefficients, that of the highest power first.
    variable : float or numpy.ndarray
        Where to evaluate it.

    Returns
    -------
    float or numpy.ndarray
        The value, of the shape of ``variable``.

    Examples
    --------
    >>> polynomial((2.0, 0.0, 1.0), 3.0)  # 2 x^2 + 1
    19.0

    """
    total = 0.0 * variable
    for coefficient in coefficients:
        total = total * variable + coefficient
    return total


SERIES_END = 0.25  # of h^2
TERMS = range(9, 0, -1)
E_MEAN = tuple(-(-1.0)**k * 2 * k / math.factorial(2 * k + 1) for k in TERMS)
E_SQUARE = tuple((-4.0)**k * (k - 1) / math.factorial(2 * k + 1) for k in TERMS if k > 1)
SINE_SQUARE = tuple(-0.5 * (-4.0)**k / math.factorial(2 * k + 1) for k in TERMS)


def arc_means(half: float) -> Tuple[float, float, float]:
    """
    Return the means of e(s), e(s)^2 and (sin(h s) / h)^2 over s in [-1, 1], h = ``half``.

    The closed forms cancel as 1 / h^4 towards h = 0; the power series in h^2 up to h = 1/2
    leave out less than 1e-17 and the closed forms beyond lose less than 3e-14.

    Parameters
    ----------
    half : float
        Half the turn [rad].

    Returns
    -------
    tuple of float
        The three means.

    Examples
    --------
    >>> arc_means(0.0)
    (0.0, 0.0, 0.3333333333333333)

    """
    square = half * half
    if square <= SERIES_END:
        return (half * polynomial(E_MEAN, square), square * polynomial(E_SQUARE, square),
                polynomial(SINE_SQUARE, square))
    cosine, sinc = math.cos(half), math.sin(half) / half
    return ((sinc - cosine) / half,
            (0.5 + cosine * (cosine - 1.5 * sinc)) / square,
            0.5 * (1.0 - cosine * sinc) / square)


def arc_means_of_all(half: Array) -> Tuple[Array, Array, Array]:
    """
    Return what :func:`arc_means` returns, of many arcs at once.

    Parameters
    ----------
    half : numpy.ndarray, shape (n,)
        Half the turn of each [rad].

    Returns
    -------
    tuple of numpy.ndarray, shape (n,)
        The three means of each.

    Examples
    --------
    >>> [float(mean[0]) for mean in arc_means_of_all(np.array([0.0]))]
    [0.0, 0.0, 0.3333333333333333]

    """
    square = half * half
    wide = square > SERIES_END
    divisor = np.where(wide, half, 1.0)
    cosine, ratio = np.cos(divisor), np.sin(divisor) / divisor
    closed = ((ratio - cosine) / divisor,
              (0.5 + cosine * (cosine - 1.5 * ratio)) / divisor**2,
              0.5 * (1.0 - cosine * ratio) / divisor**2)
    near = np.where(wide, 0.0, square)
    series = (half * polynomial(E_MEAN, near), near * polynomial(E_SQUARE, near),
              polynomial(SINE_SQUARE, near))
    mean, square_mean, sine_square = (np.where(wide, *forms) for forms in zip(closed, series))
    return mean, square_mean, sine_square
