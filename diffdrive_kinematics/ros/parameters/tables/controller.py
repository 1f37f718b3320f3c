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

"""The parameters of ``diff_drive_controller``."""

import math
from typing import Tuple

from diffdrive_kinematics.core.kinematics import check_duration, check_rate
from diffdrive_kinematics.ros.parameters.parameter_checks import (
    check_frame, check_offset, check_update_rate)
from diffdrive_kinematics.ros.parameters.parameter_spec import (
    fixed, ParameterSpec, settable, topic)
from diffdrive_kinematics.ros.parameters.tables.shared import (
    DIAGNOSTICS, EXECUTOR, GEOMETRY, JOINTS, RESPONSE)

LIMITS = {
    'max_velocity': 'Highest velocity [{unit}], 0 or above. NaN: no limit.',
    'min_velocity': 'Lowest velocity [{unit}], 0 or below. NaN: -max_velocity.',
    'max_acceleration': 'Highest acceleration [{unit}] when speeding up forward, above 0. NaN: '
    'no limit.',
    'max_acceleration_reverse': 'Acceleration limit [{unit}] when speeding up in reverse, below '
    '0. NaN: -max_acceleration.',
    'max_deceleration': 'Acceleration limit [{unit}] when slowing down forward, below 0. NaN: '
    'max_acceleration_reverse.',
    'max_deceleration_reverse': 'Acceleration limit [{unit}] when slowing down in reverse, above '
    '0. NaN: -max_deceleration.',
    'max_jerk': 'Highest jerk [{unit}] while the acceleration rises, as when speeding up forward '
    'begins or braking ends, above 0. NaN: no limit.',
    'min_jerk': 'Jerk limit [{unit}] while the acceleration falls, below 0. NaN: -max_jerk.',
    'min_acceleration': 'Limit [{unit}] of every fall of the velocity, in older files, below 0.'}
SWITCHES = {  # what their limits have in their names
    'has_velocity_limits': 'velocity', 'has_acceleration_limits': 'celeration',
    'has_jerk_limits': 'jerk'}
_AXES = {'linear.x': 'm', 'angular.z': 'rad'}


def _per(limit: str) -> str:
    return 's' if 'velocity' in limit else 's^3' if 'jerk' in limit else 's^2'


def _axis_entries() -> Tuple[ParameterSpec, ...]:
    limits = tuple(
        settable(f'{axis}.{limit}', math.nan, meaning.format(unit=f'{unit}/{_per(limit)}'))
        for axis, unit in _AXES.items() for limit, meaning in LIMITS.items())
    switches = tuple(
        settable(f'{axis}.{switch}', True, 'Use the limits of this kind. It comes from older '
                 'files; leave the limits NaN instead of setting it to false.')
        for axis in _AXES for switch in SWITCHES)
    return limits + switches


DIFF_DRIVE_CONTROLLER = (
    *GEOMETRY, *JOINTS,
    topic('cmd_vel_topic', 'cmd_vel', 'Subscribes to: velocity commands.'),
    topic('emergency_stop_topic', '', 'Subscribes to: the emergency stop (Bool), of any quality '
          'of service. At true the wheels stop at once, and no command is obeyed until it is '
          'false. After the start none is heard for 1 s (5 s beside a latched publisher) until '
          'it says something. Empty: only the services ~/stop and ~/resume are there.',
          optional=True),
    topic('wheel_rates_topic', 'wheel_rates', 'Publishes: wheel rates (JointState).'),
    topic('wheel_commands_topic', '', 'Publishes: wheel rates for a velocity controller of '
          'ros2_control (Float64MultiArray), left wheels, then right wheels. Empty: off.',
          optional=True),
    topic('cmd_vel_out_topic', 'cmd_vel_out', 'Publishes: the velocity after all limits '
          '(TwistStamped).'),
    fixed('publish_limited_velocity', False, 'Publish cmd_vel_out.'),
    fixed('enable_stamped_cmd_vel', False, 'Commands are TwistStamped instead of Twist.'),
    settable('stamp_tolerance', 0.0, 'Greatest age [s] of the stamp of a command with which the '
             'wheel rates get that stamp. Rates of older commands get the time of arrival.',
             check_duration),
    settable('cmd_vel_timeout', 0.5, 'Age [s] at which a command ends and the robot brakes. '
             'Commands that are older when they come are refused. 0: commands never end.',
             check_duration),
    settable('cmd_vel_clock_offset', 0.0, 'Time on the clock of the controller minus time on the '
             'clock of the senders of commands [s]. NaN: it is unknown, and neither stamps nor '
             'the time of sending count.', check_offset),
    settable('publish_rate', 50.0, 'Rate [Hz] at which the wheel rates are repeated.', check_rate),
    settable('update_rate', 100.0, 'Rate [Hz] at which ramps step. Each step is published.',
             check_update_rate),
    settable('max_wheel_rate', math.nan, 'Highest rate [rad/s] of every wheel. Beyond it the '
             'rates of both sides are scaled by one factor, so that the path keeps its curvature. '
             'NaN: no limit.'),
    fixed('base_frame_id', 'base_link', 'Frame of the limited velocity.', check_frame),
    settable('use_response', False, 'Ask for the command that yields, by the response, the motion '
             'that cmd_vel wants. Limits hold for the motion wanted and for what is asked for, '
             'which is at most 3 times the speed asked for on a straight.'),
    *RESPONSE, *_axis_entries(), DIAGNOSTICS, EXECUTOR)
