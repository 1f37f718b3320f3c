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
    check_count, check_description, check_frame, check_named, check_non_negative_or_nan,
    check_one_of, check_optional_picture, check_picture, check_positive_or_nan,
    check_recording, check_seed, check_stages, check_step)
from diffdrive_kinematics.ros.parameters.parameter_spec import file, fixed, Kind, settable, topic
from diffdrive_kinematics.ros.parameters.tables.shared import (
    BIAS, DISTRIBUTION, ENCODER_RANGE, EXECUTOR, GEOMETRY, JOINTS, SEPARATION, SLIP, SQUARE, START)

OVERWRITE = fixed('overwrite', False, 'Replace files that exist.')
MODELS = (
    'unicycle', 'differential_drive', 'tricycle', 'bicycle', 'car', 'front_drive_tricycle',
    'rear_wheels_tricycle', 'ackermann_car')

PLOT_PATHS = (
    replace(SEPARATION[0], check=check_positive_or_nan, required=False, description='Distance L '
            'between left and right wheels [m], above 0, for slip and for models that have two '
            'wheels on an axle.'),
    SEPARATION[1],
    fixed('model', '', 'Model of the robot, by its name in core/models. Empty: the differential '
          'drive with slip.', check_one_of('', *MODELS)),
    fixed('commands', [], 'The commands, each as speed v [m/s], yaw rate omega [rad/s] and '
          'duration [s], one after another in one flat list. For a model: its own two commands, '
          'then the duration.'),
    fixed('steps', 5, 'Number of equal steps into which each command is cut. Each has slip, or '
          'errors of the commands, of its own.', check_stages),
    fixed('command_bounds', [], 'For a model: bounds of the errors of its two commands, in one '
          'flat list. There is one picture for each pair, side by side. None: the commands have '
          'no errors.'),
    fixed('max_steering_rates', [], 'For a model: bounds [rad/s] of the rate of the steering '
          'angle. There is one picture for each, side by side. 0 or none: the angle jumps.'),
    fixed('max_steering_angle', 1.2, 'For a model: bound [rad] of the steering angle.',
          check_positive),
    fixed('wheel_base', math.nan, 'For a model: distance l [m] from the rear axle to the front '
          'axle.', check_positive_or_nan),
    fixed('wheel_radius', math.nan, 'For the model differential_drive: radius R [m] of the '
          'wheels.', check_positive_or_nan),
    fixed('paths', 100, 'Number of sample paths.', check_count),
    *START,
    fixed('seed', 0, 'Seed of the paths, 0 or above.', check_seed),
    *BIAS, *SLIP,
    replace(DISTRIBUTION, description=DISTRIBUTION.description + ' That of the errors of '
            'commands has to be bounded: gaussian means uniform there.'),
    file('output', 'paths.png', 'File to write, .png or .svg.', check_picture),
    OVERWRITE)

