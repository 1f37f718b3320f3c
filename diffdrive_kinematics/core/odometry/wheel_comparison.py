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

"""Whether wheels of a side have rolled alike, and who is left out where they have not."""

import math
from typing import NamedTuple, Sequence, Tuple

import numpy as np

SHARE = 0.25  # of the longest way
STANDS = 0.1  # of the longest way
Floats = Tuple[float, ...]
Flags = Tuple[bool, ...]


def mean_of(values: Sequence[float], used: Sequence[bool]) -> float:
    """
    Return the mean of the values that are used, NaN where none is.

    Parameters
    ----------
    values : sequence of float, shape (n,)
        Values of any unit.
    used : sequence of bool, shape (n,)
        Which of them are used.

    Returns
    -------
    float
        The mean, in the unit of the values.

    Examples
    --------
    >>> mean_of((1.0, 2.0, 9.0), (True, True, False)), mean_of((1.0,), (False,))
    (1.5, nan)

    """
    chosen = [value for value, use in zip(values, used) if use]
    return sum(chosen) / len(chosen) if chosen else math.nan


class Disagreement(NamedTuple):
    """
    How far wheels have gone since the comparison before, and who is left out.

    Parameters
    ----------
    travels : tuple of float
        How far each of n wheels has gone [rad]; NaN: it says nothing.
    left_out : tuple of bool
        Whether each of them is left out.

    Examples
    --------
    >>> seen = Disagreement(travels=(0.0, 4.0), left_out=(True, False))
    >>> [travel for travel, out in zip(seen.travels, seen.left_out) if out]
    [0.0]

    """

    travels: Floats
    left_out: Flags


def judged(
        travels: Floats, known: Sequence[float], left_out: Flags, other: float
) -> Tuple[bool, Flags]:
    """
    Return whether the wheels differ, and who is to be left out.

    Parameters
    ----------
    travels : tuple of float
        How far each of n wheels has gone [rad]; NaN: it says nothing.
    known : sequence of float
        Those of them that are not NaN.
    left_out : tuple of bool
        Whether each wheel was left out before.
    other : float
        How far the other side has gone [rad].

    Returns
    -------
    differ : bool
        Whether they differ.
    left_out : tuple of bool
        Whether each wheel is left out from now on.

    Examples
    --------
    >>> judged((4.0, 4.0, 1.0), (4.0, 4.0, 1.0), left_out=(False,) * 3, other=4.0)
    (True, (False, False, True))

    """
    longest, middle = max(map(abs, known)), float(np.median(known))
    silent = tuple(out and travel != travel for travel, out in zip(travels, left_out))
    if max(known) - min(known) <= SHARE * longest:
        return any(silent), silent
    apart = tuple(abs(travel - middle) > SHARE * longest for travel in travels)
    if 0 < 2 * sum(apart) < len(known):
        return True, tuple(a or b for a, b in zip(apart, silent))
    stand = tuple(abs(travel) < STANDS * longest for travel in travels)
    if any(stand) and other >= SHARE * longest:
        return True, tuple(a or b for a, b in zip(stand, silent))
    return True, left_out
