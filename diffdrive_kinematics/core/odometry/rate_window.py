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
Wheel rates from positions, as the mean over a window of the last messages.

An increment over its own interval is no rate: stamps jitter, messages come in pairs or bursts,
and encoders count in ticks.  Over a window of N intervals these errors are N times smaller.

* Messages that come within half the usual interval of each other count as one, the last of them,
  so that a burst does not make the window short.  The usual interval is that between such groups,
  and a pause, be it the first one, does not make it long.
* No rate is taken over less than half the usual interval: it stays what it was.
* A wheel that has not moved since a time turns by no more than its smallest increment a such time.
"""

from typing import NamedTuple, Tuple

from diffdrive_kinematics.core.kinematics import NANOSECONDS
from diffdrive_kinematics.core.odometry.wheel_sample import WheelPair, ZERO

USUAL_NS = 20_000_000  # the interval expected before two messages are known
WEIGHT = 16  # of what was usual, against one more interval
LONGEST = 4  # usual intervals that one more counts for at most
FIRST = 2  # intervals that are taken for usual as they are


class RateWindow(NamedTuple):
    """
    The angles of the wheels over the last messages, and the rates they amount to.

    Parameters
    ----------
    size : int
        How many intervals the window has.
    groups : tuple of (int, float, float)
        Time [ns] and angles (left, right) [rad] of the last message of each group, by time.
    begun_ns : int
        Time [ns] of the first message of the last group.
    usual_ns : int
        The usual interval [ns].
    rates : pair of float
        Mean rates [rad/s] over the window.
    runs, rests : pair of int
        How many messages in a row each wheel turned, below 0: backward; or stood.

    Examples
    --------
    >>> window = RateWindow(size=2).begun(0, (7.0, 8.0))
    >>> window = window.followed(250_000_000, (7.25, 9.0)).followed(500_000_000, (8.0, 10.0))
    >>> window.rates, window.runs, window.usual_ns
    ((2.0, 4.0), (2, 2), 250000000)

    """

    size: int = 10
    groups: Tuple[Tuple[int, float, float], ...] = ()
    begun_ns: int = 0
    usual_ns: int = USUAL_NS
    rates: WheelPair = ZERO
    runs: Tuple[int, int] = (0, 0)
    rests: Tuple[int, int] = (0, 0)

    def begun(self, time_ns: int, angles: WheelPair, rates: WheelPair = ZERO) -> 'RateWindow':
        """
        Return the window that starts with a message; what interval is usual stays known.

        Parameters
        ----------
        time_ns : int
            Its time [ns].
        angles : pair of float
            Angles of the wheels [rad].
        rates : pair of float
            Rates [rad/s] until the next message, where they are known.

        Returns
        -------
        RateWindow
            The window with one group.

        Examples
        --------
        See :class:`RateWindow`.

        """
        return RateWindow(self.size, ((time_ns, *angles),), time_ns, self.usual_ns, rates)

    def followed(self, time_ns: int, angles: WheelPair) -> 'RateWindow':
        """
        Return the window after one more message; an earlier one changes nothing.

        Parameters
        ----------
        time_ns : int
            Its time [ns].
        angles : pair of float
            Angles of the wheels [rad].

        Returns
        -------
        RateWindow
            The window up to it.

        Examples
        --------
        See :class:`RateWindow`.

        """
        groups = self.groups
        last_ns, *last = groups[-1]
        if time_ns <= last_ns:
            return self
        begun_ns, usual_ns = self.begun_ns, self.usual_ns
        entry = time_ns, angles[0], angles[1]
        interval_ns = time_ns - begun_ns
        if interval_ns < usual_ns // 2:
            groups = (*groups[:-1], entry)
        else:
            interval_ns = min(interval_ns, LONGEST * usual_ns)
            usual_ns = interval_ns if len(groups) <= FIRST else usual_ns + (
                interval_ns - usual_ns) // WEIGHT
            groups, begun_ns = (*groups, entry)[-1 - self.size:], time_ns
        (left_run, left_rest), (right_run, right_rest) = map(
            _counted, zip(angles, last, self.runs, self.rests))
        rests = left_rest, right_rest
        rates, span_ns = self.rates, time_ns - groups[0][0]
        if span_ns >= usual_ns // 2:
            seconds = span_ns / NANOSECONDS
            rates = ((angles[0] - groups[0][1]) / seconds, (angles[1] - groups[0][2]) / seconds)
            if any(rests) and any(rates):
                rates = (_bounded(rates[0], groups, 1), _bounded(rates[1], groups, 2))
        return RateWindow(
            self.size, groups, begun_ns, usual_ns, rates, (left_run, right_run), rests)

    def rested(self, by: WheelPair) -> 'RateWindow':
        """
        Return the window with rates of 0 until the next message, and angles moved.

        Parameters
        ----------
        by : pair of float
            By how much the angles are moved [rad].

        Returns
        -------
        RateWindow
            The window of wheels that stand.

        Examples
        --------
        >>> window = RateWindow().begun(0, (7.0, 8.0)).followed(250_000_000, (7.25, 9.0))
        >>> window = window.rested((-7.25, -9.0))
        >>> window.rates, window.groups[-1]
        ((0.0, 0.0), (250000000, 0.0, 0.0))

        """
        return self._replace(rates=ZERO, groups=tuple(
            (time_ns, left + by[0], right + by[1]) for time_ns, left, right in self.groups))

    def shifted(self, step_ns: int) -> 'RateWindow':
        """
        Return the window as it reads after the clock itself was stepped.

        Parameters
        ----------
        step_ns : int
            By how much the clock was stepped [ns].

        Returns
        -------
        RateWindow
            The window with its times moved.

        Examples
        --------
        >>> RateWindow().begun(5, (7.0, 8.0)).shifted(-2).groups
        ((3, 7.0, 8.0),)

        """
        return self._replace(begun_ns=self.begun_ns + step_ns, groups=tuple(
            (time_ns + step_ns, left, right) for time_ns, left, right in self.groups))


def _counted(wheel: Tuple[float, float, int, int]) -> Tuple[int, int]:
    """Return for how many messages a wheel has turned one way, and stood."""
    angle, last, run, rest = wheel
    if angle > last:
        return max(run, 0) + 1, 0
    if angle < last:
        return min(run, 0) - 1, 0
    return 0, rest + 1


def _bounded(rate: float, groups: Tuple[Tuple[int, float, float], ...], wheel: int) -> float:
    """Return a rate within what a wheel may turn that has not moved for some time."""
    smallest, moved_ns = 0.0, 0
    for after, before in zip(groups[:0:-1], groups[-2::-1]):
        increment = abs(float(after[wheel]) - float(before[wheel]))
        if increment and not (smallest and smallest <= increment):
            smallest = increment
        moved_ns = moved_ns or (int(after[0]) if increment else 0)
    still_ns = int(groups[-1][0]) - moved_ns
    if not smallest or still_ns <= 0:
        return rate
    bound = smallest * NANOSECONDS / still_ns
    return max(-bound, min(bound, rate))
