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

from typing import Tuple

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


def gathered(added: Tuple[Array, ...], cosine: Array, sine: Array, x: Array, y: Array) -> Array:
    """
    Return the sum of covariances that arcs add, each swung by the motion that follows it.

    It is the sum of ``J R A R^T J^T`` over the arcs, with R of :func:`rotations` and J of
    :func:`pose_jacobians`, entry by entry: a stack of small products is ten times slower.

    Parameters
    ----------
    added : tuple of numpy.ndarray, shape (..., n)
        Entries xx, xy, xt, yy, yt, tt of each arc's A, in the axes of its direction.
    cosine, sine : numpy.ndarray, shape (n,)
        Of the directions of the arcs.
    x, y : numpy.ndarray, shape (n,)
        The motion [m] after each arc.

    Returns
    -------
    numpy.ndarray, shape (..., 3, 3)
        The covariances of (x [m], y [m], theta [rad]) at the end.

    Examples
    --------
    An error of the heading of 1e-4 rad^2 and a metre along x after it:

    >>> zero, one = np.zeros(1), np.ones(1)
    >>> gathered((zero, zero, zero, zero, zero, 1e-4 * one), one, zero, one, zero)
    array([[0.    , 0.    , 0.    ],
           [0.    , 0.0001, 0.0001],
           [0.    , 0.0001, 0.0001]])

    """
    xx, xy, xt, yy, yt, tt = added
    both, along, across = cosine * sine, cosine * cosine, sine * sine
    mixed = 2.0 * both * xy
    turned_xy = both * (xx - yy) + (along - across) * xy
    xx, yy = along * xx - mixed + across * yy, across * xx + mixed + along * yy
    xt, yt = cosine * xt - sine * yt, sine * xt + cosine * yt
    total = np.empty((*tt.shape[:-1], 3, 3))
    total[..., 0, 0] = (xx - y * (2.0 * xt - y * tt)).sum(axis=-1)
    total[..., 1, 1] = (yy + x * (2.0 * yt + x * tt)).sum(axis=-1)
    total[..., 2, 2] = tt.sum(axis=-1)
    total[..., 0, 1] = total[..., 1, 0] = (turned_xy + x * xt - y * yt - x * y * tt).sum(axis=-1)
    total[..., 0, 2] = total[..., 2, 0] = (xt - y * tt).sum(axis=-1)
    total[..., 1, 2] = total[..., 2, 1] = (yt + x * tt).sum(axis=-1)
    return total
