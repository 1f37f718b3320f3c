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
The rolling robots of the texts: each is a box of commands and the twist that they make.

``s`` is the speed of the middle of the rear axle, where the pose is; with front drive it is that
of the front wheel.  ``phi`` is the steering angle, positive to the left.  ``l`` is the distance
from the rear axle to the front one, ``L`` that between the wheels of an axle.
"""

import math

from diffdrive_kinematics.core.kinematics import (
    check_length, pose_change_from_travel, twist_from_wheel_rates, WheelGeometry)
from diffdrive_kinematics.core.models.quantities import both_ways, function_of, steering_bound
from diffdrive_kinematics.core.models.rolling import Rolling

STEEPEST = math.radians(89.0)
"""Largest steering angle of a robot that is driven from the rear: at 90 degrees it skids."""


def unicycle(*, max_speed: float = math.inf, max_yaw_rate: float = math.inf) -> Rolling:
    """
    Return the unicycle, told its twist: ``v = s``, ``w = w`` (LaValle 2.18).

    Parameters
    ----------
    max_speed : float
        Bound of the speed [m/s], either way.
    max_yaw_rate : float
        Bound of the yaw rate [rad/s], either way.

    Returns
    -------
    Rolling
        The robot.

    Raises
    ------
    ValueError
        If a bound is not above 0.

    Examples
    --------
    >>> unicycle(max_speed=1.0).commands[0]
    Quantity(name='s', unit='m/s', low=-1.0, high=1.0)

    """
    return Rolling(
        (both_ways('s', 'm/s', max_speed), both_ways('w', 'rad/s', max_yaw_rate)),
        lambda u: (u[0], u[1]))


def differential_drive(geometry: WheelGeometry, *, max_wheel_rate: float = math.inf) -> Rolling:
    """
    Return the differential drive (u_l, u_r), told its wheel rates (LaValle 2.22).

    ``v = R (u_l + u_r) / 2``, ``w = R (u_r - u_l) / L``.

    Parameters
    ----------
    geometry : WheelGeometry
        Size and distance of the wheels.
    max_wheel_rate : float
        Bound of both rates [rad/s], either way.

    Returns
    -------
    Rolling
        The robot.

    Raises
    ------
    ValueError
        If the bound is not above 0.

    Examples
    --------
    >>> robot = differential_drive(WheelGeometry(0.2, 0.05))
    >>> robot.twist((2.0, 2.0))
    (0.1, 0.0)

    """
    return Rolling(
        (both_ways('u_l', 'rad/s', max_wheel_rate), both_ways('u_r', 'rad/s', max_wheel_rate)),
        lambda u: twist_from_wheel_rates(geometry, *u))  # type: ignore[type-var]


def tricycle(
        *, wheel_base: float, max_steering: float = STEEPEST, max_speed: float = math.inf
) -> Rolling:
    """
    Return the tricycle with rear drive (s, phi): ``v = s``, ``w = s tan(phi) / l`` (2.19).

    The bicycle, and the car whose front axle turns as one, move alike: see :func:`bicycle` and
    :func:`car`.

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
        If the wheel base is no length, or the bound of phi not between 0 and pi / 2.

    Examples
    --------
    >>> v, w = tricycle(wheel_base=2.0).twist((1.0, math.pi / 4))
    >>> round(v / w, 9)
    2.0

    """
    check_length('wheel_base', wheel_base)
    steering = both_ways('phi', 'rad', steering_bound(max_steering))
    return Rolling((both_ways('s', 'm/s', max_speed), steering),
                   lambda u: (u[0], u[0] * function_of('tan', u[1]) / wheel_base))


bicycle = tricycle
"""The bicycle with rear drive: the tricycle with its rear wheels in one place (2.19)."""


def front_drive_tricycle(
        *, wheel_base: float, max_steering: float = 0.5 * math.pi, max_speed: float = math.inf
) -> Rolling:
    """
    Return the tricycle, or bicycle, with front drive (s_w, phi).

    ``v = s_w cos(phi)``, ``w = s_w sin(phi) / l``: the distances from the turning centre give
    d_s = d_w r_c / r_w (LaValle, sec. 2.2.1).  At phi = pi / 2 it turns in place.

    Parameters
    ----------
    wheel_base : float
        Distance l [m] of the axles.
    max_steering : float
        Bound of phi [rad], either way.
    max_speed : float
        Bound of the speed of the front wheel [m/s], either way.

    Returns
    -------
    Rolling
        The robot.

    Raises
    ------
    ValueError
        If the wheel base is no length.

    Examples
    --------
    >>> v, w = front_drive_tricycle(wheel_base=0.5).twist((1.0, math.pi / 2))
    >>> abs(v) < 1e-15, w
    (True, 2.0)

    """
    check_length('wheel_base', wheel_base)
    return Rolling(
        (both_ways('s_w', 'm/s', max_speed), both_ways('phi', 'rad', max_steering)),
        lambda u: (u[0] * function_of('cos', u[1]), u[0] * function_of('sin', u[1]) / wheel_base))


def rear_wheels_tricycle(*, track: float, max_speed: float = math.inf) -> Rolling:
    """
    Return the tricycle with two driven rear wheels (v_l, v_r), told by their speeds.

    ``v = (v_l + v_r) / 2``, ``w = (v_r - v_l) / L``.  Its front wheel only follows, turned by
    ``atan2(w l, v)``.

    Parameters
    ----------
    track : float
        Distance L [m] of the wheels of an axle.
    max_speed : float
        Bound of the speed of both wheels [m/s], either way.

    Returns
    -------
    Rolling
        The robot.

    Raises
    ------
    ValueError
        If the track L is no length.

    Examples
    --------
    >>> rear_wheels_tricycle(track=0.5).twist((1.0, 2.0))
    (1.5, 2.0)

    """
    geometry = WheelGeometry(check_length('track', track), 1.0)
    return Rolling(
        (both_ways('v_l', 'm/s', max_speed), both_ways('v_r', 'm/s', max_speed)),
        lambda u: pose_change_from_travel(geometry, *u))  # type: ignore[type-var]
