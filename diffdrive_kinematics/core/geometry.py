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
Wheel geometry: what relates wheel rates to the robot's twist, and wheel angles to travel.

====================  =======  ==============================================================
symbol                unit     meaning
====================  =======  ==============================================================
``L``                 m        effective wheel separation
``R_l``, ``R_r``      m        effective wheel radii
``u_l``, ``u_r``      rad/s    wheel rates, positive = forward
``v``, ``w``          m/s, rad/s   forward speed and yaw rate, counter-clockwise positive
``d_l``, ``d_r``      m        wheel travel, ``d_i = R_i * angle``
====================  =======  ==============================================================

The functions are plain arithmetic: floats and numpy arrays (any shapes that broadcast) alike.
"""

from dataclasses import dataclass
from functools import cached_property
import math
from typing import Tuple, TypeVar

from diffdrive_kinematics.core.arc import Pose
from diffdrive_kinematics.core.checks import check_finite, check_length, check_positive
import numpy as np
from numpy.typing import NDArray

__all__ = [
    'WheelGeometry', 'inverse_jacobian', 'jacobian', 'pose_change_from_travel',
    'travel_from_angles', 'turning_centre', 'turning_radius', 'twist_from_wheel_rates',
    'wheel_rates_from_twist']

Number = TypeVar('Number', float, NDArray[np.float64])


@dataclass(frozen=True)
class WheelGeometry:
    """
    Size and spacing of the wheels, with ros2_controllers' correction factors.

    Parameters
    ----------
    wheel_separation, wheel_radius : float
        Nominal distance between the wheels' contact points and nominal radius [m].
    wheel_separation_multiplier, left_wheel_radius_multiplier, right_wheel_radius_multiplier : float
        Calibrated effective value over nominal value.

    Raises
    ------
    ValueError
        If a value is not a finite positive number, or its product with its multiplier is not
        from 1e-6 to 1e6 m.

    """  # noqa: E501

    wheel_separation: float
    wheel_radius: float
    wheel_separation_multiplier: float = 1.0
    left_wheel_radius_multiplier: float = 1.0
    right_wheel_radius_multiplier: float = 1.0

    def __post_init__(self) -> None:
        for name in (
                'wheel_separation', 'wheel_radius', 'wheel_separation_multiplier',
                'left_wheel_radius_multiplier', 'right_wheel_radius_multiplier'):
            check_positive(name, getattr(self, name))
        check_length('wheel_separation * wheel_separation_multiplier', self.separation)
        check_length('wheel_radius * left_wheel_radius_multiplier', self.left_radius)
        check_length('wheel_radius * right_wheel_radius_multiplier', self.right_radius)

    @cached_property
    def separation(self) -> float:
        """Return effective wheel separation L [m]."""
        return self.wheel_separation * self.wheel_separation_multiplier

    @cached_property
    def left_radius(self) -> float:
        """Effective radius R_l of the left wheel [m]."""
        return self.wheel_radius * self.left_wheel_radius_multiplier

    @cached_property
    def right_radius(self) -> float:
        """Effective radius R_r of the right wheel [m]."""
        return self.wheel_radius * self.right_wheel_radius_multiplier


def twist_from_wheel_rates(
        geometry: WheelGeometry, left: Number, right: Number) -> Tuple[Number, Number]:
    """
    Return the twist (v [m/s], w [rad/s]) of the wheel rates [rad/s] (forward kinematics).

    ``v = (R_r u_r + R_l u_l) / 2``, ``w = (R_r u_r - R_l u_l) / L``
    (Siegwart & Nourbakhsh, sec. 3.2.2; LaValle, Planning Algorithms, eq. 13.16).
    """
    v_left = geometry.left_radius * left
    v_right = geometry.right_radius * right
    return 0.5 * (v_left + v_right), (v_right - v_left) / geometry.separation


def wheel_rates_from_twist(
        geometry: WheelGeometry, v: Number, w: Number) -> Tuple[Number, Number]:
    """
    Return the wheel rates (left, right) [rad/s] that make the twist (inverse kinematics).

    ``u_r = (v + w L/2) / R_r``, ``u_l = (v - w L/2) / R_l``.
    """
    half = 0.5 * geometry.separation * w
    return (v - half) / geometry.left_radius, (v + half) / geometry.right_radius


def jacobian(geometry: WheelGeometry) -> NDArray[np.float64]:
    """
    Return J, shape (2, 2), with ``[v, w] = J @ [u_l, u_r]``.

    With equal radii this is ``R [[1/2, 1/2], [-1/L, 1/L]]``.
    """
    left, right, separation = geometry.left_radius, geometry.right_radius, geometry.separation
    return np.array([[0.5 * left, 0.5 * right], [-left / separation, right / separation]])


def inverse_jacobian(geometry: WheelGeometry) -> NDArray[np.float64]:
    """Return the inverse of J, shape (2, 2), with ``[u_l, u_r] = J^-1 @ [v, w]``."""
    left, right, half = geometry.left_radius, geometry.right_radius, 0.5 * geometry.separation
    return np.array([[1.0 / left, -half / left], [1.0 / right, half / right]])


def travel_from_angles(
        geometry: WheelGeometry, left: Number, right: Number) -> Tuple[Number, Number]:
    """Return the wheel travel (d_l, d_r) [m] of angles rolled (left, right) [rad]."""
    return geometry.left_radius * left, geometry.right_radius * right


def pose_change_from_travel(
        geometry: WheelGeometry, d_left: Number, d_right: Number) -> Tuple[Number, Number]:
    """Return (distance of the centre [m], turn [rad]) of wheel travel [m]."""
    return 0.5 * (d_left + d_right), (d_right - d_left) / geometry.separation


def turning_radius(geometry: WheelGeometry, d_left: float, d_right: float) -> float:
    """
    Return the signed radius r_c [m] of the circle that the robot's centre follows.

    ``r_c = L (d_l + d_r) / (2 (d_r - d_l))`` (LaValle, Mobile Robotics, eq. 2.7), for travel
    [m] or, equally, wheel speeds [m/s].  Positive: the centre lies to the left.  Parallel travel
    gives ``inf``.

    Raises
    ------
    ValueError
        If a travel is not finite, or both are 0: a wheel pair at rest has no turning radius.

    """
    check_finite('d_left', d_left)
    check_finite('d_right', d_right)
    if d_left == d_right == 0.0:
        raise ValueError('d_left and d_right are 0, expected travel of at least one wheel')
    if d_left == d_right:
        return math.inf
    return geometry.separation * (0.5 * d_left + 0.5 * d_right) / (d_right - d_left)


def turning_centre(
        geometry: WheelGeometry, pose: Pose, d_left: float, d_right: float) -> Tuple[float, float]:
    """
    Return the point (x, y) [m] about which the robot turns, in the frame of ``pose``.

    It lies ``turning_radius`` to the left of the robot's centre, on the wheels' common axis
    (LaValle, Mobile Robotics, sec. 2.1).  Parallel travel gives infinite coordinates.

    Raises
    ------
    ValueError
        As :func:`turning_radius`.

    """
    radius = turning_radius(geometry, d_left, d_right)
    theta = float(pose.theta)
    sine, cosine = math.sin(theta), math.cos(theta)
    if math.isinf(radius):
        return -math.copysign(math.inf, sine), math.copysign(math.inf, cosine)
    return float(pose.x) - radius * sine, float(pose.y) + radius * cosine
