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
Numerical integration for commands that vary within the step, and for states of any size.

Where the twist is constant :func:`diffdrive_kinematics.core.kinematics.advance` is exact and
cheaper; these are for time-varying commands, for models that have no arcs, and to show what a step
of a peer costs in accuracy.
"""

from typing import Callable, Tuple

from diffdrive_kinematics.core.kinematics.checks import check_count, check_finite
from diffdrive_kinematics.core.kinematics.pose import Pose, pose_rate, Scalar

State = Tuple[Scalar, ...]
RateOfState = Callable[[State, float], State]
TwistOfTime = Callable[[float], Tuple[float, float]]


def euler(state: State, rate: RateOfState, *, start: float, duration: float, steps: int) -> State:
    """
    Return the state after a time, by Euler's method.

    ``x' = x + h f(x, t_k)``, sampled at the start of each step (LaValle, Mobile Robotics,
    eq. 2.17).  The error falls with the first power of the step h.

    Parameters
    ----------
    state : tuple of float or numpy.ndarray
        Where the motion begins.
    rate : callable
        ``rate(state, t)``: how fast each part of the state changes at a time [s].
    start : float
        Time at which the motion begins [s].
    duration : float
        How long it lasts [s].
    steps : int
        Number of steps, h = duration / steps.

    Returns
    -------
    tuple of float or numpy.ndarray
        Where the motion ends.

    Raises
    ------
    ValueError
        If ``steps`` is no integer, 1 or above, or a time is not finite.

    Examples
    --------
    Growth by itself, to e = 2.71828:

    >>> x, = euler((1.0,), lambda x, t: x, start=0.0, duration=1.0, steps=10)
    >>> f'{x:.5f}'
    '2.59374'

    """
    step = _check_step(start, duration, steps)
    for k in range(steps):
        state = _moved(state, rate(state, start + k * step), step)
    return state


def runge_kutta(
        state: State, rate: RateOfState, *, start: float, duration: float, steps: int) -> State:
    """
    Return the state after a time, by the 4th-order method of Runge and Kutta.

    ``x' = x + h/6 (w1 + 2 w2 + 2 w3 + w4)`` (LaValle, Mobile Robotics, eq. 2.20).  The error
    falls with the fourth power of the step h, for rates that are smooth within each step.

    Parameters
    ----------
    state : tuple of float or numpy.ndarray
        Where the motion begins.
    rate : callable
        ``rate(state, t)``: how fast each part of the state changes at a time [s].
    start : float
        Time at which the motion begins [s].
    duration : float
        How long it lasts [s].
    steps : int
        Number of steps, h = duration / steps.

    Returns
    -------
    tuple of float or numpy.ndarray
        Where the motion ends.

    Raises
    ------
    ValueError
        If ``steps`` is no integer, 1 or above, or a time is not finite.

    Examples
    --------
    Growth by itself, to e = 2.71828:

    >>> x, = runge_kutta((1.0,), lambda x, t: x, start=0.0, duration=1.0, steps=10)
    >>> f'{x:.5f}'
    '2.71828'

    """
    step = _check_step(start, duration, steps)
    for k in range(steps):
        time = start + k * step
        middle = time + 0.5 * step
        w1 = rate(state, time)
        w2 = rate(_moved(state, w1, 0.5 * step), middle)
        w3 = rate(_moved(state, w2, 0.5 * step), middle)
        w4 = rate(_moved(state, w3, step), time + step)
        mean = tuple((a + 2.0 * b + 2.0 * c + d) / 6.0 for a, b, c, d in zip(w1, w2, w3, w4))
        state = _moved(state, mean, step)
    return state


def integrate_euler(
        pose: Pose, twist: TwistOfTime, *, start: float, duration: float, steps: int) -> Pose:
    """
    Return the pose after a time-varying twist, by Euler's method.

    ``x' = x + h f(x, u(t_k))`` with the command sampled at the start of each step (LaValle,
    Mobile Robotics, eq. 2.17).  The error falls with the first power of the step h.

    Parameters
    ----------
    pose : Pose
        Where the motion begins.
    twist : callable
        ``twist(t) -> (v, w)``: speed [m/s] and yaw rate [rad/s] at a time [s].
    start : float
        Time at which the motion begins [s].
    duration : float
        How long it lasts [s].
    steps : int
        Number of steps, h = duration / steps.

    Returns
    -------
    Pose
        Where the motion ends.  The heading is not wrapped.

    Raises
    ------
    ValueError
        If ``steps`` is no integer, 1 or above, or a time is not finite.

    Examples
    --------
    On an arc of 1 rad and radius 1 m, which ends at x = sin 1 = 0.8415 m:

    >>> end = integrate_euler(
    ...     Pose(0.0, 0.0, 0.0), lambda t: (1.0, 1.0), start=0.0, duration=1.0, steps=10)
    >>> f'{end.x:.4f}'
    '0.8638'

    """
    return Pose(*euler(pose, _rate_under(twist), start=start, duration=duration, steps=steps))


def integrate_runge_kutta(
        pose: Pose, twist: TwistOfTime, *, start: float, duration: float, steps: int) -> Pose:
    """
    Return the pose after a time-varying twist, by the 4th-order method of Runge and Kutta.

    ``x' = x + h/6 (w1 + 2 w2 + 2 w3 + w4)`` (LaValle, Mobile Robotics, eq. 2.20).  The error
    falls with the fourth power of the step h, for commands that are smooth within each step.

    Parameters
    ----------
    pose : Pose
        Where the motion begins.
    twist : callable
        ``twist(t) -> (v, w)``: speed [m/s] and yaw rate [rad/s] at a time [s].
    start : float
        Time at which the motion begins [s].
    duration : float
        How long it lasts [s].
    steps : int
        Number of steps, h = duration / steps.

    Returns
    -------
    Pose
        Where the motion ends.  The heading is not wrapped.

    Raises
    ------
    ValueError
        If ``steps`` is no integer, 1 or above, or a time is not finite.

    Examples
    --------
    On an arc of 1 rad and radius 1 m, which ends at x = sin 1 = 0.8415 m:

    >>> end = integrate_runge_kutta(
    ...     Pose(0.0, 0.0, 0.0), lambda t: (1.0, 1.0), start=0.0, duration=1.0, steps=10)
    >>> f'{end.x:.4f}'
    '0.8415'

    """
    return Pose(*runge_kutta(
        pose, _rate_under(twist), start=start, duration=duration, steps=steps))


def _rate_under(twist: TwistOfTime) -> RateOfState:
    return lambda pose, time: pose_rate(Pose(*pose), *twist(time))


def _moved(state: State, rate: State, step: float) -> State:
    return tuple(value + step * change for value, change in zip(state, rate))


def _check_step(start: float, duration: float, steps: int) -> float:
    check_finite('start', start)
    check_finite('duration', duration)
    return duration / check_count('steps', steps)
