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
from diffdrive_kinematics.ros.parameters.parameter_checks import (
    check_frame, check_port)
from diffdrive_kinematics.ros.parameters.parameter_spec import (
    Kind, ParameterSpec as Spec, string, topic)
from diffdrive_kinematics.ros.parameters.tables.shared import (
    DIAGNOSTICS, EXECUTOR, RADII, SEPARATION)

COMMANDS_OUT = (
    topic('cmd_vel_topic', 'cmd_vel', 'publishes: velocity commands'),
    Spec('enable_stamped_cmd_vel', False, 'publish TwistStamped instead of Twist', Kind.BOOL,
         read_only=True),
    string('base_frame_id', 'base_link', 'frame of stamped commands', check_frame))

WEB_VIEW = (
    string('host', '127.0.0.1', 'address on which the page is served; any other than that of this '
           'machine alone lets whoever reaches it drive the robot'),
    Spec('port', 8080, 'port on which the page is served; 0: a free one, which the log names',
         Kind.INTEGER, check_port, read_only=True),
    SEPARATION[0], RADII[0],
    topic('odom_topic', 'odom', 'subscribes to: the odometry that the robot believes'),
    topic('truth_topic', 'ground_truth', 'subscribes to: the odometry of where it really is; '
          'empty: there is none', optional=True),
    topic('poses_topic', 'projected_poses', 'subscribes to: samples of forward_projection; '
          'empty: off', optional=True),
    topic('boundary_topic', 'projected_boundary', 'subscribes to: boundary of '
          'forward_projection; empty: off', optional=True),
    *COMMANDS_OUT,
    topic('autonomous_cmd_vel_topic', '', 'subscribes to: velocity commands that are passed '
          'on while nobody drives on the page; empty: none', optional=True),
    topic('goal_topic', 'goal_pose', 'publishes: where somebody clicked on the map, PoseStamped'),
    topic('plan_topic', 'path', 'publishes: an empty Path where somebody begins to drive, which '
          'ends what goal_steering does'),
    string('noise_node', 'wheel_noise', 'node of which bias and slip are set; empty: none'),
    string('controller_node', 'diff_drive_controller', 'node that is stopped and released'),
    Spec('base_nodes', ['simulated_base', 'ground_truth'], 'nodes whose poses are reset',
         Kind.STRINGS, read_only=True),
    Spec('max_speed', 0.2, 'speed [m/s] of a key, or of the stick at its end',
         check=check_positive),
    Spec('max_yaw_rate', 1.5, 'yaw rate [rad/s] of a key, or of the stick at its end',
         check=check_positive),
    Spec('frame_rate', 20.0, 'rate [Hz] at which the page is drawn and commands are sent',
         check=check_rate, read_only=True),
    DIAGNOSTICS, EXECUTOR)

TELEOP = (
    *COMMANDS_OUT,
    Spec('speed', 0.2, 'speed [m/s] of a key at the start', check=check_positive, read_only=True),
    Spec('yaw_rate', 1.0, 'yaw rate [rad/s] of a key at the start', check=check_positive,
         read_only=True),
    Spec('key_timeout', 0.6, 'silence of the terminal [s] after which a key counts as released; '
         'longer than it waits before it repeats a key that is held',
         check=check_positive, read_only=True),
    Spec('publish_rate', 20.0, 'rate [Hz] of the commands while a key is held', check=check_rate,
         read_only=True),
    DIAGNOSTICS, EXECUTOR)
