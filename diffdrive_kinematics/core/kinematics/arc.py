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
Pose of the robot, and the exact arc that it follows while its twist is constant.

A pose is (x [m], y [m], theta [rad]) in a fixed frame, theta counter-clockwise from the x axis
(REP-103).  Its fields are floats, or numpy arrays that broadcast: N poses move in one call.
"""

import math
from typing import NamedTuple, Union

import numpy as np
from numpy.typing import NDArray

__all__ = ['Pose', 'Scalar', 'advance', 'sinc']

Scalar = Union[float, NDArray[np.float64]]


class Pose(NamedTuple):
    """
    Position and heading of a robot in a fixed frame; one pose, or arrays of poses.

    Parameters
    ----------
    x, y : float or numpy.ndarray
        Position [m].
    theta : float or numpy.ndarray
        Heading [rad], counter-clockwise from the x axis.

    Examples
    --------
    >>> Pose(1.0, 2.0, 0.5)._replace(theta=0.0)
    Pose(x=1.0, y=2.0, theta=0.0)

    """

    x: Scalar
    y: Scalar
    theta: Scalar


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


def advance(pose: Pose, distance: Scalar, turn: Scalar) -> Pose:
    """
    Return the pose after an arc of constant curvature.

    The chord of the arc has length ``distance * sinc(turn / 2)`` and direction
    ``theta + turn / 2``: exact for a constant twist, for the straight line (turn = 0) and for
    the turn in place (distance = 0), without a case of its own for either.

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
    half = 0.5 * turn
    chord = distance * sinc(half)
    direction = pose.theta + half
    if isinstance(direction, np.ndarray):
        return Pose(pose.x + chord * np.cos(direction), pose.y + chord * np.sin(direction),
                    pose.theta + turn)
    return Pose(pose.x + chord * math.cos(direction), pose.y + chord * math.sin(direction),
                pose.theta + turn)
