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
How long ago a message was sent, where its sender is not known, nor the clock of it.

Several clocks may be in use at a time.  That of one known sender is a :class:`.SenderClock`, which
follows its drift and maps its stamps.

The latency of a message, the own clock at its arrival less the sender's when it was sent, is its
age and the offset of the two clocks in one.  The offsets of several senders are known at a time,
since a message does not say whose it is; its age is the least that one of them explains.

* Senders are on the own clock until they show that they are not.
* A message that comes before any known sender could have sent it is of another one, whose clock
  is ahead; its offset is learnt at once.
* Messages that are old come as a burst, out of a queue, the later ones less old.  Those that come
  late and equally so for a while are sent as they come, by another clock: its offset is learnt.
* What no message has fitted for a while, where others have fitted another one, is forgotten, but
  for a clock that was given.
"""

from typing import NamedTuple, Optional, Tuple

WHILE_NS = 300_000_000  # for which messages of another clock come equally late
EQUALLY_NS = 100_000_000
GAP_NS = 1_000_000_000  # beyond the timeout: the longest between two such messages
REMEMBERED_NS = 10_000_000_000
MOST = 8


class Clock(NamedTuple):
    """
    What may be the clock of a sender.

    Parameters
    ----------
    offset_ns : int
        Own clock less the sender's [ns], with what its fastest message took.
    first_ns, last_ns : int
        When it was heard first and last [ns], on a steady clock.
    known : bool
        Whether it is known, or in doubt: messages came late, but equally so.

    Examples
    --------
    >>> Clock(offset_ns=-3_000_000_000, first_ns=0, last_ns=0, known=True)._replace(last_ns=5)
    Clock(offset_ns=-3000000000, first_ns=0, last_ns=5, known=True)

    """

    offset_ns: int
    first_ns: int
    last_ns: int
    known: bool


OWN = Clock(0, 0, 0, True)


class SenderClocks(NamedTuple):
    """
    What is known of the clocks of senders; a value: :meth:`update` returns a new one.

    Parameters
    ----------
    timeout_ns : int
        Age [ns] at which a message is old; clocks are told apart to half of it.
    clocks : tuple of Clock
        The latest last; one of them is known.
    given_ns : int or None
        Offset [ns] of a clock that is known beforehand, and not forgotten; None: of none.

    Examples
    --------
    A sender on the own clock, then one whose clock is 3 s ahead; messages take 2 ms:

    >>> clocks, age_ns = SenderClocks(timeout_ns=500_000_000).update(2_000_000, 0)
    >>> age_ns, clocks.agree()
    (2000000, True)
    >>> clocks, age_ns = clocks.update(-2_998_000_000, 10_000_000)
    >>> age_ns, clocks.agree(), [clock.offset_ns for clock in clocks.clocks]
    (0, False, [0, -2998000000])
    >>> clocks.update(-1_998_000_000, 20_000_000)[1]  # 1 s later than the first one
    1000000000

    """

    timeout_ns: int
    clocks: Tuple[Clock, ...] = (OWN,)
    given_ns: Optional[int] = None

    def update(self, latency_ns: int, arrival_ns: int) -> Tuple['SenderClocks', int]:
        """
        Return the clocks after a message, and its age.

        Parameters
        ----------
        latency_ns : int
            Own clock at its arrival less the sender's when it was sent [ns].
        arrival_ns : int
            Time of its arrival [ns] on a steady clock.

        Returns
        -------
        clocks : SenderClocks
            What is known of the clocks then.
        age_ns : int
            The least age [ns] that a known clock explains, 0 or above.

        Examples
        --------
        See :class:`SenderClocks`.

        """
        half, clocks = self.timeout_ns // 2, self.clocks
        if self.given_ns is not None:
            clocks = (Clock(self.given_ns, arrival_ns, arrival_ns, True), *clocks)
        clock = max((clock for clock in clocks
                     if clock.known and clock.offset_ns <= latency_ns + half), default=None)
        if clock is None:
            return self._with(Clock(latency_ns, arrival_ns, arrival_ns, True)), 0
        age = max(0, latency_ns - clock.offset_ns)
        if age <= half:
            return self._with(clock._replace(last_ns=arrival_ns), clock), age
        doubt = self._doubt(latency_ns, arrival_ns)
        if doubt is None:
            return self._with(Clock(latency_ns, arrival_ns, arrival_ns, False)), age
        least = min(latency_ns, doubt.offset_ns)
        known = arrival_ns - doubt.first_ns >= WHILE_NS
        return (self._with(Clock(least, doubt.first_ns, arrival_ns, known), doubt),
                latency_ns - least if known else age)

    def agree(self) -> bool:
        """
        Return whether all senders are on the own clock, as far as is known.

        Returns
        -------
        bool
            False where another clock is known or in doubt.

        Examples
        --------
        See :class:`SenderClocks`.

        """
        return len(self.clocks) == 1 and self.clocks[0].offset_ns == 0

    def clock_stepped(self, step_ns: int) -> 'SenderClocks':
        """
        Return the clocks after the own one was stepped: some senders' were, and some not.

        Parameters
        ----------
        step_ns : int
            By how much the own clock was stepped [ns], negative where it was set back.

        Returns
        -------
        SenderClocks
            With the latest ones that were known, each as stepped and as not stepped.

        Examples
        --------
        >>> clocks = SenderClocks(timeout_ns=500_000_000).clock_stepped(3_000_000_000)
        >>> [clock.offset_ns for clock in clocks.clocks]
        [3000000000, 0]

        """
        known = [clock for clock in self.clocks if clock.known][-MOST // 2:]
        stepped = [clock._replace(offset_ns=clock.offset_ns + step_ns) for clock in known]
        return self._replace(clocks=(*stepped, *known))

    def _doubt(self, latency_ns: int, arrival_ns: int) -> Optional[Clock]:
        """Return the clock in doubt of which a message may be."""
        return next((
            clock for clock in self.clocks
            if not clock.known and abs(latency_ns - clock.offset_ns) <= EQUALLY_NS
            and arrival_ns - clock.last_ns <= GAP_NS + self.timeout_ns), None)

    def _with(self, new: Clock, old: Optional[Clock] = None) -> 'SenderClocks':
        """Return the clocks with a new one, in the place of an old one, as the latest."""
        since_ns = new.last_ns - REMEMBERED_NS - 4 * self.timeout_ns
        kept = [clock for clock in self.clocks
                if clock is not old and (not new.known or clock.last_ns >= since_ns)]
        if len(kept) >= MOST:
            doubts = [clock for clock in kept if not clock.known]
            kept.remove(doubts[0] if doubts else kept[0])
        return self._replace(clocks=(*kept, new))
