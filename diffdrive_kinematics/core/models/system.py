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
Control systems: what a robot's state is, what it can be told, and how it moves.

A state x and a command u are tuples with a number for each of the system's quantities; floats,
or numpy arrays that broadcast, so that n robots move in one call.  u is held over the time of a
transition, and a robot does what is nearest to it in its command set U(x).
"""

from typing import Protocol, Sequence, Tuple

from diffdrive_kinematics.core.kinematics import Scalar
from diffdrive_kinematics.core.models.quantities import clipped, Quantity

Vector = Tuple[Scalar, ...]
Bounds = Tuple[Tuple[Scalar, Scalar], ...]


class ControlSystem(Protocol):
    """
    A transition equation x' = f(x, u) with its states and commands (LaValle 2.15).

    Parameters
    ----------
    *args, **kwargs
        What a protocol takes: nothing.

    Examples
    --------
    >>> from diffdrive_kinematics.core.models import unicycle
    >>> robot: ControlSystem = unicycle(max_speed=1.0, max_yaw_rate=2.0)
    >>> [each.name for each in robot.states], [each.name for each in robot.commands]
    (['x', 'y', 'theta'], ['s', 'w'])
    >>> robot.rate((0.0, 0.0, 0.0), (0.5, 0.25))
    Pose(x=0.5, y=0.0, theta=0.25)
    >>> robot.bounds((0.0, 0.0, 0.0)), robot.within((1.0, 2.0, 3.0))
    (((-1.0, 1.0), (-2.0, 2.0)), (1.0, 2.0, 3.0))

    """

    @property
    def states(self) -> Tuple[Quantity, ...]:
        """Return the parts of a state."""

    @property
    def commands(self) -> Tuple[Quantity, ...]:
        """Return the parts of a command."""

    def rate(self, state: Vector, command: Vector) -> Vector:
        """
        Return f(x, u).

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
        See :class:`ControlSystem`.

        """

    def bounds(self, state: Vector) -> Bounds:
        """
        Return the box U(x).

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
        See :class:`ControlSystem`.

        """

    def within(self, state: Vector) -> Vector:
        """
        Return what the bounds of the states leave of a state.

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
        See :class:`ControlSystem`.

        """


def admitted(system: ControlSystem, state: Vector, command: Vector) -> Vector:
    """
    Return the command of U(x) that is nearest to another.

    Parameters
    ----------
    system : ControlSystem
        What is commanded.
    state : tuple of float or numpy.ndarray
        State x, in the order of ``states``.
    command : tuple of float or numpy.ndarray
        Command u, in the order of ``commands``.

    Returns
    -------
    tuple of float or numpy.ndarray
        Command that the system can do.

    Examples
    --------
    >>> from diffdrive_kinematics.core.models import augmented, unicycle
    >>> smooth = augmented(unicycle(max_speed=1.0), 's', bound=2.0)
    >>> admitted(smooth, (0.0, 0.0, 0.0, 0.5), (9.0, 0.0))
    (2.0, 0.0)
    >>> admitted(smooth, (0.0, 0.0, 0.0, 1.0), (9.0, 0.0))
    (0.0, 0.0)

    """
    return tuple(clipped(value, *bound) for value, bound in zip(command, system.bounds(state)))


def check_command(system: ControlSystem, command: Sequence[float]) -> None:
    """
    Raise ``ValueError`` unless the command is in the box U.

    Parameters
    ----------
    system : ControlSystem
        What is commanded.
    command : sequence of float
        Command u, in the order of ``system.commands``.

    Raises
    ------
    ValueError
        If a part is beyond its bounds, or the number of parts another one.

    Examples
    --------
    >>> from diffdrive_kinematics.core.models import tricycle
    >>> check_command(tricycle(wheel_base=1.0, max_steering=0.5), (1.0, 0.7))
    Traceback (most recent call last):
    ValueError: phi is 0.7 rad, expected from -0.5 to 0.5 rad

    """
    if len(command) != len(system.commands):
        raise ValueError(
            f'the command has {len(command)} numbers, expected one for each of '
            f'{[each.name for each in system.commands]}')
    for (name, unit, low, high), value in zip(system.commands, command):
        if not low <= value <= high:
            raise ValueError(f'{name} is {value!r} {unit}, expected from {low} to {high} {unit}')
