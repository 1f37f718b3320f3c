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

from types import SimpleNamespace

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from diffdrive_kinematics.ros.inputs.publisher_watch import PATIENCE, PublisherWatch
from diffdrive_kinematics.ros.inputs.wheel_watch import WheelWatch
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
import pytest
import rclpy
from sensor_msgs.msg import JointState
from support.graph import DEEP, JOINTS, KHEPERA, set_stamp, stamp_ns, twist

RADIUS = KHEPERA['wheel_radius']
STEP_NS = 20_000_000
STEP = 0.06  # [rad] in STEP_NS
TRIES = 3
REST = 50  # steps before it moves, in which all are heard
LATE = 10  # steps of which a driver that sends them at once was silent
TIMEOUT_S = 0.5  # command_timeout of the base, for which it goes on by itself
BASE = {**KHEPERA, 'enable_odom_tf': False, 'diagnostics_rate': 10.0}
SPEED = STEP * 1e9 / STEP_NS * RADIUS


def statuses_of(graph, name):
    """Return a list to which each status of a node is added."""
    found = []
    graph.collect(DiagnosticArray, '/diagnostics', lambda message: found.extend(
        status for status in message.status if status.name == name))
    return found


def warned(statuses, words):
    return [status for status in statuses
            if status.level == DiagnosticStatus.WARN and words in status.message]


def value(status, key):
    return next(pair.value for pair in status.values if pair.key == key)


class Publishers:
    """A driver, and another node that publishes joint states on the same topic."""

    def __init__(self, graph, names, frame_ids=('', ''), velocity=False):
        self.graph, self._names, self._velocity = graph, names, velocity
        self.driver = graph.publisher(JointState, 'wheel_rates')
        self._node = rclpy.create_node(
            'joint_state_publisher', context=graph.context, start_parameter_services=False)
        self.other = self._node.create_publisher(JointState, 'wheel_rates', DEEP)
        graph.wait_for(lambda: self.other.get_subscription_count() == 1, 'the other publisher')
        self._frame_ids = frame_ids
        self._start_ns, self.step = graph.now_ns(), 0
        self._late_step = -1

    def say_zeros(self):
        message = JointState(name=self._names, position=[0.0] * len(self._names))
        self._send(self.other, message, self._frame_ids[1])

    def say_position(self):
        message = JointState(name=JOINTS, position=[self.angle()] * 2)
        if self._velocity:
            message.velocity = [STEP * 1e9 / STEP_NS if self.step > REST else 0.0] * 2
        self._send(self.driver, message, self._frame_ids[0])

    def _send(self, publisher, message, frame_id):
        set_stamp(message, self._start_ns + self.step * STEP_NS)
        message.header.frame_id = frame_id
        publisher.publish(message)

    def angle(self):
        return STEP * max(0, self.step - REST)

    def going_on(self, condition):
        """Return a condition that lets both go on, in real time, until it is true."""
        def until():
            step = self.step
            while self._start_ns + self.step * STEP_NS < self.graph.now_ns():
                self.step += 1
                self.say_position()
                if self.step % 5 == 0:
                    self.say_zeros()
            if self.step - step > LATE:
                self._late_step = self.step
            return condition()

        return until

    def was_silent_since(self, step):
        """Return whether the driver was held up after a step, or shortly before."""
        return self._late_step > step - 2 * REST

    @property
    def was_ever_silent(self):
        return self._late_step >= 0

    def close(self):
        self._node.destroy_node()


@pytest.fixture
def publishers_with(graph):
    made = []

    def make(names, **options):
        made.append(Publishers(graph, names, **options))
        return made[-1]

    yield make
    for each in made:
        each.close()


def has_gap(odometry):
    """Return whether a base stood still for some time, by the stamps of what it said."""
    stamps = [stamp_ns(message) for message in odometry]
    return any(b - a > LATE * STEP_NS for a, b in zip(stamps, stamps[1:]))


def assert_goes_steadily(graph, odometry, publishers, going_on=None):
    """
    See that the robot never goes back nor too fast, and as far as the driver says.

    Where this process or the base is held up for seconds, the driver is silent for as long: who
    speaks first takes its place, and what it has rolled is not told.  So where either was, and
    only there, that is looked at again; and what the base went on by itself is taken back.
    """
    def x():
        return odometry[-1].pose.pose.position.x

    def as_far_as_the_driver():
        first, asked_ns, begun_at = len(odometry), graph.now_ns(), publishers.step
        graph.wait_for(going_on(lambda: odometry and stamp_ns(odometry[-1]) > asked_ns),
                       'odometry of now')
        begin, angle, step = x(), publishers.angle(), publishers.step

        def there():
            way = RADIUS * (publishers.angle() - angle)
            return x() - begin == pytest.approx(way, abs=0.03)

        graph.wait_for(going_on(lambda: publishers.step > step + 100), 'some way')
        heard = len(odometry)
        graph.wait_for(going_on(lambda: there() or len(odometry) > heard + 100), 'the way')
        base_stood = has_gap(odometry[max(0, first - 2 * REST):])
        reached = there()
        assert reached or base_stood or publishers.was_silent_since(begun_at), (
            'travel was not counted, although nothing was held up')
        return reached

    going_on = going_on or publishers.going_on
    assert any(as_far_as_the_driver() for _ in range(TRIES))
    graph.wait_for(going_on(lambda: len(odometry) > 50), 'enough of odometry')
    xs = [message.pose.pose.position.x for message in odometry]
    held_up = publishers.was_ever_silent or has_gap(odometry)
    by_itself = SPEED * TIMEOUT_S if held_up else 0.0
    assert all(b - a > -by_itself - 0.005 for a, b in zip(xs, xs[1:]))
    assert max(xs) < RADIUS * publishers.angle() + by_itself + 0.03
    assert all(abs(message.twist.twist.linear.x) < 3.0 * SPEED for message in odometry)


