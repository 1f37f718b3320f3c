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

from diffdrive_kinematics.core.arc import advance, Pose
from diffdrive_kinematics.core.checks import check_finite, check_non_negative

__all__ = ['Command', 'check_times', 'pose_after', 'poses_along', 'retraced']


@dataclass(frozen=True)
class Command:
    """
    A twist (v [m/s], w [rad/s]) that is held for ``duration`` [s].

    Raises
    ------
    ValueError
        If a value is not finite or the duration is negative.

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
    Return the start and the pose after each command, k + 1 poses.

    ``x_(i+1) = f(x_i, u_i)`` with f the exact arc (LaValle, Mobile Robotics, eq. 2.11).
    """
    return list(accumulate(
        commands, lambda at, u: advance(at, u.v * u.duration, u.w * u.duration), initial=pose))


def pose_after(pose: Pose, commands: Iterable[Command]) -> Pose:
    """Return the pose after all commands; the start where there are none."""
    return poses_along(pose, commands)[-1]


def retraced(commands: Sequence[Command]) -> List[Command]:
    """Return the commands that lead back along the same path: last first, each reversed."""
    return [Command(-u.v, -u.w, u.duration) for u in reversed(commands)]


def check_times(times: Sequence[float]) -> None:
    """
    Raise ``ValueError`` unless the times [s] are finite and never decrease.

    The message counts rows from 1, as an editor does for a table without its header.
    """
    previous = -float('inf')
    for row, time in enumerate(times, start=1):
        check_finite(f'time in row {row}', time)
        if time < previous:
            raise ValueError(
                f'time in row {row} is {time!r}, expected {previous!r} or later (sorted rows)')
        previous = time
