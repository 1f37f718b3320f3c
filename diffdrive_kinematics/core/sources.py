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
Which of several publishers of the same joints is believed.

Two publishers of the same wheels cannot both be right, and what they say in turn is no motion.
They are told apart by the tag that their messages carry, and by the numbers that the middleware
gives to the messages of each publisher: those of one go up, one by one where none is lost.

* A publisher that begins where another one has been silent takes its place, and so does one with
  a tag of its own, which is a restart as far as is known.
* Where both go on, the one that moves is believed before one that never did (a node that
  publishes zeros), and else the one that was there first; it has to be silent for longer before
  the other one takes its place.
* Publishers of different joints (the left wheel and the right one) do not disturb each other.
"""

import math
from typing import NamedTuple, Optional, Sequence, Tuple

__all__ = ['Source', 'Sources', 'Spoken']

LARGEST_GAP = 100  # messages that are lost without a silence; who is further ahead is another one
TAKEOVER_NS = 500_000_000  # of silence, where a single publisher is known
CONTESTED_TAKEOVER_NS = 2_000_000_000  # of silence, where two have spoken in turn
CONTEST_NS = 5_000_000_000  # for which it is reported after the last sign of it
FORGOTTEN_NS = 10_000_000_000
MOST_SOURCES = 8
STANDS = 1e-3  # [rad, rad/s]
NEVER_NS = -10**20


class Spoken(NamedTuple):
    """
    A message as it came: who says what, and when.

    Parameters
    ----------
    tag : str
        What the publisher says of itself; empty: nothing.
    joints : tuple of int
        Which joints the message is about.
    number : int
        Among the messages of its publisher; 0: unknown.
    now_ns : int
        Time of arrival [ns].
    positions, rates : sequence of float
        Of the joints [rad, rad/s]; empty: absent.

    """

    tag: str
    joints: Tuple[int, ...]
    number: int
    now_ns: int
    positions: Sequence[float] = ()
    rates: Sequence[float] = ()


class Source(NamedTuple):
    """
    A publisher of some joints: its first message, its last one, and whether it ever moved.

    ``gap`` are the messages before and after the last gap of its numbers, if any: what comes in
    between tells that from there on it was another publisher.
    """

    first: Spoken
    last: Spoken
    moved: bool = False
    gap: Optional[Tuple[Spoken, Spoken]] = None

    def ahead(self, spoken: Spoken) -> int:
        """Return how many messages after the last one it would be; 0: it is not this one's."""
        last = self.last
        if spoken.tag != last.tag or spoken.joints != last.joints:
            return 0
        if not spoken.number or not last.number:
            return 1
        ahead = spoken.number - last.number
        return ahead if 0 < ahead and (
            ahead <= LARGEST_GAP or self.silent(spoken.now_ns) > TAKEOVER_NS) else 0

    def parted(self, spoken: Spoken) -> 'Tuple[Source, ...]':
        """Return the source as the two that it is where a message comes from within its gap."""
        if self.gap and spoken.tag == self.last.tag and spoken.joints == self.last.joints \
                and self.gap[0].number < spoken.number < self.gap[1].number:
            return (Source(self.first, self.gap[0], self.moved),
                    Source(self.gap[1], self.last))
        return self,

    def precedes(self, spoken: Spoken) -> bool:
        """Tell whether a message about other joints seems to come from the same publisher."""
        last = self.last
        return spoken.tag == last.tag and spoken.joints != last.joints and (
            not spoken.number or spoken.number == last.number + 1)

    def distance(self, spoken: Spoken) -> float:
        """Return how far [rad] the positions of a message are from the last ones."""
        apart = [abs(a - b) for a, b in zip(spoken.positions, self.last.positions)]
        return max((each for each in apart if not math.isnan(each)), default=0.0)

    def speaking(self, spoken: Spoken) -> 'Source':
        """Return the source after a message."""
        moved = self.moved or any(abs(rate) > STANDS for rate in spoken.rates) or any(
            abs(a - b) > STANDS for a, b in zip(spoken.positions, self.first.positions))
        gap = self.gap
        if spoken.number > self.last.number + 1:
            gap = self.last, spoken
        return Source(self.first, spoken, moved, gap)

    def silent(self, now_ns: int) -> int:
        """Return for how long [ns] it has said nothing; a step of the clock counts as silence."""
        return abs(now_ns - self.last.now_ns)


