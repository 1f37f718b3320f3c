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

"""How much of its speed a robot keeps in a curve: in arrays, or plain floats of one command."""

from bisect import bisect_right
import math
from typing import Sequence

from diffdrive_kinematics.core.kinematics import Number
import numpy as np

LEAST_SHARE, ROUNDING = 0.1, 0.03
"""What is left of the speed in the tightest curves, and how round the corner before it is [1]."""


def share_kept(tightness: Number, order: int) -> Number:
    """
    Return the share of the speed that is kept in curves, ``(1 - t^n)^(1/n)`` down to a tenth.

    Parameters
    ----------
    tightness : float or numpy.ndarray
        Curvature times turn loss, t [1], of either sign.
    order : int
        Order n of the loss, 1 or 2.

    Returns
    -------
    float or numpy.ndarray
        Shares [1], 1 on straights; larger ones in wider curves.

    Examples
    --------
    >>> share_kept(np.array([0.0, -0.6, 50.0]), order=2).round(2)
    array([1. , 0.8, 0.1])
    >>> round(share_kept(-0.6, order=2), 2)
    0.8

    """
    least = LEAST_SHARE**order
    if isinstance(tightness, np.ndarray):
        lost = np.minimum(np.abs(tightness), 1e100)**order
        corner = np.hypot(1.0 - lost - least, 2.0 * ROUNDING)
    else:
        lost = min(abs(tightness), 1e100)**order
        corner = math.hypot(1.0 - lost - least, 2.0 * ROUNDING)
    kept = 0.5 * (1.0 - lost + least + corner)  # the larger of both, rounded about the corner
    straight = 0.5 * (1.0 + least + math.hypot(1.0 - least, 2.0 * ROUNDING))
    share: Number = (kept / straight)**(1.0 / order)
    return share


def table_share(curvature: Number, curvatures: Sequence[float], shares: Sequence[float]) -> Number:
    """
    Return the share of a table at a curvature; the first and the last one hold beyond.

    Parameters
    ----------
    curvature : float or numpy.ndarray
        Size of the curvature [1/m].
    curvatures, shares : sequence of float
        The table, its curvatures in rising order; empty: all is kept.

    Returns
    -------
    float or numpy.ndarray
        Shares [1], linear between those of the table.

    Examples
    --------
    >>> table_share(np.array([1.0, 50.0]), (0.0, 4.0), (1.0, 0.6)), table_share(1.0, (), ())
    (array([0.9, 0.6]), 1.0)
    >>> table_share(1.0, (0.0, 4.0), (1.0, 0.6))
    0.9

    """
    if isinstance(curvature, np.ndarray):
        return np.interp(curvature, curvatures, shares) if shares else np.ones_like(curvature)
    after = bisect_right(curvatures, curvature)
    if 0 < after < len(shares):
        slope = (shares[after] - shares[after - 1]) / (curvatures[after] - curvatures[after - 1])
        return shares[after - 1] + slope * (curvature - curvatures[after - 1])
    return shares[min(after, len(shares) - 1)] if shares else 1.0
