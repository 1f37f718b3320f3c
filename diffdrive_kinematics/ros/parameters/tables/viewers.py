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

"""The parameters of the nodes on which a robot is watched and driven."""

from diffdrive_kinematics.core.kinematics import check_positive, check_rate
from diffdrive_kinematics.ros.parameters.parameter_checks import check_port
from diffdrive_kinematics.ros.parameters.parameter_spec import fixed, settable, topic
from diffdrive_kinematics.ros.parameters.tables.shared import (
    COMMANDS_OUT, DIAGNOSTICS, EXECUTOR, RADII, SEPARATION)

WEB_VIEW = (
    fixed('host', '127.0.0.1', 'Address at which the page is served. At any address other than '
          'that of this machine alone, whoever reaches it can drive the robot.'),
    fixed('port', 8080, 'Port at which the page is served. 0: a free one, which the log names.',
          check_port),
    SEPARATION[0], RADII[0],
    topic('odom_topic', 'odom', 'Subscribes to: odometry, which says where the robot believes it '
          'is.'),
    topic('truth_topic', 'ground_truth', 'Subscribes to: odometry of where the robot really is. '
          'Empty: off.', optional=True),
    topic('poses_topic', 'projected_poses', 'Subscribes to: the poses of forward_projection. '
          'Empty: off.', optional=True),
    topic('boundary_topic', 'projected_boundary', 'Subscribes to: the boundary of '
          'forward_projection. Empty: off.', optional=True),
    *COMMANDS_OUT,
    topic('autonomous_cmd_vel_topic', '', 'Subscribes to: velocity commands that are passed on '
          'while nobody drives on the page. Empty: off.', optional=True),
    topic('goal_topic', 'goal_pose', 'Publishes: the point that was clicked on the map '
          '(PoseStamped).'),
    topic('plan_topic', 'path', 'Publishes: an empty Path when somebody begins to drive, which '
          'ends what goal_steering does.'),
    fixed('noise_node', 'wheel_noise', 'Name of the node whose bias and slip the page sets. '
          'Empty: none.'),
    fixed('controller_node', 'diff_drive_controller', 'Name of the node that the page stops and '
          'releases.'),
    fixed('base_nodes', ['simulated_base', 'ground_truth'], 'Names of the nodes whose poses the '
          'page resets.'),
    settable('max_speed', 0.2, 'Speed [m/s] of a key, or of the joystick at its end.',
             check_positive),
    settable('max_yaw_rate', 1.5, 'Yaw rate [rad/s] of a key, or of the joystick at its end.',
             check_positive),
    fixed('frame_rate', 20.0, 'Rate [Hz] at which the page is drawn and commands are sent.',
          check_rate),
    DIAGNOSTICS, EXECUTOR)

TELEOP = (
    *COMMANDS_OUT,
    fixed('speed', 0.2, 'Speed [m/s] of a key at the start.', check_positive),
    fixed('yaw_rate', 1.0, 'Yaw rate [rad/s] of a key at the start.', check_positive),
    fixed('key_timeout', 0.6, 'Time [s] without a character from the terminal after which a key '
          'counts as released. It has to be longer than the terminal waits before it repeats a '
          'key that is held.', check_positive),
    fixed('publish_rate', 20.0, 'Rate [Hz] of the commands while a key is held.', check_rate),
    DIAGNOSTICS, EXECUTOR)
