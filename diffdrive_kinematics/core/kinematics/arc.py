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

"""The exact arc that a robot follows while its twist is constant."""

import math
from typing import overload, Tuple

from diffdrive_kinematics.core.kinematics.pose import Pose, Scalar
import numpy as np


def sinc(angle: Scalar) -> Scalar:
    """
    Return ``sin(angle) / angle``, and 1 where the angle is 0.

    The quotient is good to the last digit down to the smallest angle.  The usual form, a series
    below a threshold, loses digits around the threshold.

    Parameters
    ----------
    angle : float or numpy.ndarray
        Angle [rad].

    Returns
    -------
    float or numpy.ndarray
        Ratio of a chord to its arc, where ``angle`` is half the turn [1].

    Examples
    --------
    >>> sinc(0.0), round(sinc(0.5 * math.pi), 6)  # the second one is 2 / pi
    (1.0, 0.63662)

    """
    if isinstance(angle, np.ndarray):
        divisor = np.where(angle == 0.0, 1.0, angle)
        return np.where(angle == 0.0, 1.0, np.sin(divisor) / divisor)
    return math.sin(angle) / angle if angle else 1.0


@overload
def displacement(heading: float, distance: float, turn: float) -> Tuple[float, float]: ...


@overload
def displacement(heading: Scalar, distance: Scalar, turn: Scalar) -> Tuple[Scalar, Scalar]: ...


def displacement(heading: Scalar, distance: Scalar, turn: Scalar) -> Tuple[Scalar, Scalar]:
    """
    Return how far an arc of constant curvature leads, in the fixed frame.

    Its chord has length ``distance * sinc(turn / 2)`` and direction ``heading + turn / 2``: exact
    for a constant twist, for the straight line (turn = 0) and for the turn in place
    (distance = 0), without a case of its own for either.

    Parameters
    ----------
    heading : float or numpy.ndarray
        Heading where the arc begins [rad].
    distance : float or numpy.ndarray
        Length of the arc [m], negative in reverse.
    turn : float or numpy.ndarray
        Change of the heading [rad].  Arrays broadcast with ``heading``, which has to be an array
        then.

    Returns
    -------
    dx : float or numpy.ndarray
        Change of x [m].
    dy : float or numpy.ndarray
        Change of y [m].

    Examples
    --------
    Half a circle of radius 1 m to the left, which ends 2 m to the left:

    >>> [round(value, 6) for value in displacement(0.0, distance=math.pi, turn=math.pi)]
    [0.0, 2.0]

    """
    half = 0.5 * turn
    direction = heading + half
    if isinstance(direction, float):
        chord = distance * (math.sin(half) / half if half else 1.0)
        return chord * math.cos(direction), chord * math.sin(direction)
    chord = distance * sinc(half)
    return chord * np.cos(direction), chord * np.sin(direction)


def advance(pose: Pose, distance: Scalar, turn: Scalar) -> Pose:
    """
    Return the pose after an arc of constant curvature; see :func:`displacement`.

    Parameters
    ----------
    pose : Pose
        Where the arc begins; floats or arrays.
    distance : float or numpy.ndarray
        Length of the arc [m], negative in reverse.
    turn : float or numpy.ndarray
        Change of the heading [rad].  Arrays broadcast with those of ``pose``, whose theta has to
        be an array then.

    Returns
    -------
    Pose
        Where the arc ends.  The heading is not wrapped.

    Examples
    --------
    A quarter circle of radius 2 m to the left:

    >>> end = advance(Pose(0.0, 0.0, 0.0), distance=math.pi, turn=0.5 * math.pi)
    >>> [round(value, 6) for value in end]
    [2.0, 2.0, 1.570796]

    """
    dx, dy = displacement(pose.theta, distance, turn)
    return Pose(pose.x + dx, pose.y + dy, pose.theta + turn)
