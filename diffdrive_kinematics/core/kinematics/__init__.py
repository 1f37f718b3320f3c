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
Where a robot goes when its wheels turn: poses, arcs and wheel geometry, exactly.

Poses and angles, the closed-form arc of two wheels, the geometry that turns twists into wheel
rates and back, integration of commands that vary, sequences of commands, and sums that keep
their digits over a day of driving.
"""

from diffdrive_kinematics.core.kinematics.angles import wrap_angle
from diffdrive_kinematics.core.kinematics.arc import advance, displacement, sinc
from diffdrive_kinematics.core.kinematics.checks import (
    check_above, check_count, check_finite, check_non_negative, check_positive, is_sane, LARGEST)
from diffdrive_kinematics.core.kinematics.compensated import RunningSum
from diffdrive_kinematics.core.kinematics.geometry import (
    Number, pose_change_from_travel, travel_from_angles, twist_from_wheel_rates,
    wheel_rates_from_twist, WheelGeometry)
from diffdrive_kinematics.core.kinematics.integration import (
    euler, integrate_euler, integrate_runge_kutta, runge_kutta)
from diffdrive_kinematics.core.kinematics.jacobians import inverse_jacobian, jacobian
from diffdrive_kinematics.core.kinematics.pose import (
    Array, between, compose, inverse, Pose, pose_rate, Scalar)
from diffdrive_kinematics.core.kinematics.ranges import (
    check_duration, check_length, check_rate, NANOSECONDS)
from diffdrive_kinematics.core.kinematics.sequence import (
    check_times, Command, pose_after, poses_along, retraced)
from diffdrive_kinematics.core.kinematics.turning import turning_centre, turning_radius

__all__ = [
    'Array', 'Command', 'LARGEST', 'NANOSECONDS', 'Number', 'Pose', 'RunningSum', 'Scalar',
    'WheelGeometry', 'advance', 'between', 'check_above', 'check_count', 'check_duration',
    'check_finite', 'check_length', 'check_non_negative', 'check_positive', 'check_rate',
    'check_times', 'compose', 'displacement', 'euler', 'integrate_euler', 'integrate_runge_kutta',
    'inverse', 'inverse_jacobian', 'is_sane', 'jacobian', 'pose_after', 'pose_change_from_travel',
    'pose_rate', 'poses_along', 'retraced', 'runge_kutta', 'sinc', 'travel_from_angles',
    'turning_centre', 'turning_radius', 'twist_from_wheel_rates', 'wheel_rates_from_twist',
    'wrap_angle']
