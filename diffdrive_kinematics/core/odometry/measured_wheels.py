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
Wheels whose positions come from somebody else's driver, and are all that is sure of them.

Publishers of this package tell rates from the stamp on, and positions that follow from them.
A driver's positions are the truth up to their stamp, and its velocities are what it makes of
them: filtered, late, in other units, or nothing at all.

* Rates are those of the positions, over a window.
* From one message to the next the angle goes on by the velocities while they agree with the
  positions, up to twice what these show; else by the rates of the window: for a few usual
  intervals at most, and only where a wheel has turned one way for a while, so that what stands
  does not creep.
* Where that was too far the angle waits for the positions, rather than go back.  A wheel that
  stands, or turns the other way, is where its positions say.
"""

from typing import Optional

from diffdrive_kinematics.core.kinematics import NANOSECONDS
from diffdrive_kinematics.core.odometry.measured_state import MeasuredState
from diffdrive_kinematics.core.odometry.wheel_sample import WheelPair, ZERO

RESTING = 2  # messages in a row in which it did not


class MeasuredWheels(MeasuredState):
    """
    What a driver's messages say of the wheels.

    Parameters
    ----------
    extrapolates, window, check, lead : as there
        Fields of :class:`.MeasuredState`.

    Examples
    --------
    A driver that tells positions only, four times a second:

    >>> wheels = MeasuredWheels().begun(0, (0.0, 0.0), None)
    >>> for number in (1, 2, 3):
    ...     wheels = wheels.followed(
    ...         250_000_000 * number, (0.5 * number, 1.0 * number), None, ahead=(0.0, 0.0))
    >>> wheels.rates, wheels.held_rates(), wheels.fallback_rates()
    ((2.0, 4.0), (2.0, 4.0), (2.0, 4.0))
    >>> wheels.reach_ns(timeout_ns=None), wheels.reach_ns(timeout_ns=500_000_000)
    (750000000, 500000000)

    """

    __slots__ = ()

    def begun(
            self, time_ns: int, angles: WheelPair, velocities: Optional[WheelPair],
            rates: WheelPair = ZERO) -> 'MeasuredWheels':
        """
        Return what a first message says, or one after a step of its clock.

        Parameters
        ----------
        time_ns : int
            Its stamp [ns].
        angles : pair of float
            Rolled so far, as the positions say [rad].
        velocities : pair of float or None
            The driver's velocities [rad/s].
        rates : pair of float
            Rates [rad/s] until the next message, where no velocities are believed.

        Returns
        -------
        MeasuredWheels
            What is known then; velocities that were believed still are.

        Examples
        --------
        See :class:`MeasuredWheels`.

        """
        if velocities is not None and self.check.believed:
            rates = velocities
        return self._replace(
            window=self.window.begun(time_ns, angles, rates), lead=ZERO,
            check=self.check._replace(rates=velocities))

    def followed(
            self, time_ns: int, angles: WheelPair, velocities: Optional[WheelPair],
            ahead: WheelPair) -> 'MeasuredWheels':
        """
        Return what is known after one more message.

        Parameters
        ----------
        time_ns : int
            Its stamp [ns].
        angles : pair of float
            Rolled so far, as the positions say [rad].
        velocities : pair of float or None
            The driver's velocities [rad/s].
        ahead : pair of float
            By how much [rad] the angles reported until it came are ahead of that.

        Returns
        -------
        MeasuredWheels
            What is known then; a message that is not later changes nothing.

        Examples
        --------
        See :class:`MeasuredWheels`.

        """
        if not self.window.groups:
            return self.begun(time_ns, angles, velocities)
        window = self.window.followed(time_ns, angles)
        if window is self.window:
            return self
        last_ns, left, right = self.window.groups[-1]
        check = self.check.followed(
            velocities, (angles[0] - left, angles[1] - right), (time_ns - last_ns) / NANOSECONDS)
        lead = ZERO if ahead == ZERO else (
            _kept(ahead[0], window.rests[0], window.runs[0] or window.rates[0]),
            _kept(ahead[1], window.rests[1], window.runs[1] or window.rates[1]))
        return MeasuredWheels(self.extrapolates, window, check, lead)

    def rested(self, by: WheelPair) -> 'MeasuredWheels':
        """
        Return what is known of wheels that count as standing, and angles moved.

        Parameters
        ----------
        by : pair of float
            By how much the angles are moved [rad].

        Returns
        -------
        MeasuredWheels
            What is known, with rates of 0 until the next message.

        Examples
        --------
        >>> wheels = MeasuredWheels().begun(0, (7.0, 8.0), None).rested((-7.0, -8.0))
        >>> wheels.window.groups
        ((0, 0.0, 0.0),)

        """
        return self._replace(window=self.window.rested(by), lead=ZERO)

    def clock_stepped(self, step_ns: int) -> 'MeasuredWheels':
        """
        Return what is known as it reads after the clock itself was stepped.

        Parameters
        ----------
        step_ns : int
            By how much the clock was stepped [ns].

        Returns
        -------
        MeasuredWheels
            What is known, with its times moved.

        Examples
        --------
        >>> MeasuredWheels().begun(5, (7.0, 8.0), None).clock_stepped(-2).window.begun_ns
        3

        """
        return self._replace(window=self.window.shifted(step_ns))


def _kept(ahead: float, rests: int, way: float) -> float:
    """Return the lead of a wheel that is ahead: none where it stands or turns the other way."""
    return ahead if rests < RESTING and ahead * way > 0.0 else 0.0
