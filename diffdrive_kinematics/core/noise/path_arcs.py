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

"""The arcs of a recorded path, all at once, and what errors of them make at its end."""

from typing import NamedTuple, Tuple

from diffdrive_kinematics.core.kinematics import (
    Array, Pose, pose_change_from_travel, sinc, WheelGeometry)
from diffdrive_kinematics.core.noise.arc_means import arc_means_of_all
from diffdrive_kinematics.core.noise.matrices import gathered
import numpy as np


class ArcsAlong(NamedTuple):
    """
    The arcs of a path, each from the start of the path.

    Parameters
    ----------
    separation : float
        Distance between the wheels [m].
    travel : numpy.ndarray, shape (n, 2)
        Travel (d_l, d_r) [m] of each.
    distance, turn, half, chord : numpy.ndarray, shape (n,)
        Length [m], turn and half of it [rad], and chord [m] of each.
    cosine, sine : numpy.ndarray, shape (n,)
        Of its middle direction.
    x, y, theta : numpy.ndarray, shape (n,)
        The pose at its end [m, rad].
    means : tuple of numpy.ndarray, shape (n,)
        As of :func:`.arc_means_of_all`.

    Examples
    --------
    See :func:`arcs_along`.

    """

    separation: float
    travel: Array
    distance: Array
    turn: Array
    half: Array
    chord: Array
    cosine: Array
    sine: Array
    x: Array
    y: Array
    theta: Array
    means: Tuple[Array, Array, Array]

    @property
    def end(self) -> Pose:
        """Return the pose after the path, in the frame of its start, the heading not wrapped."""
        return Pose(float(self.x[-1]), float(self.y[-1]), float(self.theta[-1]))

    def gathered(self, added: Tuple[Array, ...]) -> Array:
        """
        Return the sum of what the arcs add to the covariance at the end of the path.

        Parameters
        ----------
        added : tuple of numpy.ndarray, shape (..., n)
            As of :func:`.gathered`.

        Returns
        -------
        numpy.ndarray, shape (..., 3, 3)
            The covariances of (x [m], y [m], theta [rad]), in the frame of the start.

        Examples
        --------
        See :func:`arcs_along`.

        """
        return gathered(added, self.cosine, self.sine, self.x[-1] - self.x, self.y[-1] - self.y)


def arcs_along(geometry: WheelGeometry, travel: Array) -> ArcsAlong:
    """
    Return the arcs of a path.

    Parameters
    ----------
    geometry : WheelGeometry
        Only its separation counts.
    travel : numpy.ndarray, shape (n, 2)
        Finite travel (d_l, d_r) [m] of each of n >= 1 arcs, in order.

    Returns
    -------
    ArcsAlong
        All of them.

    Examples
    --------
    Two arcs straight ahead, and an error of the heading of 1e-4 rad^2 in each:

    >>> arcs, zero = arcs_along(WheelGeometry(0.5, 0.125), np.full((2, 2), 0.5)), np.zeros(2)
    >>> arcs.end, float(arcs.gathered((*5 * (zero,), np.full(2, 1e-4)))[2, 2])
    (Pose(x=1.0, y=0.0, theta=0.0), 0.0002)

    """
    distance, turn = pose_change_from_travel(geometry, *travel.T)
    half = 0.5 * turn
    theta = np.cumsum(turn)
    way, chord = theta - half, distance * sinc(half)
    cosine, sine = np.cos(way), np.sin(way)
    return ArcsAlong(
        geometry.separation, travel, distance, turn, half, chord, cosine, sine,
        np.cumsum(chord * cosine), np.cumsum(chord * sine), theta, arc_means_of_all(half))
