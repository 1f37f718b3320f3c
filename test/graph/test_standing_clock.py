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

"""Simulated time that has not begun, or stands: nothing moves without a live command."""

from functools import cached_property
from importlib.util import find_spec
from itertools import cycle

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
import pytest
from rcl_interfaces.srv import SetParameters
from rclpy.parameter import Parameter
from sensor_msgs.msg import JointState
from support.graph import JOINTS, KHEPERA, SimulatedTime, stamp_ns, twist, x_of

SIMULATED = {**KHEPERA, 'use_sim_time': True}
WAITING = 'waiting for /clock, use_sim_time is true'
NODES = {
    'diff_drive_controller': KHEPERA, 'wheel_noise': {'wheel_radius': 0.021},
    'simulated_base': {**KHEPERA, 'enable_odom_tf': False},
    'command_sequence': {'commands': [0.1, 0.0, 60.0]}, 'forward_projection': KHEPERA,
    'goal_steering': {'goals': [1.0, 0.0, 0.0], 'odom_topic': 'seen', 'cmd_vel_topic': 'steered'}}
if find_spec('nicegui'):
    NODES['web_view'] = {
        **KHEPERA, 'port': 0, 'autonomous_cmd_vel_topic': 'planned', 'cmd_vel_topic': 'passed_on'}
RAMPS = {'linear.x.max_acceleration': 0.5}
SPEED = 0.2  # [m/s]
LIMITS = pytest.mark.parametrize('limits', [{}, RAMPS], ids=['at once', 'ramps'])
EXECUTORS = pytest.mark.parametrize('executor', ['events', 'single_threaded'])


class Controller:
    """A controller on simulated time, which goes on only where ``time`` is waited for."""

    def __init__(self, graph, **parameters):
        self.process = graph.start('diff_drive_controller', {**SIMULATED, **parameters})
        self.rates = graph.collect(JointState, 'wheel_rates')
        self._commands, self._graph = graph.publisher(Twist, 'cmd_vel'), graph

    @cached_property
    def time(self):
        """Nobody publishes /clock before a test asks for this."""
        return SimulatedTime(self._graph)

    def command(self, v):
        """Command a speed; return the one [m/s] that the wheels were told last; None: none."""
        self._commands.publish(twist(v, 0.0))
        return self.rates[-1].velocity[0] * 0.021 if self.rates else None

    def drive(self, v=SPEED, time=None):
        """Command a speed until the robot has it, with time going on."""
        (time or self.time).wait_for(
            lambda: self.command(v) == pytest.approx(v, rel=1e-9), f'{v} m/s')

    def stopped(self):
        return not any(self.rates[-1].velocity)

    def moving(self, begin=0):
        return [message for message in self.rates[begin:] if any(message.velocity)]

    def assert_no_stamp_falls(self):
        told = [(stamp_ns(message), *message.velocity) for message in self.rates]
        assert [pair for pair in zip(told, told[1:]) if pair[0][0] > pair[1][0]] == []


def test_every_node_says_that_its_clock_has_not_begun_and_hands_on_no_motion(graph):
    processes = [graph.start(name, {
        **parameters, 'use_sim_time': True, 'diagnostics_rate': 5.0})
        for name, parameters in NODES.items()]
    problems = {}
    graph.collect(DiagnosticArray, '/diagnostics', lambda message: problems.update(
        {status.name: (status.level, status.message) for status in message.status}))
    outputs = [graph.collect(JointState, topic) for topic in (
        'wheel_rates', 'noisy_wheel_rates', 'joint_states')]
    odometry = graph.collect(Odometry, 'odom')
    asked = [graph.collect(Twist, topic) for topic in ('steered', 'passed_on')]
    commands = [graph.publisher(Twist, topic) for topic in (
        'cmd_vel', *(['planned'] if 'web_view' in NODES else []))]
    wheels = graph.publisher(JointState, 'wheel_rates', listeners=4)
    seen, where = graph.publisher(Odometry, 'seen'), Odometry()
    where.header.frame_id, where.pose.pose.orientation.w = 'odom', 1.0

    def told():
        for publisher in commands:
            publisher.publish(twist(SPEED, 0.0))
        seen.publish(where)
        wheels.publish(JointState(name=JOINTS, velocity=[1.0, 1.0]))
        return (all(WAITING in process.output for process in processes)
                and set(problems) == {f'/{name}' for name in NODES}
                and all(level == DiagnosticStatus.WARN and WAITING in message
                        for level, message in problems.values()))

    graph.wait_for(told, 'all of them to say so')
    own = [message for message in outputs[0] if message.header.frame_id]  # those of the controller
    assert own == outputs[1] == outputs[2] == odometry == asked[0] == asked[1] == []


def test_a_command_from_before_the_clock_is_not_obeyed_when_it_begins_but_the_next_one_is(graph):
    controller = Controller(graph, cmd_vel_timeout=0.0)
    controller.command(SPEED)
    graph.wait_for(lambda: WAITING in controller.process.output, 'a report')
    controller.time.wait_for(lambda: len(controller.rates) > 25, 'rates')
    assert controller.moving() == []
    controller.drive()


