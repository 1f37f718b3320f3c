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

"""How much of its speed a robot keeps in a curve."""

from diffdrive_kinematics.core.kinematics import Array
import numpy as np

LEAST_SHARE, ROUNDING = 0.1, 0.03
"""What is left of the speed in the tightest curves, and how round the corner before it is [1]."""


def share_kept(tightness: Array, order: int) -> Array:
    """
    Return the share of the speed that is kept in curves, ``(1 - t^n)^(1/n)`` down to a tenth.

    Parameters
    ----------
    tightness : numpy.ndarray
        Curvature times turn loss, t [1], of either sign.
    order : int
        Order n of the loss, 1 or 2.

    Returns
    -------
    numpy.ndarray
        Shares [1], 1 on straights; larger ones in wider curves.

    Examples
    --------
    >>> share_kept(np.array([0.0, -0.6, 50.0]), order=2).round(2)
    array([1. , 0.8, 0.1])

    """
    least = LEAST_SHARE**order
    left = 1.0 - np.minimum(np.abs(tightness), 1e100)**order
    kept, straight = _rounded_maximum(left, least), _rounded_maximum(np.ones(()), least)
    shares: Array = (kept / straight)**(1.0 / order)
    return shares


def _rounded_maximum(value: Array, least: float) -> Array:
    """Return the larger of both, and a little more about where they are equal."""
    found: Array = 0.5 * (value + least + np.hypot(value - least, 2.0 * ROUNDING))
    return found
