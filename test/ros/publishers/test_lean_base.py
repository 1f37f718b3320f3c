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

"""The lean path of a base and the plain one publish the same bytes, whatever comes when."""

from collections import deque
import math
import random

from diffdrive_kinematics.nodes.simulated_base import SimulatedBase
from diffdrive_kinematics.ros.runtime import clocks
from diffdrive_kinematics.ros.runtime.clocks import SteadyTimers
from geometry_msgs.msg import PoseWithCovarianceStamped
from nav_msgs.msg import Odometry
import pytest
from rclpy.logging import LoggingSeverity
from rclpy.parameter import Parameter
from rclpy.serialization import deserialize_message, serialize_message
from sensor_msgs.msg import JointState
from std_srvs.srv import Trigger
from support.graph import JOINTS, set_stamp
from support.inside import initialised

pytestmark = pytest.mark.ros
MS = 10**6
SEEDS, EVENTS = 4, 400
SLIP = {'left_slip_variance': 1e-4, 'right_slip_variance': 2e-4}
SETTINGS = {
    'certain': {}, 'slipping': SLIP, 'without timeout': {'command_timeout': 0.0, **SLIP},
    'with tf and a path': {'gear_ratio': 30.0, 'path_topic': 'way', 'enable_odom_tf': True},
    'slip of the body, yaw unknown': {
        'turn_slip_variance': 1e-3, 'initial_heading_concentration': 100.0},
    'fixed diagonals': {
        'twist_covariance_diagonal': [1e-3] * 6, 'pose_covariance_diagonal': [1e-3] * 6, **SLIP},
    'rates alone': {'position_feedback': False, **SLIP},
    'no odometry': {'odom_topic': ''}, 'no joint states': {'joint_states_topic': '', **SLIP}}
UNUSUAL = {
    'inverted': {'left_wheel_inverted': True}, 'read by encoders': {'encoder_resolution': 4096.0},
    'wrapping': {'encoder_range': 6.0}, 'what lasts a run': {'session_scale_stddev': 0.01, **SLIP}}


class Time:
    """The clocks of the process, which only the test moves."""

    def __init__(self):
        self.steady_ns, self.wall_ns = 5 * 10**9, 1_700_000_000 * 10**9

    def monotonic_ns(self):
        return self.steady_ns

    def time_ns(self):
        return self.wall_ns

    def pass_by(self, ns, step_ns=0):
        self.steady_ns += ns
        self.wall_ns += ns + step_ns


class Base:
    """A base whose timer and queue the test has in its hands, and all that it publishes."""

    def __init__(self, lean):
        self.node = SimulatedBase(
            'lean' if lean else 'plain', timers=SteadyTimers(),
            parameter_overrides=[Parameter('lean_path', value=lean)])
        self.node.get_logger().set_level(LoggingSeverity.FATAL)  # of no other node
        self.queue, self.said = deque(), []
        self.node._wheel_motion.taken = lambda: self.queue.popleft() if self.queue else None
        for publisher in self.node.publishers:
            if publisher.topic_name != '/parameter_events':
                publisher.publish = self._keep(publisher)

    def _keep(self, publisher):
        return lambda message: self.said.append((publisher.topic_name, message))

    def state(self):
        node = self.node
        return (self.said, node._odometry, vars(node.health.statistics), node.health.sent,
                node.counts, node._wheel_watch.values(), node._path and node._path._message._poses)


