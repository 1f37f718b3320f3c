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
    check_frame, check_offset)
from diffdrive_kinematics.ros.parameters.parameter_spec import (
    Kind, ParameterSpec as Spec, string, topic)
from diffdrive_kinematics.ros.parameters.tables.shared import (
    DIAGNOSTICS, EXECUTOR, GEOMETRY, JOINTS)

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
    *GEOMETRY, *JOINTS,
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
    Spec('publish_rate', 50.0, 'rate [Hz] at which the wheel rates are repeated',
         check=check_rate),
    Spec('update_rate', 100.0, 'rate [Hz] at which ramps step; each step is published',
         check=check_rate),
    Spec('max_wheel_rate', math.nan, 'bound [rad/s] of all wheels; beyond it both sides are '
         'scaled by one factor, so that the path keeps its curvature; NaN: none'),
    string('base_frame_id', 'base_link', 'frame of the limited velocity', check_frame),
    *_axis_entries(), DIAGNOSTICS, EXECUTOR)
