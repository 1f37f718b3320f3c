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

"""Topics against closed forms: controller and base, in one process and in two over DDS."""

import math

from diffdrive_kinematics.core.kinematics import (
    advance, Pose, wheel_rates_from_twist, WheelGeometry)
from geometry_msgs.msg import TwistStamped
from nav_msgs.msg import Odometry
import pytest
from sensor_msgs.msg import JointState
from support.graph import (
    assert_pose, KHEPERA, pose_of, stamp_ns, twist, twist_stamped, x_of)
from support.relay import composed
from support.stepped import messages, nodes

GEOMETRY = WheelGeometry(KHEPERA['wheel_separation'], KHEPERA['wheel_radius'])
COMMANDS = [(0.1, 0.0), (0.05, 1.5), (-0.08, 0.7), (0.0, -2.0), (0.12, 1e-7), (0.0, 0.0)]
RATES = [(base, controller) for base in (10.0, 50.0, 200.0) for controller in (10.0, 100.0)]


def start_stack(diffdrive, *, base_rate=50.0, controller_rate=50.0, **controller):
    return diffdrive(nodes(
        'diff_drive_controller', 'simulated_base', simulated_base={'publish_rate': base_rate},
        diff_drive_controller={
            'publish_rate': controller_rate, 'cmd_vel_timeout': 0.0, **controller}),
        params=KHEPERA, clock_step=0.005)


def at_rest_after(odometry, time_ns):
    return [message for message in odometry
            if stamp_ns(message) > time_ns and message.twist.twist.linear.x == 0.0
            and message.twist.twist.angular.z == 0.0]


@pytest.mark.ros
@pytest.mark.parametrize('v, w', [(0.1, 0.0), (-0.2, 0.0), (0.0, 3.0), (0.07, -1.3), (1e-9, 1e3)])
def test_a_twist_gives_the_wheel_rates_of_the_closed_form(diffdrive, v, w):
    robot = start_stack(diffdrive)
    robot.publish('cmd_vel', twist(v, w))
    moving = messages(robot, 'wheel_rates')[-1]
    half = KHEPERA['wheel_separation'] / 2.0
    expected = [(v - w * half) / KHEPERA['wheel_radius'], (v + w * half) / KHEPERA['wheel_radius']]
    assert list(moving.name) == ['left_wheel_joint', 'right_wheel_joint']
    assert list(moving.velocity) == pytest.approx(expected, rel=1e-12)


@pytest.mark.ros
@pytest.mark.parametrize('base_rate, controller_rate', RATES)
def test_stamped_commands_compose_exactly_at_the_stamps_that_were_sent(
        diffdrive, base_rate, controller_rate):
    robot = start_stack(
        diffdrive, base_rate=base_rate, controller_rate=controller_rate,
        enable_stamped_cmd_vel=True, stamp_tolerance=5.0)
    expected, held, since = Pose(0.0, 0.0, 0.0), (0.0, 0.0), 0
    for number, command in enumerate(COMMANDS):
        robot.advance(0.12)
        stamp = round(robot.time * 1e9) - 1_234_567 * number  # between two steps of the clock
        robot.publish('cmd_vel', twist_stamped(stamp, *command))
        seconds = (stamp - since) / 1e9
        expected = advance(expected, held[0] * seconds, held[1] * seconds)
        held, since = command, stamp
    robot.advance(0.12)
    assert_pose(pose_of(at_rest_after(messages(robot, 'odom'), since)[-1]), expected)


@pytest.mark.quick
def test_stamped_commands_that_come_late_and_all_at_once_compose_exactly_too(graph):
    graph.start('diff_drive_controller', {
        **KHEPERA, 'cmd_vel_timeout': 0.0, 'enable_stamped_cmd_vel': True,
        'stamp_tolerance': 60.0})
    graph.start('simulated_base', {**KHEPERA, 'command_timeout': 60.0, 'enable_odom_tf': False})
    odometry, rates = graph.collect(Odometry, 'odom'), graph.collect(JointState, 'wheel_rates')
    commands = graph.publisher(TwistStamped, 'cmd_vel')
    graph.wait_for(lambda: commands.publish(twist_stamped(graph.now_ns(), 0.1, 0.0)) or (
        odometry and x_of(odometry) > 0.0), 'the base to hear the controller')
    commands.publish(twist_stamped(graph.now_ns(), 0.0, 0.0))
    graph.wait_for_rest([rates], [odometry])
    expected, rested = pose_of(odometry[-1]), stamp_ns(odometry[-1])
    graph.wait_for(lambda: stamp_ns(odometry[-1]) > rested + 700_000_000, 'some time to pass')
    start = graph.now_ns() - 600_000_000
    for number, (v, w) in enumerate(COMMANDS):
        commands.publish(twist_stamped(start + number * 100_000_000, v, w))
        expected = advance(expected, 0.1 * v, 0.1 * w)
    # it stands in between, too, where not all of the commands have come
    final = graph.wait_for(
        lambda: [message for message in at_rest_after(odometry, start)
                 if math.dist(pose_of(message), expected) < 1e-8], 'the robot at the end')[-1]
    assert_pose(pose_of(final), expected)


@pytest.mark.ros
@pytest.mark.parametrize('base_rate, controller_rate', RATES)
def test_plain_twists_compose_exactly_at_the_stamps_in_wheel_rates(
        diffdrive, base_rate, controller_rate):
    robot = start_stack(diffdrive, base_rate=base_rate, controller_rate=controller_rate)
    for command in COMMANDS:
        robot.publish('cmd_vel', twist(*command))
        rates = messages(robot, 'wheel_rates')
        assert tuple(rates[-1].velocity) == wheel_rates_from_twist(GEOMETRY, *command)
        robot.advance(0.125)
    final = at_rest_after(messages(robot, 'odom'), stamp_ns(rates[-1]))[-1]
    assert_pose(pose_of(final), composed(GEOMETRY, rates))
