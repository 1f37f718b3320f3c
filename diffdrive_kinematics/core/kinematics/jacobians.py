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

"""The kinematics of two wheels as matrices."""

from diffdrive_kinematics.core.kinematics.geometry import WheelGeometry
from diffdrive_kinematics.core.kinematics.pose import Array
import numpy as np


def jacobian(geometry: WheelGeometry) -> Array:
    """
    Return the matrix J of the forward kinematics: ``[v, w] = J @ [u_l, u_r]``.

    With equal radii this is ``R [[1/2, 1/2], [-1/L, 1/L]]``.

    Parameters
    ----------
    geometry : WheelGeometry
        Size and spacing of the wheels.

    Returns
    -------
    numpy.ndarray, shape (2, 2)
        J, with a first row in m and a second one without unit.

    Examples
    --------
    >>> jacobian(WheelGeometry(0.5, 0.125)) @ [2.0, 4.0]
    array([0.375, 0.5  ])

    """
    left, right, separation = geometry.left_radius, geometry.right_radius, geometry.separation
    return np.array([[0.5 * left, 0.5 * right], [-left / separation, right / separation]])


def inverse_jacobian(geometry: WheelGeometry) -> Array:
    """
    Return the matrix of the inverse kinematics: ``[u_l, u_r] = J^-1 @ [v, w]``.

    Parameters
    ----------
    geometry : WheelGeometry
        Size and spacing of the wheels.

    Returns
    -------
    numpy.ndarray, shape (2, 2)
        The inverse of :func:`jacobian`, with a first column in 1/m and a second one without unit.

    Examples
    --------
    >>> inverse_jacobian(WheelGeometry(0.5, 0.125)) @ [0.375, 0.5]
    array([2., 4.])

    """
    left, right, half = geometry.left_radius, geometry.right_radius, 0.5 * geometry.separation
    return np.array([[1.0 / left, -half / left], [1.0 / right, half / right]])
