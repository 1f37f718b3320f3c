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
from itertools import pairwise
from typing import List, NamedTuple, Sequence, Tuple

from diffdrive_kinematics.core.kinematics import check_finite, check_times, Command, NANOSECONDS


class TimedTwist(NamedTuple):
    """
    A twist that holds from a time after the start of a course.

    Parameters
    ----------
    offset_ns : int
        Time from the start of the course [ns].
    v : float
        Forward speed [m/s].
    w : float
        Yaw rate [rad/s], counter-clockwise positive.

    Examples
    --------
    >>> TimedTwist(offset_ns=2_000_000_000, v=0.5, w=0.0)
    TimedTwist(offset_ns=2000000000, v=0.5, w=0.0)

    """

    offset_ns: int
    v: float
    w: float


@dataclass(frozen=True)
class Course:
    """
    Twists by the time at which they begin; the last one is zero and ends the course.

    Parameters
    ----------
    twists : tuple of TimedTwist
        By rising times, the first one at 0.
    duplicates : int
        Rows of a recording that a later row with the same time has replaced.

    Examples
    --------
    >>> Course((TimedTwist(0, 0.5, 0.0), TimedTwist(2_000_000_000, 0.0, 0.0))).length_ns
    2000000000

    """

    twists: Tuple[TimedTwist, ...]
    duplicates: int = 0

    @property
    def length_ns(self) -> int:
        """Return the duration [ns] of the course."""
        return self.twists[-1].offset_ns

    def due(self, first: int, elapsed_ns: int) -> Tuple[TimedTwist, ...]:
        """
        Return the twists from index ``first`` on that begin by ``elapsed_ns``.

        Parameters
        ----------
        first : int
            Index of the first twist that has not been due yet.
        elapsed_ns : int
            Time since the start of the course [ns].

        Returns
        -------
        tuple of TimedTwist
            Twists that are due, in order; empty where none is.

        Examples
        --------
        >>> course = course_from_commands([Command(0.5, 0.0, 2.0), Command(0.0, 1.0, 1.0)])
        >>> course.due(1, elapsed_ns=2_500_000_000)
        (TimedTwist(offset_ns=2000000000, v=0.0, w=1.0),)

        """
        end = first
        while end < len(self.twists) and self.twists[end].offset_ns <= elapsed_ns:
            end += 1
        return self.twists[first:end]

    def commands(self) -> List[Command]:
        """
        Return the course as commands with durations.

        Returns
        -------
        list of Command
            One for each twist but the last.

        Examples
        --------
        >>> course_from_recording([(10.0, 0.5, 0.0), (12.0, 0.0, 0.0)]).commands()
        [Command(v=0.5, w=0.0, duration=2.0)]

        """
        return [
            Command(a.v, a.w, (b.offset_ns - a.offset_ns) / NANOSECONDS)
            for a, b in pairwise(self.twists)]


def course_from_commands(commands: Sequence[Command]) -> Course:
    """
    Return the course of commands one after the other.

    Parameters
    ----------
    commands : sequence of Command
        Commands, in order.

    Returns
    -------
    Course
        It begins with the first command and ends, with zero, when the last one is over.

    Raises
    ------
    ValueError
        If there are none, or they last no time.

    Examples
    --------
    >>> course_from_commands([Command(0.5, 0.0, 2.0), Command(0.0, 1.0, 1.0)]).length_ns
    3000000000

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
    Return the course of recorded commands.

    Each row holds until the next; the course starts at the first row's time and ends, with
    zero, at the last row's.  Of rows with the same time the last one wins.

    Parameters
    ----------
    rows : sequence of tuple of float
        Rows (time [s], v [m/s], w [rad/s]), by rising times.

    Returns
    -------
    Course
        It begins at 0, whatever the first time.

    Raises
    ------
    ValueError
        If there are none, a value is not finite or times decrease; rows count from 1.

    Examples
    --------
    >>> course = course_from_recording([(10.0, 0.5, 0.0), (12.0, 0.0, 1.0), (13.0, 0.0, 1.0)])
    >>> course.twists[1]
    TimedTwist(offset_ns=2000000000, v=0.0, w=1.0)

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
