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

"""The base at one time."""

from typing import NamedTuple, Tuple

from diffdrive_kinematics.core.kinematics import Pose
from diffdrive_kinematics.core.odometry.wheel_sample import WheelPair


class BaseState(NamedTuple):
    """
    The base at one time.

    Parameters
    ----------
    pose : Pose
        Where it is [m, m, rad]; theta in (-pi, pi].
    twist : pair of float
        Forward speed v [m/s] and yaw rate w [rad/s].
    angles : pair of float
        Wheel angles (left, right) rolled since the start [rad].
    rates : pair of float
        Wheel rates (left, right) [rad/s].

    Examples
    --------
    >>> state = BaseState(Pose(1.0, 0.0, 0.0), (0.5, 0.0), angles=(8.0, 8.0), rates=(4.0, 4.0))
    >>> state.pose.x
    1.0

    """

    pose: Pose
    twist: Tuple[float, float]
    angles: WheelPair
    rates: WheelPair
