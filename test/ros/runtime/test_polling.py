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

"""Wheel motion that a base looks at when it needs it, and where it must not wait for that."""

from contextlib import contextmanager
import time

from diffdrive_kinematics.nodes.simulated_base import SimulatedBase
from diffdrive_kinematics.ros.runtime import runtimes
from diffdrive_kinematics.ros.runtime.clocks import SteadyTimers
from diffdrive_kinematics.ros.runtime.polling import QUEUE_DEPTH
from diffdrive_kinematics.ros.runtime.running import make_executor
import pytest
import rclpy
from rclpy.parameter import Parameter
from sensor_msgs.msg import JointState
from support.graph import KHEPERA, wheel_motion
from support.inside import initialised

pytestmark = pytest.mark.ros
DEADLINE_S = 60.0
RARELY = 0.01  # [Hz]: no tick while a test runs
OVERRIDE = 'qos_overrides./wheel_rates.subscription.'


class Base:
    """A base whose timers nobody fires, its executor, and a publisher of wheel motion."""

    def __init__(self):
        self.timers = SteadyTimers()
        self.node = SimulatedBase(timers=self.timers)
        self._helper = rclpy.create_node('wheels')
        self._executor = make_executor([self.node, self._helper])
        self._publisher = self._helper.create_publisher(JointState, 'wheel_rates', 100)
        self.heard = []  # by somebody else
        self._helper.create_subscription(JointState, 'wheel_rates', self.heard.append, 100)
        self.spin_until(lambda: self._publisher.get_subscription_count() == 2, 'the listeners')

    def publish(self, left, right, stamp_ns=0):
        self._publisher.publish(wheel_motion(stamp_ns, velocity=[left, right]))

    def spin_until(self, condition, what):
        deadline = time.monotonic() + DEADLINE_S
        while not condition():
            assert time.monotonic() < deadline, what
            self._executor.spin_once(timeout_sec=0.01)

    def close(self):
        self._executor.shutdown()
        self._helper.destroy_node()
        self.node.destroy_node()


@contextmanager
def base_with(parameters):
    with initialised({**KHEPERA, 'enable_odom_tf': False, **parameters}):
        base = Base()
        try:
            yield base
        finally:
            base.close()


def assert_hears_as_it_comes(base):
    """Each message is heard by itself, although no timer fires."""
    for count in (1, 2, 3):
        base.publish(float(count), 0.0)
        base.spin_until(
            lambda count=count: base.node.health.statistics.count == count, f'message {count}')


def test_what_comes_between_ticks_that_are_rare_is_all_taken():
    """Without positions each lost message would be seen in the angle."""
    with base_with({'publish_rate': 10.0, 'command_timeout': 0.0}) as base:
        base.node.set_parameters([Parameter('publish_rate', value=RARELY)])
        start, rolled = time.time_ns() - 10**9, 0.0
        for number in range(90):
            base.publish(float(number), -1.0, start + number * 10**6)
            rolled += number * 1e-3
        deadline = time.monotonic() + DEADLINE_S
        while base.node.health.statistics.count < 90:
            assert time.monotonic() < deadline
            base.timers.fire_due()
        assert base.node.health.sent == 0  # no tick has taken them
        odometry = base.node._odometry  # it takes these stamps for those of another clock
        reading = odometry.predict(odometry.clock.own_ns(start + 90 * 10**6))
        assert reading.angles == pytest.approx((rolled, -0.09), rel=1e-12)


def test_without_a_stamp_wheel_motion_holds_from_when_it_came_not_from_when_it_was_looked_at():
    with base_with({'publish_rate': RARELY, 'command_timeout': 0.0}) as base:
        begun, heard_ns = time.time_ns(), []
        for number in range(20):
            base.publish(1.0 + number % 2, 1.0)
            base.spin_until(lambda count=number + 1: len(base.heard) == count, 'the message')
            heard_ns.append(time.time_ns())
        base.node._wheel_motion.take()
        assert base.node.health.statistics.count == 20
        least, most = heard_ns[-1] - heard_ns[0], time.time_ns() - begun
        assert 0.5e-9 * least < base.node._odometry.wheels.right.value < 1e-9 * most


def test_wheel_motion_is_heard_when_the_base_is_asked_where_it_is():
    with base_with({}) as base:
        base.publish(1.0, 2.0)
        base.spin_until(lambda: base.node.reading().rates == (1.0, 2.0), 'the message')


@pytest.mark.parametrize('policy, value', [('depth', 1), ('depth', 1000), ('history', 'keep_all')])
def test_a_queue_of_the_users_is_not_left_to_fill_until_the_next_tick(policy, value):
    with base_with({OVERRIDE + policy: value, 'publish_rate': 1.0}) as base:
        assert_hears_as_it_comes(base)
        assert base.node.runtime.needs_wakeup


def test_other_policies_leave_the_base_to_look_by_itself():
    with base_with({OVERRIDE + 'reliability': 'best_effort'}) as base:
        assert not base.node.runtime.needs_wakeup
        assert not [each for each in base.node.subscriptions if each.topic_name == '/wheel_rates']


def test_a_middleware_that_does_not_note_the_time_of_arrival_hands_messages_on_as_they_come(
        monkeypatch):
    """A message with a zero stamp holds from its arrival on, not from when it was looked at."""
    monkeypatch.setattr(
        runtimes, 'get_rmw_implementation_identifier', lambda: 'rmw_cyclonedds_cpp')
    with base_with({}) as base:
        assert_hears_as_it_comes(base)


def test_a_flood_does_not_keep_the_base_at_looking():
    """Each message that is read brings another one, which is there at once."""
    with base_with({}) as base:
        read, handled = base.node.wheel_reader.read, []

        def read_and_publish(*message):
            handled.append(1)
            if len(handled) < 20 * QUEUE_DEPTH:  # or this would never end
                base.publish(1.0, float(len(handled)))
            return read(*message)

        base.node.wheel_reader.read = read_and_publish
        base.publish(1.0, 0.0)
        base.spin_until(lambda: base.node.reading() and handled, 'the first message')
        assert len(handled) <= QUEUE_DEPTH