def test_a_command_to_stand_still_takes_effect_before_the_clock_has_begun(graph):
    controller = Controller(graph)
    graph.wait_for(lambda: controller.command(0.0) is not None, 'the stop')
    assert controller.moving() == []


@LIMITS
def test_where_neither_commands_come_nor_time_goes_on_the_wheels_are_told_to_stand(graph, limits):
    base = graph.start('simulated_base', {**SIMULATED, 'enable_odom_tf': False})
    odometry, controller = graph.collect(Odometry, 'odom'), Controller(graph, **limits)
    rates, time = controller.rates, controller.time
    time.wait_for(lambda: controller.command(SPEED) and odometry and x_of(odometry) > 0.0,
                  'the base to hear the controller')
    graph.wait_for_rest([rates], [odometry], time.now_ns, time.wait_for)
    began, position = x_of(odometry), rates[-1].position[0]
    controller.drive()
    graph.wait_for(controller.stopped, 'the stop')
    graph.wait_for(lambda: '/clock stands at' in controller.process.output, 'a report')
    last = rates[-1]
    time.wait_for(lambda: stamp_ns(odometry[-1]) > stamp_ns(last) + 200_000_000,
                  'odometry after it')
    controller.assert_no_stamp_falls()
    assert x_of(odometry) - began == pytest.approx(
        (rates[-1].position[0] - position) * 0.021, abs=1e-9)
    assert 'out of order' not in base.output


@pytest.mark.parametrize('asked', [0.0, 0.05, -0.1])
def test_while_time_stands_the_wheels_are_never_faster_than_asked_though_ramps_cannot_go_on(
        graph, asked):
    controller = Controller(graph, **RAMPS, cmd_vel_timeout=0.0)
    controller.drive()
    rates, driven = controller.rates, len(controller.rates)

    def obeyed():
        v = controller.command(asked)
        return abs(v) <= abs(asked) and v * asked >= 0.0

    graph.wait_for(obeyed, 'no more than what is asked')
    still = next(n for n in range(driven, len(rates)) if not any(rates[n].velocity))
    speeds = [message.velocity[0] * 0.021 for message in rates[driven - 1:still]]
    shown_s = (controller.time.now_ns - stamp_ns(rates[driven - 1])) / 1e9  # what is on its way
    slowest = SPEED - shown_s * RAMPS['linear.x.max_acceleration']
    assert slowest - 1e-9 <= min(speeds) and max(speeds) <= SPEED + 1e-9
    controller.assert_no_stamp_falls()
    controller.drive(asked)


@EXECUTORS
def test_a_ramp_on_simulated_time_steps_at_its_own_rate(graph, executor):
    controller = Controller(
        graph, **RAMPS, executor=executor, cmd_vel_timeout=0.0, publish_rate=0.01)
    rates, time, speeds = controller.rates, controller.time, cycle((0.01, 0.02))
    time.wait_for(  # nothing repeats the rates for a reader that comes late
        lambda: controller.command(next(speeds)) is not None, 'to hear it')
    for v in (SPEED, -SPEED, 0.0):
        before = len(rates)
        time.wait_for(lambda: controller.command(v) is not None and rates[before:], 'an answer')
        time.wait_for(lambda: rates[-1].velocity[0] == pytest.approx(v / 0.021), 'the ramp')
    told = {stamp_ns(message): message.velocity[0] * 0.021 for message in rates}
    speeds = [told[stamp] for stamp in sorted(told)]
    assert max(abs(b - a) for a, b in zip(speeds, speeds[1:])) <= 0.5 * 0.01 * (1.0 + 1e-9)
    assert max(speeds) == pytest.approx(SPEED) and min(speeds) == pytest.approx(-SPEED)


def test_while_time_stands_a_live_command_is_obeyed_where_no_ramp_has_to_wait(graph):
    controller = Controller(graph)
    controller.drive()
    for v in (0.1, -0.3, 0.0):
        controller.drive(v, time=graph)  # which stands
    controller.assert_no_stamp_falls()


@EXECUTORS
def test_a_clock_that_goes_back_to_its_begin_in_mid_drive_leaves_no_wheel_turning(graph, executor):
    controller = Controller(graph, **RAMPS, executor=executor)
    controller.drive()
    controller.time.now_ns = -10_000_000
    controller.time.go_on()
    graph.wait_for(
        lambda: controller.command(SPEED) is not None and controller.stopped(), 'the stop')
    controller.drive()


@LIMITS
def test_a_controller_that_is_put_on_a_clock_that_has_not_begun_stops_whatever_is_commanded(
        graph, limits):
    controller = Controller(graph, **limits, use_sim_time=False)
    graph.wait_for(lambda: controller.command(SPEED), 'the robot to drive')
    graph.call(SetParameters, 'diff_drive_controller/set_parameters', SetParameters.Request(
        parameters=[Parameter('use_sim_time', value=True).to_parameter_msg()]))

    def told():
        controller.command(SPEED)
        return WAITING in controller.process.output

    graph.wait_for(told, 'a report')
    graph.wait_for(controller.stopped, 'the stop')
    heard = len(controller.rates)
    graph.wait_for(lambda: told() and len(controller.rates) > heard + 5, 'more rates')
    assert controller.moving(heard) == []
