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
    check_bias, check_concentration, check_gear_ratio, check_joint_names, check_one_of,
    check_pose, check_radius_multiplier, check_range, check_rate_or_off)
from diffdrive_kinematics.ros.parameters.parameter_spec import Kind, ParameterSpec as Spec

DIAGNOSTICS = Spec(
    'diagnostics_rate', 1.0, 'rate [Hz] of the status on /diagnostics; 0: off',
    check=check_rate_or_off, read_only=True)
EXECUTOR = Spec(
    'executor', 'auto', 'of the process: auto (EventsExecutor where this rclpy has it), events, '
    'single_threaded; among the nodes of diffdrive_sim its own counts', Kind.STRING,
    check_one_of('auto', 'events', 'single_threaded'), read_only=True)
JOINTS = (
    Spec('left_wheel_names', ['left_wheel_joint'], 'joints of the left wheels', Kind.STRINGS,
         check_joint_names, read_only=True),
    Spec('right_wheel_names', ['right_wheel_joint'], 'joints of the right wheels', Kind.STRINGS,
         check_joint_names, read_only=True),
    Spec('left_wheel_inverted', False, 'true: the joints of the left wheels turn backward where '
         'the wheels roll forward, as a mirrored motor does; rates and positions have their sign '
         'in every message', Kind.BOOL, read_only=True),
    Spec('right_wheel_inverted', False, 'the same for the right wheels', Kind.BOOL,
         read_only=True),
    Spec('gear_ratio', 1.0, 'turns of a joint a turn of its wheel, where the joints are those of '
         'motors before a gear; rates, positions and encoders in every message are those of the '
         'joints, all other parameters those of the wheels', check=check_gear_ratio,
         read_only=True))
ENCODER_RANGE = Spec(
    'encoder_range', 0.0, 'at which positions of the joints wrap around [rad]; what comes in '
    'counts modulo it, up to half a range a message; 0: they do not wrap',
    check=check_range, read_only=True)
RADII = (
    Spec('wheel_radius', math.nan, 'radius R of the wheels [m], above 0', check=check_positive,
         required=True),
    Spec('left_wheel_radius_multiplier', 1.0, 'effective over nominal radius of the left wheels',
         check=check_radius_multiplier),
    Spec('right_wheel_radius_multiplier', 1.0,
         'effective over nominal radius of the right wheels', check=check_radius_multiplier))
SEPARATION = (
    Spec('wheel_separation', math.nan,
         'distance L between left and right wheels [m], above 0', check=check_positive,
         required=True),
    Spec('wheel_separation_multiplier', 1.0, 'effective over nominal separation',
         check=check_positive))
GEOMETRY = (*SEPARATION, *RADII)

BIAS = (
    Spec('left_bias', 0.0, 'fraction of travel that the left wheel gains, above -1',
         check=check_bias),
    Spec('right_bias', 0.0, 'fraction of travel that the right wheel gains, above -1',
         check=check_bias))
SLIP = (
    Spec('left_slip_variance', 0.0, 'k [m] of the left wheel: Var[travel error] = k |travel|',
         check=check_non_negative),
    Spec('right_slip_variance', 0.0, 'k [m] of the right wheel: Var[travel error] = k |travel|',
         check=check_non_negative),
    Spec('linear_slip_variance', 0.0, 'k_d [m] of the body, beside the wheels: '
         'Var[error of the way] = k_d |way|', check=check_non_negative),
    Spec('turn_slip_variance', 0.0, 'k_t [rad] of the body: Var[error of the yaw] = k_t |turn| '
         '+ k_x |way|', check=check_non_negative),
    Spec('heading_slip_variance', 0.0, 'k_x [rad^2/m] of the body, likewise',
         check=check_non_negative))
SESSION = (
    Spec('session_scale_stddev', 0.0, 'standard deviation, between runs, of a fraction by which '
         'all travel of a run is longer, 0 to 0.1', check=check_session_fraction),
    Spec('session_separation_stddev', 0.0, 'the same of a fraction by which the separation is '
         'larger, 0 to 0.1', check=check_session_fraction),
    Spec('session_curvature_stddev', 0.0, 'the same of a heading gained per metre of travel '
         '[rad/m]', check=check_non_negative))
DISTRIBUTION = Spec(
    'slip_distribution', 'gaussian', 'of the slip, all with the variance that is set: '
    + ', '.join(DISTRIBUTIONS), Kind.STRING, check_distribution)

START = (
    Spec('initial_pose', [0.0, 0.0, 0.0], 'x [m], y [m], yaw [rad] at start', Kind.DOUBLES,
         check_pose, read_only=True),
    Spec('initial_heading_concentration', math.nan, 'kappa of the von Mises density of the yaw '
         'at start, about that of initial_pose, near 1 / variance [1/rad^2]; NaN: it is known',
         check=check_concentration, read_only=True))

SQUARE = (
    Spec('square_side', 0.0, 'side [m] of the square of UMBmark; 0: none',
         check=check_non_negative, read_only=True),
    Spec('square_corner_radius', 0.0, 'radius [m] of its corners; 0: turns on the spot',
         check=check_non_negative, read_only=True))