class Sources(NamedTuple):
    """
    The publishers that were heard, in the order in which they began.

    ``owners`` are the sources believed, by the first message of each, which is unique;
    ``contested_ns`` is when two of the same joints last spoke in turn; ``ignored`` counts the
    messages that were not believed.
    """

    known: Tuple[Source, ...] = ()
    owners: Tuple[Spoken, ...] = ()
    contested_ns: int = NEVER_NS
    ignored: int = 0

    def heard(self, spoken: Spoken) -> Tuple['Sources', bool]:
        """Return the sources after a message, and whether it is believed."""
        parted = tuple(part for each in self.known for part in each.parted(spoken))
        if len(parted) > len(self.known):
            return self._replace(known=parted).heard(spoken)
        source = self._source_of(spoken)
        before = source.last if source else spoken
        source = (source or Source(spoken, spoken)).speaking(spoken)
        known = self._with(source, spoken)
        others = [each for each in known if each.first is not source.first
                  and not set(each.first.joints).isdisjoint(spoken.joints)
                  and not each.precedes(spoken)]
        rivals = [each for each in others if each.first in self.owners]
        contested_ns = self.contested_ns
        if before is not spoken and _in_turn(before, spoken, others):
            contested_ns = spoken.now_ns
        result = Sources(known, self.owners, contested_ns, self.ignored)
        if not all(result._gives_way(rival, source) for rival in rivals):
            return result._replace(ignored=self.ignored + 1), False
        lost = [rival.first for rival in rivals]
        owners = tuple(each for each in self.owners if each not in lost)
        if source.first not in owners:
            owners += (source.first,)
        return result._replace(owners=owners), True

    def caught_up(self, spoken: Spoken) -> 'Sources':
        """Return the sources after more messages of the only one, of which this is the last."""
        source, = self.known
        return self._replace(known=(source.speaking(spoken)._replace(gap=source.gap),))

    def contested(self, now_ns: int) -> bool:
        """Return whether two publishers of the same joints have spoken in turn of late."""
        return abs(now_ns - self.contested_ns) < CONTEST_NS

    def _source_of(self, spoken: Spoken) -> Optional[Source]:
        """Return the source that a message belongs to: the one whose number it follows."""
        found = [(ahead, source.distance(spoken), place)
                 for place, source in enumerate(self.known) if (ahead := source.ahead(spoken))]
        return self.known[min(found)[2]] if found else None

    def _with(self, source: Source, spoken: Spoken) -> Tuple[Source, ...]:
        """Return the known sources with this one as it is now, without those long silent."""
        kept = tuple(
            source if each.first is source.first else each for each in self.known
            if each.first in self.owners or each.silent(spoken.now_ns) < FORGOTTEN_NS)
        if any(each is source for each in kept):
            return kept
        return (*kept, source)[-MOST_SOURCES:]

    def _gives_way(self, rival: Source, source: Source) -> bool:
        """Tell whether a source that is believed gives way to another one that speaks now."""
        contested = self.contested(source.last.now_ns)
        if rival.silent(source.last.now_ns) > (
                CONTESTED_TAKEOVER_NS if contested else TAKEOVER_NS):
            return True
        if not contested and source.first is source.last and source.first.tag not in (
                '', rival.first.tag):
            return True
        if source.moved != rival.moved:
            return source.moved
        return contested and self._place(source) < self._place(rival)

    def _place(self, source: Source) -> int:
        return next(place for place, each in enumerate(self.known)
                    if each.first is source.first)


def _in_turn(before: Spoken, spoken: Spoken, others: Sequence[Source]) -> bool:
    """Tell whether one of the others has spoken since a source did before."""
    return any(before.now_ns <= each.last.now_ns
               and each.silent(spoken.now_ns) < CONTESTED_TAKEOVER_NS for each in others)
