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
from diffdrive_kinematics.ros.parameters.parameter_spec import fixed, settable, topic
from diffdrive_kinematics.ros.parameters.tables.shared import (
    BIAS, DIAGNOSTICS, DISTRIBUTION, ENCODER_RANGE, EXECUTOR, GEOMETRY, JOINTS, RADII, RESPONSE,
    SEPARATION, SESSION, SLIP, START)

WHEEL_NOISE = (
    *RADII, *JOINTS,
    replace(SEPARATION[0], description='Distance L between left and right wheels [m], above 0. It '
            'is needed for session_curvature_stddev, turn_slip_variance, heading_slip_variance '
            'and response_max_speed only.', check=check_positive_or_nan,
            required=False), SEPARATION[1],
    topic('input_topic', 'wheel_rates', 'Subscribes to: wheel motion as it was commanded.'),
    topic('output_topic', 'noisy_wheel_rates', 'Publishes: wheel motion with bias and slip.'),
    ENCODER_RANGE,
    *RESPONSE, *BIAS, *SLIP, *SESSION,
    settable('slip_model', 'travel', 'Law of the slip. travel: the variance grows with distance, '
             'whatever the rate of messages. command: the standard deviation is in proportion to '
             'the rate of the wheel, one value is drawn for each message, left_slip_variance and '
             'right_slip_variance are the squares of the fractions [1], and the statistics depend '
             'on the rate of messages.', check_slip_model),
    DISTRIBUTION,
    settable('seed', 0, 'Seed of the random generator, 0 or above. Setting another one starts the '
             'noise again, with another session.', check_seed),
    settable('command_timeout', 0.5, 'Longest time [s] without a message over which rates are '
             'held, as in simulated_base. 0: any.', check_duration),
    DIAGNOSTICS, EXECUTOR)

