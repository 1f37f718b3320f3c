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

"""The parameters of the nodes that command a robot."""

from diffdrive_kinematics.core.kinematics import check_duration, check_positive, check_rate
from diffdrive_kinematics.ros.parameters.parameter_checks import (
    check_frame, check_one_of, check_rounds)
from diffdrive_kinematics.ros.parameters.parameter_spec import (
    Kind, ParameterSpec as Spec, string, topic)
from diffdrive_kinematics.ros.parameters.tables.shared import DIAGNOSTICS, EXECUTOR, SQUARE

COMMAND_SEQUENCE = (
    topic('cmd_vel_topic', 'cmd_vel', 'velocity commands out'),
    Spec('enable_stamped_cmd_vel', False, 'publish TwistStamped instead of Twist', Kind.BOOL,
         read_only=True),
    string('base_frame_id', 'base_link', 'frame of stamped commands', check_frame),
    Spec('commands', [], 'v [m/s], omega [rad/s], duration [s] of each command, one after '
         'another in one flat list', Kind.DOUBLES, read_only=True),
    string('recording', '', 'CSV file (or .csv.gz) time_sec,linear_x,angular_z, or bag with '
           'cmd_vel_topic, to play instead of commands'),
    *SQUARE,
    Spec('square_speed', 0.2, 'speed [m/s] along the sides', check=check_positive,
         read_only=True),
    Spec('square_yaw_rate', 0.5, 'yaw rate [rad/s] at the corners', check=check_positive,
         read_only=True),
    Spec('square_clockwise', False, 'drive the square clockwise', Kind.BOOL, read_only=True),
    Spec('square_rounds', 0, 'drive the square so many times clockwise and then as many times '
         'counterclockwise, with a rest after each; 0: once, as square_clockwise says',
         Kind.INTEGER, check_rounds, read_only=True),
    Spec('square_pause', 0.5, 'rest [s] between sides and corners, in which ramps end',
         check=check_duration, read_only=True),
    Spec('loop', False, 'start again at the end, until stopped', Kind.BOOL, read_only=True),
    Spec('publish_rate', 50.0, 'rate [Hz] at which a held command is repeated',
         check=check_rate, read_only=True),
    Spec('wait_for_topics', [], 'topics that must have answered before the first command; '
         'until then zeros are sent', Kind.STRINGS, read_only=True),
    DIAGNOSTICS, EXECUTOR)

GOAL_STEERING = (
    topic('odom_topic', 'odom', 'odometry in: where the robot is'),
    topic('goal_topic', 'goal_pose', 'goals in, PoseStamped in the frame of the odometry; empty: '
          'off', optional=True),
    topic('plan_topic', 'path', 'paths in, Path in the frame of the odometry; empty: off',
          optional=True),
    topic('cmd_vel_topic', 'cmd_vel', 'velocity commands out'),
    Spec('enable_stamped_cmd_vel', False, 'publish TwistStamped instead of Twist', Kind.BOOL,
         read_only=True),
    string('base_frame_id', 'base_link', 'frame of stamped commands', check_frame),
    Spec('goals', [], 'x [m], y [m], yaw [rad] of goals to drive to from the start, one after '
         'another in one flat list, in the frame of the odometry; the node ends after them',
         Kind.DOUBLES, read_only=True),
    string('law', 'pose', 'that drives to goals: heading (look at it and go), point (a point '
           'ahead of the axle goes straight there, backward too) or pose (on a curve, to the yaw '
           'of the goal)', check_one_of('heading', 'point', 'pose')),
    Spec('max_speed', 0.2, 'bound of the speed [m/s]', check=check_positive),
    Spec('max_yaw_rate', 1.0, 'bound of the yaw rate [rad/s]', check=check_positive),
    Spec('distance_tolerance', 0.02, 'distance [m] to the goal that is near enough',
         check=check_positive),
    Spec('yaw_tolerance', 0.05, 'yaw [rad] off the goal that is near enough, of law pose',
         check=check_positive),
    Spec('distance_gain', 0.8, 'of the speed over the way that is left [1/s]: the robot slows '
         'down below max_speed / distance_gain', check=check_rate),
    Spec('heading_gain', 2.4, 'of the yaw rate over the error of the heading [1/s]',
         check=check_rate),
    Spec('yaw_weight', 2.0, 'h of law pose: how much the yaw of the goal counts on the way',
         check=check_positive),
    Spec('point_offset', 0.1, 'b [m] of law point: how far the point is ahead of the axle',
         check=check_positive),
    Spec('lookahead', 0.3, 'of paths: how far ahead [m] along them the robot aims',
         check=check_positive),
    Spec('odom_timeout', 0.5, 'silence of odometry [s] after which the robot is told to stand',
         check=check_positive),
    Spec('patience', 10.0, 'time [s] without coming nearer after which a goal is given up',
         check=check_positive),
    Spec('publish_rate', 20.0, 'rate [Hz] of the commands', check=check_rate),
    DIAGNOSTICS, EXECUTOR)
