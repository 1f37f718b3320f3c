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
The arcs of a recorded path, all at once, and the covariance that slip gathers along them.

The same closed form as :func:`.slip_covariance`, on arrays: where a path is known to its end,
each arc's part is swung by all the motion that is left, and the parts are added.  To first order,
and so linear in the constants of slip, which is what a fit needs.
"""

from typing import NamedTuple, Tuple

from diffdrive_kinematics.core.kinematics import (
    Array, Pose, pose_change_from_travel, sinc, WheelGeometry)
from diffdrive_kinematics.core.noise.arc_means import arc_means_of_all
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

        Each is swung by the motion that follows it: the sum of ``J R A R^T J^T`` with R of
        :func:`.rotations` and J of :func:`.pose_jacobians`, entry by entry, as a stack of small
        products is ten times slower.

        Parameters
        ----------
        added : tuple of numpy.ndarray, shape (..., n)
            Entries xx, xy, xt, yy, yt, tt of each arc's A, in the axes of its direction.

        Returns
        -------
        numpy.ndarray, shape (..., 3, 3)
            The covariances of (x [m], y [m], theta [rad]), in the frame of the start.

        Examples
        --------
        See :func:`arcs_along`.

        """
        xx, xy, xt, yy, yt, tt = added
        cosine, sine, x, y = self.cosine, self.sine, self.x[-1] - self.x, self.y[-1] - self.y
        both, along, across = cosine * sine, cosine * cosine, sine * sine
        mixed = 2.0 * both * xy
        turned_xy = both * (xx - yy) + (along - across) * xy
        xx, yy = along * xx - mixed + across * yy, across * xx + mixed + along * yy
        xt, yt = cosine * xt - sine * yt, sine * xt + cosine * yt
        total = np.empty((*tt.shape[:-1], 3, 3))
        total[..., 0, 0] = (xx - y * (2.0 * xt - y * tt)).sum(axis=-1)
        total[..., 1, 1] = (yy + x * (2.0 * yt + x * tt)).sum(axis=-1)
        total[..., 2, 2] = tt.sum(axis=-1)
        total[..., 0, 1] = total[..., 1, 0] = (
            turned_xy + x * xt - y * yt - x * y * tt).sum(axis=-1)
        total[..., 0, 2] = total[..., 2, 0] = (xt - y * tt).sum(axis=-1)
        total[..., 1, 2] = total[..., 2, 1] = (yt + x * tt).sum(axis=-1)
        return total


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


def covariance_along(arcs: ArcsAlong) -> Array:
    """
    Return the covariance of the pose after a path, for a slip variance of 1 m of either wheel.

    Parameters
    ----------
    arcs : ArcsAlong
        The path, as of :func:`.arcs_along`.

    Returns
    -------
    numpy.ndarray, shape (2, 3, 3)
        In the frame of the start, of the slip of the left and of the right wheel: that of both
        is their sum, each times its slip variance per metre [m].

    Examples
    --------
    A straight metre of twenty rows, with k = 1e-4 m of both wheels:

    >>> from diffdrive_kinematics.core.kinematics import WheelGeometry
    >>> from diffdrive_kinematics.core.noise import arcs_along
    >>> left, right = covariance_along(
    ...     arcs_along(WheelGeometry(0.5, 0.125), np.full((20, 2), 0.05)))
    >>> f'Var theta = {(1e-4 * left + 1e-4 * right)[2, 2]:.1e} rad^2'
    'Var theta = 8.0e-04 rad^2'

    """
    e_mean, e_square, sine_square = arcs.means
    separation, travel = arcs.separation, arcs.travel.T
    cosine, sign = np.cos(arcs.half), np.array([[-1.0], [1.0]])
    variance = np.abs(travel)
    lever = -sign * travel[::-1] / (2.0 * separation)
    along = 0.5 * cosine + lever * e_mean
    across = arcs.chord / (2.0 * separation)
    return arcs.gathered((  # what each arc adds, in the axes of its middle direction: (2, n)
        variance * (0.25 * cosine**2 + lever * (cosine * e_mean + lever * e_square)),
        variance * sign * across * along,
        variance * sign * along / separation,
        variance * (across**2 + lever**2 * sine_square),
        variance * across / separation,
        variance / separation**2))


def body_covariance_along(arcs: ArcsAlong) -> Array:
    """
    Return the covariances that the slip of the body makes of a path, for constants of 1.

    In the axes of an arc's middle direction, with h = turn / 2 and s from -1 (start) to 1 (end),
    an error of the distance at s moves the end by ``(cos(h s), sin(h s), 0)``, one of the heading
    by ``(-ds / 2 e(s), ds / 2 (sin(h) - sin(h s)) / h, 1)``, ``e(s) = (cos(h s) - cos(h)) / h``.

    Parameters
    ----------
    arcs : ArcsAlong
        The path, as of :func:`.arcs_along`.

    Returns
    -------
    numpy.ndarray, shape (3, 3, 3)
        Of the pose at the end, in the frame of the start, from the variances of
        :class:`.BodySlip`, in their order: that of all is their sum, each times its constant.

    Examples
    --------
    A straight metre of twenty rows:

    >>> from diffdrive_kinematics.core.kinematics import WheelGeometry
    >>> from diffdrive_kinematics.core.noise import arcs_along
    >>> linear, turn, heading = body_covariance_along(
    ...     arcs_along(WheelGeometry(0.5, 0.125), np.full((20, 2), 0.05)))
    >>> f'{linear[0, 0]:.1f} {turn[2, 2]:.1f} {heading[2, 2]:.1f} {heading[1, 1]:.3f}'
    '1.0 0.0 1.0 0.333'

    """
    e_mean, e_square, sine_square = arcs.means
    distance, half = arcs.distance, arcs.half
    none, one = np.zeros_like(half), np.ones_like(half)
    bow = half * half * sine_square
    middle, across = -0.5 * distance * e_mean, 0.5 * arcs.chord
    of_distance = 1.0 - bow, none, none, bow, none, none
    of_heading = (0.25 * distance**2 * e_square, middle * across, middle,
                  across**2 + 0.25 * distance**2 * sine_square, across, one)
    along, around = np.abs(distance), np.abs(arcs.turn)
    return arcs.gathered(tuple(  # what each arc adds, in the axes of its middle direction: (3, n)
        np.stack([along * a, around * b, along * b]) for a, b in zip(of_distance, of_heading)))
