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
The parameters: one table per node.

Names, units and defaults are those of ros2_controllers' ``diff_drive_controller`` wherever it
has the same thing.  The tables are data: nodes declare them, documentation is made from them.
"""

from diffdrive_kinematics.ros.parameters.tables.commands import (
    COMMAND_SEQUENCE, GOAL_STEERING, TELEOP, WEB_VIEW)
from diffdrive_kinematics.ros.parameters.tables.controller import DIFF_DRIVE_CONTROLLER
from diffdrive_kinematics.ros.parameters.tables.tools import (
    CALIBRATE, DIFFDRIVE_SIM, PLOT_PATHS, ROBOT_DESCRIPTION)
from diffdrive_kinematics.ros.parameters.tables.wheels import (
    FORWARD_PROJECTION, SIMULATED_BASE, WHEEL_NOISE, WHEEL_ODOMETRY)

TABLES = {
    'diff_drive_controller': DIFF_DRIVE_CONTROLLER, 'wheel_noise': WHEEL_NOISE,
    'simulated_base': SIMULATED_BASE, 'wheel_odometry': WHEEL_ODOMETRY,
    'command_sequence': COMMAND_SEQUENCE, 'forward_projection': FORWARD_PROJECTION,
    'goal_steering': GOAL_STEERING, 'plot_paths': PLOT_PATHS, 'calibrate': CALIBRATE,
    'robot_description': ROBOT_DESCRIPTION, 'teleop': TELEOP, 'web_view': WEB_VIEW,
    'diffdrive_sim': DIFFDRIVE_SIM}
KNOWN_NAMES = frozenset(entry.name for table in TABLES.values() for entry in table)
