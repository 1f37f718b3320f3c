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

"""How the angles of wheels go on after the positions of a driver, until the next ones."""

from typing import NamedTuple, Optional

from diffdrive_kinematics.core.kinematics import NANOSECONDS
from diffdrive_kinematics.core.odometry.rate_window import RateWindow
from diffdrive_kinematics.core.odometry.velocity_check import VelocityCheck
from diffdrive_kinematics.core.odometry.wheel_sample import WheelPair, ZERO

REACH = 3  # usual intervals
CREDIBLE = 2.0  # times the rate of the positions: a velocity above it is an outlier
STEADY = 3  # messages in a row in which a wheel turned one way


class MeasuredState(NamedTuple):
    """
    What is known of wheels by the positions and velocities of a driver.

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
    >>> state = MeasuredState(lead=(0.25, 0.0))
    >>> state.led((0.125, 0.125)), state.held_rates(), state.fallback_rates()
    ((0.25, 0.125), (0.0, 0.0), (0.0, 0.0))
    >>> state.reach_ns(timeout_ns=None)
    60000000

    """

    extrapolates: bool = True
    window: RateWindow = RateWindow()
    check: VelocityCheck = VelocityCheck()
    lead: WheelPair = ZERO

    @property
    def rates(self) -> WheelPair:
        """Return the rates [rad/s] of the positions."""
        return self.window.rates

    def held_rates(self) -> Optional[WheelPair]:
        """
        Return the rates by which angles go on until the next message.

        Returns
        -------
        pair of float or None
            Rates (left, right) [rad/s]; None: they do not go on.

        Examples
        --------
        See :class:`MeasuredState`.

        """
        if self.check.believed and self.check.rates is not None:
            return self._credible(self.check.rates)
        if not self.extrapolates:
            return None
        (left, right), (left_run, right_run) = self.window.rates, self.window.runs
        return left if abs(left_run) >= STEADY else 0.0, right if abs(right_run) >= STEADY else 0.0

    def fallback_rates(self) -> WheelPair:
        """
        Return the rates to go by where the next message has no positions.

        Returns
        -------
        pair of float
            Rates (left, right) [rad/s].

        Examples
        --------
        See :class:`MeasuredState`.

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
        See :class:`MeasuredState`.

        """
        if self.check.believed and self.check.rates is not None:  # by its velocities
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
        >>> MeasuredState(lead=(0.25, 0.0)).led((0.125, 0.125))
        (0.25, 0.125)

        """
        return _behind(angle[0], self.lead[0]), _behind(angle[1], self.lead[1])


def _behind(angle: float, lead: float) -> float:
    if lead > 0.0:
        return max(angle, lead)
    return min(angle, lead) if lead < 0.0 else angle
