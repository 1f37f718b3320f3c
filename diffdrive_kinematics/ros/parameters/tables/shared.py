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

"""Parameters that several nodes have: joints, geometry, slip, diagnostics."""

import math

from diffdrive_kinematics.core.kinematics import check_non_negative, check_positive
from diffdrive_kinematics.core.noise import (
    check_distribution, check_session_fraction, DISTRIBUTIONS)
from diffdrive_kinematics.ros.parameters.parameter_checks import (
    check_bias, check_delay, check_frame, check_gear_ratio, check_joint_names,
    check_non_negative_or_nan, check_one_of, check_pose, check_radius_multiplier, check_range,
    check_rate_or_off, check_slip)
from diffdrive_kinematics.ros.parameters.parameter_spec import (
    Kind, ParameterSpec as Spec, string, topic)

DIAGNOSTICS = Spec('diagnostics_rate', 1.0, 'Rate [Hz] at which the node reports its status on '
                   '/diagnostics. 0: off.', check=check_rate_or_off, read_only=True)
EXECUTOR = Spec('executor', 'auto', 'Executor of the process: auto (EventsExecutor where this '
                'rclpy has it), events, or single_threaded. In diffdrive_sim the value of '
                'diffdrive_sim itself counts.', Kind.STRING,
                check_one_of('auto', 'events', 'single_threaded'), read_only=True)
COMMANDS_OUT = (
    topic('cmd_vel_topic', 'cmd_vel', 'Publishes: velocity commands.'),
    Spec('enable_stamped_cmd_vel', False, 'Publish TwistStamped instead of Twist.', Kind.BOOL,
         read_only=True),
    string('base_frame_id', 'base_link', 'Frame of stamped commands.', check_frame))
JOINTS = (
    Spec('left_wheel_names', ['left_wheel_joint'], 'Names of the joints of the left wheels.',
         Kind.STRINGS, check_joint_names, read_only=True),
    Spec('right_wheel_names', ['right_wheel_joint'], 'Names of the joints of the right wheels.',
         Kind.STRINGS, check_joint_names, read_only=True),
    Spec('left_wheel_inverted', False, 'The joints of the left wheels turn backward where the '
         'wheels roll forward, as with a mirrored motor. Rates and positions have the sign of '
         'the joints in every message.', Kind.BOOL, read_only=True),
    Spec('right_wheel_inverted', False, 'The joints of the right wheels turn backward where the '
         'wheels roll forward.', Kind.BOOL, read_only=True),
    Spec('gear_ratio', 1.0, 'Turns of a joint for one turn of its wheel, where the joints are '
         'those of motors before a gear. Rates, positions and encoders in messages are those of '
         'the joints; all other parameters are those of the wheels.', check=check_gear_ratio,
         read_only=True))
ENCODER_RANGE = Spec('encoder_range', 0.0, 'Range [rad] after which positions of the joints wrap '
                     'around. Positions that come in count modulo it, up to half a range in one '
                     'message. 0: they do not wrap.', check=check_range, read_only=True)
RADII = (
    Spec('wheel_radius', math.nan, 'Radius R of the wheels [m], above 0.', check=check_positive,
         required=True),
    Spec('left_wheel_radius_multiplier', 1.0, 'Effective radius of the left wheels over '
         'wheel_radius.', check=check_radius_multiplier),
    Spec('right_wheel_radius_multiplier', 1.0,
         'Effective radius of the right wheels over wheel_radius.', check=check_radius_multiplier))
SEPARATION = (
    Spec('wheel_separation', math.nan, 'Distance L between left and right wheels [m], above 0.',
         check=check_positive, required=True),
    Spec('wheel_separation_multiplier', 1.0, 'Effective distance between the wheels over '
         'wheel_separation.', check=check_positive))
GEOMETRY = (*SEPARATION, *RADII)

