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
What can be set: one table of parameters per node.

Names, units and defaults are those of ros2_controllers' ``diff_drive_controller`` wherever it
has the same thing.  The tables are data: nodes declare them, documentation is made from them.
"""

from dataclasses import replace
import math
from typing import Tuple

from diffdrive_kinematics.core.kinematics import (
    check_duration, check_non_negative, check_positive, check_rate)
from diffdrive_kinematics.core.noise import DISTRIBUTIONS
from diffdrive_kinematics.ros.parameters.parameter_spec import (
    check_bias, check_concentration, check_count, check_description, check_diagonal,
    check_distribution, check_frame, check_horizon, check_joint_names, check_named,
    check_offset, check_one_of, check_optional_picture, check_optional_seed, check_picture,
    check_pose, check_positive_or_nan, check_prefix, check_range, check_rate_or_off,
    check_resolution, check_seed, check_slip_model, check_stages, check_step, check_wheel_base,
    check_width, check_window, Kind, ParameterSpec as Spec, string, topic)

__all__ = [
    'CALIBRATE', 'COMMAND_SEQUENCE', 'DIFFDRIVE_SIM', 'DIFF_DRIVE_CONTROLLER',
    'FORWARD_PROJECTION', 'GOAL_STEERING', 'KNOWN_NAMES', 'LIMITS', 'MODELS', 'PLOT_PATHS',
    'ROBOT_DESCRIPTION', 'SIMULATED_BASE', 'SWITCHES', 'TABLES', 'WHEEL_NOISE',
    'WHEEL_ODOMETRY', 'only_in_ros2_controllers']

MODELS = (
    'unicycle', 'differential_drive', 'tricycle', 'bicycle', 'car', 'front_drive_tricycle',
    'rear_wheels_tricycle', 'ackermann_car')

_DIAGNOSTICS = Spec(
    'diagnostics_rate', 1.0, 'rate [Hz] of the status on /diagnostics; 0: off',
    check=check_rate_or_off, read_only=True)
_EXECUTOR = Spec(
    'executor', 'auto', 'of the process: auto (EventsExecutor where this rclpy has it), events, '
    'single_threaded; among the nodes of diffdrive_sim its own counts', Kind.STRING,
    check_one_of('auto', 'events', 'single_threaded'), read_only=True)
_OVERWRITE = Spec('overwrite', False, 'replace files that exist', Kind.BOOL, read_only=True)
_JOINTS = (
    Spec('left_wheel_names', ['left_wheel_joint'], 'joints of the left wheels', Kind.STRINGS,
         check_joint_names, read_only=True),
    Spec('right_wheel_names', ['right_wheel_joint'], 'joints of the right wheels', Kind.STRINGS,
         check_joint_names, read_only=True),
    Spec('left_wheel_inverted', False, 'true: the joints of the left wheels turn backward where '
         'the wheels roll forward, as a mirrored motor does; rates and positions have their sign '
         'in every message', Kind.BOOL, read_only=True),
    Spec('right_wheel_inverted', False, 'the same for the right wheels', Kind.BOOL,
         read_only=True))
_ENCODER_RANGE = Spec(
    'encoder_range', 0.0, 'at which positions of the joints wrap around [rad]; what comes in '
    'counts modulo it, up to half a range a message; 0: they do not wrap',
    check=check_range, read_only=True)
_RADII = (
    Spec('wheel_radius', math.nan, 'radius R of the wheels [m], above 0', check=check_positive,
         required=True),
    Spec('left_wheel_radius_multiplier', 1.0, 'effective over nominal radius of the left wheels',
         check=check_positive),
    Spec('right_wheel_radius_multiplier', 1.0,
         'effective over nominal radius of the right wheels', check=check_positive))
_SEPARATION = (
    Spec('wheel_separation', math.nan,
         'distance L between left and right wheels [m], above 0', check=check_positive,
         required=True),
    Spec('wheel_separation_multiplier', 1.0, 'effective over nominal separation',
         check=check_positive))
_GEOMETRY = (*_SEPARATION, *_RADII)

_BIAS = (
    Spec('left_bias', 0.0, 'fraction of travel that the left wheel gains, above -1',
         check=check_bias),
    Spec('right_bias', 0.0, 'fraction of travel that the right wheel gains, above -1',
         check=check_bias))
_SLIP = (
    Spec('left_slip_variance', 0.0, 'k [m] of the left wheel: Var[travel error] = k |travel|',
         check=check_non_negative),
    Spec('right_slip_variance', 0.0, 'k [m] of the right wheel: Var[travel error] = k |travel|',
         check=check_non_negative))
_DISTRIBUTION = Spec(
    'slip_distribution', 'gaussian', 'of the slip, all with the variance that is set: '
    + ', '.join(DISTRIBUTIONS), Kind.STRING, check_distribution)

LIMITS = {
    'max_velocity': 'highest velocity, 0 or above; NaN: no limit',
    'min_velocity': 'lowest velocity, 0 or below; NaN: -max_velocity',
    'max_acceleration': 'speeding up forward, above 0; NaN: no limit',
    'max_acceleration_reverse': 'speeding up in reverse, below 0; NaN: -max_acceleration',
    'max_deceleration': 'slowing down forward, below 0; NaN: max_acceleration_reverse',
    'max_deceleration_reverse': 'slowing down in reverse, above 0; NaN: -max_deceleration',
    'max_jerk': 'rise of the acceleration (as speeding up forward begins and braking ends), above '
                '0; NaN: no limit',
    'min_jerk': 'fall of the acceleration, below 0; NaN: -max_jerk',
    'min_acceleration': 'older YAML: bound of every fall of the velocity, below 0'}
SWITCHES = {  # what their limits have in their names
    'has_velocity_limits': 'velocity', 'has_acceleration_limits': 'celeration',
    'has_jerk_limits': 'jerk'}
_AXES = {'linear.x': 'm', 'angular.z': 'rad'}


def _per(limit: str) -> str:
    return 's' if 'velocity' in limit else 's^3' if 'jerk' in limit else 's^2'


def _axis_entries() -> Tuple[Spec, ...]:
    limits = tuple(
        Spec(f'{axis}.{limit}', math.nan, f'{meaning} [{unit}/{_per(limit)}]')
        for axis, unit in _AXES.items() for limit, meaning in LIMITS.items())
    switches = tuple(
        Spec(f'{axis}.{switch}', True, 'false: the limits of this kind do not count (older '
             'YAML; leave the limits NaN instead)', Kind.BOOL)
        for axis in _AXES for switch in SWITCHES)
    return limits + switches


DIFF_DRIVE_CONTROLLER = (
    *_GEOMETRY, *_JOINTS,
    topic('cmd_vel_topic', 'cmd_vel', 'velocity commands in'),
    topic('emergency_stop_topic', '', 'Bool in, of any quality of service; true: wheels at rest '
          'at once, and no command is obeyed until it is false; empty: only ~/stop and ~/resume '
          'are there',
          optional=True),
    topic('wheel_rates_topic', 'wheel_rates', 'wheel rates out, JointState'),
    topic('wheel_commands_topic', '', 'wheel rates out as Float64MultiArray, left wheels then '
          'right wheels, for a ros2_control velocity controller; empty: off', optional=True),
    topic('cmd_vel_out_topic', 'cmd_vel_out', 'limited velocity out, TwistStamped'),
    Spec('publish_limited_velocity', False, 'whether to publish cmd_vel_out', Kind.BOOL,
         read_only=True),
    Spec('enable_stamped_cmd_vel', False, 'commands are TwistStamped instead of Twist', Kind.BOOL,
         read_only=True),
    Spec('stamp_tolerance', 0.0, 'how old [s] the stamp of a command may be to be handed on to '
         'the wheel rates; older: the time of arrival', check=check_duration),
    Spec('cmd_vel_timeout', 0.5, 'age [s] at which a command ends and the drive brakes, and at '
         'which one that comes is refused as old; 0: never', check=check_duration),
    Spec('cmd_vel_clock_offset', 0.0, 'what the clock of the controller shows less what that of '
         'the senders of commands shows [s]; NaN: unknown, neither stamps count nor when a '
         'command was sent',
         check=check_offset),
    Spec('publish_rate', 50.0, 'rate [Hz] at which the wheel rates are repeated and ramps step',
         check=check_rate),
    Spec('max_wheel_rate', math.nan, 'bound [rad/s] of all wheels; beyond it both sides are '
         'scaled by one factor, so that the path keeps its curvature; NaN: none'),
    string('base_frame_id', 'base_link', 'frame of the limited velocity', check_frame),
    *_axis_entries(), _DIAGNOSTICS, _EXECUTOR)

WHEEL_NOISE = (
    *_RADII, *_JOINTS,
    topic('input_topic', 'wheel_rates', 'nominal wheel motion in'),
    topic('output_topic', 'noisy_wheel_rates', 'effective wheel motion out'),
    _ENCODER_RANGE,
    *_BIAS, *_SLIP,
    Spec('slip_model', 'travel', "'travel': variance grows with distance, whatever the message "
         "rate; 'command': sigma is in proportion to the rate, drawn once a message, "
         '*_slip_variance is its squared fraction [1], and the statistics depend on the message '
         'rate', Kind.STRING, check_slip_model),
    _DISTRIBUTION,
    Spec('seed', 0, 'of the random generator, 0 or above; setting another one starts anew',
         Kind.INTEGER, check_seed),
    Spec('command_timeout', 0.5, 'silence [s] over which rates are held at most; as in '
         'simulated_base; 0: any', check=check_duration),
    _DIAGNOSTICS, _EXECUTOR)

_START = (
    Spec('initial_pose', [0.0, 0.0, 0.0], 'x [m], y [m], yaw [rad] at start', Kind.DOUBLES,
         check_pose, read_only=True),
    Spec('initial_heading_concentration', math.nan, 'kappa of the von Mises density of the yaw '
         'at start, about that of initial_pose, near 1 / variance [1/rad^2]; NaN: it is known',
         check=check_concentration, read_only=True))

SIMULATED_BASE = (
    *_GEOMETRY, *_JOINTS,
    topic('wheel_motion_topic', 'wheel_rates', 'wheel motion in: rates, positions or both'),
    topic('odom_topic', 'odom', 'odometry out; empty: off', optional=True),
    topic('joint_states_topic', 'joint_states', 'joint states out; empty: off', optional=True),
    topic('set_pose_topic', 'set_pose', 'poses in to put the robot at, PoseWithCovarianceStamped '
          'in odom_frame_id; empty: off', optional=True),
    Spec('publish_rate', 50.0, 'rate [Hz] of odometry and joint states', check=check_rate),
    Spec('command_timeout', 0.5, 'silence [s] after which the wheels stop, at the last stamp '
         'plus this; 0: never', check=check_duration),
    Spec('position_feedback', True, 'false: ignore positions in wheel motion and integrate its '
         'rates', Kind.BOOL, read_only=True),
    replace(_ENCODER_RANGE, description='at which positions of the joints wrap around [rad]; '
            'joint states out wrap into [-range/2, range/2), and what comes in counts modulo it, '
            'up to half a range a message; 0: they do not wrap'),
    Spec('encoder_resolution', 0.0, 'ticks a turn of the wheel in the positions of joint states '
         'out; 0: ideal', check=check_resolution, read_only=True),
    Spec('max_encoder_rate', 1000.0, 'wheel rate [rad/s], well above what the wheels can do: '
         "a driver's positions that went faster between two messages count anew, as encoders "
         'that started again elsewhere do; NaN: none', check=check_positive_or_nan),
    Spec('velocity_rolling_window_size', 10, "over how many messages of a driver's positions the "
         'twist is taken', Kind.INTEGER, check_window, read_only=True),
    Spec('extrapolate_positions', True, "whether the pose goes on from a driver's last positions "
         'by the rates of that window, so that it is that of its stamp', Kind.BOOL,
         read_only=True),
    *_START,
    Spec('initial_heading_seed', -1, 'draw the yaw at start with this seed, as a ground truth '
         'does; -1: do not, and publish how uncertain it is', Kind.INTEGER, check_optional_seed,
         read_only=True),
    Spec('enable_odom_tf', True, 'broadcast odom_frame_id -> base_frame_id (needs tf2_msgs)',
         Kind.BOOL, read_only=True),
    Spec('publish_map_odom_tf', False, 'of a ground truth: broadcast odom_frame_id (map) -> the '
         'frame of the belief, so that tf shows the robot where it is (needs tf2_msgs, and '
         'enable_odom_tf false)', Kind.BOOL, read_only=True),
    topic('belief_topic', 'odom', 'odometry in that publish_map_odom_tf corrects'),
    Spec('tf_frame_prefix_enable', False, 'put a prefix before odom_frame_id and base_frame_id',
         Kind.BOOL, read_only=True),
    string('tf_frame_prefix', '', 'that prefix, with or without a slash at its end; empty or ~: '
           'the namespace of the node', check_prefix),
    string('odom_frame_id', 'odom', 'fixed frame of the odometry', check_frame),
    string('base_frame_id', 'base_link', 'frame of the robot', check_frame),
    *_SLIP,
    Spec('slip_model', 'travel', 'as in wheel_noise; the variances of command are none per metre '
         'and are not counted here', Kind.STRING, check_slip_model),
    Spec('covariance_floor', 1e-9, 'added to every variance that is published, so that none is '
         'zero', check=check_non_negative),
    Spec('pose_covariance_diagonal', [0.0] * 6, 'variances of the pose to publish instead of '
         'those of the slip; zeros: do not', Kind.DOUBLES, check_diagonal),
    Spec('twist_covariance_diagonal', [0.0] * 6, 'variances of the twist to publish instead of '
         'those of the slip; zeros: do not', Kind.DOUBLES, check_diagonal),
    topic('path_topic', '', 'the way that was come out, Path; empty: off', optional=True),
    Spec('path_length', 1000, 'how many poses the path has at most; the oldest go',
         Kind.INTEGER, check_count, read_only=True),
    Spec('path_spacing', 0.02, 'least distance [m] between poses of the path',
         check=check_non_negative, read_only=True),
    Spec('path_rate', 2.0, 'rate [Hz] at which the path is published, where it has changed',
         check=check_rate, read_only=True),
    _DIAGNOSTICS, _EXECUTOR)

_OF_A_ROBOT = {'wheel_motion_topic': 'joint_states', 'joint_states_topic': ''}
WHEEL_ODOMETRY = tuple(
    replace(entry, default=_OF_A_ROBOT.get(entry.name, entry.default)) for entry in SIMULATED_BASE)

_SQUARE = (
    Spec('square_side', 0.0, 'side [m] of the square of UMBmark; 0: none',
         check=check_non_negative, read_only=True),
    Spec('square_corner_radius', 0.0, 'radius [m] of its corners; 0: turns on the spot',
         check=check_non_negative, read_only=True))

COMMAND_SEQUENCE = (
    topic('cmd_vel_topic', 'cmd_vel', 'velocity commands out'),
    Spec('enable_stamped_cmd_vel', False, 'publish TwistStamped instead of Twist', Kind.BOOL,
         read_only=True),
    string('base_frame_id', 'base_link', 'frame of stamped commands', check_frame),
    Spec('commands', [], 'v [m/s], omega [rad/s], duration [s] of each command, one after '
         'another in one flat list', Kind.DOUBLES, read_only=True),
    string('recording', '', 'CSV file (or .csv.gz) time_sec,linear_x,angular_z to play instead '
           'of commands'),
    *_SQUARE,
    Spec('square_speed', 0.2, 'speed [m/s] along the sides', check=check_positive,
         read_only=True),
    Spec('square_yaw_rate', 0.5, 'yaw rate [rad/s] at the corners', check=check_positive,
         read_only=True),
    Spec('square_clockwise', False, 'drive the square clockwise', Kind.BOOL, read_only=True),
    Spec('square_pause', 0.5, 'rest [s] between sides and corners, in which ramps end',
         check=check_duration, read_only=True),
    Spec('loop', False, 'start again at the end, until stopped', Kind.BOOL, read_only=True),
    Spec('publish_rate', 50.0, 'rate [Hz] at which a held command is repeated',
         check=check_rate, read_only=True),
    Spec('wait_for_topics', [], 'topics that must have answered before the first command; '
         'until then zeros are sent', Kind.STRINGS, read_only=True),
    _DIAGNOSTICS, _EXECUTOR)

FORWARD_PROJECTION = (
    *_GEOMETRY, *_JOINTS,
    topic('odom_topic', 'odom', 'odometry in: where the robot is'),
    topic('wheel_motion_topic', 'wheel_rates', 'wheel motion in: the rates that are held'),
    topic('poses_topic', 'projected_poses', 'samples out, PoseArray; empty: off', optional=True),
    topic('boundary_topic', 'projected_boundary', 'boundary of all that bounded slip can reach '
          'out, PolygonStamped; empty: off', optional=True),
    Spec('publish_rate', 5.0, 'rate [Hz] of the projections', check=check_rate),
    Spec('command_timeout', 0.5, 'silence [s] after which the wheels count as stopped; as in '
         'simulated_base; 0: never', check=check_duration),
    _ENCODER_RANGE,
    Spec('horizon', 2.0, 'how far ahead [s] to look, above 0', check=check_horizon),
    Spec('stages', 4, 'into how many steps of equal length the horizon is cut, each with slip of '
         'its own', Kind.INTEGER, check_stages),
    Spec('samples', 200, 'number of poses', Kind.INTEGER, check_count),
    Spec('seed', 0, 'of the samples; the same each time, so that they move with the robot',
         Kind.INTEGER, check_seed),
    *_SLIP, _DISTRIBUTION, _DIAGNOSTICS, _EXECUTOR)

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
    _DIAGNOSTICS, _EXECUTOR)

PLOT_PATHS = (
    replace(_SEPARATION[0], check=check_positive_or_nan, required=False,
            description='distance L between left and right wheels [m], above 0; of slip, and of '
            'models that have two wheels on an axle'),
    _SEPARATION[1],
    string('model', '', 'of the robot, a name of core/models; empty: the differential drive with '
           'slip', check_one_of('', *MODELS)),
    Spec('commands', [], 'v [m/s], omega [rad/s], duration [s] of each command, one after '
         'another in one flat list; of a model its own two commands, then the duration',
         Kind.DOUBLES, read_only=True),
    Spec('steps', 5, 'into how many steps of equal length each command is cut, each with slip, '
         'or errors of the commands, of its own', Kind.INTEGER, check_stages, read_only=True),
    Spec('command_bounds', [], 'of a model: bounds of the errors of its two commands, in one '
         'flat list; a picture for each pair, side by side; none: without errors', Kind.DOUBLES,
         read_only=True),
    Spec('max_steering_rates', [], 'of a model: bounds [rad/s] of the rate of the steering '
         'angle, a picture for each, side by side; 0 or none: it jumps', Kind.DOUBLES,
         read_only=True),
    Spec('max_steering_angle', 1.2, 'of a model: bound [rad] of the steering angle',
         check=check_positive, read_only=True),
    Spec('wheel_base', math.nan, 'of a model: distance l [m] from the rear axle to the front '
         'one', check=check_positive_or_nan, read_only=True),
    Spec('wheel_radius', math.nan, 'of model differential_drive: radius R [m]',
         check=check_positive_or_nan, read_only=True),
    Spec('paths', 100, 'number of sample paths', Kind.INTEGER, check_count, read_only=True),
    *_START,
    Spec('seed', 0, 'of the paths, 0 or above', Kind.INTEGER, check_seed, read_only=True),
    *_BIAS, *_SLIP,
    replace(_DISTRIBUTION, description=_DISTRIBUTION.description + '; that of the errors of '
            'commands has to be bounded: gaussian stands for uniform there'),
    string('output', 'paths.png', 'file to write, .png or .svg', check_picture),
    _OVERWRITE)

CALIBRATE = (
    *_GEOMETRY, *_JOINTS,
    string('square_runs', '', 'CSV file clockwise,true_x,true_y,odom_x,odom_y with a row for '
           'each run around a square'),
    *_SQUARE,
    Spec('recordings', [], 'CSV files of motion: time_sec with linear_x,angular_z or '
         'left_rate,right_rate or left_position,right_position or left_ticks,right_ticks',
         Kind.STRINGS, read_only=True),
    Spec('references', [], 'CSV files time_sec,x,y,yaw, one for each of recordings; none: the '
         'recordings have these columns', Kind.STRINGS, read_only=True),
    Spec('encoder_resolution', 0.0, 'ticks of one turn of a wheel, for files with ticks',
         check=check_non_negative, read_only=True),
    Spec('tick_increments', False, 'ticks are those since the row before, not all so far',
         Kind.BOOL, read_only=True),
    topic('motion_topic', 'joint_states', 'wheel motion in, without files'),
    _ENCODER_RANGE,
    Spec('position_feedback', True, 'false: ignore positions in wheel motion', Kind.BOOL,
         read_only=True),
    topic('reference_topic', 'ground_truth', 'reference poses in, without files'),
    string('reference_type', 'odometry', 'of the reference topic: odometry (Odometry) or pose '
           '(PoseStamped)', check_one_of('odometry', 'pose')),
    string('clock', '', 'what is fitted of the time between wheels and reference: none, delay '
           '(one for all), offsets or drifts (of each drive); empty: delay for commands, '
           'offsets for other files, none for topics',
           check_one_of('', 'none', 'delay', 'offsets', 'drifts')),
    string('mean_radius', '', 'fit: the mean radius of the wheels too; keep: leave it as it is; '
           'empty: keep for commands, of which a robot covers more or less, else fit',
           check_one_of('', 'fit', 'keep')),
    Spec('equal_slip', True, 'fit one slip constant for both wheels', Kind.BOOL,
         read_only=True),
    string('output', 'calibration.yaml', 'params file to write', check_named),
    string('picture', '', 'picture of errors before and after to write, .png or .svg; empty: '
           'none', check_optional_picture),
    _OVERWRITE,
    _EXECUTOR)

ROBOT_DESCRIPTION = (
    *_GEOMETRY, *_JOINTS,
    topic('robot_description_topic', 'robot_description', 'URDF out, String'),
    string('robot_name', 'diffdrive', 'name of the robot in the URDF', check_named),
    string('base_frame_id', 'base_link', 'link on the ground between the wheels', check_frame),
    Spec('wheel_base', math.nan, 'distance [m] from the first to the last wheel of a side, which '
         'are in order from front to rear; NaN: 2.5 radii a wheel', check=check_wheel_base),
    Spec('wheel_width', math.nan, 'width [m] of the wheels, above 0; NaN: half a radius',
         check=check_width),
    string('output', '', 'file to write instead: .urdf, or .yaml, a params file for '
           'robot_state_publisher; empty: publish', check_description),
    _OVERWRITE,
    _EXECUTOR)

DIFFDRIVE_SIM = (
    Spec('nodes', [], "what to compose: 'class' or 'class:name'", Kind.STRINGS, read_only=True),
    Spec('clock_step', 0.0, 'step [s] of a simulated clock that is published on /clock; 0: real '
         'time', check=check_step, read_only=True),
    Spec('real_time_factor', 0.0, 'pace of the simulated clock; 0: as fast as the nodes can '
         'follow', check=check_non_negative, read_only=True),
    _EXECUTOR)

TABLES = {
    'diff_drive_controller': DIFF_DRIVE_CONTROLLER, 'wheel_noise': WHEEL_NOISE,
    'simulated_base': SIMULATED_BASE, 'wheel_odometry': WHEEL_ODOMETRY,
    'command_sequence': COMMAND_SEQUENCE, 'forward_projection': FORWARD_PROJECTION,
    'goal_steering': GOAL_STEERING, 'plot_paths': PLOT_PATHS, 'calibrate': CALIBRATE,
    'robot_description': ROBOT_DESCRIPTION, 'diffdrive_sim': DIFFDRIVE_SIM}
KNOWN_NAMES = frozenset(entry.name for table in TABLES.values() for entry in table)

_ROS2_CONTROLLERS = frozenset((
    'type', 'wheels_per_side', 'open_loop', 'use_stamped_vel', 'update_rate', 'is_async',
    'publish_wheel_data'))


def only_in_ros2_controllers(name: str) -> bool:
    """Return whether ros2_controllers' diff_drive_controller knows a name and we do not."""
    return name in _ROS2_CONTROLLERS and name not in KNOWN_NAMES
