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
From velocity commands to wheel rates over time: limits, ramps, saturation and the watchdog.

The drive is a value; :meth:`Drive.commanded` and :meth:`Drive.advanced` return the drive after a
command and after the passing of time, each with the changes of the wheel rates on the way.  A
change is stamped with the time from which it holds, computed from the stamps of the commands and
never from the moment at which somebody asked, so timers only decide when a change is told.
"""

from dataclasses import dataclass
from functools import cached_property
import math
from typing import List, NamedTuple, Optional, Tuple

from diffdrive_kinematics.core.commands.limits import AxisLimits
from diffdrive_kinematics.core.commands.ramp import ramp_step
from diffdrive_kinematics.core.commands.saturation import saturate, wheel_bound, WheelBound
from diffdrive_kinematics.core.kinematics import (
    check_duration, check_rate, is_sane, LARGEST, RunningSum, wheel_rates_from_twist,
    WheelGeometry)

__all__ = ['Drive', 'DriveSettings', 'WheelCommand', 'STILL', 'Twist']

NANOSECONDS = 1e9


class Twist(NamedTuple):
    """
    A twist of the robot.

    Parameters
    ----------
    v : float
        Forward speed [m/s].
    w : float
        Yaw rate [rad/s], counter-clockwise positive.

    Examples
    --------
    See :class:`Drive`.

    """

    v: float
    w: float


STILL = Twist(0.0, 0.0)


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
    publish_rate : float
        Rate [Hz] of the grid on which ramps step.

    Raises
    ------
    ValueError
        If a value is out of its range.

    Examples
    --------
    >>> settings = DriveSettings(
    ...     WheelGeometry(0.5, 0.125), AxisLimits(max_acceleration=1.0), publish_rate=100.0)
    >>> settings.ramps, settings.period_ns, settings.wheel_bound
    (True, 10000000, None)

    """

    geometry: WheelGeometry
    linear: AxisLimits = AxisLimits()
    angular: AxisLimits = AxisLimits()
    max_wheel_rate: float = math.nan
    cmd_vel_timeout: float = 0.5
    publish_rate: float = 50.0

    def __post_init__(self) -> None:
        check_duration('cmd_vel_timeout', self.cmd_vel_timeout)
        check_rate('publish_rate', self.publish_rate)
        if self.max_wheel_rate <= 0.0:
            raise ValueError(
                f'max_wheel_rate is {self.max_wheel_rate!r}, expected above 0, or NaN')

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
        return max(1, round(NANOSECONDS / self.publish_rate))


class WheelCommand(NamedTuple):
    """
    What to tell at a time.

    Parameters
    ----------
    stamp_ns : int
        The time [ns].
    rates : pair of float
        Wheel rates (left, right) [rad/s] from then on.
    angles : pair of float
        Angles (left, right) [rad] commanded up to then.
    twist : Twist
        What the rates amount to.

    Examples
    --------
    >>> WheelCommand(0, rates=(4.0, 4.0), angles=(0.0, 0.0), twist=Twist(0.5, 0.0)).twist.v
    0.5

    """

    stamp_ns: int
    rates: Tuple[float, float]
    angles: Tuple[float, float]
    twist: Twist