class Publisher:
    """Says what wheels do, with or without their positions, as a run of a program or not."""

    def __init__(self, draw, time):
        self._draw, self._time, self.number = draw, time, 0
        self.source = draw.choice([*['driver#1', 'driver#2'] * 4, '', 'base_link'])
        self.with_positions = draw.random() < (0.7 if '#' in self.source else 0.2)
        self.rates, self.angles, self.last_ns = [0.0, 0.0], [0.0, 0.0], time.wall_ns
        self._names, self.noise = JOINTS, 0.0
        self.offset_ns = draw.choice([0] * 9 + [-3000 * MS, -300 * MS, 300 * MS, 3000 * MS])

    def change(self):
        self.rates = self._draw.choice([
            [0.0, 0.0], [self._draw.uniform(-9.0, 9.0) for _ in JOINTS],
            [self._draw.uniform(-9.0, 9.0)] * 2, [-0.0, 1e-9]])

    def message(self, fault=''):
        draw = self._draw
        stamp_ns = self._time.wall_ns - draw.choice([0, 1, 40_000, 3 * MS, 25 * MS])
        seconds = (stamp_ns - self.last_ns) / 1e9
        self.last_ns = stamp_ns
        self.angles = [angle + rate * seconds for angle, rate in zip(self.angles, self.rates)]
        if draw.random() < 0.4:
            self.change()
        self.number += 1
        message = JointState(name=list(self._names), velocity=list(self.rates))
        message.header.frame_id = self.source
        if self.with_positions:
            message.position = list(self.angles)
        stamps = {'old': -400 * MS, 'late': -30 * MS, 'older': -3000 * MS, 'future': 3000 * MS}
        set_stamp(message, stamp_ns + self.offset_ns + stamps.get(fault, 0))
        if fault in ('nan', 'huge', 'inf', 'fast'):
            values = draw.choice([message.velocity, message.position or message.velocity])
            values[draw.randrange(2)] = {
                'nan': math.nan, 'huge': 1e13, 'inf': math.inf, 'fast': 9e11}[fault]
        elif fault == 'unstamped':
            set_stamp(message, 0)
        elif fault == 'no stamp':
            message.header.stamp.nanosec = 10**9 + 5
        elif fault == 'off' and self.with_positions:
            message.position[0] += draw.choice([1e-15, 1e-9, 1e-6, 0.1])
        elif fault == 'short':
            message.velocity = message.velocity[:1]
        elif fault == 'effort':
            message.effort = [1.0, 2.0]
        elif fault == 'turned':
            message.name, message.velocity = message.name[::-1], message.velocity[::-1]
            message.position = message.position[::-1]
        elif fault == 'more':
            message.name = [*message.name, 'caster']
            message.velocity, message.position = [*message.velocity, 1.0], []
        elif fault == 'others':
            message.name = ['a', 'b']
        elif fault == 'bare':
            message.velocity = []
        elif fault == 'unnumbered':
            self.number = 0
        received = 0 if fault == 'unnumbered' else self._time.wall_ns
        return serialize_message(message), {
            'publication_sequence_number': self.number, 'source_timestamp': stamp_ns,
            'received_timestamp': received}


FAULTS = ['old', 'late', 'older', 'future', 'nan', 'huge', 'inf', 'fast', 'unstamped', 'no stamp',
          'off', 'short', 'effort', 'turned', 'more', 'others', 'bare', 'unnumbered']


def put_elsewhere(base):
    message = PoseWithCovarianceStamped()
    message.header.frame_id = 'odom'
    message.pose.pose.position.x, message.pose.pose.orientation.w = 3.0, 1.0
    message.pose.covariance[0] = 0.25
    base.node._on_pose(message)


def configure(name, value):
    return lambda base: base.node.set_parameters([Parameter(name, value=value)])


CALLS = [
    lambda base: base.node.reading(), lambda base: base.node._odometry,
    lambda base: base.node._wheel_motion.take(), put_elsewhere,
    lambda base: base.node._on_reset(Trigger.Request(), Trigger.Response()),
    configure('wheel_radius', 0.05), configure('wheel_radius', 0.5),
    configure('command_timeout', 0.2), configure('left_slip_variance', 3e-4),
    configure('covariance_floor', 1e-8), configure('publish_rate', 80.0)]


def drive(seed, time, bases):
    """Have random things happen to all bases alike; return how many messages were usual."""
    draw, usual = random.Random(seed), 0
    trouble = draw.choice([0.0, 0.004, 0.05])  # one message that is lost ends the usual for 10 s
    publishers = [Publisher(draw, time)]
    for _ in range(EVENTS):
        event = draw.random()
        publisher = draw.choice(publishers)
        if event < 0.035:
            call = draw.choice(CALLS)
            for base in bases:
                call(base)
            assert bases[0].node._odometry == bases[1].node._odometry
        elif event < 0.038:
            time.pass_by(MS, draw.choice([-3000 * MS, -20 * MS, 200 * MS, 3000 * MS]))
        elif event < 0.05:
            time.pass_by(draw.choice([490, 499, 500, 501, 700, 2500]) * MS)
        elif event < 0.05 + 0.06 * trouble:
            publishers = [Publisher(draw, time), *draw.choice([[], [], publishers])][:2]
        elif event < 0.55:
            fault = draw.choice(FAULTS) if draw.random() < trouble else ''
            messages = [publisher.message(fault)] * (
                draw.choice([0, 2]) if draw.random() < 0.6 * trouble else 1)
            for base in bases:
                base.queue.extend(messages)
        if event < 0.3 or event > 0.55:
            for base in bases:
                base.node._on_timer()
                usual += base.node._lean._fresh
        time.pass_by(draw.choice([0, 1, 300_000, 10 * MS, 20 * MS]))
    return usual


