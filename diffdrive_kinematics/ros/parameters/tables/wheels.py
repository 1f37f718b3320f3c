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

"""The parameters of the nodes that listen to wheel motion."""

from dataclasses import replace

from diffdrive_kinematics.core.kinematics import check_duration, check_non_negative, check_rate
from diffdrive_kinematics.core.noise import check_slip_model
from diffdrive_kinematics.ros.parameters.parameter_checks import (
    check_count, check_diagonal, check_frame, check_horizon, check_optional_seed,
    check_positive_or_nan, check_prefix, check_resolution, check_seed, check_stages,
    check_window)
from diffdrive_kinematics.ros.parameters.parameter_spec import (
    Kind, ParameterSpec as Spec, string, topic)
from diffdrive_kinematics.ros.parameters.tables.shared import (
    BIAS, DIAGNOSTICS, DISTRIBUTION, ENCODER_RANGE, EXECUTOR, GEOMETRY, JOINTS, RADII, SEPARATION,
    SESSION, SLIP, START)

WHEEL_NOISE = (
    *RADII, *JOINTS,
    replace(SEPARATION[0], description='distance L between left and right wheels [m], above 0; '
            'session_curvature_stddev, turn_slip_variance and heading_slip_variance ask for it',
            check=check_positive_or_nan, required=False), SEPARATION[1],
    topic('input_topic', 'wheel_rates', 'nominal wheel motion in'),
    topic('output_topic', 'noisy_wheel_rates', 'effective wheel motion out'),
    ENCODER_RANGE,
    *BIAS, *SLIP, *SESSION,
    Spec('slip_model', 'travel', "'travel': variance grows with distance, whatever the message "
         "rate; 'command': sigma is in proportion to the rate, drawn once a message, "
         '*_slip_variance is its squared fraction [1], and the statistics depend on the message '
         'rate', Kind.STRING, check_slip_model),
    DISTRIBUTION,
    Spec('seed', 0, 'of the random generator, 0 or above; setting another one starts anew, with '
         'another session',
         Kind.INTEGER, check_seed),
    Spec('command_timeout', 0.5, 'silence [s] over which rates are held at most; as in '
         'simulated_base; 0: any', check=check_duration),
    DIAGNOSTICS, EXECUTOR)

SIMULATED_BASE = (
    *GEOMETRY, *JOINTS,
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
    replace(ENCODER_RANGE, description='at which positions of the joints wrap around [rad]; '
            'joint states out wrap into [-range/2, range/2), and what comes in counts modulo it, '
            'up to half a range a message; 0: they do not wrap'),
    Spec('encoder_resolution', 0.0, 'ticks a turn of the joint in the positions of joint states '
         'out; 0: ideal', check=check_resolution, read_only=True),
    Spec('max_encoder_rate', 1000.0, 'wheel rate [rad/s], well above what the wheels can do: '
         "a driver's positions that went faster between two messages count anew, as encoders "
         'that started again elsewhere do; NaN: none', check=check_positive_or_nan),
    Spec('velocity_rolling_window_size', 10, "over how many messages of a driver's positions the "
         'twist is taken', Kind.INTEGER, check_window, read_only=True),
    Spec('extrapolate_positions', True, "whether the pose goes on from a driver's last positions "
         'by the rates of that window, so that it is that of its stamp', Kind.BOOL,
         read_only=True),
    *START,
    Spec('initial_heading_seed', -1, 'draw the yaw at start with this seed, as a ground truth '
         'does; -1: do not, and publish how uncertain it is', Kind.INTEGER, check_optional_seed,
         read_only=True),
    Spec('enable_odom_tf', True, 'broadcast odom_frame_id -> base_frame_id',
         Kind.BOOL, read_only=True),
    Spec('publish_map_odom_tf', False, 'of a ground truth: broadcast odom_frame_id (map) -> the '
         'frame of the belief, so that tf shows the robot where it is (needs '
         'enable_odom_tf false)', Kind.BOOL, read_only=True),
    topic('belief_topic', 'odom', 'odometry in that publish_map_odom_tf corrects'),
    Spec('tf_frame_prefix_enable', False, 'put a prefix before odom_frame_id and base_frame_id',
         Kind.BOOL, read_only=True),
    string('tf_frame_prefix', '', 'that prefix, with or without a slash at its end; empty or ~: '
           'the namespace of the node', check_prefix),
    string('odom_frame_id', 'odom', 'fixed frame of the odometry', check_frame),
    string('base_frame_id', 'base_link', 'frame of the robot', check_frame),
    *SLIP, *SESSION,
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
    DIAGNOSTICS, EXECUTOR)

_OF_A_ROBOT = {'wheel_motion_topic': 'joint_states', 'joint_states_topic': ''}
WHEEL_ODOMETRY = tuple(
    replace(entry, default=_OF_A_ROBOT.get(entry.name, entry.default)) for entry in SIMULATED_BASE)

FORWARD_PROJECTION = (
    *GEOMETRY, *JOINTS,
    topic('odom_topic', 'odom', 'odometry in: where the robot is'),
    topic('wheel_motion_topic', 'wheel_rates', 'wheel motion in: the rates that are held'),
    topic('poses_topic', 'projected_poses', 'samples out, PoseArray; empty: off', optional=True),
    topic('boundary_topic', 'projected_boundary', 'boundary of all that bounded slip can reach '
          'out, PolygonStamped; empty: off', optional=True),
    Spec('publish_rate', 5.0, 'rate [Hz] of the projections', check=check_rate),
    Spec('command_timeout', 0.5, 'silence [s] after which the wheels count as stopped; as in '
         'simulated_base; 0: never', check=check_duration),
    ENCODER_RANGE,
    Spec('horizon', 2.0, 'how far ahead [s] to look, above 0', check=check_horizon),
    Spec('stages', 4, 'into how many steps of equal length the horizon is cut, each with slip of '
         'its own', Kind.INTEGER, check_stages),
    Spec('samples', 200, 'number of poses', Kind.INTEGER, check_count),
    Spec('seed', 0, 'of the samples; the same each time, so that they move with the robot',
         Kind.INTEGER, check_seed),
    *SLIP, DISTRIBUTION, DIAGNOSTICS, EXECUTOR)
