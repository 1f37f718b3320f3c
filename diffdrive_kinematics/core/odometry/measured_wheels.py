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

from typing import NamedTuple, Optional

from diffdrive_kinematics.core.kinematics import NANOSECONDS
from diffdrive_kinematics.core.odometry.rate_window import RateWindow
from diffdrive_kinematics.core.odometry.velocity_check import VelocityCheck
from diffdrive_kinematics.core.odometry.wheel_sample import WheelPair, ZERO

__all__ = ['MeasuredWheels']

REACH = 3  # usual intervals
CREDIBLE = 2.0  # times the rate of the positions: a velocity above it is an outlier
STEADY = 3  # messages in a row in which a wheel turned one way
RESTING = 2  # messages in a row in which it did not


class MeasuredWheels(NamedTuple):
    """
    What a driver's messages say of the wheels.

    Parameters
    ----------
    extrapolates : bool
        Whether angles go on by the rates of the window.
    window : RateWindow
        The rates of the positions.
    check : VelocityCheck
        Whether the velocities are those of the positions.
    lead : pair of float
        By how much [rad] the angles at the last message are ahead of the positions.

    Examples
    --------
    A driver that tells positions only, four times a second:

    >>> wheels = MeasuredWheels().begun(0, (0.0, 0.0), None)
    >>> for number in (1, 2, 3):
    ...     wheels = wheels.followed(
    ...         250_000_000 * number, (0.5 * number, 1.0 * number), None, ahead=(0.0, 0.0))
    >>> wheels.rates, wheels.held_rates(), wheels.told_rates()
    ((2.0, 4.0), (2.0, 4.0), (2.0, 4.0))
    >>> wheels.reach_ns(timeout_ns=None), wheels.reach_ns(timeout_ns=500_000_000)
    (750000000, 500000000)

    """

    extrapolates: bool = True
    window: RateWindow = RateWindow()
    check: VelocityCheck = VelocityCheck()
    lead: WheelPair = ZERO

    @property
    def rates(self) -> WheelPair:
        """Return the rates [rad/s] of the positions."""
        return self.window.rates

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
            By how much [rad] the angles that were told until it came are ahead of that.

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

    def held_rates(self) -> Optional[WheelPair]:
        """
        Return the rates by which angles go on until the next message.

        Returns
        -------
        pair of float or None
            Rates (left, right) [rad/s]; None: they do not go on.

        Examples
        --------
        See :class:`MeasuredWheels`.

        """
        if self.check.believed and self.check.rates is not None:
            return self._credible(self.check.rates)
        if not self.extrapolates:
            return None
        (left, right), (left_run, right_run) = self.window.rates, self.window.runs
        return left if abs(left_run) >= STEADY else 0.0, right if abs(right_run) >= STEADY else 0.0

    def told_rates(self) -> WheelPair:
        """
        Return the rates to go by where the next message has no positions.

        Returns
        -------
        pair of float
            Rates (left, right) [rad/s].

        Examples
        --------
        See :class:`MeasuredWheels`.

        """
        check = self.check
        return self.window.rates if check.against or check.rates is None else check.rates

    def reach_ns(self, timeout_ns: Optional[int]) -> Optional[int]:
        """
        Return for how long angles go on after a message.

        Parameters
        ----------
        timeout_ns : int or None
            Silence after which the wheels stop [ns]; None: they do not.

        Returns
        -------
        int or None
            The time [ns]; None: there is no end.

        Examples
        --------
        See :class:`MeasuredWheels`.

        """
        if self._bridged():
            return timeout_ns
        reach_ns = REACH * self.window.usual_ns
        return reach_ns if timeout_ns is None else min(reach_ns, timeout_ns)

    def _credible(self, rates: WheelPair) -> WheelPair:
        """Return velocities [rad/s] within a multiple of what the positions show."""
        groups, shown = self.window.groups, self.window.rates
        last, before = groups[-1], groups[-2] if len(groups) > 1 else groups[-1]
        per_s = NANOSECONDS / self.window.usual_ns
        left = CREDIBLE * max(abs(shown[0]), abs(last[1] - before[1]) * per_s)
        right = CREDIBLE * max(abs(shown[1]), abs(last[2] - before[2]) * per_s)
        if -left <= rates[0] <= left and -right <= rates[1] <= right:
            return rates
        return max(-left, min(left, rates[0])), max(-right, min(right, rates[1]))

    def _bridged(self) -> bool:
        """Tell whether angles go on by the velocities of the driver."""
        return self.check.believed and self.check.rates is not None

    def led(self, angle: WheelPair) -> WheelPair:
        """
        Return an angle since the last message that does not go back behind the lead.

        Parameters
        ----------
        angle : pair of float
            Rolled since the last message [rad].

        Returns
        -------
        pair of float
            The angle [rad], or the lead where that is farther.

        Examples
        --------
        >>> MeasuredWheels(lead=(0.25, 0.0)).led((0.125, 0.125))
        (0.25, 0.125)

        """
        return _behind(angle[0], self.lead[0]), _behind(angle[1], self.lead[1])

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


def _behind(angle: float, lead: float) -> float:
    if lead > 0.0:
        return max(angle, lead)
    return min(angle, lead) if lead < 0.0 else angle
