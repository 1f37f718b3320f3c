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
The square of UMBmark: Borenstein & Feng 1996, IEEE Trans. Robotics and Automation 12(6).

It starts at a corner, along the x axis of the start, and has four equal sides.  A turn follows
each of them, the last one included, so that the robot ends in the pose in which it started.
"""

import math
from typing import List, NamedTuple, Tuple

from diffdrive_kinematics.core.kinematics import (
    check_count, check_length, check_non_negative, check_positive, Command)

QUARTER = 0.5 * math.pi
SHORTEST_REST_S = 1.0


class SquareRun(NamedTuple):
    """
    A run around the square within a course.

    Parameters
    ----------
    clockwise : bool
        Whether it turns right.
    end : float
        When the robot rests after it [s], from the start of the course.

    Examples
    --------
    >>> SquareRun(clockwise=True, end=28.5).clockwise
    True

    """

    clockwise: bool
    end: float


def square_course(
        *, side: float, speed: float, yaw_rate: float, clockwise: bool,
        corner_radius: float = 0.0, pause: float = 0.0) -> List[Command]:
    """
    Return the commands that drive once around the square.

    Sharp corners are turns on the spot.  Rounded ones are quarter circles that touch the sides:
    the course starts where the last of them ends, ``corner_radius`` from the corner, and each
    straight stretch has a length of ``side - 2 * corner_radius`` (none where that is 0).

    Parameters
    ----------
    side : float
        Side of the square [m].
    speed, yaw_rate : float
        Speed of the straight stretches [m/s] and rate of the turns on the spot [rad/s]; bounds
        of both on rounded corners, which are driven as fast as they allow.
    clockwise : bool
        Turn right instead of left.
    corner_radius : float
        Radius of rounded corners [m], at most half the side; 0 = sharp ones.
    pause : float
        Rest between two motions [s].

    Returns
    -------
    list of Command
        Straight stretches and corners in turn, the last corner included.

    Raises
    ------
    ValueError
        If a value is out of its range.

    Examples
    --------
    >>> course = square_course(side=4.0, speed=0.5, yaw_rate=0.5, clockwise=True)
    >>> len(course), course[0]
    (8, Command(v=0.5, w=0.0, duration=8.0))

    """
    check_length('side', side)
    check_positive('speed', speed)
    check_positive('yaw_rate', yaw_rate)
    check_non_negative('pause', pause)
    if check_non_negative('corner_radius', corner_radius) > 0.5 * side:
        raise ValueError(
            f'corner_radius is {corner_radius!r}, expected at most half the side, {0.5 * side!r}')
    motions = 4 * [
        *_straight(side - 2.0 * corner_radius, speed),
        _corner(corner_radius, speed, -yaw_rate if clockwise else yaw_rate)]
    if not pause:
        return motions
    rest = Command(0.0, 0.0, pause)
    return [motions[0], *(command for motion in motions[1:] for command in (rest, motion))]


def square_rounds(
        rounds: int, *, side: float, speed: float, yaw_rate: float, corner_radius: float = 0.0,
        pause: float = 0.0) -> Tuple[List[Command], List[SquareRun]]:
    """
    Return the commands that drive around the square several times each way, clockwise first.

    The robot rests after each run, for twice the pause and a second at least, and is not put
    back: the return error of a run counts from the pose in which it began.

    Parameters
    ----------
    rounds : int
        Runs each way.
    side, speed, yaw_rate, corner_radius, pause : float
        As of :func:`square_course`.

    Returns
    -------
    commands : list of Command
        All runs, one after the other.
    runs : list of SquareRun
        Each run, with a time in the middle of the rest after it.

    Raises
    ------
    ValueError
        If a value is out of its range.

    Examples
    --------
    >>> commands, runs = square_rounds(1, side=1.0, speed=0.5, yaw_rate=0.5 * math.pi)
    >>> [run.end for run in runs], sum(command.duration for command in commands)
    ([12.5, 25.5], 26.0)

    """
    check_count('rounds', rounds)
    rest = Command(0.0, 0.0, max(SHORTEST_REST_S, 2.0 * pause))
    commands: List[Command] = []
    runs: List[SquareRun] = []
    for clockwise in [*rounds * [True], *rounds * [False]]:
        commands += [*square_course(
            side=side, speed=speed, yaw_rate=yaw_rate, clockwise=clockwise,
            corner_radius=corner_radius, pause=pause), rest]
        end = sum(command.duration for command in commands) - 0.5 * rest.duration
        runs.append(SquareRun(clockwise, end))
    return commands, runs


def _straight(length: float, speed: float) -> List[Command]:
    return [Command(speed, 0.0, length / speed)] if length else []


def _corner(radius: float, speed: float, yaw_rate: float) -> Command:
    """Return the quarter circle, to the side that the sign of ``yaw_rate`` tells."""
    v = min(speed, abs(yaw_rate) * radius)
    w = min(v / radius, abs(yaw_rate)) if v else abs(yaw_rate)
    return Command(v, math.copysign(w, yaw_rate), QUARTER / w)
