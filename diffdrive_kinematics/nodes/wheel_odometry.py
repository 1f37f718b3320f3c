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

"""``wheel_odometry``: ``simulated_base`` as a real robot has it, fed with its joint states."""

from typing import Any

from diffdrive_kinematics.nodes.simulated_base import SimulatedBase
from diffdrive_kinematics.ros.parameters.tables import WHEEL_ODOMETRY
from diffdrive_kinematics.ros.runtime.running import main_of


class WheelOdometry(SimulatedBase):
    """A base that hears ``joint_states`` and publishes none: the robot's driver does."""

    TABLE = WHEEL_ODOMETRY

    def __init__(self, name: str = 'wheel_odometry', **composition: Any) -> None:
        super().__init__(name, **composition)


main = main_of(WheelOdometry)
