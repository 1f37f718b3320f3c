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

"""Angles: the one wrap convention of the package, (-pi, pi]."""

import math
from typing import overload

import numpy as np
from numpy.typing import NDArray


@overload
def wrap_angle(angle: float) -> float: ...


@overload
def wrap_angle(angle: NDArray[np.float64]) -> NDArray[np.float64]: ...


def wrap_angle(angle):  # type: ignore[no-untyped-def]
    """
    Return ``angle`` wrapped to (-pi, pi].

    The remainder is exact (IEEE 754), so an angle that is in range already keeps every bit.

    Parameters
    ----------
    angle : float or numpy.ndarray
        Angle [rad] of any size; an array may have any shape.

    Returns
    -------
    float or numpy.ndarray
        The same direction, in (-pi, pi] [rad].

    Examples
    --------
    >>> wrap_angle(-math.pi) == wrap_angle(3.0 * math.pi) == math.pi
    True
    >>> f'{wrap_angle(7.0):.4f}'
    '0.7168'

    """
    if not isinstance(angle, float) and isinstance(angle, np.ndarray):
        wrapped = np.fmod(angle, math.tau)  # exact; in (-2 pi, 2 pi)
        wrapped = np.where(wrapped > math.pi, wrapped - math.tau, wrapped)
        return np.where(wrapped <= -math.pi, wrapped + math.tau, wrapped)
    remainder = math.remainder(angle, math.tau)
    return math.pi if remainder <= -math.pi else remainder
