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

"""Stacks of the 3x3 matrices by which errors of (x, y, theta) turn and swing with a motion."""

from diffdrive_kinematics.core.kinematics import Array
import numpy as np


def rotations(angle: Array) -> Array:
    """
    Return the matrices of rotations about z.

    Parameters
    ----------
    angle : numpy.ndarray, shape (n,)
        Angles [rad], counter-clockwise.

    Returns
    -------
    numpy.ndarray, shape (n, 3, 3)
        One matrix for each angle, for columns (x, y, theta).

    Examples
    --------
    >>> np.round(rotations(np.array([0.5 * np.pi])) @ [1.0, 0.0, 0.2], 6)
    array([[0. , 1. , 0.2]])

    """
    matrix = pose_jacobians(np.zeros(len(angle)), np.zeros(len(angle)))
    matrix[:, 0, 0] = matrix[:, 1, 1] = np.cos(angle)
    matrix[:, 1, 0] = np.sin(angle)
    matrix[:, 0, 1] = -matrix[:, 1, 0]
    return matrix


def pose_jacobians(x: Array, y: Array) -> Array:
    """
    Return how errors of a pose grow along motions that follow.

    ``[[1, 0, -y], [0, 1, x], [0, 0, 1]]``: an error of the heading swings the motion
    (Smith, Self & Cheeseman 1990).

    Parameters
    ----------
    x, y : numpy.ndarray, shape (n,)
        The motions [m], in the fixed frame.

    Returns
    -------
    numpy.ndarray, shape (n, 3, 3)
        One matrix for each motion, for errors (x [m], y [m], theta [rad]).

    Examples
    --------
    An error of 0.01 rad at the start of 5 m along x is one of 0.05 m in y at their end:

    >>> pose_jacobians(np.array([5.0]), np.array([0.0])) @ [0.0, 0.0, 0.01]
    array([[0.  , 0.05, 0.01]])

    """
    matrix = np.zeros((len(x), 3, 3))
    matrix[:, [0, 1, 2], [0, 1, 2]] = 1.0
    matrix[:, 0, 2], matrix[:, 1, 2] = -y, x
    return matrix
