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
The clock of one sender, as the times show at which its messages arrive.

It maps stamps to the own clock.  Where it is not known who sends a message, and only its age is
asked for, there is :class:`.SenderClocks`.

The latency of a message, its arrival minus its stamp, is the offset of the sender's clock plus
what the message took.  The least latency is the offset, but for the fastest message's way.

* It falls at once: no message comes before it was sent.
* It rises by a hundredth of the time that passes, more than clocks drift, so that time mapped by
  it always goes on; and at once to that of later messages, where nothing but later ones
  has come for a while.  A burst after a stall ends with messages in time, and changes nothing.
* A clock that is within the tolerance is the own one, and its stamps are taken as they are.
"""

from typing import Tuple

from diffdrive_kinematics.core.odometry.clock_offset import ClockOffset, FEWEST, PATIENCE_NS

DRIFT = 100  # the least latency may rise by one part of so many
HYSTERESIS = 10  # clocks that were apart agree again within one part in so many of the tolerance


class SenderClock(ClockOffset):
    """
    What is known of a sender's clock; a value: :meth:`observed` returns a new one.

    Parameters
    ----------
    tolerance_ns, apart, least_ns, stamp_ns, arrival_ns, messages, since_ns : as there
        Fields of :class:`.ClockOffset`.
    late, late_since_ns, late_least_ns, low_ns, high_ns : as there
        Fields of :class:`.ClockOffset`.

    Examples
    --------
    A clock that is 3 s ahead, less the millisecond that the message took:

    >>> clock = SenderClock(tolerance_ns=250_000_000).observed(8_000_000_000, 5_001_000_000)
    >>> clock.apart, clock.offset_ns, clock.differs
    (True, -2999000000, False)
    >>> clock.own_ns(9_000_000_000), clock.theirs_ns(6_001_000_000)
    (6001000000, 9000000000)
    >>> clock.delay_ns(9_000_000_000, 6_003_000_000)  # 2 ms more than the first one
    2000000

    """

    __slots__ = ()

    def observed(self, stamp_ns: int, arrival_ns: int) -> 'SenderClock':
        """
        Return the clock after one more message.

        Parameters
        ----------
        stamp_ns : int
            Its stamp [ns].
        arrival_ns : int
            When it came [ns], on the own clock.

        Returns
        -------
        SenderClock
            What is known of the clock then.

        Examples
        --------
        See :class:`SenderClock`.

        """
        latency = arrival_ns - stamp_ns
        if self.low_ns <= latency <= self.high_ns:
            return self  # as nearly always
        least = self.least_ns
        if least is None or self.apart and stamp_ns < self.stamp_ns - self.tolerance_ns:
            return self.begun(stamp_ns, arrival_ns)  # it was set back
        if self.apart:
            least += (arrival_ns - self.arrival_ns) // DRIFT
        late, since_ns, late_least = 0, arrival_ns, latency
        if latency < least:
            least = latency
        elif latency > (least if self.apart else 0) + self.tolerance_ns:
            late = self.late + 1
            if self.late:
                since_ns, late_least = self.late_since_ns, min(latency, self.late_least_ns)
            if late >= FEWEST and arrival_ns - since_ns >= PATIENCE_NS:
                least, late = late_least, 0
        limit = self.tolerance_ns // HYSTERESIS if self.apart else self.tolerance_ns
        apart = not -limit <= least <= limit
        messages, first_ns = (self.messages + 1, self.since_ns) if self.apart else (1, arrival_ns)
        return SenderClock(
            self.tolerance_ns, apart, least, stamp_ns, arrival_ns, messages, first_ns, late,
            since_ns, late_least, *self._calm(apart or late > 0, least))

    def begun(self, stamp_ns: int, arrival_ns: int) -> 'SenderClock':
        """
        Return the clock as one message alone shows it: the first, or after a step of it.

        Parameters
        ----------
        stamp_ns : int
            Its stamp [ns].
        arrival_ns : int
            When it came [ns], on the own clock.

        Returns
        -------
        SenderClock
            What is known of the clock then.

        Examples
        --------
        >>> SenderClock(tolerance_ns=250_000_000).begun(8_000_000_000, 5_000_000_000).offset_ns
        -3000000000

        """
        latency = arrival_ns - stamp_ns
        apart = abs(latency) > self.tolerance_ns
        low_ns, high_ns = self._calm(apart, latency)
        return SenderClock(
            self.tolerance_ns, apart, latency, stamp_ns, arrival_ns, 1, arrival_ns,
            low_ns=low_ns, high_ns=high_ns)

    def tolerating(self, tolerance_ns: int) -> 'SenderClock':
        """
        Return the clock with another tolerance, by which the next message is judged.

        Parameters
        ----------
        tolerance_ns : int
            Difference [ns] up to which the clock is the own one.

        Returns
        -------
        SenderClock
            The clock under it.

        Examples
        --------
        >>> clock = SenderClock(250_000_000).observed(5_000_000_000, 5_200_000_000)
        >>> clock = clock.tolerating(50_000_000).observed(5_100_000_000, 5_300_000_000)
        >>> clock.apart, clock.offset_ns
        (True, 200000000)

        """
        return self._replace(tolerance_ns=tolerance_ns, low_ns=0, high_ns=-1)

    def clock_stepped(self, step_ns: int) -> 'SenderClock':
        """
        Return the clock as it reads after the own one was stepped.

        Parameters
        ----------
        step_ns : int
            By how much the own clock was stepped [ns].

        Returns
        -------
        SenderClock
            The clock with its times moved; one that was the own one is so still.

        Examples
        --------
        >>> clock = SenderClock(tolerance_ns=250_000_000).observed(8_000_000_000, 5_000_000_000)
        >>> clock.clock_stepped(1_000_000_000).offset_ns
        -2000000000

        """
        if self.least_ns is None:
            return self
        apart_by = step_ns if self.apart else 0  # else both are the one that was stepped
        return self._replace(
            least_ns=self.least_ns + apart_by, arrival_ns=self.arrival_ns + step_ns,
            since_ns=self.since_ns + step_ns, late_since_ns=self.late_since_ns + step_ns,
            late_least_ns=self.late_least_ns + apart_by)

    def _calm(self, alert: bool, least_ns: int) -> Tuple[int, int]:
        """Return the latencies [ns] that teach nothing; where the clock is watched, none."""
        return (0, -1) if alert else (least_ns, self.tolerance_ns)
