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

"""What a drive needs to know: wheels, limits, timeout and rate."""

from dataclasses import dataclass
from functools import cached_property
import math
from typing import Optional

from diffdrive_kinematics.core.commands.command_response import CommandFor, CommandResponse
from diffdrive_kinematics.core.commands.limits import AxisLimits
from diffdrive_kinematics.core.commands.saturation import wheel_bound, WheelBound
from diffdrive_kinematics.core.commands.wheel_command import Twist
from diffdrive_kinematics.core.kinematics import (
    check_duration, check_rate, NANOSECONDS, WheelGeometry)

MOST_MADE_UP = 3.0
"""Speed that is asked for in a curve over the one that a straight takes, at most [1]."""


@dataclass(frozen=True)
class DriveSettings:
    """
    What a drive needs to know.

    Parameters
    ----------
    geometry : WheelGeometry
        Size and spacing of the wheels.
    linear, angular : AxisLimits
        Limits of v and of w.
    max_wheel_rate : float
        Bound of both wheel rates [rad/s]; NaN = none.
    cmd_vel_timeout : float
        Age [s] at which a command ends and the drive brakes; 0 = never.
    update_rate : float
        Rate [Hz] of the grid on which ramps step.
    response : CommandResponse, optional
        How the robot follows, to ask for what yields the motion wanted; None: ask for the motion.

    Raises
    ------
    ValueError
        If a value is out of its range.

    Examples
    --------
    >>> settings = DriveSettings(
    ...     WheelGeometry(0.5, 0.125), AxisLimits(max_acceleration=1.0), update_rate=50.0)
    >>> settings.ramps, settings.period_ns, settings.wheel_bound
    (True, 20000000, None)

    """

    geometry: WheelGeometry
    linear: AxisLimits = AxisLimits()
    angular: AxisLimits = AxisLimits()
    max_wheel_rate: float = math.nan
    cmd_vel_timeout: float = 0.5
    update_rate: float = 100.0
    response: Optional[CommandResponse] = None

    def __post_init__(self) -> None:
        check_duration('cmd_vel_timeout', self.cmd_vel_timeout)
        check_rate('update_rate', self.update_rate)
        if self.max_wheel_rate <= 0.0:
            raise ValueError(
                f'max_wheel_rate is {self.max_wheel_rate!r}, expected above 0, or NaN')

    def command_for(self, motion: Twist) -> CommandFor:
        """
        Return what to ask the robot for.

        Parameters
        ----------
        motion : Twist
            What it is to do.

        Returns
        -------
        CommandFor
            The motion itself, or by the response the command that yields it within the velocity
            limits, at most 3 times the speed that a straight takes.

        Examples
        --------
        >>> DriveSettings(WheelGeometry(0.5, 0.125)).command_for(Twist(0.5, 0.0))
        CommandFor(command=Twist(v=0.5, w=0.0), reached=True)

        """
        if self.response is None:
            return CommandFor(motion, True)
        within = Twist(self.linear.limit_velocity(motion.v), self.angular.limit_velocity(motion.w))
        command, reached = self.response.command_for(within, most=MOST_MADE_UP)
        return CommandFor(command, reached and within == motion)

    @cached_property
    def ramps(self) -> bool:
        """Whether a change of the twist takes more than one step."""
        return self.linear.ramps or self.angular.ramps

    @cached_property
    def wheel_bound(self) -> Optional[WheelBound]:
        """Return the twists that the wheels can do; None where ``max_wheel_rate`` is no bound."""
        bounded = math.isfinite(self.max_wheel_rate)
        return wheel_bound(self.geometry, self.max_wheel_rate) if bounded else None

    @cached_property
    def period_ns(self) -> int:
        """Length of a step of the ramp [ns]."""
        return max(1, round(NANOSECONDS / self.update_rate))
