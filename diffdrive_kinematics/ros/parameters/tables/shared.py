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
from diffdrive_kinematics.ros.parameters.parameter_spec import fixed, settable, topic

SIDES = 'left', 'right'
DIAGNOSTICS = fixed('diagnostics_rate', 1.0, 'Rate [Hz] at which the node reports its status on '
                    '/diagnostics. 0: off.', check_rate_or_off)
EXECUTOR = fixed('executor', 'auto', 'Executor of the process: auto (EventsExecutor where this '
                 'rclpy has it), events, or single_threaded. In diffdrive_sim the value of '
                 'diffdrive_sim itself counts.', check_one_of('auto', 'events', 'single_threaded'))
COMMANDS_OUT = (
    topic('cmd_vel_topic', 'cmd_vel', 'Publishes: velocity commands.'),
    fixed('enable_stamped_cmd_vel', False, 'Publish TwistStamped instead of Twist.'),
    fixed('base_frame_id', 'base_link', 'Frame of stamped commands.', check_frame))
JOINTS = (
    *(fixed(f'{side}_wheel_names', [f'{side}_wheel_joint'], f'Names of the joints of the {side} '
            'wheels.', check_joint_names) for side in SIDES),
    fixed('left_wheel_inverted', False, 'The joints of the left wheels turn backward where the '
          'wheels roll forward, as with a mirrored motor. Rates and positions have the sign of '
          'the joints in every message.'),
    fixed('right_wheel_inverted', False, 'The joints of the right wheels turn backward where the '
          'wheels roll forward.'),
    fixed('gear_ratio', 1.0, 'Turns of a joint for one turn of its wheel, where the joints are '
          'those of motors before a gear. Rates, positions and encoders in messages are those of '
          'the joints; all other parameters are those of the wheels.', check_gear_ratio))
ENCODER_RANGE = fixed('encoder_range', 0.0, 'Range [rad] after which positions of the joints wrap '
                      'around. Positions that come in count modulo it, up to half a range in one '
                      'message. 0: they do not wrap.', check_range)
RADII = (
    settable('wheel_radius', math.nan, 'Radius R of the wheels [m], above 0.', check_positive,
             required=True),
    *(settable(f'{side}_wheel_radius_multiplier', 1.0, f'Effective radius of the {side} wheels '
               'over wheel_radius.', check_radius_multiplier) for side in SIDES))
SEPARATION = (
    settable('wheel_separation', math.nan, 'Distance L between left and right wheels [m], above '
             '0.', check_positive, required=True),
    settable('wheel_separation_multiplier', 1.0, 'Effective distance between the wheels over '
             'wheel_separation.', check_positive))
GEOMETRY = (*SEPARATION, *RADII)

RESPONSE = (
    settable('response_max_speed', 0.0, 'Largest speed [m/s] with which the response to commands '
             'was measured. Commands beyond it count as this one. 0: there is no response, the '
             'robot does what its commands say.', check_non_negative),
    settable('response_max_yaw_rate', 0.0, 'Largest yaw rate [rad/s] with which the response was '
             'measured. Commands beyond it count as this one.', check_non_negative),
    settable('response_speed_gain', 1.0, 'Gain a of the speed: where v and w are asked for, the '
             'robot drives a v s(k), with k = w / v.', check_positive),
    settable('response_yaw_rate_gain', 1.0, 'Gain b of the yaw rate: the robot turns with b w + d '
             'v.', check_positive),
    settable('response_veer', 0.0, 'By how much the robot turns on a straight, d [rad/m].'),
    settable('response_turn_loss', 0.0, 'Loss c [m] of speed in curves: the robot keeps the share '
             's of it, s^n = 1 - |c k|^n, down to a tenth.', check_non_negative),
    settable('response_turn_loss_order', 2, 'Order n of that loss, 1 or 2.'),
    fixed('response_curvatures', [], 'Values of |k| [1/m] from 0 on at which a table has factors '
          'on s.'),
    fixed('response_shares', [], 'The factors on s, one for each of response_curvatures.'),
    settable('response_delay', 0.0, 'How late the robot follows [s].', check_delay))
BIAS = tuple(
    settable(f'{side}_bias', 0.0, f'Fraction of its travel by which the {side} wheel goes '
             'further, above -1.', check_bias) for side in SIDES)
SLIP = (
    *(settable(f'{side}_slip_variance', 0.0, f'Slip constant k [m] of the {side} wheel: the '
               'variance of the error of its travel is k times the length of the travel.',
               check_slip) for side in SIDES),
    settable('linear_slip_variance', 0.0, 'Slip constant k_d [m] of the body, beside that of the '
             'wheels: the variance of the error of the distance is k_d times the distance.',
             check_slip),
    settable('turn_slip_variance', 0.0, 'Slip constant k_t [rad] of the body: the variance of the '
             'error of the yaw is k_t times the angle turned, plus k_x times the distance.',
             check_slip),
    settable('heading_slip_variance', 0.0, 'Slip constant k_x [rad^2/m] of the body: see '
             'turn_slip_variance.', check_slip))
SESSION = (
    settable('session_scale_stddev', 0.0, 'Standard deviation, between runs, of the fraction by '
             'which all travel of a run is longer, 0 to 0.1.', check_session_fraction),
    settable('session_separation_stddev', 0.0, 'Standard deviation, between runs, of the fraction '
             'by which the separation is larger, 0 to 0.1.', check_session_fraction),
    settable('session_curvature_stddev', 0.0, 'Standard deviation, between runs, of the heading '
             'that is gained per metre of travel [rad/m].', check_slip))
DISTRIBUTION = settable('slip_distribution', 'gaussian', 'Distribution of the slip, with the '
                        f"variance that is set: {', '.join(DISTRIBUTIONS)}.", check_distribution)
START = (
    fixed('initial_pose', [0.0, 0.0, 0.0], 'Pose at the start: x [m], y [m], yaw [rad].',
          check_pose),
    fixed('initial_heading_concentration', math.nan, 'Concentration kappa of the von Mises '
          'density of the yaw at the start around that of initial_pose, about 1 / variance '
          '[1/rad^2]. NaN: the yaw is known.', check_non_negative_or_nan))

SQUARE = (
    fixed('square_side', 0.0, 'Length [m] of the sides of the square of UMBmark. 0: there is no '
          'square.', check_non_negative),
    fixed('square_corner_radius', 0.0, 'Radius [m] of the corners of the square. 0: the robot '
          'turns on the spot.', check_non_negative))
