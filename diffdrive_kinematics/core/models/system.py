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
from typing import Callable, NamedTuple, Protocol, Sequence, Tuple, TypeVar, Union

from diffdrive_kinematics.core.arc import Pose, Scalar
from diffdrive_kinematics.core.checks import check_positive
from diffdrive_kinematics.core.integration import pose_rate
import numpy as np
from numpy.typing import NDArray

__all__ = [
    'Augmented', 'ControlSystem', 'Quantity', 'Rolling', 'Vector', 'admitted', 'augmented',
    'check_command']

Vector = Tuple[Scalar, ...]
Bounds = Tuple[Tuple[Scalar, Scalar], ...]
Value = TypeVar('Value')


class Quantity(NamedTuple):
    """A component of a state or a command: name, unit, and least and largest value."""

    name: str
    unit: str
    low: float = -math.inf
    high: float = math.inf


class ControlSystem(Protocol):
    """
    A transition equation x' = f(x, u) with its states and commands (LaValle 2.15).

    ``rate`` is f, ``bounds`` the box U(x), low and high of each command, and ``within`` what the
    bounds of the states leave of a state.
    """

    @property
    def states(self) -> Tuple[Quantity, ...]: ...  # noqa: D102

    @property
    def commands(self) -> Tuple[Quantity, ...]: ...  # noqa: D102

    def rate(self, state: Vector, command: Vector) -> Vector: ...  # noqa: D102

    def bounds(self, state: Vector) -> Bounds: ...  # noqa: D102

    def within(self, state: Vector) -> Vector: ...  # noqa: D102


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

    """

    commands: Tuple[Quantity, ...]
    twist: Callable[[Vector], Tuple[Scalar, Scalar]]

    @property
    def states(self) -> Tuple[Quantity, ...]:
        """Return x, y and theta."""
        return POSE

    def rate(self, state: Vector, command: Vector) -> Vector:
        """Return (v cos theta, v sin theta, w)."""
        return pose_rate(Pose(*state), *self.twist(admitted(self, state, command)))

    def bounds(self, state: Vector) -> Bounds:
        """Return the box U, the same in every state."""
        return tuple((each.low, each.high) for each in self.commands)

    def within(self, state: Vector) -> Vector:
        """Return the state: a pose has no bounds."""
        return state


@dataclass(frozen=True)
class Augmented:
    """
    A system with one of its commands as a state, whose rate is the command instead (2.23-2.27).

    A state that has come to its bound stays there, and a rate that is a state itself is then 0:
    it hits a stop.  See :func:`augmented`.
    """

    inner: ControlSystem
    index: int
    change: Quantity

    @property
    def states(self) -> Tuple[Quantity, ...]:
        """Return those of the inner system, and what was a command there."""
        return (*self.inner.states, self.inner.commands[self.index])

    @property
    def commands(self) -> Tuple[Quantity, ...]:
        """Return those of the inner system, with the rate in the place of what is a state."""
        return self._with(self.inner.commands, self.change)

    def rate(self, state: Vector, command: Vector) -> Vector:
        """Return f(x, u): that of the inner system, and the rate that is admitted."""
        command = admitted(self, state, command)
        held = self._with(command, state[-1])
        return (*self.inner.rate(state[:-1], held), command[self.index])

    def bounds(self, state: Vector) -> Bounds:
        """Return the box U(x): nothing is pushed further where it has come to its bound."""
        inner, held = self.inner.bounds(state[:-1]), state[-1]
        low, high = inner[self.index]
        return self._with(inner, (_where(held > low, self.change.low),
                                  _where(held < high, self.change.high)))

    def within(self, state: Vector) -> Vector:
        """Return the state with each of its parts in its bounds, and at rest at a stop."""
        inner = self.inner.within(state[:-1])
        return (*inner, _clipped(state[-1], *self.inner.bounds(inner)[self.index]))

    def _with(self, values: Tuple[Value, ...], value: Value) -> Tuple[Value, ...]:
        """Return the values with another one at the index."""
        return (*values[:self.index], value, *values[self.index + 1:])


def augmented(system: ControlSystem, name: str, *, bound: float) -> Augmented:
    """
    Return the system in which a command changes no faster than ``bound`` (2.23 to 2.27).

    Again and again: the rate of a rate is an acceleration, and its rate the jerk.

    Parameters
    ----------
    system : ControlSystem
        What is commanded so far.
    name : str
        Of the command that becomes a state; the new command is ``name + '_rate'``.
    bound : float
        Of the new command, both ways, above 0; ``math.inf``: none.

    Raises
    ------
    ValueError
        If the system has no such command, or the bound is not above 0.

    Examples
    --------
    >>> from diffdrive_kinematics.core.models import transition, unicycle
    >>> smooth = augmented(unicycle(), 's', bound=2.0)
    >>> [f'{each.name} [{each.unit}]' for each in (*smooth.states[3:], *smooth.commands)]
    ['s [m/s]', 's_rate [m/s^2]', 'w [rad/s]']
    >>> x, y, theta, s = transition(smooth, (0.0, 0.0, 0.0, 1.0), (2.0, 0.0), 3.0)
    >>> round(x, 9), round(s, 9)
    (12.0, 7.0)

    """
    names = [command.name for command in system.commands]
    if name not in names:
        raise ValueError(f'the command is {name!r}, expected one of {names}')
    if not math.isinf(bound):
        check_positive('bound', bound)
    index = names.index(name)
    unit = system.commands[index].unit
    base, _, power = unit.partition('/s')
    per = '/s' if '/s' not in unit else f"/s^{int(power.strip('^') or 1) + 1}"
    return Augmented(system, index, Quantity(f'{name}_rate', base + per, -bound, bound))


def admitted(system: ControlSystem, state: Vector, command: Vector) -> Vector:
    """
    Return the command of U(x) that is nearest to another.

    Examples
    --------
    >>> from diffdrive_kinematics.core.models import unicycle
    >>> smooth = augmented(unicycle(max_speed=1.0), 's', bound=2.0)
    >>> admitted(smooth, (0.0, 0.0, 0.0, 0.5), (9.0, 0.0))
    (2.0, 0.0)
    >>> admitted(smooth, (0.0, 0.0, 0.0, 1.0), (9.0, 0.0))
    (0.0, 0.0)

    """
    return tuple(_clipped(value, *bound) for value, bound in zip(command, system.bounds(state)))


def check_command(system: ControlSystem, command: Sequence[float]) -> None:
    """
    Raise ``ValueError`` unless the command is in the box U.

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


def _clipped(value: Scalar, low: Scalar, high: Scalar) -> Scalar:
    if isinstance(value, np.ndarray) or isinstance(low, np.ndarray):
        return np.clip(value, low, high)
    return min(max(value, low), high)


def _where(condition: Union[bool, NDArray[np.bool_]], bound: float) -> Scalar:
    """Return the bound where the condition holds, else 0."""
    if isinstance(condition, np.ndarray):
        return np.where(condition, bound, 0.0)
    return bound if condition else 0.0
