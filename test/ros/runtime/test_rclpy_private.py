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

"""Where rclpy lacks something private, what is public takes its place."""

import time

from diffdrive_kinematics.nodes.simulated_base import SimulatedBase
from diffdrive_kinematics.ros.runtime import rclpy_private, runtimes
from diffdrive_kinematics.ros.runtime.clocks import SteadyTimers
from diffdrive_kinematics.ros.runtime.running import make_executor
from diffdrive_kinematics.ros.runtime.runtime import Runtime
import pytest
from rclpy.clock import Clock
from rclpy.executors import SingleThreadedExecutor
from sensor_msgs.msg import JointState
from support.graph import KHEPERA
from support.inside import initialised

pytestmark = pytest.mark.ros
DEADLINE_S = 60.0


@pytest.fixture
def bare(monkeypatch):
    """Make rclpy one that has nothing but its public interface."""
    for name, value in (('CAN_TAKE', False), ('READS_CLOCK', False), ('EVENTS_EXECUTOR', None)):
        monkeypatch.setattr(rclpy_private, name, value)
    monkeypatch.setattr(runtimes, 'HAS_LEAN_PATH', False)


def test_this_rclpy_lacks_nothing_and_nothing_is_said():
    assert rclpy_private.missing() == ''


def test_what_is_missing_is_said_in_one_line(bare):
    text = rclpy_private.missing()
    assert '\n' not in text
    for word in ('rclpy', 'taking of single messages', 'clocks', 'EventsExecutor'):
        assert word in text


def test_a_base_of_the_lean_loop_works_by_what_is_public(bare):
    """Its own timers publish, although nobody fires those of the loop."""
    with initialised({**KHEPERA, 'enable_odom_tf': False, 'publish_rate': 50.0}):
        node = SimulatedBase(timers=SteadyTimers())
        executor = make_executor([node])
        try:
            assert type(node.runtime) is Runtime and type(executor) is SingleThreadedExecutor
            publisher = node.create_publisher(JointState, 'wheel_rates', 10)
            deadline = time.monotonic() + DEADLINE_S
            while node.health.sent < 3 or node.reading().rates != (1.0, 2.0):
                assert time.monotonic() < deadline
                publisher.publish(JointState(
                    name=['left_wheel_joint', 'right_wheel_joint'], velocity=[1.0, 2.0]))
                executor.spin_once(timeout_sec=0.05)
        finally:
            executor.shutdown()
            node.destroy_node()


def test_both_ways_to_read_a_clock_read_the_same(monkeypatch):
    clock = Clock()
    quick = rclpy_private.time_of(clock)
    monkeypatch.setattr(rclpy_private, 'READS_CLOCK', False)
    plain = rclpy_private.time_of(clock)
    first, second, third = plain(), quick(), plain()
    assert first <= second <= third and type(second) is type(first) is int


def test_where_messages_cannot_be_taken_there_are_none(bare):
    assert rclpy_private.taker_of(None)() is None
