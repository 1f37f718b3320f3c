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

"""The parameters of the nodes that command a robot, by a course, goals, a page or keys."""

from diffdrive_kinematics.core.kinematics import check_duration, check_positive, check_rate
from diffdrive_kinematics.ros.parameters.parameter_checks import (
    check_one_of, check_port, check_rounds)
from diffdrive_kinematics.ros.parameters.parameter_spec import file, fixed, Kind, settable, topic
from diffdrive_kinematics.ros.parameters.tables.shared import (
    COMMANDS_OUT, DIAGNOSTICS, EXECUTOR, RADII, SEPARATION, SQUARE)

COMMAND_SEQUENCE = (
    *COMMANDS_OUT,
    fixed('commands', [], 'The commands, each as speed v [m/s], yaw rate omega [rad/s] and '
          'duration [s], one after another in one flat list.'),
    file('recording', '', 'Recording to play instead of commands: a CSV file (or .csv.gz) with '
         'the columns time_sec,linear_x,angular_z, or a bag with cmd_vel_topic. The name of an '
         'installed file begins with package://diffdrive_kinematics/.'),
    *SQUARE,
    fixed('square_speed', 0.2, 'Speed [m/s] along the sides of the square.', check_positive),
    fixed('square_yaw_rate', 0.5, 'Yaw rate [rad/s] at the corners of the square.',
          check_positive),
    fixed('square_clockwise', False, 'Drive around the square clockwise.'),
    fixed('square_rounds', 0, 'Number of times to drive around the square clockwise, and then '
          'counterclockwise, with a rest after each. 0: once, in the direction that '
          'square_clockwise gives.', check_rounds),
    fixed('square_pause', 0.5, 'Time [s] at rest between sides and corners, in which ramps end.',
          check_duration),
    fixed('loop', False, 'Start again at the end, until the node is stopped.'),
    fixed('publish_rate', 50.0, 'Rate [Hz] at which a command is repeated while it holds.',
          check_rate),
    fixed('wait_for_topics', [], 'Topics on which a message must have come before the first '
          'command; until then zeros are sent.', kind=Kind.STRINGS),
    DIAGNOSTICS, EXECUTOR)

GOAL_STEERING = (
    topic('odom_topic', 'odom', 'Subscribes to: odometry, which says where the robot is.'),
    topic('goal_topic', 'goal_pose', 'Subscribes to: goals (PoseStamped) in the frame of the '
          'odometry. Empty: off.', optional=True),
    topic('plan_topic', 'path', 'Subscribes to: paths to follow (Path) in the frame of the '
          'odometry. Empty: off.', optional=True),
    *COMMANDS_OUT,
    fixed('goals', [], 'Goals to drive to from the start, each as x [m], y [m] and yaw [rad] in '
          'the frame of the odometry, one after another in one flat list. The node ends after the '
          'last one.'),
    fixed('law', 'pose', 'Control law that drives to goals. heading: turn towards the goal and '
          'drive straight. point: a point ahead of the axle goes straight to the goal, backward '
          'too. pose: drive on a curve that ends with the yaw of the goal.',
          check_one_of('heading', 'point', 'pose')),
    settable('max_speed', 0.2, 'Highest speed [m/s] that is commanded.', check_positive),
    settable('max_yaw_rate', 1.0, 'Highest yaw rate [rad/s] that is commanded.', check_positive),
    settable('distance_tolerance', 0.02, 'Distance [m] to the goal at which it counts as reached.',
             check_positive),
    settable('yaw_tolerance', 0.05, 'Difference [rad] to the yaw of the goal at which it counts '
             'as reached, for the law pose.', check_positive),
    settable('distance_gain', 0.8, 'Speed over the distance that is left [1/s]. The robot slows '
             'down when it is nearer to the goal than max_speed / distance_gain.', check_rate),
    settable('heading_gain', 2.4, 'Yaw rate over the error of the heading [1/s].', check_rate),
    settable('yaw_weight', 2.0, 'Weight h of the law pose: how much the yaw of the goal counts on '
             'the way.', check_positive),
    settable('point_offset', 0.1, 'Distance b [m] of the law point: how far the point is ahead of '
             'the axle.', check_positive),
    settable('lookahead', 0.3, 'Distance [m] along a path by which the robot aims ahead.',
             check_positive),
    settable('odom_timeout', 0.5, 'Time [s] without odometry after which the robot is commanded '
             'to stand still.', check_positive),
    settable('patience', 10.0, 'Time [s] without coming nearer after which the robot gives a goal '
             'up.', check_positive),
    settable('publish_rate', 20.0, 'Rate [Hz] of the commands.', check_rate),
    DIAGNOSTICS, EXECUTOR)
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
