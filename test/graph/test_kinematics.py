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

"""Topics against closed forms: controller and base in separate processes over DDS."""

import math

from diffdrive_kinematics.core.kinematics import (
    advance, Pose, pose_change_from_travel, travel_from_angles, wheel_rates_from_twist,
    WheelGeometry)
from geometry_msgs.msg import Twist, TwistStamped
from nav_msgs.msg import Odometry
import pytest
from sensor_msgs.msg import JointState
from support.graph import KHEPERA, pose_of, stamp_ns, twist, twist_stamped

GEOMETRY = WheelGeometry(KHEPERA['wheel_separation'], KHEPERA['wheel_radius'])
COMMANDS = [(0.1, 0.0), (0.05, 1.5), (-0.08, 0.7), (0.0, -2.0), (0.12, 1e-7), (0.0, 0.0)]
RATES = [(base, controller) for base in (10.0, 50.0, 200.0) for controller in (10.0, 100.0)]


def start_stack(
        graph, *, base_rate=50.0, controller_rate=50.0, command_timeout=0.5, **controller):
    graph.start('diff_drive_controller', {
        **KHEPERA, 'publish_rate': controller_rate, 'cmd_vel_timeout': 0.0, **controller})
    graph.start('simulated_base', {
        **KHEPERA, 'publish_rate': base_rate, 'command_timeout': command_timeout,
        'enable_odom_tf': False})
    odometry = graph.collect(Odometry, 'odom')
    rates = graph.collect(JointState, 'wheel_rates')
    graph.wait_for(lambda: odometry and rates, 'odometry and wheel rates')
    return odometry, rates


def at_rest_after(odometry, time_ns):
    return [message for message in odometry
            if stamp_ns(message) > time_ns and message.twist.twist.linear.x == 0.0
            and message.twist.twist.angular.z == 0.0]


def assert_same_pose(message, expected):
    x, y, yaw = pose_of(message)
    assert x == pytest.approx(expected.x, abs=1e-9)
    assert y == pytest.approx(expected.y, abs=1e-9)
    assert math.remainder(yaw - expected.theta, math.tau) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize('v, w', [(0.1, 0.0), (-0.2, 0.0), (0.0, 3.0), (0.07, -1.3), (1e-9, 1e3)])
def test_a_twist_gives_the_wheel_rates_of_the_closed_form(graph, v, w):
    _, rates = start_stack(graph)
    commands = graph.publisher(Twist, 'cmd_vel')
    commands.publish(twist(v, w))
    moving = graph.wait_for(
        lambda: [message for message in rates if any(message.velocity)], 'wheel rates')[0]
    half = KHEPERA['wheel_separation'] / 2.0
    expected = [(v - w * half) / KHEPERA['wheel_radius'], (v + w * half) / KHEPERA['wheel_radius']]
    assert list(moving.name) == ['left_wheel_joint', 'right_wheel_joint']
    assert list(moving.velocity) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize('base_rate, controller_rate', RATES)
def test_stamped_commands_compose_exactly_at_the_stamps_that_were_sent(
        graph, base_rate, controller_rate):
    odometry, _ = start_stack(
        graph, base_rate=base_rate, controller_rate=controller_rate,
        enable_stamped_cmd_vel=True, stamp_tolerance=5.0)
    commands = graph.publisher(TwistStamped, 'cmd_vel')
    expected, held, since = Pose(0.0, 0.0, 0.0), (0.0, 0.0), None
    for command in COMMANDS:
        now_ns = graph.now_ns()
        commands.publish(twist_stamped(now_ns, *command))
        if since:
            seconds = (now_ns - since) / 1e9
            expected = advance(expected, held[0] * seconds, held[1] * seconds)
        held, since = command, now_ns
        until = now_ns + 120_000_000
        graph.wait_for(lambda: stamp_ns(odometry[-1]) > until, 'odometry to go on')
    final = graph.wait_for(lambda: at_rest_after(odometry, since), 'the robot to stand')[0]
    assert_same_pose(final, expected)


@pytest.mark.quick
def test_stamped_commands_that_come_late_and_all_at_once_compose_exactly_too(graph):
    odometry, _ = start_stack(
        graph, command_timeout=60.0, enable_stamped_cmd_vel=True, stamp_tolerance=60.0)
    commands = graph.publisher(TwistStamped, 'cmd_vel')
    first = stamp_ns(odometry[0])
    graph.wait_for(lambda: stamp_ns(odometry[-1]) > first + 700_000_000, 'some time to pass')
    start = graph.now_ns() - 600_000_000
    expected = Pose(0.0, 0.0, 0.0)
    for number, (v, w) in enumerate(COMMANDS):
        commands.publish(twist_stamped(start + number * 100_000_000, v, w))
        expected = advance(expected, 0.1 * v, 0.1 * w)
    # it stands in between, too, where not all of the commands have come
    final = graph.wait_for(
        lambda: [message for message in at_rest_after(odometry, start)
                 if math.dist(pose_of(message), expected) < 1e-8], 'the robot at the end')[-1]
    assert_same_pose(final, expected)


@pytest.mark.parametrize('base_rate, controller_rate', RATES)
def test_plain_twists_compose_exactly_at_the_stamps_in_wheel_rates(
        graph, base_rate, controller_rate):
    odometry, rates = start_stack(graph, base_rate=base_rate, controller_rate=controller_rate)
    commands = graph.publisher(Twist, 'cmd_vel')
    for command in COMMANDS:
        heard = len(rates)
        commands.publish(twist(*command))
        expected_rates = wheel_rates_from_twist(GEOMETRY, *command)
        told = graph.wait_for(
            lambda: [message for message in rates[heard:]
                     if tuple(message.velocity) == expected_rates], "the command's rates")[-1]
        until = stamp_ns(told) + 120_000_000
        graph.wait_for(lambda: stamp_ns(odometry[-1]) > until, 'odometry to go on')
    final = at_rest_after(odometry, stamp_ns(told))[-1]
    expected = Pose(0.0, 0.0, 0.0)
    for before, after in zip(rates, rates[1:]):
        seconds = (stamp_ns(after) - stamp_ns(before)) / 1e9
        travel = travel_from_angles(GEOMETRY, *(rate * seconds for rate in before.velocity))
        expected = advance(expected, *pose_change_from_travel(GEOMETRY, *travel))
    assert_same_pose(final, expected)
