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

"""The covariance of a pose as six floats."""

import math
from typing import NamedTuple

from diffdrive_kinematics.core.kinematics import Array
import numpy as np


class PoseCovariance(NamedTuple):
    """
    Symmetric covariance of (x, y, theta) in a fixed frame, as six floats.

    Plain floats, as one step of it takes a few microseconds and one of a numpy matrix several
    times that.  ``+`` joins tuples: add with :meth:`plus`.

    Parameters
    ----------
    xx, xy : float
        Var x and Cov(x, y) [m^2].
    xt : float
        Cov(x, theta) [m rad].
    yy : float
        Var y [m^2].
    yt : float
        Cov(y, theta) [m rad].
    tt : float
        Var theta [rad^2].

    Examples
    --------
    >>> covariance = NO_COVARIANCE._replace(xx=0.04, yy=0.01)
    >>> f'{math.sqrt(covariance.xx):.2f} m along x'
    '0.20 m along x'

    """

    xx: float
    xy: float
    xt: float
    yy: float
    yt: float
    tt: float

    def matrix(self) -> Array:
        """
        Return the covariance as an array.

        Returns
        -------
        numpy.ndarray, shape (3, 3)
            Rows and columns are (x, y, theta).

        Examples
        --------
        >>> PoseCovariance(4.0, 0.5, 0.0, 1.0, 0.0, 9.0).matrix()
        array([[4. , 0.5, 0. ],
               [0.5, 1. , 0. ],
               [0. , 0. , 9. ]])

        """
        return np.array([[self.xx, self.xy, self.xt],
                         [self.xy, self.yy, self.yt],
                         [self.xt, self.yt, self.tt]])

    @staticmethod
    def from_matrix(matrix: Array) -> 'PoseCovariance':
        """
        Return the covariance of a symmetric matrix.

        Parameters
        ----------
        matrix : numpy.ndarray, shape (3, 3)
            Rows and columns are (x, y, theta); its upper triangle counts.

        Returns
        -------
        PoseCovariance
            The same covariance as floats.

        Raises
        ------
        ValueError
            If the shape is another one.

        Examples
        --------
        >>> PoseCovariance.from_matrix(np.diag([4.0, 1.0, 9.0]))
        PoseCovariance(xx=4.0, xy=0.0, xt=0.0, yy=1.0, yt=0.0, tt=9.0)

        """
        if np.shape(matrix) != (3, 3):
            raise ValueError(f'matrix has shape {np.shape(matrix)}, expected (3, 3)')
        return PoseCovariance(*(float(matrix[i][j]) for i in range(3) for j in range(i, 3)))

    def plus(self, other: 'PoseCovariance') -> 'PoseCovariance':
        """
        Return the sum: the covariance of the sum of two independent errors.

        Parameters
        ----------
        other : PoseCovariance
            In the same frame.

        Returns
        -------
        PoseCovariance
            The sum, element by element.

        Examples
        --------
        >>> NO_COVARIANCE._replace(xx=4.0).plus(NO_COVARIANCE._replace(xx=1.0)).xx
        5.0

        """
        return PoseCovariance(
            self.xx + other.xx, self.xy + other.xy, self.xt + other.xt,
            self.yy + other.yy, self.yt + other.yt, self.tt + other.tt)

    def rotated(self, angle: float) -> 'PoseCovariance':
        """
        Return ``R P R^T``: the covariance of the error turned counter-clockwise by ``angle``.

        A covariance in the axes of frame B is, in those of frame A, turned by the heading of B
        in A; from A into the axes of a robot with heading theta it is turned by ``-theta``.

        Parameters
        ----------
        angle : float
            Angle [rad] to turn by.

        Returns
        -------
        PoseCovariance
            In the turned axes; Var theta stays as it is.

        Examples
        --------
        An error along the axis of a robot that looks along y is one in y:

        >>> turned = NO_COVARIANCE._replace(xx=4.0).rotated(0.5 * math.pi)
        >>> round(turned.xx, 9), round(turned.yy, 9)
        (0.0, 4.0)

        """
        c, s = math.cos(angle), math.sin(angle)
        twice = 2.0 * s * c * self.xy
        return PoseCovariance(
            c * c * self.xx - twice + s * s * self.yy,
            s * c * (self.xx - self.yy) + (c * c - s * s) * self.xy,
            c * self.xt - s * self.yt,
            s * s * self.xx + twice + c * c * self.yy,
            s * self.xt + c * self.yt,
            self.tt)


NO_COVARIANCE = PoseCovariance(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
