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
What is commanded from a time on, and its steps towards the target: limits, ramps, saturation.

:class:`diffdrive_kinematics.core.commands.Drive` decides when a step is due.
"""

from typing import List, NamedTuple, Optional, Tuple, TypeVar

from diffdrive_kinematics.core.commands.drive_settings import DriveSettings
from diffdrive_kinematics.core.commands.ramp import ramp_step
from diffdrive_kinematics.core.commands.saturation import saturate
from diffdrive_kinematics.core.commands.wheel_command import STILL, Twist, WheelCommand
from diffdrive_kinematics.core.kinematics import NANOSECONDS, RunningSum, wheel_rates_from_twist

D = TypeVar('D', bound='DriveState')


class DriveState(NamedTuple):
    """
    The commanded motion at a time, and its steps; see :class:`Drive`, which is made of it.

    Parameters
    ----------
    settings : DriveSettings
        Geometry and limits.
    since_ns : int
        Time of the last change of the rates [ns].
    target : Twist
        What was asked for.
    twist, before : Twist
        What is commanded after limits and saturation, and a step before: the limiter's state.
    rates : pair of float
        Wheel rates [rad/s] of ``twist``.
    left, right : RunningSum
        Angle [rad] commanded up to ``since_ns``.
    deadline_ns : int or None
        When the command ends [ns]; None: it does not, or has.
    step_ns : int or None
        Time of the ramp's next step [ns]; None: the twist is settled.
    saturated, limited : int
        How many commands or steps the wheel rate bound, or a limit, has cut.
    timeouts : int
        How many commands to move have ended because no other came.

    Examples
    --------
    >>> from diffdrive_kinematics.core.kinematics import WheelGeometry
    >>> settings = DriveSettings(WheelGeometry(0.5, wheel_radius=0.125))
    >>> drive = DriveState(settings, since_ns=0, rates=(2.0, 6.0), deadline_ns=500_000_000)
    >>> drive.command_at(250_000_000).angles
    (0.5, 1.5)
    >>> drive.ended_by(300_000_000).deadline_ns, drive.clock_stepped(-2).since_ns
    (300000000, -2)
    >>> resting = drive.halted(250_000_000)
    >>> resting.rates, resting.command_at(500_000_000).angles
    ((0.0, 0.0), (0.5, 1.5))

    """

    settings: DriveSettings
    since_ns: int
    target: Twist = STILL
    twist: Twist = STILL
    before: Twist = STILL
    rates: Tuple[float, float] = (0.0, 0.0)
    left: RunningSum = RunningSum(0.0)
    right: RunningSum = RunningSum(0.0)
    deadline_ns: Optional[int] = None
    step_ns: Optional[int] = None
    saturated: int = 0
    limited: int = 0
    timeouts: int = 0

    def command_at(self, now_ns: int) -> WheelCommand:
        """
        Return what holds at a time (at the last change where that is later).

        Parameters
        ----------
        now_ns : int
            The time [ns].

        Returns
        -------
        WheelCommand
            Wheel rates, angles and twist.

        Examples
        --------
        See :class:`DriveState`.

        """
        stamp = max(now_ns, self.since_ns)
        left, right = self._angles(stamp)
        return WheelCommand(stamp, self.rates, (left.value, right.value), self.twist)

    def ended_by(self: D, time_ns: int) -> D:
        """
        Return the drive whose command ends at a time, where it would go on for longer.

        Parameters
        ----------
        time_ns : int
            The time [ns].

        Returns
        -------
        Drive
            The drive; :meth:`Drive.advanced` brakes it.  One without a deadline has none.

        Examples
        --------
        See :class:`DriveState`.

        """
        if self.deadline_ns is None or self.deadline_ns <= time_ns:
            return self
        return self._replace(deadline_ns=time_ns)

    def halted(self: D, now_ns: int) -> D:
        """
        Return the drive with its wheels at rest from ``now_ns`` on, whatever the limits.

        Parameters
        ----------
        now_ns : int
            Time from which they rest [ns].

        Returns
        -------
        Drive
            The drive without a target; its angles and counts go on.

        Examples
        --------
        See :class:`DriveState`.

        """
        stamp = max(now_ns, self.since_ns + 1)
        left, right = self._angles(stamp)
        return self._replace(
            since_ns=stamp, target=STILL, twist=STILL, before=STILL, rates=(0.0, 0.0), left=left,
            right=right, deadline_ns=None, step_ns=None)

    def clock_stepped(self: D, step_ns: int) -> D:
        """
        Return the drive as it reads after the clock itself was stepped.

        Parameters
        ----------
        step_ns : int
            By how much the clock was stepped [ns].

        Returns
        -------
        Drive
            The drive with its times moved.

        Examples
        --------
        See :class:`DriveState`.

        """
        return self._replace(
            since_ns=self.since_ns + step_ns,
            deadline_ns=None if self.deadline_ns is None else self.deadline_ns + step_ns,
            step_ns=None if self.step_ns is None else self.step_ns + step_ns)

    def _stepped(self: D, time_ns: int) -> Tuple[D, List[WheelCommand]]:
        """Take one step towards the target at ``time_ns``; without ramps it gets there."""
        settings = self.settings
        asked, reached = settings.command_for(self.target)
        allowed = Twist(settings.linear.limit_velocity(asked.v),
                        settings.angular.limit_velocity(asked.w))
        goal, rates, factor = self._saturated(allowed)
        if factor < 1.0:
            goal, rates, _ = self._saturated(goal)  # the rates of the twist as it was rounded
        twist, settled, held_back = goal, not settings.ramps, False
        if settings.ramps:
            v, w, held_back = ramp_step(
                goal, current=self.twist, before=self.before, dt=1.0 / settings.update_rate,
                linear=settings.linear, angular=settings.angular, bound=settings.wheel_bound)
            twist = Twist(v, w)
            rates = self._saturated(twist)[1]  # within the bound to the last digit
            settled = twist == self.twist == self.before
        drive = self._replace(
            twist=twist, before=self.twist if settings.ramps else twist,
            step_ns=None if settled else time_ns + settings.period_ns,
            saturated=self.saturated + (factor < 1.0 or held_back),
            limited=self.limited + (not reached or allowed != asked or twist != goal))
        if rates == self.rates and twist == self.twist:
            return drive, []
        return drive._turning(rates, time_ns)

    def _turning(
            self: D, rates: Tuple[float, float], time_ns: int) -> Tuple[D, List[WheelCommand]]:
        """Return the drive with other wheel rates from ``time_ns`` on, and the change."""
        left, right = self._angles(time_ns)
        drive = self._replace(since_ns=time_ns, rates=rates, left=left, right=right)
        return drive, [WheelCommand(time_ns, rates, (left.value, right.value), self.twist)]

    def _on_grid_from(self: D, now_ns: int, old_period_ns: int) -> D:
        """Go on ramping, a step of another length after the last one, at the acceleration."""
        assert self.step_ns is not None
        period_ns = self.settings.period_ns
        ratio = period_ns / old_period_ns
        before = Twist(self.twist.v - ratio * (self.twist.v - self.before.v),
                       self.twist.w - ratio * (self.twist.w - self.before.w))
        return self._replace(
            before=before, step_ns=max(now_ns, self.step_ns - old_period_ns + period_ns))

    def _on_new_wheels(self: D, time_ns: int) -> Tuple[D, List[WheelCommand]]:
        """Hold new wheels at once: a twist beyond their bound is cut, and ramps on from there."""
        twist, rates, factor = self._saturated(self.twist)
        drive = self
        if factor < 1.0:
            step = time_ns + self.settings.period_ns if self.step_ns is None else self.step_ns
            drive = self._replace(
                twist=twist, before=twist, step_ns=step, saturated=self.saturated + 1)
        return drive._turning(rates, time_ns) if rates != self.rates else (drive, [])

    def _saturated(self, twist: Twist) -> Tuple[Twist, Tuple[float, float], float]:
        left, right, factor = saturate(
            *wheel_rates_from_twist(self.settings.geometry, *twist), self.settings.max_wheel_rate)
        return Twist(twist.v * factor, twist.w * factor), (left, right), factor

    def _angles(self, time_ns: int) -> Tuple[RunningSum, RunningSum]:
        seconds = (time_ns - self.since_ns) / NANOSECONDS
        return self.left.plus(self.rates[0] * seconds), self.right.plus(self.rates[1] * seconds)
