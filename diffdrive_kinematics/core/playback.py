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

"""A course of velocity commands with the times at which each begins: LaValle, eq. 2.11."""

from dataclasses import dataclass
from typing import List, NamedTuple, Sequence, Tuple

from diffdrive_kinematics.core.checks import check_finite
from diffdrive_kinematics.core.sequence import check_times, Command

__all__ = ['Course', 'TimedTwist', 'course_from_commands', 'course_from_recording']

NANOSECONDS = 1e9


class TimedTwist(NamedTuple):
    """A twist (v [m/s], w [rad/s]) that holds from ``offset_ns`` after the start."""

    offset_ns: int
    v: float
    w: float


@dataclass(frozen=True)
class Course:
    """
    Twists by the time at which they begin; the last one is zero and ends the course.

    ``duplicates`` counts the rows that a later row with the same time has replaced.
    """

    twists: Tuple[TimedTwist, ...]
    duplicates: int = 0

    @property
    def length_ns(self) -> int:
        """Return the duration [ns] of the course."""
        return self.twists[-1].offset_ns

    def due(self, first: int, elapsed_ns: int) -> Tuple[TimedTwist, ...]:
        """Return the twists from index ``first`` on that begin by ``elapsed_ns``."""
        end = first
        while end < len(self.twists) and self.twists[end].offset_ns <= elapsed_ns:
            end += 1
        return self.twists[first:end]

    def commands(self) -> List[Command]:
        """Return the course as commands with durations [s]."""
        return [
            Command(a.v, a.w, (b.offset_ns - a.offset_ns) / NANOSECONDS)
            for a, b in zip(self.twists, self.twists[1:])]


def course_from_commands(commands: Sequence[Command]) -> Course:
    """
    Return the course of commands one after the other.

    Raises
    ------
    ValueError
        If there are none, or they last no time.

    """
    if not commands:
        raise ValueError('commands is empty, expected at least one (v, omega, duration)')
    offset_ns = 0
    twists = []
    for command in commands:
        twists.append(TimedTwist(offset_ns, command.v, command.w))
        offset_ns += round(command.duration * NANOSECONDS)
    if not offset_ns:
        raise ValueError('commands last 0 s, expected a duration above 0 of at least one')
    return Course((*twists, TimedTwist(offset_ns, 0.0, 0.0)))


def course_from_recording(rows: Sequence[Tuple[float, float, float]]) -> Course:
    """
    Return the course of recorded rows (time [s], v [m/s], w [rad/s]).

    Each row holds until the next; the course starts at the first row's time and ends, with
    zero, at the last row's.  Of rows with the same time the last one wins.

    Raises
    ------
    ValueError
        If there are none, a value is not finite or times decrease; rows count from 1.

    """
    if not rows:
        raise ValueError('the recording has no rows, expected at least one')
    check_times([row[0] for row in rows])
    for number, (_, v, w) in enumerate(rows, start=1):
        check_finite(f'linear_x in row {number}', v)
        check_finite(f'angular_z in row {number}', w)
    begin = rows[0][0]
    by_time = {
        offset_ns: TimedTwist(offset_ns, v, w)
        for offset_ns, v, w in (
            (round((time - begin) * NANOSECONDS), v, w) for time, v, w in rows)}
    if len(by_time) == 1:
        raise ValueError('the recording has one time only, expected at least two')
    twists = [*by_time.values()]
    twists[-1] = TimedTwist(twists[-1].offset_ns, 0.0, 0.0)
    return Course(tuple(twists), duplicates=len(rows) - len(by_time))