@pytest.fixture
def time(monkeypatch):
    time = Time()
    monkeypatch.setattr(clocks, 'time', time)
    monkeypatch.setattr(SimulatedBase, 'source', lambda node: 'base#1')
    return time


@pytest.mark.parametrize('name', [*SETTINGS, *UNUSUAL])
def test_a_lean_base_is_a_plain_one(name, time):
    settings = {'wheel_radius': 0.033, 'wheel_separation': 0.16, 'publish_rate': 100.0,
                'enable_odom_tf': False, **{**SETTINGS, **UNUSUAL}[name]}
    usual = 0
    for seed in range(SEEDS):
        with initialised(settings):
            lean, plain = bases = Base(True), Base(False)
            try:
                usual += drive(f'{seed} of {name}', time, bases)
                assert lean.state() == plain.state(), f'seed {seed}'
                assert not plain.node._lean._fresh
            finally:
                for base in bases:
                    base.node.destroy_node()
    assert usual > 50 if name in SETTINGS else not usual


RATE = 5.0
STEP_M = 0.01 * 0.033 * RATE  # of a tick


class Wheels:
    """Two wheels that turn alike, what they tell a base, and what the base makes of it."""

    def __init__(self, base, time, ahead_ns=0):
        self._base, self._time, self._ahead_ns = base, time, ahead_ns
        self._number = self._ticks = 0

    @property
    def angle(self):
        return 0.01 * RATE * self._ticks

    def tell(self):
        self._number += 1
        message = JointState(
            name=list(JOINTS), velocity=[RATE] * 2, position=[self.angle] * 2)
        message.header.frame_id = 'driver#1'
        set_stamp(message, self._time.wall_ns + self._ahead_ns)
        self._base.queue.append((serialize_message(message), {
            'publication_sequence_number': self._number,
            'received_timestamp': self._time.wall_ns}))

    def turn(self, ticks, *, silently=False):
        """Turn for so many ticks, and tell it at every other one."""
        for tick in range(ticks):
            if not (silently or tick % 2):
                self.tell()
            self._base.node._on_timer()
            self._time.pass_by(10 * MS)
            self._ticks += 1

    def said(self, topic, kind):
        """Tick, and return the last message of a topic."""
        self._base.node._on_timer()
        return deserialize_message(
            next(data for name, data in reversed(self._base.said) if name == topic), kind)


LEAN = {'wheel_radius': 0.033, 'wheel_separation': 0.16, 'publish_rate': 100.0,
        'enable_odom_tf': False, **SLIP}


@pytest.fixture
def lean(time):
    with initialised(LEAN):
        base = Base(True)
        try:
            yield base
        finally:
            base.node.destroy_node()


def x_and_variance(wheels):
    pose = wheels.said('/odom', Odometry).pose
    return pose.pose.position.x, pose.covariance[0]


def test_a_pose_that_is_set_and_a_reset_hold_on_the_lean_path(time, lean):
    wheels = Wheels(lean, time)
    wheels.turn(50)
    assert lean.node._lean._fresh and x_and_variance(wheels)[0] == pytest.approx(50 * STEP_M)
    put_elsewhere(lean)
    assert x_and_variance(wheels) == pytest.approx((3.0, 0.25))
    wheels.turn(50)
    assert lean.node._lean._fresh
    x, variance = x_and_variance(wheels)
    assert x == pytest.approx(3.0 + 50 * STEP_M) and 0.25 < variance < 0.26
    assert wheels.said('/joint_states', JointState).position[0] == pytest.approx(wheels.angle)
    lean.node._on_reset(Trigger.Request(), Trigger.Response())
    wheels.turn(50)
    assert lean.node._lean._fresh
    x, variance = x_and_variance(wheels)
    assert x == pytest.approx(50 * STEP_M) and 0.0 < variance < 0.01
    assert wheels.said('/joint_states', JointState).position[0] == pytest.approx(0.5 * RATE)


