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

"""Two publishers of what should have one: told apart, reported, and no motion of the robot."""

import sys

from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
import pytest
import rclpy
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState
from support.graph import (
    clock_at, DEEP, JOINTS, KHEPERA, stamp_ns, twist, wheel_motion, x_of)
from support.health import OK, statuses_of, WARN, with_health
from support.stepped import messages, nodes, tell_wheels

RADIUS = KHEPERA['wheel_radius']
STEP_NS, STEP_S = 20_000_000, 0.02
STEP = 0.06  # [rad] in STEP_S
REST = 50  # steps before it moves, in which all are heard
TRIES = 3
LATE = 10  # steps of which a driver that sends them at once was silent
TIMEOUT_S = 0.5  # command_timeout of the base, for which it goes on by itself
BASE = {**KHEPERA, 'enable_odom_tf': False, 'diagnostics_rate': 10.0}
SPEED = STEP / STEP_S * RADIUS
SEVERAL = "several publishers on '/wheel_rates'"
ZEROS = """
import sys

from diffdrive_kinematics.testing import spin
import rclpy
from sensor_msgs.msg import JointState


def say_zeros():
    message = JointState(name=sys.argv[1:], position=[0.0] * len(sys.argv[1:]))
    message.header.stamp = node.get_clock().now().to_msg()
    publisher.publish(message)


rclpy.init(args=['--ros-args', '-p', 'use_sim_time:=true'])
node = rclpy.create_node('joint_state_publisher')
publisher = node.create_publisher(JointState, 'wheel_rates', 100)
node.create_timer(0.1, say_zeros)
spin(node)
"""


def angle_after(steps):
    """Return the angle [rad] of wheels that rest, and then turn at one rate."""
    return STEP * max(0, steps - REST)


class Driver:
    """A driver of wheels, and a node that hears it."""

    def __init__(self, diffdrive, capfd, node='simulated_base', frame_id='', velocity=False):
        self.robot = with_health(diffdrive(nodes(node), params=BASE))
        self._capfd, self._output = capfd, ''
        self._frame_id, self._velocity, self._step = frame_id, velocity, 0

    def begin_zeros(self, names=JOINTS):
        """Start another node that publishes zeros of joints."""
        self.robot.start_process([sys.executable, '-c', ZEROS, *names], lockstep=True)

    def roll(self, steps):
        """Tell step by step what the wheels do."""
        for _ in range(steps):
            self.robot.advance(STEP_S)
            self._step += 1
            rate = STEP / STEP_S if self._step > REST else 0.0
            tell_wheels(
                self.robot, [angle_after(self._step)] * 2, [rate] * 2 if self._velocity else (),
                frame_id=self._frame_id)

    def output(self):
        self._output += self._capfd.readouterr().err
        return self._output

    def status(self):
        """Return the level, the words and the values of the base's last status."""
        return statuses_of(self.robot, '/simulated_base')[-1]

    def assert_goes_steadily(self):
        """See that the robot never goes back nor too fast, and as far as told, but for a step."""
        odometry = messages(self.robot, 'odom')
        xs = [message.pose.pose.position.x for message in odometry]
        assert all(b - a > -1e-9 for a, b in zip(xs, xs[1:]))
        told = RADIUS * angle_after(self._step)
        assert told - RADIUS * STEP - 1e-9 < xs[-1] < told + 1e-9 and xs[-1] > 0.1
        assert all(abs(message.twist.twist.linear.x) < SPEED + 1e-9 for message in odometry)


@pytest.fixture
def driver(diffdrive, capfd):
    """Return what makes a driver, and a node that hears it."""
    return lambda *node, **options: Driver(diffdrive, capfd, *node, **options)


