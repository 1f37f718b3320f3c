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
Where held commands lead: exactly, by Runge-Kutta, or by Euler steps; and sample paths.

Sample paths are made under disturbances of the commands (LaValle 2.35, 2.39).
"""

import math
from typing import Callable, List, Sequence, Tuple

from diffdrive_kinematics.core.kinematics import (
    advance, Array, check_count, check_finite, check_positive, euler, Pose, runge_kutta, Scalar)
from diffdrive_kinematics.core.models.disturbance import Disturbance, disturbed, Step
from diffdrive_kinematics.core.models.rolling import Rolling
from diffdrive_kinematics.core.models.system import admitted, ControlSystem, Vector
import numpy as np


def transition(
        system: ControlSystem, state: Vector, command: Vector, duration: float, *,
        step: float = 0.01) -> Vector:
    """
    Return the state after a command was held for ``duration`` [s] (LaValle 2.10).

    It is exact where the robot moves along arcs (2.4 to 2.6), else by Runge-Kutta steps (2.20).

    Parameters
    ----------
    system : ControlSystem
        What moves.
    state : tuple of float or numpy.ndarray
        State x, in the order of ``states``.
    command : tuple of float or numpy.ndarray
        Command u, in the order of ``commands``.
    duration : float
        For how long [s] the command is held; below 0: where it came from.
    step : float
        Longest Runge-Kutta step [s].

    Returns
    -------
    tuple of float or numpy.ndarray
        State x after that time.

    Raises
    ------
    ValueError
        If the duration is not finite, or the step not above 0.

    Examples
    --------
    A quarter circle of a tricycle to the left:

    >>> from diffdrive_kinematics.core.models import tricycle
    >>> x, y, theta = transition(
    ...     tricycle(wheel_base=1.0), (0.0, 0.0, 0.0), (1.0, math.pi / 4), math.pi / 2)
    >>> round(x, 9), round(y, 9), round(theta, 9)
    (1.0, 1.0, 1.570796327)

    """
    check_finite('duration', duration)
    if isinstance(system, Rolling):
        v, w = system.twist(admitted(system, state, command))
        return advance(Pose(*state), v * duration, w * duration)
    steps = max(1, math.ceil(abs(duration) / check_positive('step', step) - 1e-9))
    return transition_runge_kutta(system, state, command, duration, steps=steps)


def transition_euler(
        system: ControlSystem, state: Vector, command: Vector, duration: float, *,
        steps: int) -> Vector:
    """
    Return the state after a held command by ``steps`` Euler steps (LaValle 2.17).

    Parameters
    ----------
    system : ControlSystem
        What moves.
    state : tuple of float or numpy.ndarray
        State x, in the order of ``states``.
    command : tuple of float or numpy.ndarray
        Command u, in the order of ``commands``.
    duration : float
        For how long [s] the command is held; below 0: where it came from.
    steps : int
        Number of steps of equal length.

    Returns
    -------
    tuple of float or numpy.ndarray
        State x after that time.

    Raises
    ------
    ValueError
        If the duration is not finite or ``steps`` no integer, 1 or above.

    Examples
    --------
    >>> from diffdrive_kinematics.core.models import unicycle
    >>> x, y, theta = transition_euler(
    ...     unicycle(), (0.0, 0.0, 0.0), (1.0, math.pi), 1.0, steps=2)
    >>> round(x, 9), round(y, 9)
    (0.5, 0.5)

    """
    return _stepped(euler, system, state, command, duration, steps)


def transition_runge_kutta(
        system: ControlSystem, state: Vector, command: Vector, duration: float, *,
        steps: int) -> Vector:
    """
    Return the state after a held command by ``steps`` Runge-Kutta steps (LaValle 2.20).

    Parameters
    ----------
    system : ControlSystem
        What moves.
    state : tuple of float or numpy.ndarray
        State x, in the order of ``states``.
    command : tuple of float or numpy.ndarray
        Command u, in the order of ``commands``.
    duration : float
        For how long [s] the command is held; below 0: where it came from.
    steps : int
        Number of steps of equal length.

    Returns
    -------
    tuple of float or numpy.ndarray
        State x after that time.

    Raises
    ------
    ValueError
        If the duration is not finite or ``steps`` no integer, 1 or above.

    Examples
    --------
    >>> from diffdrive_kinematics.core.models import unicycle
    >>> x, y, theta = transition_runge_kutta(
    ...     unicycle(), (0.0, 0.0, 0.0), (1.0, math.pi), 1.0, steps=100)
    >>> abs(y - 2.0 / math.pi) < 1e-8
    True

    """
    return _stepped(runge_kutta, system, state, command, duration, steps)


def _stepped(
        method: Callable[..., Vector], system: ControlSystem, state: Vector, command: Vector,
        duration: float, steps: int) -> Vector:
    for _ in range(check_count('steps', steps)):
        state = system.within(method(
            state, lambda at, _: system.rate(at, command), start=0.0, duration=duration / steps,
            steps=1))
    return state


def sample_paths(
        system: ControlSystem, start: Vector, steps: Sequence[Step], disturbance: Disturbance, *,
        n: int, generator: 'np.random.Generator') -> Tuple[Array, ...]:
    """
    Return n sample paths: the forward projection over one and many steps (2.35, 2.39).

    Row 1 of each array is the one-step projection of ``start``, row k that of k steps.  For the
    differential drive with slip, :func:`diffdrive_kinematics.core.noise.sample_paths` is
    the fast one.

    Parameters
    ----------
    system : ControlSystem
        What moves.
    start : tuple
        State of all paths (floats), or of each (arrays, shape (n,)).
    steps : sequence of (command, duration)
        The k commands, and for how long [s] each is held.
    disturbance : Disturbance
        Of the commands, drawn anew for each step.
    n : int
        Number of paths.
    generator : numpy.random.Generator
        Source of randomness.

    Returns
    -------
    tuple of arrays, shape (k + 1, n)
        One for each state.

    Raises
    ------
    ValueError
        If ``n`` is no integer, 1 or above, or the disturbance has not one number for each
        command.

    Examples
    --------
    >>> from diffdrive_kinematics.core.models import bounded, unicycle
    >>> x, y, theta = sample_paths(
    ...     unicycle(), (0.0, 0.0, 0.0), [((1.0, 0.1), 0.5)] * 4, bounded([0.1, 0.0]), n=50,
    ...     generator=np.random.default_rng(1))
    >>> x.shape, bool(abs(theta[-1] - 0.2).max() < 1e-12)
    ((5, 50), True)

    """
    check_count('n', n)
    state: Vector = tuple(np.array(np.broadcast_to(value, (n,)), np.float64) for value in start)
    path: List[Sequence[Scalar]] = [state]
    for command, duration in steps:
        state = transition(
            system, state, disturbed(command, disturbance, n=n, generator=generator), duration)
        path.append(state)
    return tuple(np.stack(np.broadcast_arrays(*column)) for column in zip(*path))
