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

"""The robots of a composition: which base is the belief of one, and which its truth."""

from typing import Any, Dict, List, NamedTuple, Optional, Sequence, Tuple

from diffdrive_kinematics.core.kinematics import Pose, WheelGeometry
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
