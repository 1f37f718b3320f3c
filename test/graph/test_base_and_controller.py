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

"""Outputs of base and controller: frames, joints, limits, timeouts."""

import math

from diffdrive_kinematics.nodes.simulated_base import SimulatedBase
from nav_msgs.msg import Odometry
import pytest
from rclpy.parameter import Parameter
from sensor_msgs.msg import JointState
from support.graph import KHEPERA, stamp_ns, wheel_motion
from support.inside import inside, START_NS
from support.stepped import messages, nodes, tell_wheels


@pytest.mark.quick
def test_odometry_has_its_frames_initial_pose_covariances_and_twist_in_the_robots_frame(graph):
    graph.start('simulated_base', {
        **KHEPERA, 'initial_pose': [1.0, 2.0, math.pi / 2], 'odom_frame_id': 'map',
        'base_frame_id': 'robot', 'enable_odom_tf': False, 'command_timeout': 0.0,
        'pose_covariance_diagonal': [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]})
    odometry = graph.collect(Odometry, 'odom')
    graph.publisher(JointState, 'wheel_rates').publish(
        wheel_motion(graph.now_ns(), velocity=[1.0, 1.0]))
    message = graph.wait_for(
        lambda: odometry and odometry[-1].pose.pose.position.y > 2.01 and odometry[-1], 'motion')
    assert (message.header.frame_id, message.child_frame_id) == ('map', 'robot')
    assert message.pose.pose.position.x == pytest.approx(1.0, abs=1e-12)
    assert message.twist.twist.linear.x == pytest.approx(0.021, rel=1e-12)
    assert message.twist.twist.linear.y == 0.0
    assert list(message.pose.covariance[::7]) == [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]


@pytest.mark.ros
def test_joint_states_carry_accumulated_positions_and_can_be_switched_off(diffdrive):
    robot = diffdrive(
        nodes('simulated_base', 'simulated_base:ground_truth', ground_truth={
            'odom_topic': 'ground_truth', 'joint_states_topic': ''}),
        params={**KHEPERA, 'enable_odom_tf': False, 'command_timeout': 0.0})
    robot.advance(0.1)
    tell_wheels(robot, velocity=[2.0, -1.0])
    robot.advance(1.0)
    joints = messages(robot, 'joint_states')
    seconds = stamp_ns(joints[-1]) / 1e9 - 0.1
    assert list(joints[-1].position) == pytest.approx([2.0 * seconds, -seconds], rel=1e-12)
    assert list(joints[-1].velocity) == [2.0, -1.0]
    assert len(joints) == len(robot.history('ground_truth'))  # of one base, not of two


@pytest.mark.ros
def test_the_wheels_stop_exactly_at_the_last_stamp_plus_the_timeout(diffdrive):
    robot = diffdrive(nodes('simulated_base'), params={
        **KHEPERA, 'enable_odom_tf': False, 'command_timeout': 0.3})
    robot.advance(0.1)
    tell_wheels(robot, velocity=[2.0, 4.0])
    robot.advance(1.0)
    message = robot.history('joint_states')[-1].message
    assert list(message.velocity) == [0.0, 0.0]
    assert list(message.position) == pytest.approx([0.6, 1.2], rel=1e-12)


@pytest.mark.ros
def test_rates_come_as_a_float64_multi_array_too_where_the_yaml_asks_for_it(diffdrive):
    robot = diffdrive(nodes('diff_drive_controller'), params={
        **KHEPERA, 'left_wheel_names': ['fl', 'rl'], 'right_wheel_names': ['fr', 'rr'],
        'wheel_commands_topic': 'wheels/commands', 'cmd_vel_timeout': 0.0})
    robot.drive(0.021, 0.5, 0.1)
    turn = 0.5 * 0.0885 / 2.0 / 0.021
    assert list(robot.history('wheels/commands')[-1].message.data) == pytest.approx(
        [1.0 - turn, 1.0 - turn, 1.0 + turn, 1.0 + turn], rel=1e-12)
    assert list(robot.history('wheel_rates')[-1].message.name) == ['fl', 'rl', 'fr', 'rr']


@pytest.mark.ros
def test_the_drive_brakes_through_the_limiter_after_the_timeout(diffdrive):
    robot = diffdrive(nodes('diff_drive_controller'), params={
        **KHEPERA, 'cmd_vel_timeout': 0.2, 'publish_limited_velocity': True, 'update_rate': 50.0,
        'linear.x.max_acceleration': 2.0, 'linear.x.max_deceleration': -0.5})
    robot.drive(0.1, 0.0, 0.3)
    robot.advance(1.0)
    braking = [(each.time, each.message.twist.linear.x) for each in robot.history('cmd_vel_out')]
    full = max(time for time, v in braking if v == 0.1)
    stopped = min(time for time, v in braking if v == 0.0 and time > full)
    speeds = sorted(
        {round(v, 12) for time, v in braking if full <= time <= stopped}, reverse=True)
    assert speeds == pytest.approx([0.01 * k for k in range(10, -1, -1)], abs=1e-12)
    assert braking[-1][1] == 0.0


@pytest.mark.ros
def test_both_wheels_are_scaled_by_one_factor_at_the_wheel_rate_bound(diffdrive):
    robot = diffdrive(nodes('diff_drive_controller'), params={
        **KHEPERA, 'max_wheel_rate': 5.0, 'cmd_vel_timeout': 0.0})
    robot.drive(0.42, 4.0, 0.1)
    turn = 4.0 * 0.0885 / 2.0 / 0.021
    left, right = robot.history('wheel_rates')[-1].message.velocity
    assert right == 5.0
    assert left / right == pytest.approx((20.0 - turn) / (20.0 + turn), rel=1e-12)


def test_a_change_of_geometry_and_of_the_rate_at_run_time_keeps_the_pose():
    with inside(SimulatedBase, {**KHEPERA, 'enable_odom_tf': False}) as held:
        def roll(offset_ns, angle):
            held.advance_to(START_NS + offset_ns)
            held.hear('/wheel_rates', wheel_motion(START_NS + offset_ns, [angle, angle]))

        roll(0, 0.0)
        roll(100_000_000, 1.0)
        before = len(held.said['/odom'])
        held.node.set_parameters([
            Parameter(name, value=value)
            for name, value in (('wheel_radius', 0.042), ('publish_rate', 200.0))])
        for step in range(1, 21):
            held.advance_to(START_NS + 100_000_000 + step * 5_000_000)
        assert len(held.said['/odom']) - before >= 20
        assert held.node.reading().pose.x == pytest.approx(0.021, abs=1e-12)
        roll(600_000_000, 2.0)
        assert held.node.reading().pose.x == pytest.approx(0.021 + 0.042, abs=1e-12)