RESPONSE = (
    Spec('response_max_speed', 0.0, 'Largest speed [m/s] with which the response to commands was '
         'measured. Commands beyond it count as this one. 0: there is no response, the robot does '
         'what its commands say.', check=check_non_negative),
    Spec('response_max_yaw_rate', 0.0, 'Largest yaw rate [rad/s] with which the response was '
         'measured. Commands beyond it count as this one.', check=check_non_negative),
    Spec('response_speed_gain', 1.0, 'Gain a of the speed: where v and w are asked for, the robot '
         'drives a v s(k), with k = w / v.', check=check_positive),
    Spec('response_yaw_rate_gain', 1.0, 'Gain b of the yaw rate: the robot turns with b w + d v.',
         check=check_positive),
    Spec('response_veer', 0.0, 'By how much the robot turns on a straight, d [rad/m].'),
    Spec('response_turn_loss', 0.0, 'Loss c [m] of speed in curves: the robot keeps the share s '
         'of it, s^n = 1 - |c k|^n, down to a tenth.', check=check_non_negative),
    Spec('response_turn_loss_order', 2, 'Order n of that loss, 1 or 2.', Kind.INTEGER),
    Spec('response_curvatures', [], 'Values of |k| [1/m] from 0 on at which a table has factors '
         'on s.', Kind.DOUBLES, read_only=True),
    Spec('response_shares', [], 'The factors on s, one for each of response_curvatures.',
         Kind.DOUBLES, read_only=True),
    Spec('response_delay', 0.0, 'How late the robot follows [s].', check=check_delay))
BIAS = (
    Spec('left_bias', 0.0, 'Fraction of its travel by which the left wheel goes further, above '
         '-1.', check=check_bias),
    Spec('right_bias', 0.0, 'Fraction of its travel by which the right wheel goes further, above '
         '-1.', check=check_bias))
SLIP = (
    Spec('left_slip_variance', 0.0, 'Slip constant k [m] of the left wheel: the variance of the '
         'error of its travel is k times the length of the travel.', check=check_slip),
    Spec('right_slip_variance', 0.0, 'Slip constant k [m] of the right wheel: the variance of the '
         'error of its travel is k times the length of the travel.', check=check_slip),
    Spec('linear_slip_variance', 0.0, 'Slip constant k_d [m] of the body, beside that of the '
         'wheels: the variance of the error of the distance is k_d times the distance.',
         check=check_slip),
    Spec('turn_slip_variance', 0.0, 'Slip constant k_t [rad] of the body: the variance of the '
         'error of the yaw is k_t times the angle turned, plus k_x times the distance.',
         check=check_slip),
    Spec('heading_slip_variance', 0.0, 'Slip constant k_x [rad^2/m] of the body: see '
         'turn_slip_variance.', check=check_slip))
SESSION = (
    Spec('session_scale_stddev', 0.0, 'Standard deviation, between runs, of the fraction by '
         'which all travel of a run is longer, 0 to 0.1.', check=check_session_fraction),
    Spec('session_separation_stddev', 0.0, 'Standard deviation, between runs, of the fraction '
         'by which the separation is larger, 0 to 0.1.', check=check_session_fraction),
    Spec('session_curvature_stddev', 0.0, 'Standard deviation, between runs, of the heading '
         'that is gained per metre of travel [rad/m].', check=check_slip))
DISTRIBUTION = Spec(
    'slip_distribution', 'gaussian', 'Distribution of the slip, with the variance that is set: '
    f"{', '.join(DISTRIBUTIONS)}.", Kind.STRING, check_distribution)

START = (
    Spec('initial_pose', [0.0, 0.0, 0.0], 'Pose at the start: x [m], y [m], yaw [rad].',
         Kind.DOUBLES, check_pose, read_only=True),
    Spec('initial_heading_concentration', math.nan, 'Concentration kappa of the von Mises density '
         'of the yaw at the start around that of initial_pose, about 1 / variance [1/rad^2]. NaN: '
         'the yaw is known.', check=check_non_negative_or_nan, read_only=True))

SQUARE = (
    Spec('square_side', 0.0, 'Length [m] of the sides of the square of UMBmark. 0: there is no '
         'square.', check=check_non_negative, read_only=True),
    Spec('square_corner_radius', 0.0, 'Radius [m] of the corners of the square. 0: the robot '
         'turns on the spot.', check=check_non_negative, read_only=True))
