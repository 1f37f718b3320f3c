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
from typing import Tuple

from diffdrive_kinematics.core.arc import Scalar
from diffdrive_kinematics.core.checks import check_length
from diffdrive_kinematics.core.geometry import (
    pose_change_from_travel, twist_from_wheel_rates, WheelGeometry)
from diffdrive_kinematics.core.models.system import Quantity, Rolling, Vector
import numpy as np

__all__ = [
    'ackermann_car', 'bicycle', 'car', 'differential_drive', 'front_drive_tricycle',
    'front_wheel_angles', 'least_turning_radius', 'rear_wheels_tricycle', 'tricycle', 'unicycle']

STEEPEST = math.radians(89.0)
"""Largest steering angle of a robot that is driven from the rear: at 90 degrees it skids."""


def unicycle(*, max_speed: float = math.inf, max_yaw_rate: float = math.inf) -> Rolling:
    """
    Return the unicycle, told its twist: ``v = s``, ``w = w`` (LaValle 2.18).

    Examples
    --------
    >>> unicycle(max_speed=1.0).commands[0]
    Quantity(name='s', unit='m/s', low=-1.0, high=1.0)

    """
    return Rolling(
        (_both_ways('s', 'm/s', max_speed), _both_ways('w', 'rad/s', max_yaw_rate)),
        lambda u: (u[0], u[1]))


def differential_drive(geometry: WheelGeometry, *, max_wheel_rate: float = math.inf) -> Rolling:
    """
    Return the differential drive (u_l, u_r), told its wheel rates (LaValle 2.22).

    ``v = R (u_l + u_r) / 2``, ``w = R (u_r - u_l) / L``.

    Examples
    --------
    >>> robot = differential_drive(WheelGeometry(0.2, 0.05))
    >>> robot.twist((2.0, 2.0))
    (0.1, 0.0)

    """
    return Rolling(
        (_both_ways('u_l', 'rad/s', max_wheel_rate), _both_ways('u_r', 'rad/s', max_wheel_rate)),
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
        l [m].
    max_steering : float
        Bound of phi [rad], below pi / 2: there the front wheel would skid.
    max_speed : float
        Bound of s [m/s].

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
    steering = _both_ways('phi', 'rad', _steering(max_steering))
    return Rolling((_both_ways('s', 'm/s', max_speed), steering),
                   lambda u: (u[0], u[0] * _of('tan', u[1]) / wheel_base))


bicycle = tricycle
"""The bicycle with rear drive: the tricycle with its rear wheels in one place (2.19)."""


def car(*, wheel_base: float, max_steering: float, max_speed: float = math.inf) -> Rolling:
    """
    Return the car whose front axle turns as one by a bounded phi, as a wagon's: a tricycle.

    Examples
    --------
    >>> car(wheel_base=2.5, max_steering=0.6).commands[1]
    Quantity(name='phi', unit='rad', low=-0.6, high=0.6)

    """
    return tricycle(wheel_base=wheel_base, max_steering=max_steering, max_speed=max_speed)


def front_drive_tricycle(
        *, wheel_base: float, max_steering: float = 0.5 * math.pi, max_speed: float = math.inf
) -> Rolling:
    """
    Return the tricycle, or bicycle, with front drive (s_w, phi).

    ``v = s_w cos(phi)``, ``w = s_w sin(phi) / l``: the distances from the turning centre give
    d_s = d_w r_c / r_w (LaValle, sec. 2.2.1).  At phi = pi / 2 it turns in place.

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
        (_both_ways('s_w', 'm/s', max_speed), _both_ways('phi', 'rad', max_steering)),
        lambda u: (u[0] * _of('cos', u[1]), u[0] * _of('sin', u[1]) / wheel_base))


def rear_wheels_tricycle(*, track: float, max_speed: float = math.inf) -> Rolling:
    """
    Return the tricycle with two driven rear wheels (v_l, v_r), told by their speeds.

    ``v = (v_l + v_r) / 2``, ``w = (v_r - v_l) / L``.  Its front wheel only follows, turned by
    ``atan2(w l, v)``.

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
        (_both_ways('v_l', 'm/s', max_speed), _both_ways('v_r', 'm/s', max_speed)),
        lambda u: pose_change_from_travel(geometry, *u))  # type: ignore[type-var]


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
    wheel_base, track : float
        l and L [m].
    max_steering : float
        Bound of phi [rad], below pi / 2.
    max_speed : float
        Bound of s [m/s].

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
    steering = _both_ways('phi', 'rad', _steering(max_steering))

    def twist(command: Vector) -> Tuple[Scalar, Scalar]:
        slope = _of('tan', command[1])
        return command[0], command[0] * slope / (wheel_base + half * _of('fabs', slope))

    return Rolling((_both_ways('s', 'm/s', max_speed), steering), twist)


def front_wheel_angles(
        *, wheel_base: float, track: float, curvature: float) -> Tuple[float, float]:
    """
    Return the angles (left, right) [rad] of a car's front wheels that roll on one circle.

    ``(r_c -+ L/2) tan(phi) = l`` with r_c = 1 / curvature (LaValle 2.8 and 2.9, put right).

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


def least_turning_radius(
        *, wheel_base: float, max_steering: float, track: float = 0.0) -> float:
    """
    Return the least radius [m] of the circle of the middle of the rear axle.

    ``l / tan(phi) + L/2``: L is that of Ackermann steering, whose phi is that of the inner wheel,
    and 0 where one wheel or the axle is steered.

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
    return wheel_base / math.tan(_steering(max_steering)) + 0.5 * track


def _both_ways(name: str, unit: str, bound: float) -> Quantity:
    if not bound > 0.0:
        raise ValueError(f'the bound of {name} is {bound!r} {unit}, expected above 0')
    return Quantity(name, unit, -bound, bound)


def _of(function: str, angle: Scalar) -> Scalar:
    """Return tan, sin, cos or fabs of a float as a float, of an array as an array."""
    value: Scalar = getattr(np if isinstance(angle, np.ndarray) else math, function)(angle)
    return value


def _steering(bound: float) -> float:
    if not 0.0 < bound < 0.5 * math.pi:
        raise ValueError(f'max_steering is {bound!r} rad, expected between 0 and pi / 2')
    return bound
