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
Ending an acceleration in time: on a grid of steps, within a limit of jerk, without overshoot.

In continuous time an acceleration a that falls at the rate j still adds ``a^2 / (2 j)`` to the
velocity, so it may grow until ``v + a^2 / (2 j)`` reaches the target.  On a grid the velocity
changes by c, c - f, c - 2 f, ... in the steps to come, where f is the jerk times the square of the
step, and the largest c whose sum still fits is a closed form as well.
"""

import math

LEAST_FALL = 1e-200  # keeps the number of steps, and its square, finite


def eased(
        target: float, *, current: float, before: float, dt: float, rise: float, fall: float,
        up: float, down: float) -> float:
    """
    Return the velocity a step after ``current`` on the way up to a higher ``target``.

    Acceleration away from the target has ended at once; towards it, it grows within ``rise``,
    and is never so large that it could not fall within ``fall`` until it ends at the target.
    A robot that is turned round brakes at ``down`` and then speeds up at ``up``; where that is
    less, the acceleration has fallen to it when the robot stands.

    Parameters
    ----------
    target, current, before : float
        Velocities asked for, now and a step ago [m/s or rad/s].
    dt : float
        The step [s].
    rise, fall : float
        Largest growth and fall of the acceleration per second [m/s^3 or rad/s^3]; infinite where
        not limited.
    up, down : float
        Largest acceleration while the velocity is positive and while it is negative [m/s^2 or
        rad/s^2].

    Returns
    -------
    float
        Velocity [m/s or rad/s], from ``current`` to ``target``.

    Examples
    --------
    >>> way = [0.0, 0.0]
    >>> while way[-1] < 2.0:
    ...     way.append(eased(2.0, current=way[-1], before=way[-2], dt=0.5, rise=2.0, fall=2.0,
    ...                      up=math.inf, down=math.inf))
    >>> way
    [0.0, 0.0, 0.5, 1.5, 2.0]

    """
    distance = target - current
    change = max(0.0, current - before) + rise * dt * dt
    if fall < math.inf:
        fall_a_step = max(fall * dt * dt, LEAST_FALL)
        change = min(change, largest_change(distance, fall_a_step))
        if current < 0.0 < target and up < down:
            change = min(change, largest_change(
                -current, fall_a_step, last=up * dt, share=1.0 - up / down))
    return target if change >= distance else min(current + change, target)


def largest_change(distance: float, fall: float, last: float = 0.0, share: float = 1.0) -> float:
    """
    Return the largest change of velocity in a step that can fall to ``last`` in time.

    It is the largest c for which ``c - k fall <= last + share * max(0, distance - s_k)`` for all
    k >= 0, with ``s_k`` the sum of the first k of the changes c, c - fall, c - 2 fall, ...  With
    ``last`` 0 and ``share`` 1: all of them together do not pass ``distance``.

    Parameters
    ----------
    distance : float
        How far off the velocity is at which the change has to have fallen [m/s or rad/s]; not
        negative.
    fall : float
        By how much a change may be less than the one before it [m/s or rad/s]; above 0.
    last : float
        The change that is allowed there [m/s or rad/s].
    share : float
        1 - last / (the change allowed before) [1]; a step that gets there with time to spare
        makes a change in between.

    Returns
    -------
    float
        Change c [m/s or rad/s].

    Examples
    --------
    >>> largest_change(1.5, fall=0.5)  # 1.0 + 0.5 = 1.5
    1.0

    """
    base = last + 0.5 * fall
    steps = float(math.floor(
        2.0 * distance / (math.sqrt(base * base + 2.0 * fall * distance) + base)))
    through = last + share * distance + steps * fall * (1.0 + 0.5 * share * (steps - 1.0))
    return min(through / (1.0 + share * steps), last + (steps + 1.0) * fall)
