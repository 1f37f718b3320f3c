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
Whether the velocities of a driver are those of its positions.

They are compared by the travel of blocks of messages: velocities are filtered, hence late, and
positions are counted in ticks, so that a single message proves nothing.  In a block they agree
where both travels differ by no more than a fifth and one message's travel.  Where a late filter
can make the difference, of the range that the velocity has in the block, it proves nothing.

Velocities are believed from the first block in which they agree, until they are wrong by a factor
of two in one, or by less in three in a row.  Three in a row that are wrong in one way are a
disagreement to report.
"""

from typing import NamedTuple, Optional, Tuple

from diffdrive_kinematics.core.odometry.wheel_sample import WheelPair, ZERO

FEWEST = 10  # messages of a block,
SHORTEST_S = 0.5  # its duration
LONGEST_S = 5.0
ENOUGH = 0.5  # and travel [rad]
TOLERANCE = 0.2
LATE_S = 0.25
GROSS = 2.0
PERSISTENT = 3  # blocks


class Mismatch(NamedTuple):
    """
    What velocities and positions say of the same time.

    Parameters
    ----------
    side : str
        The wheel, or ``both``: ``left``, ``right``.
    reported, rolled : float
        Travel [rad] by the velocities and by the positions.

    Examples
    --------
    See :class:`VelocityCheck`.

    """

    side: str
    reported: float
    rolled: float


class VelocityCheck(NamedTuple):
    """
    What is known of a driver's velocities; a value: :meth:`followed` returns a new one.

    Parameters
    ----------
    believed : bool
        Whether they agreed with the positions when it was judged last.
    disagreement : Mismatch or None
        What they persistently differ by.
    against : tuple of Mismatch
        The last blocks in a row that disagreed.
    reported, rolled, largest, low, high : pair of float
        Of the block that is under way: travel by the velocities and by the positions [rad], the
        largest increment [rad], the lowest and the highest velocity [rad/s].
    messages, seconds : int, float
        Messages and duration [s] of it.
    rates : pair of float or None
        The last velocities [rad/s].

    Examples
    --------
    A driver that tells degrees for radians, in messages 1/16 s apart, and one that does not:

    >>> wrong = right = VelocityCheck()
    >>> for _ in range(50):
    ...     wrong = wrong.followed((60.0, 60.0), increments=(0.0625, 0.0625), seconds=0.0625)
    ...     right = right.followed((1.0, 1.0), increments=(0.0625, 0.0625), seconds=0.0625)
    >>> wrong.believed, right.believed
    (False, True)
    >>> wrong.disagreement == Mismatch('both', reported=112.5, rolled=1.875)
    True

    """

    believed: bool = False
    disagreement: Optional[Mismatch] = None
    against: Tuple[Mismatch, ...] = ()
    reported: WheelPair = ZERO
    rolled: WheelPair = ZERO
    largest: WheelPair = ZERO
    low: WheelPair = ZERO
    high: WheelPair = ZERO
    messages: int = 0
    seconds: float = 0.0
    rates: Optional[WheelPair] = None

    def followed(
            self, rates: Optional[WheelPair], increments: WheelPair, seconds: float
    ) -> 'VelocityCheck':
        """
        Return the check after one more message.

        Parameters
        ----------
        rates : pair of float or None
            Its velocities [rad/s]; None: it has none.
        increments : pair of float
            What was rolled [rad] since the message before.
        seconds : float
            Time [s] since the message before.

        Returns
        -------
        VelocityCheck
            What is known then.

        Examples
        --------
        See :class:`VelocityCheck`.

        """
        before = self.rates
        if rates is None or before is None:
            return self._replace(rates=rates)
        half = 0.5 * seconds
        low, high = (self.low, self.high) if self.messages else (before, before)
        check = VelocityCheck(
            self.believed, self.disagreement, self.against,
            (self.reported[0] + half * (before[0] + rates[0]),
             self.reported[1] + half * (before[1] + rates[1])),
            (self.rolled[0] + increments[0], self.rolled[1] + increments[1]),
            (max(self.largest[0], abs(increments[0])), max(self.largest[1], abs(increments[1]))),
            (min(low[0], rates[0]), min(low[1], rates[1])),
            (max(high[0], rates[0]), max(high[1], rates[1])),
            self.messages + 1, self.seconds + seconds, rates)
        if check.messages < FEWEST or check.seconds < SHORTEST_S:
            return check
        if max(map(abs, (*check.reported, *check.rolled))) >= ENOUGH:
            return check._judged()
        return check._anew() if check.seconds > LONGEST_S else check

    def _anew(self) -> 'VelocityCheck':
        return VelocityCheck(self.believed, self.disagreement, self.against, rates=self.rates)

    def _judged(self) -> 'VelocityCheck':
        """Return the check after a block with enough travel."""
        wrong = self._wrong(LATE_S)
        if wrong is None:
            return self._anew() if self._wrong(0.0) else VelocityCheck(True, rates=self.rates)
        against = self.against if self.against and _alike(self.against[-1], wrong) else ()
        against = (*against, wrong)[-PERSISTENT:]
        persistent = len(against) == PERSISTENT
        return self._anew()._replace(
            believed=self.believed and not (persistent or _grossly(wrong)), against=against,
            disagreement=_together(against) if persistent else self.disagreement)

    def _wrong(self, late: float) -> Optional[Mismatch]:
        """Return by what wheels disagree in the block with a filter that is late [s]; or None."""
        allowed = [largest + late * (high - low) for largest, low, high in zip(
            self.largest, self.low, self.high)]
        wrong = [Mismatch(side, reported, rolled) for side, reported, rolled, allowance in zip(
            ('left', 'right'), self.reported, self.rolled, allowed) if _differ(
                reported, rolled, allowance)]
        if len(wrong) == 2 and _alike(*wrong):
            return Mismatch('both', *max(
                (each[1:] for each in wrong), key=lambda travel: max(map(abs, travel))))
        return wrong[0] if wrong else None


def _together(blocks: Tuple[Mismatch, ...]) -> Mismatch:
    """Return what blocks disagree by, all in all."""
    sides = {block.side for block in blocks}
    return Mismatch(
        sides.pop() if len(sides) == 1 else 'both', sum(block.reported for block in blocks),
        sum(block.rolled for block in blocks))


def _differ(reported: float, rolled: float, allowance: float) -> bool:
    travel = max(abs(reported), abs(rolled))
    return travel >= ENOUGH and abs(reported - rolled) > TOLERANCE * travel + allowance


def _alike(one: Mismatch, other: Mismatch) -> bool:
    """Tell whether two blocks are wrong in the same way."""
    return _way(one) == _way(other)


def _grossly(wrong: Mismatch) -> bool:
    """Tell whether a block is wrong by more than a factor, or by sign."""
    low, high = sorted((abs(wrong.reported), abs(wrong.rolled)))
    return wrong.reported * wrong.rolled < 0.0 or high > GROSS * low


def _way(wrong: Mismatch) -> str:
    if wrong.reported * wrong.rolled < 0.0:
        return 'sign'
    return 'more' if abs(wrong.reported) > abs(wrong.rolled) else 'less'
