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
Which of several publishers of the same joints is used.

Two publishers of the same wheels cannot both be right, and their mixed messages are no motion.
They are told apart by the tag that their messages carry, and by the numbers that the middleware
gives to the messages of each publisher: those of one go up, one by one where none is lost.

* A publisher that begins where another one has been silent takes its place, and so does one with
  a tag of its own, which is a restart as far as is known.
* Where both go on, the one that moves is used rather than one that never did (a node that
  publishes zeros), and else the one that was there first; it has to be silent for longer before
  the other one takes its place.
* Publishers of different joints (the left wheel and the right one) do not disturb each other.
"""

from typing import NamedTuple, Optional, Sequence, Tuple

from diffdrive_kinematics.core.odometry.source import JointMessage, Source, TAKEOVER_NS

CONTESTED_TAKEOVER_NS = 2_000_000_000  # of silence, where two have sent in turn
CONTEST_NS = 5_000_000_000  # for which it is reported after the last sign of it
FORGOTTEN_NS = 10_000_000_000
MOST_SOURCES = 8
NEVER_NS = -10**20


class Sources(NamedTuple):
    """
    The publishers of some joints; a value: :meth:`update` returns a new one.

    Parameters
    ----------
    known : tuple of Source
        In the order in which they began.
    owners : tuple of JointMessage
        The sources that are used, by the first message of each, which is unique.
    contested_ns : int
        When two of the same joints last spoke in turn [ns].
    ignored : int
        How many messages were not used.

    Examples
    --------
    A driver, and a node that publishes zeros beside it:

    >>> sources = Sources()
    >>> for number in range(1, 5):
    ...     moved = JointMessage(
    ...         '', (0, 1), number, 20_000_000 * number, (0.5 * number, 0.5 * number))
    ...     zeros = JointMessage('', (0, 1), 900 + number, moved.now_ns + 9_000_000, (0.0, 0.0))
    ...     sources, moved_believed = sources.update(moved)
    ...     sources, zeros_believed = sources.update(zeros)
    >>> moved_believed, zeros_believed, sources.ignored, sources.contested(zeros.now_ns)
    (True, False, 4, True)

    """

    known: Tuple[Source, ...] = ()
    owners: Tuple[JointMessage, ...] = ()
    contested_ns: int = NEVER_NS
    ignored: int = 0

    def update(self, received: JointMessage) -> Tuple['Sources', bool]:
        """
        Return the sources after a message, and whether it is used.

        Parameters
        ----------
        received : JointMessage
            The message.

        Returns
        -------
        sources : Sources
            The sources after it.
        believed : bool
            Whether it is of a source that is used.

        Examples
        --------
        See :class:`Sources`.

        """
        parted = tuple(part for each in self.known for part in each.parted(received))
        if len(parted) > len(self.known):
            return self._replace(known=parted).update(received)
        source = self._source_of(received)
        before = source.last if source else received
        source = (source or Source(received, received)).with_message(received)
        known = self._with(source, received)
        others = [each for each in known if each.first is not source.first
                  and not set(each.first.joints).isdisjoint(received.joints)
                  and not each.precedes(received)]
        rivals = [each for each in others if each.first in self.owners]
        contested_ns = self.contested_ns
        if before is not received and _in_turn(before, received, others):
            contested_ns = received.now_ns
        result = Sources(known, self.owners, contested_ns, self.ignored)
        if not all(result._gives_way(rival, source) for rival in rivals):
            return result._replace(ignored=self.ignored + 1), False
        lost = [rival.first for rival in rivals]
        owners = tuple(each for each in self.owners if each not in lost)
        if source.first not in owners:
            owners += (source.first,)
        return result._replace(owners=owners), True

    def caught_up(self, received: JointMessage) -> 'Sources':
        """
        Return the sources after more messages of the only one, of which this is the last.

        Parameters
        ----------
        received : JointMessage
            The last one of the messages; those before it are no gap.

        Returns
        -------
        Sources
            The sources after them.

        Raises
        ------
        ValueError
            If none is known, or more than one.

        Examples
        --------
        >>> first = JointMessage('', (0, 1), number=1, now_ns=0)
        >>> sources, _ = Sources().update(first)
        >>> source, = sources.caught_up(first._replace(number=9, now_ns=160_000_000)).known
        >>> source.last.number, source.gap
        (9, None)

        """
        source, = self.known
        return self._replace(known=(source.with_message(received)._replace(gap=source.gap),))

    def contested(self, now_ns: int) -> bool:
        """
        Return whether two publishers of the same joints have sent in turn of late.

        Parameters
        ----------
        now_ns : int
            The time [ns].

        Returns
        -------
        bool
            True for ``CONTEST_NS`` after the last sign of it.

        Examples
        --------
        See :class:`Sources`.

        """
        return abs(now_ns - self.contested_ns) < CONTEST_NS

    def _source_of(self, received: JointMessage) -> Optional[Source]:
        """
        Return the source that a message belongs to: the one whose number it follows.

        One that has lost its place by its silence is only asked where no other one fits: a
        restarted publisher counts past its predecessor.
        """
        longest_ns = self._takeover_ns(received.now_ns)
        found = [
            (source.silent(received.now_ns) > longest_ns, ahead, source.distance(received), place)
            for place, source in enumerate(self.known) if (ahead := source.ahead(received))]
        return self.known[min(found)[-1]] if found else None

    def _takeover_ns(self, now_ns: int) -> int:
        """Return after what silence [ns] a source gives way to another one."""
        return CONTESTED_TAKEOVER_NS if self.contested(now_ns) else TAKEOVER_NS

    def _with(self, source: Source, received: JointMessage) -> Tuple[Source, ...]:
        """Return the known sources with this one as it is now, without those long silent."""
        kept = tuple(
            source if each.first is source.first else each for each in self.known
            if each.first in self.owners or each.silent(received.now_ns) < FORGOTTEN_NS)
        if any(each is source for each in kept):
            return kept
        spare = [each.first for each in kept if each.first not in self.owners]
        forgotten = spare[:max(0, len(kept) + 1 - MOST_SOURCES)]
        return (*(each for each in kept if each.first not in forgotten), source)

    def _gives_way(self, rival: Source, source: Source) -> bool:
        """Tell whether a source that is used gives way to another one that speaks now."""
        contested = self.contested(source.last.now_ns)
        if rival.silent(source.last.now_ns) > self._takeover_ns(source.last.now_ns):
            return True
        if not contested and source.first is source.last and source.first.tag not in (
                '', rival.first.tag):
            return True
        if source.moved != rival.moved:
            return source.moved
        return contested and self._place(source) < self._place(rival)

    def _place(self, source: Source) -> int:
        return next(place for place, each in enumerate(self.known) if each.first is source.first)


def _in_turn(before: JointMessage, received: JointMessage, others: Sequence[Source]) -> bool:
    """Tell whether one of the others has sent since a source did before."""
    return any(before.now_ns <= each.last.now_ns
               and each.silent(received.now_ns) < CONTESTED_TAKEOVER_NS for each in others)