@pytest.mark.slow
@pytest.mark.ros
@pytest.mark.parametrize('velocity', [False, True], ids=['positions', 'both'])
@pytest.mark.parametrize('frame_id', ['', 'driver#1'])
def test_zeros_of_a_joint_state_publisher_beside_the_driver_are_reported_and_do_not_move_it(
        driver, frame_id, velocity):
    driver = driver(frame_id=frame_id, velocity=velocity)
    driver.begin_zeros()
    driver.roll(250)
    driver.assert_goes_steadily()
    line, = (line for line in driver.output().splitlines() if SEVERAL in line)
    for words in '/joint_state_publisher', '/diffdrive_test', 'let one node publish':
        assert words in line
    level, text, values = driver.status()
    assert level == WARN and SEVERAL in text
    assert int(values['messages of other publishers']) > 10


@pytest.mark.slow
@pytest.mark.ros
def test_zeros_that_were_there_first_give_way_to_the_driver(driver):
    driver = driver()
    driver.begin_zeros()
    driver.robot.advance(3.0)
    driver.roll(250)
    driver.assert_goes_steadily()
    assert SEVERAL in driver.output()


@pytest.mark.slow
@pytest.mark.ros
def test_joint_states_of_an_arm_beside_the_driver_are_nothing_to_report(driver):
    driver = driver()
    driver.begin_zeros(['arm', 'gripper'])
    driver.roll(250)
    driver.assert_goes_steadily()
    assert 'several publishers' not in driver.output()
    statuses = statuses_of(driver.robot, '/simulated_base')
    assert len(statuses) > 20 and not any('publishers' in text for _, text, _ in statuses)
    assert driver.status()[2]['messages of other publishers'] == '0'


@pytest.mark.ros
@pytest.mark.parametrize('node', ['wheel_noise', 'forward_projection'])
def test_whoever_listens_to_wheel_motion_reports_two_publishers_of_it(driver, node):
    driver = driver(node)
    driver.begin_zeros()
    driver.roll(100)
    assert SEVERAL in driver.output()


class RealDriver:
    """A driver, and another node that says zeros, in real time."""

    def __init__(self, graph, other, clock=None):
        self._graph, self._clock = graph, clock
        self._driver, self._zeros = (
            node.create_publisher(JointState, 'wheel_rates', DEEP) for node in (graph.node, other))
        for publisher in self._driver, self._zeros:
            graph.wait_for(publisher.get_subscription_count, 'a node to listen')
        self._start_ns, self.step, self.late_step = graph.now_ns(), 0, -2 * REST

    def _say(self, publisher, angle):
        publisher.publish(wheel_motion(self._start_ns + self.step * STEP_NS, [angle, angle]))

    def _go_on(self):
        begun = self.step
        while self._start_ns + self.step * STEP_NS < self._graph.now_ns():
            self.step += 1
            self._say(self._driver, angle_after(self.step))
            if self.step % 5 == 0:
                self._say(self._zeros, 0.0)
        if self.step - begun > LATE:
            self.late_step = self.step
        if self._clock:
            self._clock.publish(clock_at(self._graph.now_ns()))

    def wait_for(self, condition, what):
        """Let both go on until a condition is true."""
        self._graph.wait_for(lambda: self._go_on() or condition(), what)

    def was_held_up(self, since, odometry):
        """Return whether it was since a step, or shortly before; or the base that said this."""
        stamps = [stamp_ns(message) for message in odometry]
        return self.late_step > since - 2 * REST or any(
            b - a > LATE * STEP_NS for a, b in zip(stamps, stamps[1:]))


@pytest.fixture
def other(graph):
    """Yield a second node in the process of the test."""
    node = rclpy.create_node('other', context=graph.context, start_parameter_services=False)
    yield node
    node.destroy_node()


