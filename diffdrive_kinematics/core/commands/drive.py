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

:meth:`Drive.commanded` and :meth:`Drive.advanced` return the drive after a command and after some
time, with the changes of the wheel rates on the way, each stamped with the time of the commands.
"""

from typing import List, Optional, Tuple

from diffdrive_kinematics.core.commands.drive_settings import DriveSettings
from diffdrive_kinematics.core.commands.drive_state import DriveState
from diffdrive_kinematics.core.commands.wheel_command import STILL, Twist, WheelCommand
from diffdrive_kinematics.core.kinematics import (
    is_sane, LARGEST, NANOSECONDS, wheel_rates_from_twist)


class Drive(DriveState):
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
    A command holds for half a second:

    >>> from diffdrive_kinematics.core.kinematics import WheelGeometry
    >>> settings = DriveSettings(WheelGeometry(0.5, 0.125), cmd_vel_timeout=0.5)
    >>> drive, changes = Drive(settings, since_ns=0).commanded(Twist(0.5, 1.0), 1_000_000_000)
    >>> changes[0].stamp_ns, changes[0].rates
    (1000000000, (2.0, 6.0))
    >>> drive.command_at(1_250_000_000).angles
    (0.5, 1.5)
    >>> drive, changes = drive.advanced(2_000_000_000)
    >>> changes[0].stamp_ns, changes[0].rates, changes[0].angles
    (1500000000, (0.0, 0.0), (1.0, 3.0))
    >>> drive.resumed(9_000_000_000).deadline_ns is None
    True

    """

    __slots__ = ()

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
        timeout_ns = round(self.settings.cmd_vel_timeout * NANOSECONDS)
        deadline = stamp_ns + timeout_ns if self.settings.cmd_vel_timeout else None
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

        >>> from diffdrive_kinematics.core.kinematics import WheelGeometry
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

    def resumed(self, now_ns: int) -> 'Drive':
        """
        Return the drive whose command has ended before ``now_ns``, as if no time had passed since.

        Parameters
        ----------
        now_ns : int
            The time [ns]; the command goes on from it, without an end.

        Returns
        -------
        Drive
            The drive.

        Examples
        --------
        See :class:`Drive`.

        """
        if self.deadline_ns is None:
            return self
        return self.clock_stepped(now_ns - self.deadline_ns)._replace(deadline_ns=None)

    def _with_new_timeout(self, now_ns: int) -> 'Drive':
        """Let the live command end a new timeout from now on, or earlier where it did before."""
        timeout = self.settings.cmd_vel_timeout
        if not timeout:
            return self._replace(deadline_ns=None)
        end_ns = now_ns + round(timeout * NANOSECONDS)
        if self.deadline_ns is None and self.target != STILL:
            return self._replace(deadline_ns=end_ns)
        return self.ended_by(end_ns)


def _earlier(one: Optional[int], other: Optional[int]) -> Optional[int]:
    """Return the earlier of two times [ns]; None never comes."""
    if one is None or other is None:
        return other if one is None else one
    return one if one < other else other
