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
Several wheels of a side: one position of what each of them says.

Where all are heard and agree, a side's position is the mean of its wheels'.  A wheel that says
nothing (NaN) is left out, and the others go on from the position that the side has: nothing jumps
where wheels come and go, and nothing is lost.

Wheels of a side stand on the same ground, so they roll alike, but for some per cent of their
radii and of their slip.  How far each has gone is compared whenever one of them has gone
``LEAST_TRAVEL`` in ``LEAST_CHANGES`` changes of its reading (coarse encoders tick one after the
other).  Where two differ by more than ``SHARE`` of the longest way,

* of three or more, the few that differ from the median are left out;
* of two, or of equal parts, those that stand are left out while the other side moves: on a robot
  that moves a wheel turns, or its encoder does not say so.  Where the other side stands as well,
  the wheel that turns may be the one in the air: then all count.

A wheel that was left out takes part again once it agrees.  What it has spoilt since the
comparison before is made good.
"""

import math
from typing import NamedTuple, Optional, Sequence, Tuple

from diffdrive_kinematics.core.kinematics import is_sane
from diffdrive_kinematics.core.odometry.wheel_comparison import (
    Disagreement, Flags, Floats, judged, mean_of)

LEAST_TRAVEL = 0.5  # [rad]
LEAST_CHANGES = 8


class SideTrack(NamedTuple):
    """
    The wheels of one side; a value: :meth:`followed` returns a new one.

    Parameters
    ----------
    position : float
        Of the side [rad]; NaN until a wheel is heard.
    readings, offsets : tuple of float
        The last positions [rad] of the n wheels, and what makes the side's position of them; NaN:
        a wheel was not heard yet.
    used, left_out : tuple of bool
        Whose readings made the position, and whose do not, as they differ from the others'.
    changes : tuple of int
        How often each reading has changed since the comparison before.
    start, start_position, start_other : tuple of float, float, float
        Readings, position, and position of the other side at that comparison [rad]; a wheel that
        comes in later has gone as the side has until then.
    disagreement : Disagreement, optional
        What that comparison has shown; None: no difference.

    Examples
    --------
    The first of two wheels says that it stands, while the robot moves:

    >>> track = SideTrack.starting_at((0.0, 0.0), other=0.0)
    >>> for number in range(1, 9):
    ...     track, position = track.followed((0.0, 0.5 * number), other=0.5 * number)
    >>> track.disagreement
    Disagreement(travels=(0.0, 4.0), left_out=(True, False))
    >>> position  # all the way, as if the first wheel had not been there
    4.0

    """

    position: float
    readings: Floats
    offsets: Floats
    used: Flags
    left_out: Flags
    changes: Tuple[int, ...]
    start: Floats
    start_position: float
    start_other: float
    disagreement: Optional[Disagreement] = None

    @staticmethod
    def starting_at(readings: Sequence[float], other: float = math.nan) -> 'SideTrack':
        """
        Return the track that begins with readings.

        Parameters
        ----------
        readings : sequence of float, shape (n,)
            Positions of the wheels [rad]; NaN where one says nothing.
        other : float
            Position of the other side [rad], which may count from anywhere; NaN: not known.

        Returns
        -------
        SideTrack
            The track, whose position is the mean of those that are heard.

        Examples
        --------
        >>> SideTrack.starting_at((1.0, 2.0, math.nan)).position
        1.5

        """
        count = len(readings)
        used = tuple(map(is_sane, readings))
        known = tuple(reading if use else math.nan for reading, use in zip(readings, used))
        position = mean_of(known, used)
        return SideTrack(
            position, known, tuple(0.0 if use else math.nan for use in used), used,
            (False,) * count, (0,) * count, known, position, other)

    def followed(
            self, readings: Sequence[float], other: float = math.nan
    ) -> 'Tuple[SideTrack, float]':
        """
        Return the track after further readings, and the side's position.

        Parameters
        ----------
        readings : sequence of float, shape (n,)
            Positions of the wheels [rad]; NaN where one says nothing.
        other : float
            Position of the other side [rad], which may count from anywhere; NaN: not known.

        Returns
        -------
        track : SideTrack
            The track after them.
        position : float
            Of the side [rad]; NaN where no wheel says anything, and goes on once one does.

        Examples
        --------
        See :class:`SideTrack`.

        """
        if self.position != self.position:
            track = SideTrack.starting_at(readings, other)
            return track, track.position
        present = tuple(map(is_sane, readings))
        used = tuple(a and not b for a, b in zip(present, self.left_out))
        if not any(used):
            return self, math.nan
        track = self if used == self.used else self._regrouped(used)
        position = track._position_of(readings)
        return track._with(readings, present, position)._compared(present, other)

    def _position_of(self, readings: Sequence[float]) -> float:
        """Return the position [rad] by the wheels whose offsets are known."""
        voters = [reading + offset for reading, offset, use in zip(
            readings, self.offsets, self.used) if use and offset == offset]
        return sum(voters) / len(voters) if voters else self.position

    def _with(self, readings: Sequence[float], present: Flags, position: float) -> 'SideTrack':
        """Return the track with new readings and a new position [rad]."""
        known = tuple(new if here else old for new, old, here in zip(
            readings, self.readings, present))
        return self._replace(
            position=position, readings=known,
            changes=tuple(count + (new != old) for count, new, old in zip(
                self.changes, known, self.readings)),
            offsets=self._offsets(known, position, fresh_only=True),
            start=tuple(new - (position - self.start_position) if here and old != old else old
                        for new, old, here in zip(known, self.start, present)))

    def _offsets(self, readings: Floats, position: float, *, fresh_only: bool) -> Floats:
        """Return the offsets with those of the wheels in use that make the position [rad]."""
        return tuple(
            position - reading if use and (not fresh_only or offset != offset) else offset
            for reading, offset, use in zip(readings, self.offsets, self.used))

    def _regrouped(self, used: Flags) -> 'SideTrack':
        """Return the track for other wheels in use, which go on from where the side is."""
        return self._replace(
            used=used, offsets=self._offsets(self.readings, self.position, fresh_only=False))

    def _anew(self, present: Flags, other: float) -> 'SideTrack':
        """Return the track with a comparison that begins here, for the others where they come."""
        return self._replace(
            changes=(0,) * len(self.changes), start=tuple(
                reading if here else math.nan for reading, here in zip(self.readings, present)),
            start_position=self.position, start_other=other)

    def _compared(self, present: Flags, other: float) -> 'Tuple[SideTrack, float]':
        """Return the track with the wheels compared where they have gone far enough."""
        travels = tuple(b - a if here else math.nan for a, b, here in zip(
            self.start, self.readings, present))
        known = [travel for travel in travels if travel == travel]
        longest = max(map(abs, known))
        if longest < LEAST_TRAVEL or not any(
                abs(travel) == longest and count >= LEAST_CHANGES
                for travel, count in zip(travels, self.changes)):
            return self, self.position
        apart, left_out = judged(travels, known, self.left_out, abs(other - self.start_other))
        disagreement = Disagreement(travels, left_out) if apart else None
        track = self._replace(disagreement=disagreement)
        if left_out != self.left_out:
            track = track._without(left_out, present, travels)
        return track._anew(present, other), track.position

    def _without(self, left_out: Flags, present: Flags, travels: Floats) -> 'SideTrack':
        """Return the track with the way since the comparison before without those left out."""
        used = tuple(a and not b for a, b in zip(present, left_out))
        went_on = tuple(a and b for a, b in zip(used, self.used))
        position = self.position
        if any(a and b for a, b in zip(left_out, self.used)) and any(went_on):
            position = self.start_position + mean_of(travels, went_on)
        return self._replace(
            position=position, used=used, left_out=left_out, offsets=tuple(
                position - reading if use else math.nan
                for reading, use in zip(self.readings, used)))
