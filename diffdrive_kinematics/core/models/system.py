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

from dataclasses import dataclass
import math
from typing import Callable, NamedTuple, Protocol, Sequence, Tuple

from diffdrive_kinematics.core.kinematics import Pose, pose_rate, Scalar
import numpy as np

__all__ = [
    'Bounds', 'ControlSystem', 'Quantity', 'Rolling', 'Vector', 'admitted', 'check_command',
    'clipped']

Vector = Tuple[Scalar, ...]
Bounds = Tuple[Tuple[Scalar, Scalar], ...]


class Quantity(NamedTuple):
    """
    A component of a state or a command.

    Parameters
    ----------
    name : str
        What it is called.
    unit : str
        Its unit.
    low : float
        Least value.
    high : float
        Largest value.

    Examples
    --------
    >>> Quantity('phi', 'rad', -0.5, 0.5).high
    0.5

    """

    name: str
    unit: str
    low: float = -math.inf
    high: float = math.inf


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
        ...

    @property
    def commands(self) -> Tuple[Quantity, ...]:
        """Return the parts of a command."""
        ...

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
        ...

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
        ...

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
        ...


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


def clipped(value: Scalar, low: Scalar, high: Scalar) -> Scalar:
    """
    Return what of a range is nearest to a value.

    Parameters
    ----------
    value : float or numpy.ndarray
        The value.
    low : float or numpy.ndarray
        Least value of the range.
    high : float or numpy.ndarray
        Largest value of the range.

    Returns
    -------
    float or numpy.ndarray
        A value of the range.

    Examples
    --------
    >>> clipped(3.0, 0.0, 2.0)
    2.0

    """
    if isinstance(value, np.ndarray) or isinstance(low, np.ndarray):
        return np.clip(value, low, high)
    return min(max(value, low), high)
