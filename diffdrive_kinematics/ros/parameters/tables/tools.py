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

"""The parameters of the executables that write files, and of the composing one."""

from dataclasses import replace
import math

from diffdrive_kinematics.core.kinematics import check_non_negative, check_positive
from diffdrive_kinematics.ros.parameters.parameter_checks import (
    check_count, check_description, check_frame, check_named, check_one_of,
    check_optional_picture, check_picture, check_positive_or_nan, check_recording, check_seed,
    check_stages, check_step, check_wheel_base)
from diffdrive_kinematics.ros.parameters.parameter_spec import (
    Kind, ParameterSpec as Spec, string, topic)
from diffdrive_kinematics.ros.parameters.tables.shared import (
    BIAS, DISTRIBUTION, ENCODER_RANGE, EXECUTOR, GEOMETRY, JOINTS, SEPARATION, SLIP, SQUARE, START)

OVERWRITE = Spec('overwrite', False, 'replace files that exist', Kind.BOOL, read_only=True)
MODELS = (
    'unicycle', 'differential_drive', 'tricycle', 'bicycle', 'car', 'front_drive_tricycle',
    'rear_wheels_tricycle', 'ackermann_car')

PLOT_PATHS = (
    replace(SEPARATION[0], check=check_positive_or_nan, required=False,
            description='distance L between left and right wheels [m], above 0; of slip, and of '
            'models that have two wheels on an axle'),
    SEPARATION[1],
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
    *START,
    Spec('seed', 0, 'of the paths, 0 or above', Kind.INTEGER, check_seed, read_only=True),
    *BIAS, *SLIP,
    replace(DISTRIBUTION, description=DISTRIBUTION.description + '; that of the errors of '
            'commands has to be bounded: gaussian stands for uniform there'),
    string('output', 'paths.png', 'file to write, .png or .svg', check_picture),
    OVERWRITE)

CALIBRATE = (
    *GEOMETRY, *JOINTS,
    string('square_runs', '', 'CSV file clockwise,true_x,true_y,odom_x,odom_y with a row for '
           'each run around a square'),
    *SQUARE,
    Spec('recordings', [], 'bags (directories, .mcap, .db3), and CSV files of motion: time_sec '
         'with linear_x,angular_z or left_rate,right_rate or left_position,right_position or '
         'left_ticks,right_ticks',
         Kind.STRINGS, read_only=True),
    Spec('references', [], 'bags, or CSV files time_sec,x,y,yaw, one for each of recordings; '
         'none: the recordings have the reference too', Kind.STRINGS, read_only=True),
    Spec('encoder_resolution', 0.0, 'ticks of one turn of a joint, for files with ticks',
         check=check_non_negative, read_only=True),
    Spec('tick_increments', False, 'ticks are those since the row before, not all so far',
         Kind.BOOL, read_only=True),
    topic('motion_topic', 'joint_states', 'wheel motion in, without files; in bags JointState, '
          'Odometry (its twist), or commands as Twist or TwistStamped'),
    ENCODER_RANGE,
    Spec('position_feedback', True, 'false: ignore positions in wheel motion', Kind.BOOL,
         read_only=True),
    topic('reference_topic', 'ground_truth', 'reference poses in, without files; in bags '
          'Odometry, PoseStamped, PoseWithCovarianceStamped, or /tf'),
    Spec('reference_frames', [], 'parent and child frame of the reference, where reference_topic '
         'is /tf', Kind.STRINGS, read_only=True),
    string('reference_type', 'odometry', 'of the reference topic: odometry (Odometry) or pose '
           '(PoseStamped); bags know theirs', check_one_of('odometry', 'pose')),
    string('clock', '', 'what is fitted of the time between wheels and reference: none, delay '
           '(one for all), offsets or drifts (of each drive), auto (an offset for each drive, and '
           'a drift where it pays); empty: delay for commands, auto for other files, none for '
           'topics', check_one_of('', 'none', 'delay', 'offsets', 'drifts', 'auto')),
    string('mean_radius', '', 'fit: the mean radius of the wheels too; keep: leave it as it is; '
           'empty: keep for commands, of which a robot covers more or less, else fit',
           check_one_of('', 'fit', 'keep')),
    Spec('equal_slip', True, 'fit one slip constant for both wheels', Kind.BOOL,
         read_only=True),
    string('output', 'calibration.yaml', 'params file to write', check_named),
    string('picture', '', 'picture of errors before and after to write, .png or .svg; empty: '
           'none', check_optional_picture),
    OVERWRITE,
    EXECUTOR)

ROBOT_DESCRIPTION = (
    *GEOMETRY, *JOINTS,
    topic('robot_description_topic', 'robot_description', 'URDF out, String'),
    string('robot_name', 'diffdrive', 'name of the robot in the URDF', check_named),
    string('base_frame_id', 'base_link', 'link on the ground between the wheels', check_frame),
    Spec('wheel_base', math.nan, 'distance [m] from the first to the last wheel of a side, which '
         'are in order from front to rear; NaN: 2.5 radii a wheel', check=check_wheel_base),
    Spec('wheel_width', math.nan, 'width [m] of the wheels, above 0; NaN: half a radius',
         check=check_positive_or_nan),
    string('output', '', 'file to write instead: .urdf, or .yaml, a params file for '
           'robot_state_publisher; empty: publish', check_description),
    OVERWRITE,
    EXECUTOR)

DIFFDRIVE_SIM = (
    Spec('nodes', [], "what to compose: 'class' or 'class:name'", Kind.STRINGS, read_only=True),
    Spec('clock_step', 0.0, 'step [s] of a simulated clock that is published on /clock; 0: real '
         'time', check=check_step, read_only=True),
    Spec('real_time_factor', 0.0, 'pace of the simulated clock; 0: as fast as the nodes can '
         'follow', check=check_non_negative, read_only=True),
    string('record', '', 'file to write: .csv, of belief, truth, wheels and commands of one '
           'robot 50 times a second, or .mcap, of all that the nodes publish; empty: none',
           check_recording),
    string('square_runs', '', 'CSV file to which the runs around the square of command_sequence '
           'are added, a row each, as calibrate reads them; empty: none'),
    string('calibration', '', 'params file to write at the end, of a calibration by all rows of '
           'square_runs; empty: none'),
    string('picture', '', 'picture to write of the way that was driven, .png or .svg; empty: '
           'none', check_optional_picture),
    OVERWRITE,
    EXECUTOR)
