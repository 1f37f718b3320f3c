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

"""Cars: their front wheels turn as one with the axle, or each as its circle wants (Ackermann)."""

import math
from typing import Tuple

from diffdrive_kinematics.core.kinematics import check_length, Scalar
from diffdrive_kinematics.core.models.quantities import both_ways, function_of, steering_bound
from diffdrive_kinematics.core.models.robots import tricycle
from diffdrive_kinematics.core.models.rolling import Rolling
from diffdrive_kinematics.core.models.system import Vector


def car(*, wheel_base: float, max_steering: float, max_speed: float = math.inf) -> Rolling:
    """
    Return the car whose front axle turns as one by a bounded phi, as a wagon's: a tricycle.

    Parameters
    ----------
    wheel_base : float
        Distance l [m] of the axles.
    max_steering : float
        Bound of phi [rad], either way, below pi / 2.
    max_speed : float
        Bound of the speed [m/s], either way.

    Returns
    -------
    Rolling
        The robot.

    Raises
    ------
    ValueError
        As :func:`tricycle`.

    Examples
    --------
    >>> car(wheel_base=2.5, max_steering=0.6).commands[1]
    Quantity(name='phi', unit='rad', low=-0.6, high=0.6)

    """
    return tricycle(wheel_base=wheel_base, max_steering=max_steering, max_speed=max_speed)


def ackermann_car(
        *, wheel_base: float, track: float, max_steering: float, max_speed: float = math.inf
) -> Rolling:
    """
    Return the car with Ackermann steering (s, phi), phi the angle of the inner front wheel.

    The inner wheel is the one that turns more, and comes to its stop first:
    ``(r_c - L/2) tan(phi) = l``, so that ``w / v = tan(phi) / (l + L/2 |tan(phi)|)`` (LaValle 2.8
    and 2.9, put right).

    Parameters
    ----------
    wheel_base : float
        Distance l [m] of the axles.
    track : float
        Distance L [m] of the wheels of an axle.
    max_steering : float
        Bound of phi [rad], either way, below pi / 2.
    max_speed : float
        Bound of the speed [m/s], either way.

    Returns
    -------
    Rolling
        The robot.

    Raises
    ------
    ValueError
        If a length is none, or the bound of phi not between 0 and pi / 2.

    Examples
    --------
    >>> v, w = ackermann_car(wheel_base=2.0, track=1.0, max_steering=1.0).twist(
    ...     (1.0, math.pi / 4))
    >>> round(v / w, 9)
    2.5

    """
    check_length('wheel_base', wheel_base)
    half = 0.5 * check_length('track', track)
    steering = both_ways('phi', 'rad', steering_bound(max_steering))

    def twist(command: Vector) -> Tuple[Scalar, Scalar]:
        slope = function_of('tan', command[1])
        return command[0], command[0] * slope / (wheel_base + half * function_of('fabs', slope))

    return Rolling((both_ways('s', 'm/s', max_speed), steering), twist)


def front_wheel_angles(
        *, wheel_base: float, track: float, curvature: float) -> Tuple[float, float]:
    """
    Return the angles (left, right) [rad] of a car's front wheels that roll on one circle.

    ``(r_c -+ L/2) tan(phi) = l`` with r_c = 1 / curvature (LaValle 2.8 and 2.9, put right).

    Parameters
    ----------
    wheel_base : float
        Distance l [m] of the axles.
    track : float
        Distance L [m] of the wheels of an axle.
    curvature : float
        Of the path of the middle of the rear axle [1/m], positive to the left.

    Returns
    -------
    left : float
        Angle of the left front wheel [rad].
    right : float
        Angle of the right front wheel [rad].

    Raises
    ------
    ValueError
        If a length is none, or the turning centre lies between the rear wheels.

    Examples
    --------
    >>> left, right = front_wheel_angles(wheel_base=2.0, track=1.0, curvature=0.4)
    >>> round(left, 9) == round(math.pi / 4, 9), round(math.tan(right), 9)
    (True, 0.666666667)

    """
    check_length('wheel_base', wheel_base)
    half = 0.5 * check_length('track', track) * curvature
    if not abs(half) < 1.0:
        raise ValueError(
            f'curvature is {curvature!r}, expected below {2.0 / track!r} either way, where the '
            'turning centre is beside the car')
    slope = wheel_base * curvature
    return math.atan2(slope, 1.0 - half), math.atan2(slope, 1.0 + half)


def least_turning_radius(*, wheel_base: float, max_steering: float, track: float = 0.0) -> float:
    """
    Return the least radius [m] of the circle of the middle of the rear axle.

    ``l / tan(phi) + L/2``: L is that of Ackermann steering, whose phi is that of the inner wheel,
    and 0 where one wheel or the axle is steered.

    Parameters
    ----------
    wheel_base : float
        Distance l [m] of the axles.
    max_steering : float
        Bound of phi [rad], either way, below pi / 2.
    track : float
        Distance L [m] of the wheels of an axle, 0 where one wheel or the axle is steered.

    Returns
    -------
    float
        Radius [m].

    Raises
    ------
    ValueError
        If a length is none, or the bound of phi not between 0 and pi / 2.

    Examples
    --------
    >>> round(least_turning_radius(wheel_base=2.0, track=1.0, max_steering=math.pi / 4), 9)
    2.5

    """
    check_length('wheel_base', wheel_base)
    if track:
        check_length('track', track)
    return wheel_base / math.tan(steering_bound(max_steering)) + 0.5 * track
