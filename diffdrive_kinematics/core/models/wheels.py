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

"""The point about which wheels at given places turn, or that there is none (LaValle 2.2.1)."""

from enum import Enum
import math
from typing import NamedTuple, Sequence

from diffdrive_kinematics.core.kinematics import check_finite
import numpy as np

TOLERANCE = 1e-9
"""Of the directions, and of the places over the size of the vehicle."""


class Wheel(NamedTuple):
    """
    A wheel on the ground.

    Parameters
    ----------
    x : float
        Where it touches the ground [m].
    y : float
        Where it touches the ground [m].
    direction : float
        Direction in which it rolls [rad].

    Examples
    --------
    See :func:`rolling_centre`.

    """

    x: float
    y: float
    direction: float


class Motion(Enum):
    """
    How a vehicle on wheels can move without any of them skidding.

    Examples
    --------
    See :class:`RollingCentre`.

    """

    TURN = 'about one point'
    STRAIGHT = 'along one direction'
    AXLE = 'about any point of the one axle'
    SKID = 'not at all'


class RollingCentre(NamedTuple):
    """
    How wheels can roll, and about which point.

    Parameters
    ----------
    motion : Motion
        What they can do.
    x : float
        Of the point [m]; infinite for STRAIGHT, else NaN for none.
    y : float
        Of the point [m], alike.

    Examples
    --------
    >>> RollingCentre(Motion.TURN, 0.0, 2.0).motion.value
    'about one point'

    """

    motion: Motion
    x: float
    y: float


def rolling_centre(wheels: Sequence[Wheel]) -> RollingCentre:
    """
    Return the instantaneous centre of rotation of wheels, or that they skid.

    The axis of each wheel has to go through it: ``(p - p_i) . (cos a_i, sin a_i) = 0``.  These
    are linear equations for p in homogeneous coordinates, whose rank tells what there is.

    Parameters
    ----------
    wheels : sequence of Wheel
        At least one, in any frame.

    Returns
    -------
    RollingCentre
        The point in that frame.

    Raises
    ------
    ValueError
        If there are no wheels or a number is not finite.

    Examples
    --------
    A tricycle with its front wheel at 45 degrees:

    >>> rear = [Wheel(0.0, 0.5, 0.0), Wheel(0.0, -0.5, 0.0)]
    >>> motion, x, y = rolling_centre([*rear, Wheel(2.0, 0.0, math.pi / 4)])
    >>> motion.name, round(x, 9), round(y, 9)
    ('TURN', 0.0, 2.0)
    >>> rolling_centre([*rear, Wheel(2.0, 0.5, 0.4), Wheel(2.0, -0.5, 0.4)]).motion.name
    'SKID'

    """
    if not wheels:
        raise ValueError('there are no wheels, expected one or more')
    for wheel in wheels:
        for name, value in zip(Wheel._fields, wheel):
            check_finite(f'{name} of a wheel', value)
    places = np.array([(wheel.x, wheel.y) for wheel in wheels])
    origin = places.mean(axis=0)
    size = float(np.abs(places - origin).max()) or 1.0
    unit = np.array([(math.cos(wheel.direction), math.sin(wheel.direction)) for wheel in wheels])
    offset = np.sum(unit * (places - origin), axis=1) / size
    _, values, rows = np.linalg.svd(np.column_stack([unit, -offset]), full_matrices=True)
    rank = int(np.count_nonzero(values > TOLERANCE * math.sqrt(len(wheels))))
    if rank == 1:
        return RollingCentre(Motion.AXLE, math.nan, math.nan)
    if rank == 3:
        return RollingCentre(Motion.SKID, math.nan, math.nan)
    x, y, weight = rows[-1]
    if abs(weight) <= TOLERANCE:
        cosine, sine = unit[0]
        return RollingCentre(
            Motion.STRAIGHT, -math.copysign(math.inf, sine), math.copysign(math.inf, cosine))
    return RollingCentre(
        Motion.TURN, float(origin[0] + size * x / weight), float(origin[1] + size * y / weight))
