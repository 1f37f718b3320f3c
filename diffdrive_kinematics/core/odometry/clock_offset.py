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

"""The offset between the own clock and that of a sender, and times mapped by it."""

from typing import NamedTuple, Optional

PATIENCE_NS = 1_000_000_000
FEWEST = 5  # messages to judge by


class ClockOffset(NamedTuple):
    """
    What is known of a sender's clock.

    Parameters
    ----------
    tolerance_ns : int
        Difference [ns] up to which the clock is the own one.
    apart : bool
        Whether the clock is another one, by what was heard so far.
    least_ns : int or None
        The least latency [ns]; None: nothing was heard.
    stamp_ns, arrival_ns : int
        Of the last message that taught something [ns].
    messages, since_ns : int
        How many messages have come since the clock is apart, and when [ns] the first one came.
    late, late_since_ns, late_least_ns : int
        How many messages in a row came late, when [ns] the first did, and the least latency [ns].
    low_ns, high_ns : int
        Latencies [ns] from one to the other teach nothing; there are some where clocks agree.

    Examples
    --------
    >>> clock = ClockOffset(tolerance_ns=250_000_000, apart=True, least_ns=-3_000_000_000)
    >>> clock.own_ns(9_000_000_000), clock.theirs_ns(6_000_000_000)
    (6000000000, 9000000000)
    >>> clock.delay_ns(9_000_000_000, 6_002_000_000)
    2000000

    """

    tolerance_ns: int
    apart: bool = False
    least_ns: Optional[int] = None
    stamp_ns: int = 0
    arrival_ns: int = 0
    messages: int = 0
    since_ns: int = 0
    late: int = 0
    late_since_ns: int = 0
    late_least_ns: int = 0
    low_ns: int = 0
    high_ns: int = -1

    @property
    def offset_ns(self) -> int:
        """Return what [ns] to add to stamps for the time on the own clock; 0: they agree."""
        return self.least_ns or 0 if self.apart else 0

    @property
    def differs(self) -> bool:
        """Return whether the clock is another one, and steadily so."""
        return (self.apart and self.messages >= FEWEST
                and self.arrival_ns - self.since_ns >= PATIENCE_NS)

    def own_ns(self, stamp_ns: int) -> int:
        """
        Return the time on the own clock of a stamp.

        Parameters
        ----------
        stamp_ns : int
            The stamp [ns].

        Returns
        -------
        int
            The time [ns].

        Examples
        --------
        See :class:`ClockOffset`.

        """
        return stamp_ns + self.offset_ns

    def theirs_ns(self, time_ns: int) -> int:
        """
        Return the time on the sender's clock when the own clock shows another.

        Parameters
        ----------
        time_ns : int
            The time on the own clock [ns].

        Returns
        -------
        int
            The time on the sender's clock [ns].

        Examples
        --------
        See :class:`ClockOffset`.

        """
        return time_ns - (self.least_ns or 0) if self.apart else time_ns

    def delay_ns(self, stamp_ns: int, arrival_ns: int) -> int:
        """
        Return how much later than the fastest ones a message came, whatever the clock.

        Parameters
        ----------
        stamp_ns : int
            Its stamp [ns].
        arrival_ns : int
            When it came [ns], on the own clock.

        Returns
        -------
        int
            The delay [ns].

        Examples
        --------
        See :class:`ClockOffset`.

        """
        return arrival_ns - stamp_ns - (self.least_ns or 0)
