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

"""Goals and paths to drive to, and the odometry by which."""

from typing import List, NamedTuple, Sequence, Union

from diffdrive_kinematics.core.commands import Waypoints
from diffdrive_kinematics.core.kinematics import check_finite, Pose
from diffdrive_kinematics.ros.parameters.from_values import triples


class Task(NamedTuple):
    """Where to go, in a frame; an empty one is that of the odometry."""

    target: Union[Pose, Waypoints]
    frame_id: str

    def __str__(self) -> str:
        """Return it in words."""
        if isinstance(self.target, Waypoints):
            return f'the path of {len(self.target.points)} points'
        return 'the goal x {:.3f} m, y {:.3f} m, yaw {:.3f} rad'.format(*self.target)


class Seen(NamedTuple):
    """What odometry said last: pose, frame and stamp [ns]."""

    pose: Pose
    frame_id: str
    stamp_ns: int


def goals_from(numbers: Sequence[float]) -> List[Pose]:
    """Return the goals of a flat list of x, y, yaw, or raise ``ValueError``."""
    goals = [Pose(*three) for three in triples('goals', numbers, 'goal: x, y, yaw')]
    for number in numbers:
        check_finite('goals', number)
    return goals
