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

"""Robots that roll in the plane: the command decides the twist, and they move along arcs."""

from dataclasses import dataclass
from typing import Callable, Tuple

from diffdrive_kinematics.core.kinematics import Pose, pose_rate, Scalar
from diffdrive_kinematics.core.models.quantities import Quantity
from diffdrive_kinematics.core.models.system import admitted, Bounds, Vector

POSE = (Quantity('x', 'm'), Quantity('y', 'm'), Quantity('theta', 'rad'))


@dataclass(frozen=True)
class Rolling:
    """
    A robot in the plane whose twist (v, w) its command alone decides: it moves along arcs.

    Parameters
    ----------
    commands : tuple of Quantity
        The box U.
    twist : callable
        Command -> (v [m/s], w [rad/s]).

    Examples
    --------
    >>> robot = Rolling((Quantity('v', 'm/s', -1.0, 1.0),), lambda u: (u[0], 2.0 * u[0]))
    >>> robot.rate((0.0, 0.0, 0.0), (9.0,))
    Pose(x=1.0, y=0.0, theta=2.0)
    >>> robot.bounds((0.0, 0.0, 0.0)), robot.within((1.0, 2.0, 9.0))
    (((-1.0, 1.0),), (1.0, 2.0, 9.0))

    """

    commands: Tuple[Quantity, ...]
    twist: Callable[[Vector], Tuple[Scalar, Scalar]]

    @property
    def states(self) -> Tuple[Quantity, ...]:
        """Return x, y and theta."""
        return POSE

    def rate(self, state: Vector, command: Vector) -> Vector:
        """
        Return (v cos theta, v sin theta, w).

        Parameters
        ----------
        state : tuple of float or numpy.ndarray
            State x, in the order of ``states``.
        command : tuple of float or numpy.ndarray
            Command u, in the order of ``commands``.

        Returns
        -------
        tuple of float or numpy.ndarray
            Rate of each part of the state.

        Examples
        --------
        See :class:`Rolling`.

        """
        return pose_rate(Pose(*state), *self.twist(admitted(self, state, command)))

    def bounds(self, state: Vector) -> Bounds:
        """
        Return the box U, the same in every state.

        Parameters
        ----------
        state : tuple of float or numpy.ndarray
            State x, in the order of ``states``.

        Returns
        -------
        tuple of (low, high)
            Bounds of each command.

        Examples
        --------
        See :class:`Rolling`.

        """
        return tuple((each.low, each.high) for each in self.commands)

    def within(self, state: Vector) -> Vector:
        """
        Return the state: a pose has no bounds.

        Parameters
        ----------
        state : tuple of float or numpy.ndarray
            State x, in the order of ``states``.

        Returns
        -------
        tuple of float or numpy.ndarray
            State in its bounds.

        Examples
        --------
        See :class:`Rolling`.

        """
        return state