@pytest.mark.parametrize('velocity', [False, True], ids=['positions', 'both'])
@pytest.mark.parametrize('frame_ids', [('', ''), ('driver#1', '')])
def test_zeros_of_a_joint_state_publisher_beside_the_driver_are_reported_and_do_not_move_it(
        graph, publishers_with, frame_ids, velocity):
    base = graph.start('simulated_base', BASE)
    odometry, statuses = graph.collect(Odometry, 'odom'), statuses_of(graph, '/simulated_base')
    both = publishers_with(JOINTS, frame_ids=frame_ids, velocity=velocity)
    words = "several publishers on '/wheel_rates'"
    graph.wait_for(both.going_on(lambda: words in base.output and warned(statuses, words)),
                   'a report')
    graph.wait_for(both.going_on(lambda: both.step > 150), 'some way')
    assert_goes_steadily(graph, odometry, both)
    line = next(line for line in base.output.splitlines() if words in line)
    assert '/joint_state_publisher' in line and '/test' in line and 'let one node publish' in line
    assert base.output.count(words) == 1
    graph.wait_for(
        lambda: int(value(statuses[-1], 'messages of other publishers')) > 10, 'their count')


def test_zeros_that_were_there_first_give_way_to_the_driver(graph, publishers_with):
    base = graph.start('simulated_base', BASE)
    odometry = graph.collect(Odometry, 'odom')
    both = publishers_with(JOINTS)
    for _ in range(30):
        both.say_zeros()
    graph.wait_for(lambda: odometry, 'zeros')
    graph.wait_for(both.going_on(lambda: 'several publishers' in base.output), 'a report')
    graph.wait_for(both.going_on(lambda: both.step > 150), 'some way')
    assert_goes_steadily(graph, odometry, both)


def test_on_simulated_time_they_are_told_apart_as_well(graph, publishers_with):
    """Messages are handed on as they come there, by an executor."""
    from rosgraph_msgs.msg import Clock
    base = graph.start('simulated_base', {**BASE, 'use_sim_time': True})
    odometry = graph.collect(Odometry, 'odom')
    clock = graph.publisher(Clock, '/clock')
    both = publishers_with(JOINTS)

    def until(condition):
        def ticking():
            message = Clock()
            message.clock.sec, message.clock.nanosec = divmod(graph.now_ns(), 10**9)
            clock.publish(message)
            return condition()

        return both.going_on(ticking)

    graph.wait_for(until(lambda: 'several publishers' in base.output), 'a report')
    graph.wait_for(until(lambda: both.step > 150), 'some way')
    assert_goes_steadily(graph, odometry, both, until)


def test_joint_states_of_an_arm_beside_the_driver_are_nothing_to_report(graph, publishers_with):
    base = graph.start('simulated_base', BASE)
    odometry, statuses = graph.collect(Odometry, 'odom'), statuses_of(graph, '/simulated_base')
    both = publishers_with(['arm', 'gripper'])
    graph.wait_for(both.going_on(lambda: both.step > 150 and len(statuses) > 20), 'three seconds')
    assert_goes_steadily(graph, odometry, both)
    assert 'several publishers' not in base.output
    assert not warned(statuses, 'publishers')
    assert value(statuses[-1], 'messages of other publishers') == '0'


@pytest.mark.parametrize('name, topic', [
    ('wheel_noise', 'wheel_rates'), ('forward_projection', 'wheel_rates')])
def test_whoever_listens_to_wheel_motion_reports_two_publishers_of_it(
        graph, publishers_with, name, topic):
    node = graph.start(name, KHEPERA if name != 'wheel_noise' else {'wheel_radius': RADIUS})
    both = publishers_with(JOINTS)
    graph.wait_for(both.going_on(lambda: 'several publishers' in node.output), 'a report')


