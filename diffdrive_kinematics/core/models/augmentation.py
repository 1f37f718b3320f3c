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

"""A command becomes a state with a bounded rate, again and again (LaValle 2.23 to 2.27)."""

from dataclasses import dataclass
import math
from typing import Tuple, TypeVar, Union

from diffdrive_kinematics.core.kinematics import check_positive, Scalar
from diffdrive_kinematics.core.models.quantities import clipped, Quantity
from diffdrive_kinematics.core.models.system import admitted, Bounds, ControlSystem, Vector
import numpy as np
from numpy.typing import NDArray

Value = TypeVar('Value')


@dataclass(frozen=True)
class Augmented:
    """
    A system with one of its commands as a state, whose rate is the command instead (2.23-2.27).

    A state that has come to its bound stays there, and a rate that is a state itself is then 0:
    it hits a stop.  See :func:`augmented`.

    Parameters
    ----------
    inner : ControlSystem
        System of which a command becomes a state.
    index : int
        Which of its commands.
    change : Quantity
        Command that is there instead: the rate.

    Examples
    --------
    >>> from diffdrive_kinematics.core.models import unicycle
    >>> smooth = Augmented(
    ...     unicycle(max_speed=1.0), 0, Quantity('s_rate', 'm/s^2', -2.0, 2.0))
    >>> smooth.rate((0.0, 0.0, 0.0, 0.5), (2.0, 0.25))
    (0.5, 0.0, 0.25, 2.0)
    >>> smooth.bounds((0.0, 0.0, 0.0, 1.0))[0]
    (-2.0, 0.0)
    >>> smooth.within((0.0, 0.0, 0.0, 1.5))
    (0.0, 0.0, 0.0, 1.0)

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
        """
        Return f(x, u): that of the inner system, and the rate that is admitted.

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
        See :class:`Augmented`.

        """
        command = admitted(self, state, command)
        held = self._with(command, state[-1])
        return (*self.inner.rate(state[:-1], held), command[self.index])

    def bounds(self, state: Vector) -> Bounds:
        """
        Return the box U(x): nothing is pushed further where it has come to its bound.

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
        See :class:`Augmented`.

        """
        inner, held = self.inner.bounds(state[:-1]), state[-1]
        low, high = inner[self.index]
        return self._with(inner, (_where(held > low, self.change.low),
                                  _where(held < high, self.change.high)))

    def within(self, state: Vector) -> Vector:
        """
        Return the state with each of its parts in its bounds, and at rest at a stop.

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
        See :class:`Augmented`.

        """
        inner = self.inner.within(state[:-1])
        return (*inner, clipped(state[-1], *self.inner.bounds(inner)[self.index]))

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

    Returns
    -------
    Augmented
        System with one more state.

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


def _where(condition: Union[bool, NDArray[np.bool_]], bound: float) -> Scalar:
    """Return the bound where the condition holds, else 0."""
    if isinstance(condition, np.ndarray):
        return np.where(condition, bound, 0.0)
    return bound if condition else 0.0
