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

"""Params files of the shape of other packages' robots, with their names and values."""

CLEARPATH = """\
    left_wheel_names: [front_left_wheel_joint, rear_left_wheel_joint]
    right_wheel_names: [front_right_wheel_joint, rear_right_wheel_joint]
    wheel_separation: 0.562
    wheel_separation_multiplier: 1.5
    wheel_radius: 0.1651
    wheels_per_side: 2
    publish_rate: 50.0
    odom_frame_id: odom
    base_frame_id: base_link
    pose_covariance_diagonal: [0.001, 0.001, 0.001, 0.001, 0.001, 0.03]
    twist_covariance_diagonal: [0.001, 0.001, 0.001, 0.001, 0.001, 0.03]
    open_loop: false
    enable_odom_tf: false
    cmd_vel_timeout: 0.25
    use_stamped_vel: false
    preserve_turning_radius: true
    publish_limited_velocity: true
    linear.x.max_velocity: 4.0
    linear.x.max_acceleration: 2.0
    angular.z.max_velocity: 2.0
    angular.z.max_acceleration: 3.0
"""
ROSBOT = """\
    left_wheel_names: [fl_wheel_joint, rl_wheel_joint]
    right_wheel_names: [fr_wheel_joint, rr_wheel_joint]
    wheel_separation: 0.27
    wheel_radius: 0.048
    tf_frame_prefix_enable: false
    position_feedback: true
    enable_odom_tf: false
    cmd_vel_timeout: 0.2
    use_stamped_vel: true
    velocity_rolling_window_size: 3
    linear: {x: {has_velocity_limits: true, max_velocity: 0.9, min_velocity: -0.9,
                 has_acceleration_limits: true, max_acceleration: 1.5, has_jerk_limits: false}}
    angular: {z: {has_velocity_limits: true, max_velocity: 3.14, max_acceleration: 5.74}}
"""
ANDINO = """\
    type: diff_drive_controller/DiffDriveController
    left_wheel_names: [left_wheel_joint]
    right_wheel_names: [right_wheel_joint]
    wheel_separation: 0.137
    wheel_radius: 0.033
    enable_odom_tf: false
    publish_cmd: true
    publish_wheel_data: true
    linear.x.has_velocity_limits: false
"""
FAKE = """\
    wheels: {separation: 0.16, radius: 0.033}
    wheel_separation: 0.16
    wheel_radius: 0.033
    enable_odom_tf: false
    joint_states_frame: base_footprint
    odom_frame: odom
    base_frame: base_footprint
"""
LOOPBACK = """\
    wheel_separation: 0.16
    wheel_radius: 0.033
    enable_odom_tf: false
    update_duration: 0.02
    odom_publish_dur: 0.02
    speed_factor: 1.0
    base_frame_id: base_footprint
    odom_frame_id: odom
    map_frame_id: map
    scan_frame_id: base_scan
    publish_clock: true
"""
FILES = {
    'clearpath': (CLEARPATH, {'wheels_per_side', 'open_loop', 'use_stamped_vel',
                              'preserve_turning_radius'}),
    'rosbot': (ROSBOT, {'use_stamped_vel'}),
    'andino': (ANDINO, {'type', 'publish_cmd', 'publish_wheel_data'}),
    'turtlebot3_fake_node': (FAKE, {'wheels.separation', 'wheels.radius', 'joint_states_frame',
                                    'odom_frame', 'base_frame'}),
    'nav2_loopback_sim': (LOOPBACK, {'update_duration', 'odom_publish_dur', 'speed_factor',
                                     'map_frame_id', 'scan_frame_id', 'publish_clock'})}