CALIBRATE = (
    *GEOMETRY, *JOINTS,
    file('square_runs', '', 'CSV file with the columns clockwise,true_x,true_y,odom_x,odom_y and '
         'one row for each run around a square. Where it also has the columns square_side, '
         'square_corner_radius, left_radius, right_radius or separation [m], all rows have to be '
         'of the square and the wheels that the parameters say.'),
    *SQUARE,
    fixed('recordings', [], 'Recordings of drives: bags (directories, .mcap, .db3), or CSV files '
          'of motion with the column time_sec and one of the pairs linear_x,angular_z, '
          'left_rate,right_rate, left_position,right_position or left_ticks,right_ticks.',
          kind=Kind.STRINGS, names_files=True),
    fixed('references', [], 'Bags, or CSV files with the columns time_sec,x,y,yaw, one for each '
          'of the recordings. None: the recordings hold the reference too.', kind=Kind.STRINGS,
          names_files=True),
    fixed('encoder_resolution', 0.0, 'Ticks in one turn of a joint, for files with ticks.',
          check_non_negative),
    fixed('tick_increments', False, 'Ticks are counted since the row before, not since the '
          'start.'),
    topic('motion_topic', 'joint_states', 'Subscribes to: wheel motion, where no files are given. '
          'In bags it may be JointState, Odometry (its twist), or commands as Twist or '
          'TwistStamped.'),
    ENCODER_RANGE,
    fixed('position_feedback', True, 'Use positions in wheel motion. false: use its rates only.'),
    topic('reference_topic', 'ground_truth', 'Subscribes to: reference poses, where no files are '
          'given. In bags they may be Odometry, PoseStamped, PoseWithCovarianceStamped, or /tf.'),
    fixed('reference_frames', [], 'Parent and child frame of the reference, where reference_topic '
          'is /tf.', kind=Kind.STRINGS),
    fixed('reference_type', 'odometry', 'Type of the reference topic: odometry (Odometry) or pose '
          '(PoseStamped). Bags know theirs.', check_one_of('odometry', 'pose')),
    fixed('clock', '', 'What is fitted between the clocks of wheels and reference. none: nothing. '
          'delay: one delay for all drives. offsets: an offset for each drive. drifts: an offset '
          'and a drift for each drive. auto: an offset for each drive, and a drift where it pays. '
          'Empty: delay for commands, auto for other files, none for topics.',
          check_one_of('', 'none', 'delay', 'offsets', 'drifts', 'auto')),
    fixed('mean_radius', '', 'Whether the mean radius of the wheels is fitted too. fit: it is. '
          'keep: it stays as it is. Empty: keep for commands, of which a robot covers more or '
          'less; fit for all else.', check_one_of('', 'fit', 'keep')),
    fixed('fit_response', False, 'Fit how the robot follows its commands, instead of its wheels, '
          'and write it as response_* parameters. For recordings of commands.'),
    fixed('equal_slip', True, 'Fit one slip constant for both wheels.'),
    file('output', 'calibration.yaml', 'Params file to write.', check_named),
    file('picture', '', 'Picture of the errors before and after to write, .png or .svg. Empty: '
         'none.', check_optional_picture),
    OVERWRITE,
    EXECUTOR)

ROBOT_DESCRIPTION = (
    *GEOMETRY, *JOINTS,
    topic('robot_description_topic', 'robot_description', 'Publishes: the URDF (String).'),
    fixed('robot_name', 'diffdrive', 'Name of the robot in the URDF.', check_named),
    fixed('base_frame_id', 'base_link', 'Link on the ground between the wheels.', check_frame),
    settable('wheel_base', math.nan, 'Distance [m] from the first to the last wheel of a side; '
             'wheels are listed from front to rear. NaN: 2.5 radii for each wheel.',
             check_non_negative_or_nan),
    settable('wheel_width', math.nan, 'Width [m] of the wheels, above 0. NaN: half a radius.',
             check_positive_or_nan),
    file('output', '', 'File to write instead of publishing: .urdf, or .yaml, a params file for '
         'robot_state_publisher. Empty: publish.', check_description),
    OVERWRITE,
    EXECUTOR)

DIFFDRIVE_SIM = (
    fixed('nodes', [], "The nodes to run in this process, each as 'class' or 'class:name'.",
          kind=Kind.STRINGS),
    fixed('clock_step', 0.0, 'Step [s] of a simulated clock that is published on /clock. 0: real '
          'time.', check_step),
    fixed('real_time_factor', 0.0, 'Pace of the simulated clock over that of real time. 0: as '
          'fast as the nodes can follow.', check_non_negative),
    file('record', '', 'File to record into: .csv with belief, truth, wheels and commands of one '
         'robot 50 times a second, or .mcap with all that the nodes publish. Empty: none.',
         check_recording),
    file('square_runs', '', 'CSV file to which a row is added for each run around a square: where '
         'it ended, and of which square and wheels it was. It is made where it is missing, '
         'whatever overwrite is. One with rows of another square or other wheels is refused. '
         'Empty: none.'),
    file('calibration', '', 'Params file to write at the end, with a calibration from all rows of '
         'square_runs. Empty: none.'),
    file('picture', '', 'Picture of the path that was driven to write, .png or .svg. Empty: none.',
         check_optional_picture),
    OVERWRITE,
    EXECUTOR)
