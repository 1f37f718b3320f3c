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
Normals by additions, multiplications, square roots and bits alone, in float32.

The way of Box & Muller (1958), on a half circle with a sign at random, from polynomials: numpy
does these operations on many numbers at once on every processor, and IEEE 754 defines their last
bits.  It takes half the time of numpy's own ziggurat, which does one number at a time.

Both uniform numbers of a pair have 24 binary digits and the normals are off by less than 1e-6 of
those that belong to them.  The largest is 6.66: one of 4e10 would be beyond.
"""

import math
from typing import Sequence

from diffdrive_kinematics.core.kinematics import Array
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float32]

SINE = (0.07765766233205795, -0.598291277885437, 2.550077438354492, -5.167710304260254,
        3.1415927410125732)
COSINE = (0.21968960762023926, -1.331876516342163, 4.058411121368408, -4.934792995452881,
          0.9999999403953552)
"""sin(pi v) / v and cos(pi v) at the Chebyshev nodes of v^2 below 1/4, to 5e-8."""

LOGARITHM = (-0.17487891018390656, 0.2875466048717499, -0.2989819049835205, 0.33121392130851746,
             -0.39913955330848694, 0.5000430941581726, -0.6666836738586426, 0.9999997615814209,
             -2.0)
"""-2 log(1 + t) / t at the Chebyshev nodes of 1 + t from sqrt(1/2) to sqrt(2), to 3e-8."""

ROOT_BITS = 0x3F3504F3
"""Of sqrt(1/2)."""

ALL_BITS = 2**64 - 1
WORDS = 8192
"""Of 64 bits, drawn at once: numpy draws them into new memory."""


def fill_normals(generator: 'np.random.Generator', normals: Array, work: Floats) -> None:
    """
    Write independent normals of mean 0 and variance 1.

    Parameters
    ----------
    generator : numpy.random.Generator
        Source of randomness; of its bits 64 are taken for every two normals.
    normals : numpy.ndarray, shape (n,)
        Overwritten.
    work : numpy.ndarray of float32, shape (m,)
        Work space of five numbers for every two normals, ``m >= 5 ceil(n / 2)``.

    Examples
    --------
    >>> normals = np.empty(100000)
    >>> fill_normals(np.random.default_rng(1), normals, np.empty(250000, np.float32))
    >>> f'{normals.std():.2f}'
    '1.00'

    """
    pairs = (len(normals) + 1) // 2
    value, _, radius, angle, square = parts = work[:5 * pairs].reshape(5, pairs)
    bits = parts[:2].view(np.int32)
    for start in range(0, pairs, WORDS):
        stop = min(start + WORDS, pairs)
        words = generator.integers(ALL_BITS, size=stop - start, dtype=np.uint64, endpoint=True)
        bits[:, start:stop] = words.view(np.int32).reshape(2, -1)
    _fill_radii(bits[0], radius, angle, square)
    np.left_shift(bits[1], 31, out=bits[0])
    signed = radius.view(np.int32)
    signed |= bits[0]
    np.copyto(angle, bits[1], casting='same_kind')
    angle *= 2.0**-32  # over pi, on half a circle: the sign of the radius makes it a whole one
    np.square(angle, out=square)
    _fill_polynomial(COSINE, square, value)
    np.multiply(value, radius, out=normals[:pairs])
    _fill_polynomial(SINE, square, value)
    value *= angle
    rest = len(normals) - pairs
    np.multiply(value[:rest], radius[:rest], out=normals[pairs:])


def _fill_radii(
        bits: NDArray[np.int32], radius: Floats, mantissa: Floats, exponent: Floats) -> None:
    """
    Write sqrt(-2 log(u)) with u = (k + 1/2) / 2^31 of 31 bits, which are overwritten.

    With k + 1/2 = 2^e (1 + t), of 24 digits: the last 64 of the 2^31 give 0.
    """
    bits &= 0x7FFFFFFF
    np.copyto(mantissa, bits, casting='same_kind')
    mantissa += 0.5
    as_bits = mantissa.view(np.int32)
    np.subtract(as_bits, ROOT_BITS, out=bits)
    bits >>= 23
    np.copyto(exponent, bits, casting='same_kind')
    bits <<= 23
    as_bits -= bits
    mantissa -= 1.0
    _fill_polynomial(LOGARITHM, mantissa, radius)
    radius *= mantissa
    exponent -= 31.0
    exponent *= -2.0 * math.log(2.0)
    radius += exponent
    np.sqrt(radius, out=radius)


def _fill_polynomial(coefficients: Sequence[float], variable: Floats, value: Floats) -> None:
    """Write a polynomial, the highest power first (Horner)."""
    first, *others, last = coefficients
    np.multiply(variable, first, out=value)
    for coefficient in others:
        value += coefficient
        value *= variable
    value += last
