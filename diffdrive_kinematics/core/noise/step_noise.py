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

"""Mean of one step of wheel travel, and the standard deviations of its errors."""

from typing import NamedTuple, Optional, Tuple

from diffdrive_kinematics.core.kinematics import Command, Scalar, WheelGeometry
from diffdrive_kinematics.core.noise.body_slip import (
    body_noise, BodyNoise, BodySlip, NO_BODY_SLIP, root)
from diffdrive_kinematics.core.noise.noise import travel_variance, WheelSlip


class StepNoise(NamedTuple):
    """
    The mean of one step and the standard deviations of its errors; floats, or one per pose.

    Parameters
    ----------
    half_turn : float or numpy.ndarray
        Half the turn of the step, h [rad].
    distance : float or numpy.ndarray
        Travel of the centre [m].
    left, right : float or numpy.ndarray
        What the slip of either wheel adds to the half turn [rad]: sigma / (2 L).
    lateral_left, lateral_right : float or numpy.ndarray
        What it adds to the lateral displacement [m].
    body : BodyNoise or None
        What the slip of the body adds; None: there is none.

    Examples
    --------
    >>> noise = step_noise(0.25, 0.5, WheelGeometry(0.5, 0.125), WheelSlip(), WheelSlip())
    >>> noise.half_turn, noise.distance, noise.left
    (0.25, 0.375, 0.0)

    """

    half_turn: Scalar
    distance: Scalar
    left: Scalar
    right: Scalar
    lateral_left: Scalar
    lateral_right: Scalar
    body: Optional[BodyNoise] = None


def lateral_variances(
        d_left: Scalar, d_right: Scalar, geometry: WheelGeometry, left_slip: WheelSlip,
        right_slip: WheelSlip) -> Tuple[Scalar, Scalar]:
    """
    Return the variance of the lateral displacement that the slip of either wheel makes.

    ``q_l d_r^2 / (12 L^2)`` and ``q_r d_l^2 / (12 L^2)``: the error of a wheel turns the robot
    about the other wheel.  q is that of the nominal travel, d the biased one.

    Parameters
    ----------
    d_left, d_right : float or numpy.ndarray
        Nominal travel [m] of the wheels in one step.
    geometry : WheelGeometry
        Distance of the wheels.
    left_slip, right_slip : WheelSlip
        Bias and slip of the wheels.

    Returns
    -------
    left : float or numpy.ndarray
        From the slip of the left wheel [m^2]; zero for the law ``command``.
    right : float or numpy.ndarray
        From the slip of the right wheel [m^2], likewise.

    Examples
    --------
    >>> slip = WheelSlip(variance=1e-4)
    >>> left, right = lateral_variances(1.0, 1.0, WheelGeometry(0.5, 0.125), slip, slip)
    >>> f'{left + right:.2e}'  # a quarter of Var y after a straight metre
    '6.67e-05'

    """
    scale = 1.0 / (12.0 * geometry.separation**2)
    left, right = (1.0 + left_slip.bias) * d_left, (1.0 + right_slip.bias) * d_right
    return (scale * _gathered(left_slip, d_left) * right * right,
            scale * _gathered(right_slip, d_right) * left * left)


def step_noise(
        d_left: Scalar, d_right: Scalar, geometry: WheelGeometry, left_slip: WheelSlip,
        right_slip: WheelSlip, body: BodySlip = NO_BODY_SLIP) -> StepNoise:
    """
    Return mean and standard deviations of one step of wheel travel.

    Parameters
    ----------
    d_left, d_right : float or numpy.ndarray
        Nominal travel [m] of the wheels.
    geometry : WheelGeometry
        Distance of the wheels.
    left_slip, right_slip : WheelSlip
        Bias and slip of the wheels.
    body : BodySlip
        What slips beside the wheels.

    Returns
    -------
    StepNoise
        The mean has the bias in it.

    Examples
    --------
    >>> slip = WheelSlip(variance=1e-4)
    >>> f'{step_noise(1.0, 1.0, WheelGeometry(0.5, 0.125), slip, slip).left:.3f} rad'
    '0.010 rad'

    """
    left, right = (1.0 + left_slip.bias) * d_left, (1.0 + right_slip.bias) * d_right
    double = 2.0 * geometry.separation
    lateral = lateral_variances(d_left, d_right, geometry, left_slip, right_slip)
    half_turn, distance = (right - left) / double, 0.5 * (left + right)
    return StepNoise(
        half_turn, distance,
        root(travel_variance(left_slip, d_left)) / double,
        root(travel_variance(right_slip, d_right)) / double,
        root(lateral[0]), root(lateral[1]),
        body_noise(body, distance, 2.0 * half_turn) if body else None)


def travel_of_command(command: Command, geometry: WheelGeometry) -> Tuple[float, float]:
    """
    Return the nominal travel of the wheels under a command.

    Parameters
    ----------
    command : Command
        Twist and duration.
    geometry : WheelGeometry
        Distance of the wheels.

    Returns
    -------
    d_left : float
        Travel of the left wheel [m].
    d_right : float
        Travel of the right wheel [m].

    Examples
    --------
    >>> travel_of_command(Command(0.375, 0.5, 2.0), WheelGeometry(0.5, 0.125))
    (0.5, 1.0)

    """
    half = 0.5 * geometry.separation * command.w
    return (command.v - half) * command.duration, (command.v + half) * command.duration


def _gathered(slip: WheelSlip, travel: Scalar) -> Scalar:
    return travel_variance(slip, travel) if slip.model == 'travel' else 0.0 * travel
