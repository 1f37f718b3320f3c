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

"""The robots of a composition: which base is a belief, which a truth, and how they are shown."""

import math
from typing import Any, Dict, List, NamedTuple, Optional, Sequence, Tuple

from diffdrive_kinematics.core.kinematics import Pose, WheelGeometry, wrap_angle
from diffdrive_kinematics.core.noise import PoseCovariance
from diffdrive_kinematics.core.odometry import BaseState

Bases = Sequence[Tuple[Any, bool]]
"""Nodes that are a SimulatedBase, and whether each is fed with the wheels as they really turn."""


class Robot(NamedTuple):
    """A base for the table: its name, what it stands for, its pose, and how far that is off."""

    name: str
    role: str
    pose: Pose
    mean_error: Optional[Tuple[float, float]] = None  # of x and y [m], where the wheels slip


class Moment(NamedTuple):
    """A robot at one time: what it believes, how well and by what geometry, and where it is."""

    namespace: str
    time_ns: int
    belief: BaseState
    covariance: PoseCovariance
    truth: Optional[Pose]
    geometry: WheelGeometry


def robots_of(bases: Bases) -> List[Robot]:
    """Return the rows of the table; a base that is fed with noise, beside one not, is a truth."""
    return [_robot(base, role) for base, role in _with_roles(bases)]


def moments_of(bases: Bases, time_ns: int) -> List[Moment]:
    """Return each robot that has a belief, as it is at a time that is now [ns]."""
    found: Dict[str, Dict[str, Any]] = {}
    for base, role in _with_roles(bases):
        namespace = base.get_fully_qualified_name().rpartition('/')[0]
        found.setdefault(namespace, {}).setdefault(role, base)
    return [
        Moment(namespace, time_ns, roles['belief'].reading(), roles['belief'].covariance(),
               roles['truth'].reading().pose if 'truth' in roles else None,
               roles['belief'].config.geometry)
        for namespace, roles in found.items() if 'belief' in roles]


def _with_roles(bases: Bases) -> List[Tuple[Any, str]]:
    with_truth = len({fed for _, fed in bases}) == 2
    return [(base, 'truth' if fed and with_truth else 'belief') for base, fed in bases]


def _robot(base: Any, role: str) -> Robot:
    error = base.moments().mean_error
    return Robot(base.get_fully_qualified_name(), role, base.reading().pose,
                 (error.real, error.imag) if error else None)


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
            belief, truth = by_role['belief'], by_role['truth']
            distance = math.hypot(truth.x - belief.x, truth.y - belief.y)
            turn = wrap_angle(float(truth.theta - belief.theta))
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
