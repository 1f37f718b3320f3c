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

"""Processes that die and come back mid-drive, a second publisher, and clocks that jump."""

import signal

from diffdrive_kinematics.nodes.simulated_base import SimulatedBase
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
import pytest
from support.graph import KHEPERA, stamp_ns, twist, wheel_motion, x_of
from support.inside import inside, START_NS
from support.stepped import messages, nodes, tell_wheels, time_ns

SPEED = 0.2  # [m/s]
TIMEOUT_S = 0.5  # command_timeout of the base


def driven(graph, odometry, commands, distance):
    """Drive at SPEED, command after command, a distance on; return the x [m] that was passed."""
    graph.wait_for(lambda: odometry, 'odometry')
    end = x_of(odometry) + distance

    def there():
        commands.publish(twist(SPEED, 0.0))
        return x_of(odometry) > end

    graph.wait_for(there, f'x > {end}')
    return end


def assert_no_jump(odometry):
    """
    Compare each pose with what the time since the first one can have driven.

    Rates that come late make up for a base that stood; those that come earlier than the base
    thought, or with a stop, take back no more than it went on by itself, which is its timeout.
    """
    began, start, furthest = stamp_ns(odometry[0]), x_of(odometry[:1]), 0.0
    assert len(odometry) > 20
    for message in odometry:
        x = message.pose.pose.position.x - start
        assert x <= SPEED * (stamp_ns(message) - began) / 1e9 + 1e-9
        furthest = max(furthest, x)
        assert x > furthest - SPEED * TIMEOUT_S - 1e-9


@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGKILL], ids=['SIGINT', 'SIGKILL'])
def test_a_controller_that_is_restarted_mid_drive_causes_no_jump(graph, number):
    graph.start('simulated_base', {**KHEPERA, 'enable_odom_tf': False})
    controller = graph.start('diff_drive_controller', KHEPERA)
    odometry = graph.collect(Odometry, 'odom')
    commands = graph.publisher(Twist, 'cmd_vel')
    driven(graph, odometry, commands, 0.4)
    controller.stop(number)
    graph.start('diff_drive_controller', KHEPERA)
    driven(graph, odometry, commands, 0.3)
    assert_no_jump(odometry)


@pytest.mark.ros
def test_a_second_idle_controller_does_not_move_the_pose(diffdrive):
    robot = diffdrive(
        nodes('diff_drive_controller', 'diff_drive_controller:idle', 'simulated_base',
              idle={'cmd_vel_topic': 'other', 'publish_rate': 100.0}),
        params={**KHEPERA, 'enable_odom_tf': False}, clock_step=0.01)
    robot.kill('idle')
    robot.drive(SPEED, 0.0, 2.0)
    robot.restart('idle')
    passed = robot.odom.x
    robot.drive(SPEED, 0.0, 1.0)
    rates = messages(robot, 'wheel_rates')
    assert len({message.header.frame_id for message in rates[-9:]}) == 2
    # its first message is taken for that of a controller that was restarted
    assert robot.odom.x == pytest.approx(passed + SPEED * 1.0, abs=SPEED * 0.05)
    assert_no_jump(messages(robot, 'odom'))


@pytest.mark.ros
def test_joint_states_of_a_clock_that_is_ahead_count_from_their_second_message_on(diffdrive):
    robot = diffdrive(nodes('simulated_base'), params={
        **KHEPERA, 'enable_odom_tf': False, 'extrapolate_positions': False})
    for number in range(9):
        robot.advance(0.02)
        tell_wheels(robot, [number, number], at_ns=time_ns(robot) + 3_000_000_000)
    assert robot.odom.x == pytest.approx(8 * 0.021, abs=1e-12)


@pytest.mark.ros
def test_a_course_on_simulated_time_takes_a_step_back_of_the_clock_as_no_time(diffdrive, capfd):
    robot = diffdrive(
        nodes('command_sequence', 'diff_drive_controller', 'simulated_base',
              command_sequence={'commands': [0.1, 0.0, 2.0]}),
        params={**KHEPERA, 'enable_stamped_cmd_vel': True, 'cmd_vel_timeout': 0.0,
                'enable_odom_tf': False}, clock_step=0.005)
    robot.step_clock(100.0)
    robot.advance(1.2)
    robot.step_clock(-50.0)
    robot.advance(3.0)
    passed = [message.pose.pose.position.x for message in messages(robot, 'odom')]
    assert all(0.0 <= b - a < 0.1 * 2.01 * 0.02 for a, b in zip(passed, passed[1:]))
    assert passed[-1] == pytest.approx(0.2, abs=0.1 * 1.01 * 0.02)  # to a tick of the sequence
    assert '[command_sequence]: the clock was stepped by -' in capfd.readouterr().err


@pytest.mark.ros
def test_the_watchdog_does_not_wait_for_the_next_repeat(diffdrive):
    robot = diffdrive(nodes('diff_drive_controller'), params={
        **KHEPERA, 'publish_rate': 0.01, 'cmd_vel_timeout': 0.2})
    robot.publish('cmd_vel', twist(SPEED, 0.0))
    robot.advance(1.0)
    drive, stop = robot.history('wheel_rates')[-2:]
    assert any(drive.message.velocity) and not any(stop.message.velocity)
    assert stop.time - drive.time == pytest.approx(0.2)


def test_a_clock_that_follows_the_step_of_the_publishers_clock_moves_nothing():
    """The wheels are told by the new clock first; on /clock that is a matter of chance."""
    with inside(SimulatedBase, {
            **KHEPERA, 'enable_odom_tf': False, 'command_timeout': 0.0}) as held:
        def roll(time_ns):
            held.hear('/wheel_rates', wheel_motion(time_ns, velocity=[10.0, 10.0]))

        roll(START_NS)
        back = START_NS - 500 * 10**9
        roll(back)
        held.clock.advance_to(back)
        roll(back + 20_000_000)
        held.clock.advance_to(back + 20_000_000)
        way = 10.0 * 0.02 * KHEPERA['wheel_radius']
        assert held.node.reading().pose.x == pytest.approx(way, abs=1e-12)
        assert held.node.counts['clock steps'] == held.node.counts['clock step'] == 1
