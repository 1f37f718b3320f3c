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

"""Sequences of commands (u_1, ..., u_k), each held for a time: LaValle, eq. 2.11."""

from dataclasses import dataclass
from itertools import accumulate
from typing import Iterable, List, Sequence

from diffdrive_kinematics.core.kinematics.arc import advance
from diffdrive_kinematics.core.kinematics.checks import check_finite, check_non_negative
from diffdrive_kinematics.core.kinematics.pose import Pose


@dataclass(frozen=True)
class Command:
    """
    A twist that is held for a time.

    Parameters
    ----------
    v : float
        Forward speed [m/s].
    w : float
        Yaw rate [rad/s], counter-clockwise positive.
    duration : float
        How long it is held [s].

    Raises
    ------
    ValueError
        If a value is not finite or the duration is negative.

    Examples
    --------
    >>> Command(v=0.5, w=0.0, duration=2.0)
    Command(v=0.5, w=0.0, duration=2.0)

    """

    v: float
    w: float
    duration: float

    def __post_init__(self) -> None:
        check_finite('v', self.v)
        check_finite('omega', self.w)
        check_non_negative('duration', self.duration)


def poses_along(pose: Pose, commands: Iterable[Command]) -> List[Pose]:
    """
    Return the poses between commands: the start, and that after each command.

    ``x_(i+1) = f(x_i, u_i)`` with f the exact arc (LaValle, Mobile Robotics, eq. 2.11).

    Parameters
    ----------
    pose : Pose
        Where the first command begins.
    commands : iterable of Command
        The k commands, in order.

    Returns
    -------
    list of Pose
        The k + 1 poses; headings are not wrapped.

    Examples
    --------
    >>> forward = Command(v=0.5, w=0.0, duration=2.0)
    >>> [pose.x for pose in poses_along(Pose(0.0, 0.0, 0.0), [forward, forward])]
    [0.0, 1.0, 2.0]

    """
    return list(accumulate(
        commands, lambda at, u: advance(at, u.v * u.duration, u.w * u.duration), initial=pose))


def pose_after(pose: Pose, commands: Iterable[Command]) -> Pose:
    """
    Return the pose after all commands; the start where there are none.

    Parameters
    ----------
    pose : Pose
        Where the first command begins.
    commands : iterable of Command
        Commands, in order.

    Returns
    -------
    Pose
        Where the last command ends; the heading is not wrapped.

    Examples
    --------
    >>> pose_after(Pose(0.0, 0.0, 0.0), [Command(0.5, 0.0, 2.0), Command(0.0, 0.25, 2.0)])
    Pose(x=1.0, y=0.0, theta=0.5)

    """
    return poses_along(pose, commands)[-1]


def retraced(commands: Sequence[Command]) -> List[Command]:
    """
    Return the commands that lead back along the same path: last first, each reversed.

    Parameters
    ----------
    commands : sequence of Command
        Commands of the way there.

    Returns
    -------
    list of Command
        Commands of the way back.

    Examples
    --------
    >>> there = [Command(1.0, 0.5, 2.0), Command(1.0, -0.5, 1.0)]
    >>> end = pose_after(Pose(0.0, 0.0, 0.0), there + retraced(there))
    >>> bool(max(map(abs, end)) < 1e-12)
    True

    """
    return [Command(-u.v, -u.w, u.duration) for u in reversed(commands)]


def check_times(times: Sequence[float]) -> None:
    """
    Raise ``ValueError`` unless times are finite and never decrease.

    Parameters
    ----------
    times : sequence of float
        Times [s], one for each row of a table.

    Raises
    ------
    ValueError
        If a time is not finite, or earlier than that of the row before.  Rows count from 1, as
        an editor counts those of a table without its header.

    Examples
    --------
    >>> check_times([0.0, 1.0, 0.5])
    Traceback (most recent call last):
    ValueError: time in row 3 is 0.5, expected 1.0 or later (sorted rows)

    """
    previous = -float('inf')
    for row, time in enumerate(times, start=1):
        check_finite(f'time in row {row}', time)
        if time < previous:
            raise ValueError(
                f'time in row {row} is {time!r}, expected {previous!r} or later (sorted rows)')
        previous = time
