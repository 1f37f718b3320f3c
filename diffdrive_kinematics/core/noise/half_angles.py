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
Sines and cosines of many angles from additions, multiplications and rounding alone.

IEEE 754 defines these to the last bit and numpy does them on several elements at once everywhere,
while whether its sin, cos and tan are, and what their last bits are, differs between processors.
"""

import math
from typing import Sequence

from diffdrive_kinematics.core.kinematics import Array
import numpy as np

TURN, TURN_REST = 6.2831853069365025, 2.430840202602477e-10
"""2 pi in two parts (Cody & Waite 1980): the first of 33 bits, so that its multiples are exact."""

MOST = 2.0**20 * TURN
"""Up to here the multiples are exact."""

SINE = (0.011293577448355921, -43.55130845705858, 23524.714108075437, -3279602.85715388,
        95461427.17904961)
COSINE = (-1211.466818657448, 328479.2733555018, -22469443.57748267, 190922854.3580992)
"""tan(r / 2) = r SINE(r^2) / (r^8 + COSINE(r^2)) at the Chebyshev nodes of r^2 below 3.5^2."""

WITHIN = 3.5
"""Of r: somewhat more than pi, so that headings which are wrapped need no reduction."""

SINC = (-2.4931934029233215e-08, 2.7556981477681245e-06, -0.00019841269403598734,
        0.00833333333307693, -0.16666666666666116, 1.0)
SINC_NEAR = (-0.00019837742786582438, 0.008333333192254634, -0.16666666666648608, 1.0)
"""sin(h) / h at the Chebyshev nodes of h^2 below ``WIDE`` and below ``NEAR``."""

NEAR, WIDE = 0.0064, 0.25
"""Of h^2."""


def fill_half_angles(angle: Array, cosine: Array, work: Array) -> None:
    """
    Write vectors, of any length, that point along half of the angles, or against it.

    With p and q its components, ``sin(angle) = 2 p q / (p^2 + q^2)`` and ``cos(angle) =
    (q^2 - p^2) / (p^2 + q^2)``.  The direction is off by less than 2e-17 rad but for rounding.

    Parameters
    ----------
    angle : numpy.ndarray, shape (n,)
        The angles [rad]; overwritten with p, along y.  One beyond a million turns is taken modulo
        the double nearest to 2 pi, an error below that of its own rounding.
    cosine : numpy.ndarray, shape (n,)
        Overwritten with q, along x.
    work : numpy.ndarray, shape (n,)
        Work space.

    Examples
    --------
    >>> p, (q, work) = np.array([0.5 * math.pi]), np.empty((2, 1))
    >>> fill_half_angles(p, q, work)
    >>> round(float(p[0] / q[0]), 12)
    1.0

    """
    largest = np.abs(angle, out=work).max(initial=0.0)
    if not largest <= MOST:
        np.fmod(angle, math.tau, out=angle, where=work > MOST)
    if not largest <= WITHIN:
        np.multiply(angle, 1.0 / math.tau, out=work)
        np.rint(work, out=work)
        np.multiply(work, TURN, out=cosine)
        angle -= cosine
        work *= TURN_REST
        angle -= work
    np.square(angle, out=work)
    np.multiply(work, SINE[0], out=cosine)
    _add_powers(SINE[1:], work, cosine)
    angle *= cosine
    np.add(work, COSINE[0], out=cosine)
    cosine *= work
    _add_powers(COSINE[1:], work, cosine)


def fill_sincs(half: Array, sinc: Array, work: Array) -> None:
    """
    Write ``sin(h) / h``.

    Parameters
    ----------
    half : numpy.ndarray, shape (n,)
        The angles h [rad].
    sinc : numpy.ndarray, shape (n,)
        Overwritten.
    work : numpy.ndarray, shape (n,)
        Work space.

    Examples
    --------
    >>> sinc, work = np.empty((2, 2))
    >>> fill_sincs(np.array([0.0, math.pi]), sinc, work)
    >>> sinc.round(12).tolist()
    [1.0, 0.0]

    """
    np.square(half, out=work)
    largest = work.max(initial=0.0)
    first, *others = SINC_NEAR if largest <= NEAR else SINC
    np.multiply(work, first, out=sinc)
    _add_powers(others, work, sinc)
    if not largest <= WIDE:
        wide = work > WIDE
        p = half[wide]
        q, scratch = np.empty((2, len(p)))
        fill_half_angles(p, q, scratch)
        sinc[wide] = 2.0 * p * q / ((p * p + q * q) * half[wide])


def _add_powers(coefficients: Sequence[float], variable: Array, value: Array) -> None:
    """Go on with a polynomial, the highest power first (Horner), from its first product."""
    *others, last = coefficients
    for coefficient in others:
        value += coefficient
        value *= variable
    value += last
