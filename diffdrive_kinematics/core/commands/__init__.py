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
From what is asked for to what the wheels are told, over time.

Limits of velocity, acceleration and jerk, the bound of the wheel rates, the drive that ramps and
times out; how a robot follows its commands; who of several viewers drives; courses to drive:
recordings and the square of UMBmark; and steering laws, which find the command from where the
robot is: :class:`HeadingRegulator`, :class:`PointForward`, :class:`PoseController`, and
:class:`PurePursuit` along :class:`Waypoints`.  An order in which to read the files:

* the drive: ``wheel_command``, ``drive_settings``, ``drive_state`` (its steps), ``drive`` (when);
* what holds it back: ``limit_ranges`` and ``limits``, ``easing``, ``saturation``, ``ramp``;
* how a robot follows: ``command_response``, ``turn_loss``; who drives: ``helm``;
* courses: ``playback``, ``square_course``;
* laws: ``steering``, ``steering_laws``, ``pose_controller``, ``waypoints``, ``pursuit``.
"""

from diffdrive_kinematics.core.commands.command_response import CommandFor, CommandResponse
from diffdrive_kinematics.core.commands.drive import Drive
from diffdrive_kinematics.core.commands.drive_settings import DriveSettings
from diffdrive_kinematics.core.commands.easing import largest_change
from diffdrive_kinematics.core.commands.helm import Helm
from diffdrive_kinematics.core.commands.limits import AxisLimits
from diffdrive_kinematics.core.commands.playback import (
    Course, course_from_commands, course_from_recording, TimedTwist)
from diffdrive_kinematics.core.commands.pose_controller import PoseController
from diffdrive_kinematics.core.commands.pursuit import PurePursuit, PursuitCommand
from diffdrive_kinematics.core.commands.ramp import ramp_step, RampStep
from diffdrive_kinematics.core.commands.saturation import (
    saturate, SaturatedRates, wheel_bound, WheelBound)
from diffdrive_kinematics.core.commands.square_course import (
    QUARTER, square_course, square_rounds, SquareRun)
from diffdrive_kinematics.core.commands.steering import (
    Law, Progress, SteeringCommand, SteeringLimits)
from diffdrive_kinematics.core.commands.steering_laws import HeadingRegulator, PointForward
from diffdrive_kinematics.core.commands.waypoints import Waypoints, waypoints_from_poses
from diffdrive_kinematics.core.commands.wheel_command import STILL, Twist, WheelCommand

__all__ = [
    'AxisLimits', 'CommandFor', 'CommandResponse', 'Course', 'Drive', 'DriveSettings',
    'HeadingRegulator', 'Helm', 'Law', 'PointForward', 'PoseController', 'Progress', 'PurePursuit',
    'PursuitCommand', 'QUARTER', 'RampStep', 'STILL', 'SaturatedRates', 'SquareRun',
    'SteeringCommand', 'SteeringLimits', 'TimedTwist', 'Twist', 'Waypoints', 'WheelBound',
    'WheelCommand', 'course_from_commands', 'course_from_recording', 'largest_change', 'ramp_step',
    'saturate', 'square_course', 'square_rounds', 'waypoints_from_poses', 'wheel_bound']