class Drive(NamedTuple):
    """
    The commanded motion, from ``since_ns`` on.

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
    A command holds for half a second, as no other comes:

    >>> settings = DriveSettings(WheelGeometry(0.5, 0.125), cmd_vel_timeout=0.5)
    >>> drive, changes = Drive(settings, since_ns=0).commanded(Twist(0.5, 1.0), 1_000_000_000)
    >>> changes[0].stamp_ns, changes[0].rates
    (1000000000, (2.0, 6.0))
    >>> drive.command_at(1_250_000_000).angles
    (0.5, 1.5)
    >>> drive, changes = drive.advanced(2_000_000_000)
    >>> changes[0].stamp_ns, changes[0].rates, changes[0].angles
    (1500000000, (0.0, 0.0), (1.0, 3.0))

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

    def commanded(self, target: Twist, stamp_ns: int) -> Tuple['Drive', List[WheelCommand]]:
        """
        Return the drive after a command that holds from ``stamp_ns``, and the changes.

        The change is never before the last one: at its time or later by 1 ns.  While a ramp is
        under way a command only moves the target, and the ramp's next step heads for it.

        Parameters
        ----------
        target : Twist
            What is asked for.
        stamp_ns : int
            Time of the command [ns].

        Returns
        -------
        drive : Drive
            The drive after the command.
        changes : list of WheelCommand
            The changes on the way, in order of time.

        Raises
        ------
        ValueError
            If the twist or its wheel rates are not finite or absurdly large.

        Examples
        --------
        See :class:`Drive`.

        """
        rates = wheel_rates_from_twist(self.settings.geometry, *target)
        if not is_sane(*target, *rates):
            raise ValueError(
                f'the command (linear.x, angular.z) is {tuple(target)!r}, expected finite '
                f'numbers that give wheel rates within +-{LARGEST:g} rad/s')
        drive, changes = self.advanced(stamp_ns)
        timeout = drive.settings.cmd_vel_timeout
        deadline = stamp_ns + round(timeout * NANOSECONDS) if timeout else None
        drive = drive._replace(target=target, deadline_ns=deadline)
        if drive.step_ns is None:
            drive, change = drive._stepped(max(stamp_ns, drive.since_ns + 1))
            changes += change
        return drive, changes

    def advanced(self, now_ns: int) -> Tuple['Drive', List[WheelCommand]]:
        """
        Return the drive at a time and the changes due until then, ramps and watchdog.

        Parameters
        ----------
        now_ns : int
            The time [ns].

        Returns
        -------
        drive : Drive
            The drive at the time.
        changes : list of WheelCommand
            The changes on the way, in order of time.

        Examples
        --------
        See :class:`Drive`.

        """
        drive: Drive = self
        changes: List[WheelCommand] = []
        while True:
            event = _earlier(drive.deadline_ns, drive.step_ns)
            if event is None or event > now_ns:
                return drive, changes
            if event == drive.deadline_ns:
                drive = drive._replace(
                    target=STILL, deadline_ns=None,
                    timeouts=drive.timeouts + (drive.target != STILL))
                if drive.step_ns is not None:
                    continue
            drive, change = drive._stepped(max(event, drive.since_ns + 1))
            changes += change

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
        See :class:`Drive`.

        """
        stamp = max(now_ns, self.since_ns)
        left, right = self._angles(stamp)
        return WheelCommand(stamp, self.rates, (left.value, right.value), self.twist)

    def configured(
            self, settings: DriveSettings, now_ns: int) -> Tuple['Drive', List[WheelCommand]]:
        """
        Return the drive under new settings from ``now_ns`` on: the same target anew.

        A new timeout counts from then on, but no command ends later than it would have.

        Parameters
        ----------
        settings : DriveSettings
            The new settings.
        now_ns : int
            Time from which they hold [ns].

        Returns
        -------
        drive : Drive
            The drive under them.
        changes : list of WheelCommand
            The changes on the way, in order of time.

        Examples
        --------
        Wheels of twice the size turn half as fast:

        >>> small = DriveSettings(WheelGeometry(0.5, wheel_radius=0.125))
        >>> large = DriveSettings(WheelGeometry(0.5, wheel_radius=0.25))
        >>> drive, _ = Drive(small, since_ns=0).commanded(Twist(0.5, 0.0), 1_000_000_000)
        >>> drive.rates, drive.configured(large, now_ns=1_250_000_000)[0].rates
        ((4.0, 4.0), (2.0, 2.0))

        """
        drive, changes = self.advanced(now_ns)
        drive = drive._replace(settings=settings)
        if settings.cmd_vel_timeout != self.settings.cmd_vel_timeout:
            drive = drive._with_new_timeout(now_ns)
        if drive.step_ns is not None and settings.period_ns != self.settings.period_ns:
            drive = drive._on_grid_from(now_ns, self.settings.period_ns)
        wheels = settings.geometry, settings.max_wheel_rate
        if settings.ramps and wheels != (self.settings.geometry, self.settings.max_wheel_rate):
            drive, change = drive._on_new_wheels(max(now_ns, drive.since_ns + 1))
            changes += change
        if drive.step_ns is None or not settings.ramps:
            drive, change = drive._stepped(max(now_ns, drive.since_ns + 1))
            changes += change
        return drive, changes

    def ended_by(self, time_ns: int) -> 'Drive':
        """
        Return the drive whose command ends at a time, where it would go on for longer.

        Parameters
        ----------
        time_ns : int
            The time [ns].

        Returns
        -------
        Drive
            The drive; :meth:`advanced` brakes it.  One without a deadline has none.

        Examples
        --------
        >>> drive = Drive(DriveSettings(WheelGeometry(0.5, 0.125)), since_ns=0)
        >>> drive, _ = drive.commanded(Twist(0.5, 0.0), 1_000_000_000)
        >>> drive.deadline_ns, drive.ended_by(1_250_000_000).deadline_ns
        (1500000000, 1250000000)

        """
        if self.deadline_ns is None or self.deadline_ns <= time_ns:
            return self
        return self._replace(deadline_ns=time_ns)

    def exceeds_target(self) -> bool:
        """
        Return whether a speed or yaw rate is more than what is asked for, or of another sign.

        Returns
        -------
        bool
            Whether the robot is faster than asked, as where a ramp brakes it.

        Examples
        --------
        >>> settings = DriveSettings(WheelGeometry(0.5, 0.125))
        >>> Drive(settings, since_ns=0, twist=Twist(0.5, 0.0)).exceeds_target()
        True

        """
        return any(abs(now) > abs(asked) or now * asked < 0.0
                   for now, asked in zip(self.twist, self.target))

    def resumed(self, now_ns: int) -> 'Drive':
        """
        Return the drive as if no time had passed since its command ended.

        For a process that was held up: nobody was told of that end, and the next command is here.

        Parameters
        ----------
        now_ns : int
            The time [ns].

        Returns
        -------
        Drive
            The drive at the time, without a deadline.

        Examples
        --------
        >>> drive = Drive(DriveSettings(WheelGeometry(0.5, 0.125)), since_ns=0)
        >>> drive, _ = drive.commanded(Twist(0.5, 0.0), 1_000_000_000)
        >>> drive.resumed(9_000_000_000).command_at(9_000_000_000).angles
        (2.0, 2.0)

        """
        if self.deadline_ns is None:
            return self
        return self.clock_stepped(now_ns - self.deadline_ns)._replace(deadline_ns=None)

    def halted(self, now_ns: int) -> 'Drive':
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
        >>> drive = Drive(DriveSettings(WheelGeometry(0.5, 0.125)), since_ns=0)
        >>> drive, _ = drive.commanded(Twist(0.5, 0.0), 1_000_000_000)
        >>> command = drive.halted(1_250_000_000).command_at(1_500_000_000)
        >>> command.rates, command.angles
        ((0.0, 0.0), (1.0, 1.0))

        """
        stamp = max(now_ns, self.since_ns + 1)
        left, right = self._angles(stamp)
        return Drive(
            self.settings, stamp, left=left, right=right, saturated=self.saturated,
            limited=self.limited, timeouts=self.timeouts)

    def clock_stepped(self, step_ns: int) -> 'Drive':
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
        >>> Drive(DriveSettings(WheelGeometry(0.5, 0.125)), since_ns=5).clock_stepped(-2).since_ns
        3

        """
        return self._replace(
            since_ns=self.since_ns + step_ns,
            deadline_ns=None if self.deadline_ns is None else self.deadline_ns + step_ns,
            step_ns=None if self.step_ns is None else self.step_ns + step_ns)

    def _stepped(self, time_ns: int) -> Tuple['Drive', List[WheelCommand]]:
        """Take one step towards the target at ``time_ns``; without ramps it gets there."""
        settings = self.settings
        allowed = Twist(settings.linear.limit_velocity(self.target.v),
                        settings.angular.limit_velocity(self.target.w))
        goal, rates, factor = self._saturated(allowed)
        if factor < 1.0:
            goal, rates, _ = self._saturated(goal)  # the rates of the twist as it was rounded
        twist, settled, held_back = goal, not settings.ramps, False
        if settings.ramps:
            v, w, held_back = ramp_step(
                goal, current=self.twist, before=self.before, dt=1.0 / settings.publish_rate,
                linear=settings.linear, angular=settings.angular, bound=settings.wheel_bound)
            twist = Twist(v, w)
            rates = self._saturated(twist)[1]  # within the bound to the last digit
            settled = twist == self.twist == self.before
        drive = self._replace(
            twist=twist, before=self.twist if settings.ramps else twist,
            step_ns=None if settled else time_ns + settings.period_ns,
            saturated=self.saturated + (factor < 1.0 or held_back),
            limited=self.limited + (allowed != self.target or twist != goal))
        if rates == self.rates and twist == self.twist:
            return drive, []
        return drive._turning(rates, time_ns)

    def _turning(
            self, rates: Tuple[float, float],
            time_ns: int) -> Tuple['Drive', List[WheelCommand]]:
        """Return the drive with other wheel rates from ``time_ns`` on, and the change."""
        left, right = self._angles(time_ns)
        drive = self._replace(since_ns=time_ns, rates=rates, left=left, right=right)
        return drive, [drive.command_at(time_ns)]

    def _with_new_timeout(self, now_ns: int) -> 'Drive':
        """Let the live command end a new timeout from now on, or earlier where it did before."""
        timeout = self.settings.cmd_vel_timeout
        if not timeout:
            return self._replace(deadline_ns=None)
        end_ns = now_ns + round(timeout * NANOSECONDS)
        if self.deadline_ns is None and self.target != STILL:
            return self._replace(deadline_ns=end_ns)
        return self.ended_by(end_ns)

    def _on_grid_from(self, now_ns: int, old_period_ns: int) -> 'Drive':
        """Go on ramping, a step of another length after the last one, at the acceleration."""
        assert self.step_ns is not None
        period_ns = self.settings.period_ns
        ratio = period_ns / old_period_ns
        before = Twist(self.twist.v - ratio * (self.twist.v - self.before.v),
                       self.twist.w - ratio * (self.twist.w - self.before.w))
        return self._replace(
            before=before, step_ns=max(now_ns, self.step_ns - old_period_ns + period_ns))

    def _on_new_wheels(self, time_ns: int) -> Tuple['Drive', List[WheelCommand]]:
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
            *wheel_rates_from_twist(self.settings.geometry, *twist),
            self.settings.max_wheel_rate)
        return Twist(twist.v * factor, twist.w * factor), (left, right), factor

    def _angles(self, time_ns: int) -> Tuple[RunningSum, RunningSum]:
        seconds = (time_ns - self.since_ns) / NANOSECONDS
        return (self.left.plus(self.rates[0] * seconds),
                self.right.plus(self.rates[1] * seconds))


def _earlier(one: Optional[int], other: Optional[int]) -> Optional[int]:
    """Return the earlier of two times [ns]; None never comes."""
    if one is None or other is None:
        return other if one is None else one
    return one if one < other else other