def test_two_publishers_of_commands_are_reported_with_the_remedy_while_there_are_two(graph):
    controller = graph.start('diff_drive_controller', {**KHEPERA, 'diagnostics_rate': 10.0})
    statuses = statuses_of(graph, '/diff_drive_controller')
    commands = graph.publisher(Twist, 'cmd_vel')

    def driving(condition):
        def until():
            commands.publish(twist(0.1, 0.0))
            return condition()

        return until

    graph.wait_for(driving(lambda: statuses and statuses[-1].level == DiagnosticStatus.OK),
                   'a healthy controller')
    assert 'twist_mux' not in controller.output
    teleop = rclpy.create_node(
        'teleop', context=graph.context, start_parameter_services=False)
    try:
        teleop.create_publisher(Twist, 'cmd_vel', 1)
        graph.wait_for(driving(lambda: 'twist_mux' in controller.output
                               and warned(statuses, 'twist_mux')), 'a report')
        line = next(line for line in controller.output.splitlines() if 'twist_mux' in line)
        assert "2 publishers of '/cmd_vel' (/teleop, /test)" in line
        assert value(warned(statuses, 'twist_mux')[-1], 'publishers of commands') == '2'
    finally:
        teleop.destroy_node()
    again = "'/cmd_vel' has no more than one publisher again"
    graph.wait_for(driving(lambda: again in controller.output), 'the end of it')
    heard = len(statuses)
    graph.wait_for(driving(lambda: DiagnosticStatus.OK in {
        status.level for status in statuses[heard:]}), 'a healthy controller again')
    assert controller.output.count('twist_mux') == 1


class Discovery:
    """A node whose middleware finds the publishers of a topic; their names come later."""

    def __init__(self, *names):
        self.names, self.warnings = [*names], []
        self.runtime = SimpleNamespace(every=lambda rate, look: setattr(self, 'look', look))
        self.watch = PublisherWatch(
            self, 'cmd_vel', SimpleNamespace(get_publisher_count=lambda: len(self.names)), 'stop')

    def resolve_topic_name(self, name):
        return f'/{name}'

    def get_publishers_info_by_topic(self, topic):
        return [SimpleNamespace(node_namespace='/' if name else '_NODE_NAMESPACE_UNKNOWN_',
                                node_name=name or '_NODE_NAME_UNKNOWN_') for name in self.names]

    def get_logger(self):
        return SimpleNamespace(warning=self.warnings.append, info=lambda words: None)


def test_the_report_of_two_publishers_waits_for_their_names():
    node = Discovery('test', '')
    node.look()
    assert not node.warnings and not node.watch.problems()
    node.names[1] = 'teleop'
    node.look()
    node.look()
    assert node.warnings == ["2 publishers of '/cmd_vel' (/teleop, /test): stop"]
    assert [each.message for each in node.watch.problems()] == node.warnings


def test_a_publisher_whose_name_never_comes_is_reported_without_one():
    node = Discovery('test', '')
    for _ in range(PATIENCE + 1):
        assert not node.warnings
        node.look()
    assert node.warnings == ["2 publishers of '/cmd_vel' (/test, a node without a name): stop"]


def test_looks_for_the_name_of_a_publisher_that_has_gone_do_not_count_for_the_next_one():
    node = Discovery('test', '')
    for _ in range(PATIENCE - 1):
        node.look()
    node.names.pop()
    node.look()
    node.names.append('')
    for _ in range(PATIENCE):
        node.look()
        assert not node.warnings
    node.names[1] = 'teleop'
    node.look()
    assert node.warnings == ["2 publishers of '/cmd_vel' (/teleop, /test): stop"]


def test_the_count_does_not_wait_for_names_nor_are_those_of_before_said_with_it():
    node = Discovery('test', 'teleop')
    node.look()
    node.names.append('')
    node.look()
    assert node.watch.count == 3 and len(node.warnings) == 1
    assert [each.message for each in node.watch.problems()] == [
        "3 publishers of '/cmd_vel': stop"]
    node.names[2] = 'page'
    node.look()
    assert node.warnings[1:] == ["3 publishers of '/cmd_vel' (/page, /teleop, /test): stop"]
    assert [each.message for each in node.watch.problems()] == node.warnings[1:]


def test_looks_for_names_begin_anew_where_wheel_motion_is_contested_anew():
    node, contested = Discovery('driver', ''), [True]
    gathering = SimpleNamespace(
        sources=SimpleNamespace(contested=lambda now_ns: contested[0]), waiting_since_ns=None,
        delays=lambda: None, left_out=0, disagreements=list, incomplete=0)
    node.runtime.now_ns = int
    watch = WheelWatch(node, SimpleNamespace(gathering=gathering), 'wheel_rates')
    for _ in range(PATIENCE - 1):
        node.look()
    contested[0] = False
    node.look()
    contested[0] = True
    for _ in range(PATIENCE):
        node.look()
        assert not node.warnings and not watch.problems()
    node.names[1] = 'other'
    node.look()
    assert '(it is published by /driver, /other)' in node.warnings[0]
    assert [each.message for each in watch.problems()] == node.warnings
