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
from typing import Tuple, TypeVar

from diffdrive_kinematics.core.kinematics.checks import check_positive
from diffdrive_kinematics.core.kinematics.ranges import check_length
import numpy as np
from numpy.typing import NDArray

Number = TypeVar('Number', float, NDArray[np.float64])


@dataclass(frozen=True)
class WheelGeometry:
    """
    Size and spacing of the wheels, with ros2_controllers' correction factors.

    Parameters
    ----------
    wheel_separation : float
        Nominal distance between the contact points of the wheels [m].
    wheel_radius : float
        Nominal radius of the wheels [m].
    wheel_separation_multiplier : float
        Calibrated separation over the nominal one [1].
    left_wheel_radius_multiplier : float
        Calibrated radius of the left wheel over the nominal one [1].
    right_wheel_radius_multiplier : float
        Calibrated radius of the right wheel over the nominal one [1].

    Raises
    ------
    ValueError
        If a value is not a finite positive number, or its product with its multiplier is not
        from 1e-6 to 1e6 m.

    Examples
    --------
    >>> geometry = WheelGeometry(
    ...     wheel_separation=0.5, wheel_radius=0.125, wheel_separation_multiplier=1.5)
    >>> geometry.separation, geometry.left_radius
    (0.75, 0.125)

    """

    wheel_separation: float
    wheel_radius: float
    wheel_separation_multiplier: float = 1.0
    left_wheel_radius_multiplier: float = 1.0
    right_wheel_radius_multiplier: float = 1.0

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            check_positive(name, value)
        check_length('wheel_separation * wheel_separation_multiplier', self.separation)
        check_length('wheel_radius * left_wheel_radius_multiplier', self.left_radius)
        check_length('wheel_radius * right_wheel_radius_multiplier', self.right_radius)

    @cached_property
    def separation(self) -> float:
        """Effective wheel separation L [m]."""
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
    Return the twist that wheel rates make (forward kinematics).

    ``v = (R_r u_r + R_l u_l) / 2``, ``w = (R_r u_r - R_l u_l) / L``
    (Siegwart & Nourbakhsh, sec. 3.2.2; LaValle, Planning Algorithms, eq. 13.16).

    Parameters
    ----------
    geometry : WheelGeometry
        Size and spacing of the wheels.
    left, right : float or numpy.ndarray
        Wheel rates u_l and u_r [rad/s], positive = forward.

    Returns
    -------
    v : float or numpy.ndarray
        Forward speed [m/s].
    w : float or numpy.ndarray
        Yaw rate [rad/s], counter-clockwise positive.

    Examples
    --------
    >>> twist_from_wheel_rates(WheelGeometry(0.5, 0.125), left=2.0, right=4.0)
    (0.375, 0.5)

    """
    v_left = geometry.left_radius * left
    v_right = geometry.right_radius * right
    return 0.5 * (v_left + v_right), (v_right - v_left) / geometry.separation


def wheel_rates_from_twist(geometry: WheelGeometry, v: Number, w: Number) -> Tuple[Number, Number]:
    """
    Return the wheel rates that make a twist (inverse kinematics).

    ``u_r = (v + w L/2) / R_r``, ``u_l = (v - w L/2) / R_l``: the inverse of
    :func:`twist_from_wheel_rates`.

    Parameters
    ----------
    geometry : WheelGeometry
        Size and spacing of the wheels.
    v : float or numpy.ndarray
        Forward speed [m/s].
    w : float or numpy.ndarray
        Yaw rate [rad/s], counter-clockwise positive.

    Returns
    -------
    left : float or numpy.ndarray
        Wheel rate u_l [rad/s], positive = forward.
    right : float or numpy.ndarray
        Wheel rate u_r [rad/s].

    Examples
    --------
    >>> wheel_rates_from_twist(WheelGeometry(0.5, 0.125), v=0.375, w=0.5)
    (2.0, 4.0)

    """
    half = 0.5 * geometry.separation * w
    return (v - half) / geometry.left_radius, (v + half) / geometry.right_radius


def travel_from_angles(
        geometry: WheelGeometry, left: Number, right: Number) -> Tuple[Number, Number]:
    """
    Return the travel of wheels that have rolled by angles: ``d_i = R_i * angle``.

    Parameters
    ----------
    geometry : WheelGeometry
        Size and spacing of the wheels.
    left, right : float or numpy.ndarray
        Angles rolled [rad].

    Returns
    -------
    d_left : float or numpy.ndarray
        Travel d_l of the left wheel [m].
    d_right : float or numpy.ndarray
        Travel d_r of the right wheel [m].

    Examples
    --------
    >>> travel_from_angles(WheelGeometry(0.5, 0.125), left=2.0, right=4.0)
    (0.25, 0.5)

    """
    return geometry.left_radius * left, geometry.right_radius * right


def pose_change_from_travel(
        geometry: WheelGeometry, d_left: Number, d_right: Number) -> Tuple[Number, Number]:
    """
    Return how far the robot's centre moves and how far it turns, for :func:`.advance`.

    ``distance = (d_l + d_r) / 2``, ``turn = (d_r - d_l) / L``.

    Parameters
    ----------
    geometry : WheelGeometry
        Size and spacing of the wheels.
    d_left, d_right : float or numpy.ndarray
        Wheel travel [m].

    Returns
    -------
    distance : float or numpy.ndarray
        Length of the arc of the centre between the wheels [m].
    turn : float or numpy.ndarray
        Change of the heading [rad].

    Examples
    --------
    >>> pose_change_from_travel(WheelGeometry(0.5, 0.125), d_left=0.25, d_right=0.5)
    (0.375, 0.5)

    """
    return 0.5 * (d_left + d_right), (d_right - d_left) / geometry.separation