@pytest.mark.parametrize('use_sim_time', [False, True])
def test_in_real_processes_they_are_told_apart_as_well(graph, other, use_sim_time):
    """
    Where something is held up, and only there, travel may be lost: then it is looked at again.

    Who speaks first takes the place of a driver that is silent, and what the base went on by
    itself is taken back.
    """
    base = graph.start('simulated_base', {**BASE, 'use_sim_time': use_sim_time})
    odometry = graph.collect(Odometry, 'odom')
    driver = RealDriver(graph, other, graph.publisher(Clock, '/clock') if use_sim_time else None)

    def goes_as_far_as_told():
        first, asked_ns, begun = len(odometry), graph.now_ns(), driver.step
        driver.wait_for(lambda: odometry and stamp_ns(odometry[-1]) > asked_ns, 'odometry of now')
        x, step = x_of(odometry), driver.step

        def there():
            way = RADIUS * (angle_after(driver.step) - angle_after(step))
            return x_of(odometry) - x == pytest.approx(way, abs=0.03)

        driver.wait_for(lambda: driver.step > step + 100, 'some way')
        heard = len(odometry)
        driver.wait_for(lambda: there() or len(odometry) > heard + 100, 'the way')
        reached = there()
        assert reached or driver.was_held_up(begun, odometry[max(0, first - 2 * REST):]), (
            'travel was not counted, although nothing was held up')
        return reached

    driver.wait_for(lambda: SEVERAL in base.output and driver.step > 150, 'a report, and some way')
    assert any(goes_as_far_as_told() for _ in range(TRIES))
    driver.wait_for(lambda: len(odometry) > 50, 'enough of odometry')
    xs = [message.pose.pose.position.x for message in odometry]
    by_itself = SPEED * TIMEOUT_S if driver.was_held_up(0, odometry) else 0.0
    assert all(b - a > -by_itself - 0.005 for a, b in zip(xs, xs[1:]))
    assert max(xs) < RADIUS * angle_after(driver.step) + by_itself + 0.03
    assert all(abs(message.twist.twist.linear.x) < 3.0 * SPEED for message in odometry)


@pytest.mark.parametrize('name', ['wheel_noise', 'forward_projection'])
def test_whoever_listens_in_a_real_process_reports_two_publishers_as_well(graph, other, name):
    node = graph.start(name, {'wheel_radius': RADIUS} if name == 'wheel_noise' else KHEPERA)
    RealDriver(graph, other).wait_for(lambda: SEVERAL in node.output, 'a report')


def test_a_controller_in_a_real_process_reports_two_publishers_and_their_end(graph, other):
    controller = graph.start('diff_drive_controller', KHEPERA)
    commands = graph.publisher(Twist, 'cmd_vel')
    second = other.create_publisher(Twist, 'cmd_vel', 1)

    def driven_until(words):
        graph.wait_for(lambda: commands.publish(twist(0.1, 0.0)) or words in controller.output,
                       words)

    driven_until("2 publishers of '/cmd_vel' (/other, /test)")
    other.destroy_publisher(second)
    driven_until("'/cmd_vel' has no more than one publisher again")
    assert controller.output.count('twist_mux') == 1


@pytest.mark.ros
def test_two_publishers_of_commands_are_reported_with_the_remedy_while_there_are_two(
        diffdrive, capfd):
    robot = with_health(diffdrive(
        nodes('diff_drive_controller', 'command_sequence:teleop'),
        params={**KHEPERA, 'diagnostics_rate': 10.0, 'commands': [0.1, 0.0, 600.0]}))

    def told():
        """Let both drive; return what is said, and the level, words and values of the status."""
        robot.drive(0.1, 0.0, 2.0)
        return capfd.readouterr().err, *statuses_of(robot, '/diff_drive_controller')[-1]

    robot.kill('teleop')
    output, level, _, _ = told()
    assert level == OK and 'twist_mux' not in output
    robot.restart('teleop')
    output, level, text, values = told()
    line, = (line for line in output.splitlines() if 'twist_mux' in line)
    assert "2 publishers of '/cmd_vel' (/diffdrive_test, /teleop)" in line
    assert level == WARN and 'twist_mux' in text and values['publishers of commands'] == '2'
    robot.kill('teleop')
    output, level, _, _ = told()
    assert level == OK and "'/cmd_vel' has no more than one publisher again" in output
    assert 'twist_mux' not in output