SIMULATED_BASE = (
    *GEOMETRY, *JOINTS,
    topic('wheel_motion_topic', 'wheel_rates', 'Subscribes to: wheel motion, as rates, positions '
          'or both.'),
    topic('odom_topic', 'odom', 'Publishes: odometry. Empty: off.', optional=True),
    topic('joint_states_topic', 'joint_states', 'Publishes: joint states. Empty: off.',
          optional=True),
    topic('set_pose_topic', 'set_pose', 'Subscribes to: poses at which the robot is placed '
          '(PoseWithCovarianceStamped in odom_frame_id). Empty: off.', optional=True),
    settable('publish_rate', 50.0, 'Rate [Hz] of odometry and joint states.', check_rate),
    settable('command_timeout', 0.5, 'Time [s] without a message after which the wheels count as '
             'stopped, at the last stamp plus this time. 0: never.', check_duration),
    fixed('position_feedback', True, 'Use positions in wheel motion. false: integrate its rates '
          'only.'),
    replace(ENCODER_RANGE, description='Range [rad] after which positions of the joints wrap '
            'around. Published joint states wrap into [-range/2, range/2). Positions that come in '
            'count modulo it, up to half a range in one message. 0: they do not wrap.'),
    fixed('encoder_resolution', 0.0, 'Ticks in one turn of a joint, for the positions in '
          'published joint states. 0: ideal encoders.', check_resolution),
    settable('max_encoder_rate', 1000.0, 'Wheel rate [rad/s] well above what the wheels can do. '
             'If the positions of a driver changed faster between two messages, they count from '
             'there, as encoders do that started again elsewhere. NaN: no limit.',
             check_positive_or_nan),
    fixed('velocity_rolling_window_size', 10, 'Number of messages over which the twist is taken '
          "from a driver's positions.", check_window),
    fixed('extrapolate_positions', True, "Continue the pose from a driver's last positions with "
          'the rates of that window, so that it holds at its stamp.'),
    *START,
    fixed('initial_heading_seed', -1, 'Seed with which the yaw at the start is drawn, as for a '
          'ground truth. -1: the yaw is not drawn, and its uncertainty is published.',
          check_optional_seed),
    fixed('enable_odom_tf', True, 'Publish the transform from odom_frame_id to base_frame_id on '
          '/tf.'),
    fixed('publish_map_odom_tf', False, 'For a ground truth: publish the transform from its '
          'odom_frame_id (map) to the frame of the belief on /tf, so that tf shows the robot '
          'where it really is. enable_odom_tf must be false.'),
    topic('belief_topic', 'odom', 'Subscribes to: odometry that publish_map_odom_tf corrects.'),
    fixed('tf_frame_prefix_enable', False, 'Put a prefix before odom_frame_id and base_frame_id.'),
    fixed('tf_frame_prefix', '', 'Prefix of the frames, with or without a slash at its end. Empty '
          'or ~: the namespace of the node.', check_prefix),
    fixed('odom_frame_id', 'odom', 'Fixed frame of the odometry.', check_frame),
    fixed('base_frame_id', 'base_link', 'Frame of the robot.', check_frame),
    *SLIP, *SESSION,
    settable('slip_model', 'travel', 'Law of the slip, as in wheel_noise. The variances of the '
             'model command are not per metre and do not count here.', check_slip_model),
    settable('covariance_floor', 1e-9, 'Value that is added to every published variance, so that '
             'none is zero.', check_non_negative),
    settable('pose_covariance_diagonal', [0.0] * 6, 'Variances of the pose to publish instead of '
             'those of the slip. Zeros: those of the slip.', check_diagonal),
    settable('twist_covariance_diagonal', [0.0] * 6, 'Variances of the twist to publish instead '
             'of those of the slip. Zeros: those of the slip.', check_diagonal),
    topic('path_topic', '', 'Publishes: the path that the robot has driven (Path). Empty: off.',
          optional=True),
    fixed('path_length', 1000, 'Greatest number of poses in the path. The oldest ones are '
          'dropped.', check_count),
    fixed('path_spacing', 0.02, 'Least distance [m] between poses of the path.',
          check_non_negative),
    fixed('path_rate', 2.0, 'Rate [Hz] at which the path is published when it has changed.',
          check_rate),
    fixed('lean_path', True, 'Handle usual messages and ticks in one function each, which costs '
          'less CPU. false: handle all of them as the unusual ones are. The messages are the '
          'same.'),
    DIAGNOSTICS, EXECUTOR)

_OF_A_ROBOT = {'wheel_motion_topic': 'joint_states', 'joint_states_topic': ''}
WHEEL_ODOMETRY = tuple(
    replace(entry, default=_OF_A_ROBOT.get(entry.name, entry.default)) for entry in SIMULATED_BASE)

FORWARD_PROJECTION = (
    *GEOMETRY, *JOINTS,
    topic('odom_topic', 'odom', 'Subscribes to: odometry, which says where the robot is.'),
    topic('wheel_motion_topic', 'wheel_rates', 'Subscribes to: wheel motion, whose rates are '
          'held.'),
    topic('poses_topic', 'projected_poses', 'Publishes: the sampled poses (PoseArray). Empty: '
          'off.', optional=True),
    topic('boundary_topic', 'projected_boundary', 'Publishes: the boundary of all that bounded '
          'slip can reach (PolygonStamped). Empty: off.', optional=True),
    settable('publish_rate', 5.0, 'Rate [Hz] of the projections.', check_rate),
    settable('command_timeout', 0.5, 'Time [s] without a message after which the wheels count as '
             'stopped, as in simulated_base. 0: never.', check_duration),
    ENCODER_RANGE,
    settable('horizon', 2.0, 'Time ahead [s] for which poses are projected, above 0.',
             check_horizon),
    settable('stages', 4, 'Number of equal steps into which the horizon is cut. Each has slip of '
             'its own.', check_stages),
    settable('samples', 200, 'Number of sampled poses.', check_count),
    settable('seed', 0, 'Seed of the samples. It is used again each time, so that the samples '
             'move with the robot.', check_seed),
    *SLIP, DISTRIBUTION, DIAGNOSTICS, EXECUTOR)
