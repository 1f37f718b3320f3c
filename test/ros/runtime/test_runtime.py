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


"""What nodes ask of the world: everything through the runtime, in every kind of time."""

import ast
from pathlib import Path
import time

import diffdrive_kinematics
from diffdrive_kinematics.ros.runtime.clocks import SteppedClock
from diffdrive_kinematics.ros.runtime.in_flight_messages import InFlightMessages
from diffdrive_kinematics.ros.runtime.rclpy_private import MessageInfo
from diffdrive_kinematics.ros.runtime.rejections import Rejections
from diffdrive_kinematics.ros.runtime.runtimes import runtime_of
import pytest
import rclpy
from rclpy.executors import SingleThreadedExecutor
from std_msgs.msg import Bool
from support.inside import initialised

DEADLINE_S = 60.0
ROOT = Path(diffdrive_kinematics.__file__).parent
ROOMS = ['nodes', 'ros/inputs', 'ros/publishers', 'tools']


@pytest.mark.parametrize('path', [
    path for room in ROOMS for path in sorted((ROOT / room).glob('*.py'))],
    ids=lambda path: path.stem)
def test_topics_and_services_are_made_by_the_runtime(path):
    made = {node.attr for node in ast.walk(ast.parse(path.read_text()))
            if isinstance(node, ast.Attribute)}
    assert not made & {'create_publisher', 'create_service', 'create_subscription'}


@pytest.fixture
def node():
    with initialised():
        made = rclpy.create_node('listener')
        yield made
        made.destroy_node()


def test_a_node_listens_beside_what_it_publishes_and_stepped_time_does_not_wait_for_that(node):
    in_flight = InFlightMessages()
    runtime = runtime_of(node, Rejections(node), stepped=SteppedClock(), in_flight=in_flight)
    publisher = runtime.publish(Bool, 'told')
    beside = runtime.listen_beside(Bool, 'told', print)
    publisher.publish(Bool())
    assert in_flight.settled()
    runtime.unlisten(beside)
    assert beside not in node.subscriptions


def test_what_listens_beside_ends_without_those_who_listen(node):
    in_flight = InFlightMessages()
    runtime = runtime_of(node, Rejections(node), stepped=SteppedClock(), in_flight=in_flight)
    runtime.listen(Bool, 'told', print)
    runtime.unlisten(runtime.listen_beside(Bool, 'told', print))
    publisher = node.create_publisher(Bool, 'told', 10)
    in_flight.count_sent(publisher, 'listener')
    publisher.publish(Bool())
    assert not in_flight.settled()  # who listens has not heard it yet


def test_on_stepped_time_a_callback_is_told_numbers_and_no_times_of_the_wall_clock(node):
    in_flight, told = InFlightMessages(), []
    runtime = runtime_of(node, Rejections(node), stepped=SteppedClock(), in_flight=in_flight)
    publisher = node.create_publisher(Bool, 'told', 10)
    in_flight.count_sent(publisher, 'listener')
    runtime.listen(Bool, 'told', lambda _, info: told.append(info), informed=True)
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    deadline = time.monotonic() + DEADLINE_S
    for number in range(1, 4):
        while not in_flight.matched():
            assert time.monotonic() < deadline
            executor.spin_once(timeout_sec=0.1)
        publisher.publish(Bool())
        while not in_flight.settled():
            assert time.monotonic() < deadline
            executor.spin_once(timeout_sec=0.1)
        assert told[-1] == MessageInfo(number)
    executor.shutdown()
