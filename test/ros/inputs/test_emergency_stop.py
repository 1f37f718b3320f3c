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

"""The emergency stop: wheels at rest at once, past all limits, until it is released."""

from geometry_msgs.msg import Twist
import pytest
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import JointState
from std_msgs.msg import Bool
from std_srvs.srv import Trigger
from support.graph import KHEPERA, twist
from support.health import collect, ERROR, OK, wait_for_level

CONTROLLER = 'diff_drive_controller'
SPEED = 0.2  # [m/s]
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
SETTINGS = {
    **KHEPERA, 'linear.x.max_acceleration': 0.5, 'cmd_vel_timeout': 0.0,
    'emergency_stop_topic': 'stop', 'diagnostics_rate': 10.0}
BEST_EFFORT = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
PROFILES = pytest.mark.parametrize('profile', [QoSProfile(depth=1), LATCHED, BEST_EFFORT], ids=[
    'volatile', 'latched', 'best effort'])


class Robot:
    """A controller with commands that go on until it drives."""

    def __init__(self, graph):
        self._graph = graph
        self.process = graph.start(CONTROLLER, SETTINGS)
        self.statuses = collect(graph, f'/{CONTROLLER}')
        self.rates = graph.collect(JointState, 'wheel_rates')
        self.commands = graph.publisher(Twist, 'cmd_vel')

    def speeds(self, begin=0):
        return [message.velocity[0] * 0.021 for message in self.rates[begin:]]

    def at(self, v):
        return self.rates and self.speeds(len(self.rates) - 1)[0] == pytest.approx(v, abs=1e-9)

    def drive(self, v=SPEED):
        def driving():
            self.commands.publish(twist(v, 0.0))
            return self.at(v)
        self._graph.wait_for(driving, 'the robot to drive')

    def assert_stands(self):
        """Commands do not move it, and the rates are repeated."""
        heard = len(self.rates)

        def commanded():
            self.commands.publish(twist(SPEED, 0.0))
            return len(self.rates) > heard + 20

        self._graph.wait_for(commanded, 'repeats')
        assert set(self.speeds(heard)) == {0.0}

    def assert_stopped_at_once(self, begin):
        """Between speed and rest there is no ramp."""
        speeds = self.speeds(begin)
        first = speeds.index(0.0)
        assert set(speeds[first:]) == {0.0}
        assert speeds[:first] == pytest.approx([SPEED] * first, abs=1e-9)


@PROFILES
def test_a_topic_stops_it_at_once_whatever_its_quality_of_service_and_lets_it_go_again(
        graph, profile):
    robot = Robot(graph)
    robot.drive()
    begin = len(robot.rates)
    stop = graph.node.create_publisher(Bool, 'stop', profile)
    listeners = 1 if profile is BEST_EFFORT else 3 if profile is LATCHED else 2
    graph.wait_for(lambda: stop.get_subscription_count() == listeners, 'listeners')
    stop.publish(Bool(data=True))

    def stopped():
        if profile is BEST_EFFORT:  # may be lost while the two find each other
            stop.publish(Bool(data=True))
        return robot.at(0.0)

    graph.wait_for(stopped, 'the stop')
    robot.assert_stopped_at_once(begin)
    robot.assert_stands()
    values = wait_for_level(graph, robot.statuses, ERROR, "stopped by '/stop'")[2]
    assert values['emergency stop'] == "stopped by '/stop'"
    assert int(values['commands ignored while stopped']) > 0

    heard = len(robot.rates)
    stop.publish(Bool(data=False))
    wait_for_level(graph, robot.statuses, OK)
    graph.wait_for(lambda: len(robot.rates) > heard + 20, 'rates')
    assert set(robot.speeds(heard)) == {0.0}  # the command of before is over
    robot.drive()
    first = next(v for v in robot.speeds(heard) if v)
    assert first == pytest.approx(0.5 / 100.0, rel=1e-9)  # the ramp begins at rest
    if profile is not BEST_EFFORT:  # a stop that is heard is not said to be lost
        assert 'No messages will be received' not in robot.process.output


@pytest.mark.quick
def test_a_stop_that_was_latched_before_the_controller_started_holds(graph):
    graph.node.create_publisher(Bool, 'stop', LATCHED).publish(Bool(data=True))
    robot = Robot(graph)
    wait_for_level(graph, robot.statuses, ERROR, "stopped by '/stop'")
    robot.assert_stands()


def test_a_course_beside_a_stop_that_nobody_publishes_is_driven_whole(graph, tmp_path):
    sim = graph.simulate(
        tmp_path, CONTROLLER, 'simulated_base', 'command_sequence', **KHEPERA,
        enable_odom_tf=False, enable_stamped_cmd_vel=True, stamp_tolerance=60.0,
        cmd_vel_timeout=0.0, command_timeout=0.0, emergency_stop_topic='stop',
        commands=[SPEED, 0.0, 2.0], wait_for_topics=['odom'])
    assert sim.wait() == 0, sim.output
    x, _, _ = map(float, sim.output.splitlines()[-1].split()[-3:])
    assert x == SPEED * 2.0, sim.output


def test_services_stop_it_and_let_it_go_but_not_against_the_topic(graph):
    robot = Robot(graph)
    robot.drive()
    begin = len(robot.rates)
    answer = graph.call(Trigger, f'{CONTROLLER}/stop', Trigger.Request())
    assert answer.success and answer.message == 'stopped by ~/stop'
    graph.wait_for(lambda: robot.at(0.0), 'the stop')
    robot.assert_stopped_at_once(begin)
    robot.assert_stands()

    stop = graph.publisher(Bool, 'stop')
    stop.publish(Bool(data=True))
    wait_for_level(graph, robot.statuses, ERROR, "stopped by ~/stop and '/stop'")
    answer = graph.call(Trigger, f'{CONTROLLER}/resume', Trigger.Request())
    assert not answer.success and "'/stop'" in answer.message and 'still' in answer.message
    robot.assert_stands()

    graph.call(Trigger, f'{CONTROLLER}/stop', Trigger.Request())
    stop.publish(Bool(data=False))
    wait_for_level(graph, robot.statuses, ERROR, 'stopped by ~/stop')
    robot.assert_stands()  # who stopped it by the service has not let it go
    assert graph.call(Trigger, f'{CONTROLLER}/resume', Trigger.Request()).success
    robot.drive()


def test_without_a_topic_there_is_none_and_the_services_are_there(graph):
    graph.start(CONTROLLER, KHEPERA)
    assert graph.call(Trigger, f'{CONTROLLER}/resume', Trigger.Request()).success
    types = [kind for name, kinds in graph.node.get_topic_names_and_types() for kind in kinds]
    assert 'std_msgs/msg/Bool' not in types


@pytest.mark.parametrize('simulated', [False, True])
def test_it_stops_whatever_the_clock_does(graph, simulated):
    """Simulated time has not begun, and nothing was ever told."""
    graph.start(CONTROLLER, {**KHEPERA, 'use_sim_time': simulated})
    rates = graph.collect(JointState, 'wheel_rates')
    assert graph.call(Trigger, f'{CONTROLLER}/stop', Trigger.Request()).success
    graph.wait_for(lambda: len(rates) > 5, 'rates, again and again')
    assert not any(any(message.velocity) for message in rates)
