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

"""A publisher of joints, told from others by its tag and by the numbers of its messages."""

import math
from typing import NamedTuple, Optional, Sequence, Tuple

LARGEST_GAP = 100  # messages that are lost without a silence; who is further ahead is another one
FASTEST_NS = 500_000  # between messages: what a silence may have swallowed
TAKEOVER_NS = 500_000_000  # of silence, where a single publisher is known
STANDS = 1e-3  # [rad, rad/s]


class JointMessage(NamedTuple):
    """
    What a message says, and who sent it when.

    Parameters
    ----------
    tag : str
        Name by which the publisher marks its messages; empty: none.
    joints : tuple of int
        Which joints the message is about.
    number : int
        Among the messages of its publisher; 0: unknown.
    now_ns : int
        Time of arrival [ns].
    positions, rates : sequence of float
        Of the joints [rad, rad/s]; empty: absent.

    Examples
    --------
    >>> JointMessage('', (0, 1), number=7, now_ns=20_000_000, positions=(0.5, 0.25)).rates
    ()

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

    Parameters
    ----------
    first, last : JointMessage
        Its first message, which tells it from all others, and its last one.
    moved : bool
        Whether it has ever said that a joint moves.
    gap : tuple of (JointMessage, JointMessage), optional
        The messages before and after the last gap of its numbers: what comes in between tells that
        from there on it was another publisher.

    Examples
    --------
    A publisher of both wheels whose second message did not come:

    >>> first = JointMessage('', (0, 1), number=1, now_ns=0, positions=(0.0, 0.0))
    >>> third = JointMessage('', (0, 1), number=3, now_ns=40_000_000, positions=(0.5, 0.25))
    >>> source = Source(first, first)
    >>> source.ahead(third), source.distance(third), source.silent(third.now_ns)
    (2, 0.5, 40000000)
    >>> source = source.with_message(third)
    >>> source.moved, source.gap == (first, third)
    (True, True)

    The number comes after all, so there are two publishers:

    >>> len(source.parted(third._replace(number=2, now_ns=45_000_000)))
    2

    """

    first: JointMessage
    last: JointMessage
    moved: bool = False
    gap: Optional[Tuple[JointMessage, JointMessage]] = None

    def ahead(self, received: JointMessage) -> int:
        """
        Return how many messages after the last one it would be; 0: it is not this one's.

        Parameters
        ----------
        received : JointMessage
            The message.

        Returns
        -------
        int
            1 for the next one, and where numbers are unknown.

        Examples
        --------
        See :class:`Source`.

        """
        last = self.last
        if received.tag != last.tag or received.joints != last.joints:
            return 0
        if not received.number or not last.number:
            return 1
        ahead, silent = received.number - last.number, self.silent(received.now_ns)
        return ahead if 0 < ahead and (
            ahead <= LARGEST_GAP + silent // FASTEST_NS or silent > TAKEOVER_NS) else 0

    def parted(self, received: JointMessage) -> 'Tuple[Source, ...]':
        """
        Return the source as the two that it is where a message comes from within its gap.

        Parameters
        ----------
        received : JointMessage
            The message.

        Returns
        -------
        tuple of Source
            The one before the gap and the one after it; the source alone where it is one.

        Examples
        --------
        See :class:`Source`.

        """
        if self.gap and received.tag == self.last.tag and received.joints == self.last.joints \
                and self.gap[0].number < received.number < self.gap[1].number:
            return Source(self.first, self.gap[0], self.moved), Source(self.gap[1], self.last)
        return self,

    def precedes(self, received: JointMessage) -> bool:
        """
        Tell whether a message about other joints seems to come from the same publisher.

        Parameters
        ----------
        received : JointMessage
            The message.

        Returns
        -------
        bool
            True where the tags are the same and the number, if known, is the next one.

        Examples
        --------
        >>> left = JointMessage('', (0,), number=1, now_ns=0)
        >>> right = JointMessage('', (1,), number=2, now_ns=3_000_000)
        >>> Source(left, left).precedes(right), Source(left, left).precedes(left)
        (True, False)

        """
        last = self.last
        return received.tag == last.tag and received.joints != last.joints and (
            not received.number or received.number == last.number + 1)

    def distance(self, received: JointMessage) -> float:
        """
        Return how far the positions of a message are from the last ones.

        Parameters
        ----------
        received : JointMessage
            The message, about the same joints.

        Returns
        -------
        float
            The largest distance of a joint [rad]; 0 where no two positions are known.

        Examples
        --------
        See :class:`Source`.

        """
        apart = [abs(a - b) for a, b in zip(received.positions, self.last.positions)]
        return max((each for each in apart if not math.isnan(each)), default=0.0)

    def with_message(self, received: JointMessage) -> 'Source':
        """
        Return the source after a message.

        Parameters
        ----------
        received : JointMessage
            The message, which is of this source.

        Returns
        -------
        Source
            The source, of which this message is the last one.

        Examples
        --------
        See :class:`Source`.

        """
        moved = self.moved or any(abs(rate) > STANDS for rate in received.rates) or any(
            abs(a - b) > STANDS for a, b in zip(received.positions, self.first.positions))
        gap = self.gap
        if received.number > self.last.number + 1:
            gap = self.last, received
        return Source(self.first, received, moved, gap)

    def silent(self, now_ns: int) -> int:
        """
        Return for how long it has said nothing; a step of the clock counts as silence.

        Parameters
        ----------
        now_ns : int
            The time [ns].

        Returns
        -------
        int
            How long [ns], 0 or above.

        Examples
        --------
        See :class:`Source`.

        """
        return abs(now_ns - self.last.now_ns)