@pytest.mark.parametrize('ahead_ms', [0, 3000, -3000])
def test_wheels_stop_by_the_timeout_whatever_the_clock_of_a_publisher_that_is_killed(
        time, lean, ahead_ms):
    wheels = Wheels(lean, time, ahead_ms * MS)
    wheels.turn(101)
    assert lean.node._lean._live or ahead_ms
    wheels.turn(48, silently=True)
    assert wheels.said('/odom', Odometry).twist.twist.linear.x == pytest.approx(0.033 * RATE)
    time.pass_by(10 * MS)
    at_rest = wheels.said('/odom', Odometry)
    assert at_rest.twist.twist.linear.x == 0.0
    assert at_rest.pose.pose.position.x == pytest.approx(150 * STEP_M)
    time.pass_by(10_000 * MS)
    assert wheels.said('/odom', Odometry).pose.pose == at_rest.pose.pose


class Pair:
    """A lean base and a plain one, which hear the same from publishers of the test's making."""

    def __init__(self, bases, time, angle):
        self.bases, self._time, self._angle, self._number = bases, time, angle, 0
        self._began_ns = time.wall_ns

    def hear(self, source='driver#1', rates=(RATE, RATE), ulps=0.0, carry=0):
        """Tell both where wheels are that turn at ``RATE``, and let them tick."""
        self._number += 1  # that of the other publisher may be the next one, too
        angle = self._angle + RATE * (self._time.wall_ns - self._began_ns) / 1e9
        message = JointState(
            name=list(JOINTS), velocity=list(rates),
            position=[angle + ulps * math.ulp(angle), angle])
        message.header.frame_id = source
        set_stamp(message, self._time.wall_ns)
        message.header.stamp.sec -= carry
        message.header.stamp.nanosec += carry * 10**9
        for base in self.bases:
            base.queue.append((serialize_message(message), {
                'publication_sequence_number': self._number,
                'received_timestamp': self._time.wall_ns}))
            base.node._on_timer()
        self._time.pass_by(20 * MS)


@pytest.mark.parametrize(('angle', 'unusual'), [
    (1.0, {'carry': 1}),  # a second too few in the seconds, and in the nanoseconds one too many
    (1.0, {'ulps': 32.0}),  # positions that went further than rates and rounding say
    (1e12 - 0.95, {}),  # beyond the largest position
    (1.0, {'rates': (9e11, -9e11)}),  # each is in bounds, their turn is not
    (1.0, {'source': 'driver#2'})], ids=['stamp', 'rounding', 'position', 'turn', 'source'])
def test_the_lean_path_leaves_a_message_that_is_nearly_usual_to_the_plain_one(
        time, angle, unusual):
    with initialised({**LEAN, 'wheel_radius': 0.5}):
        pair = Pair((Base(True), Base(False)), time, angle)
        lean, plain = pair.bases
        try:
            for _ in range(10):
                pair.hear()
            assert lean.node._lean._live and lean.node._lean._fresh
            for _ in range(3):
                pair.hear(**unusual)
                assert lean.state() == plain.state()
            for _ in range(3):
                pair.hear()
            assert lean.state() == plain.state()
        finally:
            for base in pair.bases:
                base.node.destroy_node()


@pytest.mark.parametrize('refused', [1, 2, 3])
def test_a_publisher_whose_first_messages_were_refused_is_not_taken_for_the_one_before(
        time, refused):
    """Guard whose motion is held: the reader knows the new publisher, the odometry does not."""
    with initialised({**LEAN, 'command_timeout': 0.0}):
        pair = Pair((Base(True), Base(False)), time, 1.0)
        lean, plain = pair.bases
        try:
            for _ in range(10):
                pair.hear()
            time.pass_by(15_000 * MS)
            for _ in range(refused):
                pair.hear('driver#2', rates=(1e13, RATE))
                assert lean.state() == plain.state()
            for rate in (RATE, 0.0, RATE):
                pair.hear('driver#2', rates=(RATE, rate))
                assert lean.state() == plain.state()
        finally:
            for base in pair.bases:
                base.node.destroy_node()
