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

"""What ``diffdrive_sim`` shows: progress, and where the robot believes to be and where it is."""

import math
from typing import Dict, List, Tuple

from diffdrive_kinematics.core.kinematics import Pose, wrap_angle
from diffdrive_kinematics.tools.robots import Robot


def drift(belief: Pose, truth: Pose) -> Tuple[float, float]:
    """Return the distance [m] and the wrapped heading [rad] from belief to truth."""
    return (math.hypot(truth.x - belief.x, truth.y - belief.y),
            wrap_angle(float(truth.theta - belief.theta)))


def progress_line(elapsed: float, length: float, robots: List[Robot]) -> str:
    """Return a line of progress [s] with the poses."""
    return f'{elapsed:7.1f} of {length:.1f} s   {_poses(robots)}'


def pose_line(elapsed: float, robots: List[Robot]) -> str:
    """Return a line of a time [s] with the poses."""
    return f'{elapsed:7.1f} s   {_poses(robots)}'


def drift_table(robots: List[Robot]) -> str:
    """Return the table of poses, with the drift where a namespace has a belief and a truth."""
    rows = [f"{'':34}{'x [m]':>10}{'y [m]':>10}{'yaw [deg]':>12}"]
    rows += [
        f"{f'{robot.role} ({robot.name})':34}{_fixed(robot.pose.x, 4):>10}"
        f'{_fixed(robot.pose.y, 4):>10}{_fixed(math.degrees(robot.pose.theta), 2):>12}'
        for robot in robots]
    by_namespace: Dict[str, List[Robot]] = {}
    for robot in robots:
        by_namespace.setdefault(robot.name.rpartition('/')[0], []).append(robot)
    for namespace, pair in by_namespace.items():
        by_role = {robot.role: robot.pose for robot in pair}
        if len(pair) == 2 and set(by_role) == {'belief', 'truth'}:
            distance, turn = drift(by_role['belief'], by_role['truth'])
            rows.append(
                f"{f'drift ({namespace})' if namespace else 'drift':34}"
                f"{_fixed(1000.0 * distance, 1) + ' mm':>20}{_fixed(math.degrees(turn), 2):>12}")
    rows += [
        f"{f'mean error ({robot.name})':34}"
        + ''.join(f'{_fixed(1000.0 * error, 2)} mm'.rjust(10) for error in robot.mean_error)
        for robot in robots if robot.role == 'belief' and robot.mean_error is not None]
    return '\n'.join(rows)


def _poses(robots: List[Robot]) -> str:
    return '   '.join(f'{robot.role} {_short(robot.pose)}' for robot in robots)


def _short(pose: Pose) -> str:
    x, y, yaw = _fixed(pose.x, 3), _fixed(pose.y, 3), _fixed(math.degrees(pose.theta), 1)
    return f'({x:>7}, {y:>7}, {yaw:>6} deg)'


def _fixed(value: float, digits: int) -> str:
    """Return the value with fixed digits, and no minus sign before zero."""
    return f'{round(value, digits) + 0.0:.{digits}f}'
