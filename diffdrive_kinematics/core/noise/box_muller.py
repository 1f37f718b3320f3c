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
Normals for millions of draws, by whole-array arithmetic.

The ziggurat of numpy makes one normal after the other; the transform of Box & Muller (1958) is
the same few operations for every element, and numpy runs those on several elements at once.
"""

import math

import numpy as np
from numpy.typing import NDArray

__all__ = ['fill_normals']

Array = NDArray[np.float64]
STEP = 2.0**-32


def fill_normals(bits: 'np.random.BitGenerator', normals: Array, work: Array) -> None:
    """
    Fill ``normals`` with independent draws of mean 0 and variance 1.

    ``r = sqrt(-2 log u1)``, ``z = r (cos 2 pi u2, sin 2 pi u2)`` with u1 and u2 from the halves
    of one 64-bit word, at the midpoints of 2^32 intervals; with t = tan(pi u2) the cosine is
    (1 - t^2) / (1 + t^2) and the sine 2 t / (1 + t^2).  No draw is beyond 6.77: one in 7e10
    normals would be.

    Parameters
    ----------
    bits : numpy.random.BitGenerator
        Source of randomness; one word is taken for two normals.
    normals : numpy.ndarray, shape (2 m,)
        Where to put the normals.
    work : numpy.ndarray, shape (2, m)
        Scratch space, overwritten.

    Examples
    --------
    >>> normals = np.empty(20000)
    >>> fill_normals(np.random.SFC64(1), normals, np.empty((2, 10000)))
    >>> bool(abs(normals.mean()) < 0.03), bool(abs(normals.var() - 1.0) < 0.05)
    (True, True)

    """
    half = len(normals) // 2
    cosine, sine = normals[:half], normals[half:]
    tangent, radius = work
    words = bits.random_raw(half).view(np.int32)
    np.multiply(words[0::2], STEP, out=radius)
    radius += 0.5 + 0.5 * STEP
    np.log(radius, out=radius)
    radius *= -2.0
    np.sqrt(radius, out=radius)
    np.multiply(words[1::2], math.pi * STEP, out=tangent)
    np.tan(tangent, out=tangent)
    np.multiply(tangent, tangent, out=cosine)
    cosine += 1.0
    radius /= cosine
    np.subtract(2.0, cosine, out=cosine)
    cosine *= radius
    tangent *= 2.0
    np.multiply(tangent, radius, out=sine)
