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

"""What is said between the nodes of a robot under test, to processes beside them, and by these."""

import sys
import time

from diffdrive_kinematics.ros.runtime.clocks import SteppedClock
from diffdrive_kinematics.ros.runtime.rclpy_private import MessageInfo
from diffdrive_kinematics.ros.runtime.rejections import Rejections
from diffdrive_kinematics.ros.runtime.runtimes import runtime_of
from diffdrive_kinematics.testing.messages import RecordedMessages
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
import pytest
import rclpy
from rclpy.executors import SingleThreadedExecutor
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64
from support.inside import initialised
from support.planners import NOISE, ROBOT

pytestmark = pytest.mark.ros

DEADLINE_S = 60.0
TOPICS = {'cmd_vel': Twist, 'wheel_rates': JointState, 'noisy_wheel_rates': JointState,
          'odom': Odometry, 'ground_truth': Odometry}


def spin_until(executor, condition):
    """Spin until a condition holds."""
    deadline = time.monotonic() + DEADLINE_S
    while not condition():
        assert time.monotonic() < deadline
        executor.spin_once(timeout_sec=0.1)


class Outsider:
    """A node of another process, as it is in a context of its own, that hears some topics."""

    def __init__(self, robot, topics):
        self._context, self.heard = rclpy.Context(), {topic: [] for topic in topics}
        rclpy.init(context=self._context, domain_id=robot.domain)
        self._node = rclpy.create_node('outsider', context=self._context)
        self.executor = SingleThreadedExecutor(context=self._context)
        self.executor.add_node(self._node)
        for topic, heard in self.heard.items():
            self._node.create_subscription(TOPICS[topic], topic, heard.append, 1000)
        spin_until(self.executor, lambda: all(
            publisher.get_subscription_count() >= self._node.count_subscribers(name)
            for publisher in robot._messages.publishers
            if (name := publisher.topic_name).lstrip('/') in topics))

    def close(self):
        """Leave the graph."""
        self.executor.shutdown()
        self._node.destroy_node()
        rclpy.shutdown(context=self._context)


def test_a_robot_does_the_same_whoever_hears_it_and_they_hear_all(diffdrive):
    def driven(topics):
        robot = diffdrive(params=ROBOT, noise=NOISE)
        robot.publish('cmd_vel', Twist())  # from here on it is published
        outsider = Outsider(robot, topics)
        try:
            robot.drive(0.2, 0.3, 0.5)
            robot.advance(1.0)
            said = {topic: robot.history(topic) for topic in TOPICS}
            spin_until(outsider.executor, lambda: all(
                len(outsider.heard[topic]) >= len(said[topic]) - (topic == 'cmd_vel')
                for topic in topics))
            for topic in topics:
                assert outsider.heard[topic] == [
                    each.message for each in said[topic]][topic == 'cmd_vel':]
        finally:
            outsider.close()
        for topic in ('wheel_rates', 'noisy_wheel_rates'):
            for each in said[topic]:
                each.message.header.frame_id = ''  # tells one start of a node from another
        return said

    alone = driven([])
    assert len(alone['wheel_rates']) > 50
    assert driven(['wheel_rates', 'odom']) == alone
    assert driven([*TOPICS]) == alone


@pytest.mark.parametrize('heard_elsewhere', [False, True], ids=['here', 'and elsewhere'])
def test_a_node_is_told_the_number_of_a_message_and_misses_those_of_the_lost(heard_elsewhere):
    with initialised():
        node, other, third = map(rclpy.create_node, ('one', 'other', 'third'))
        executor = SingleThreadedExecutor()
        executor.add_node(node)
        clock = SteppedClock()
        messages = RecordedMessages(clock)
        runtime, speaks = (runtime_of(
            each, Rejections(each), stepped=clock, in_flight=messages) for each in (node, other))
        publisher, told = speaks.publish(Float64, 'told'), []
        runtime.listen(Float64, 'told', lambda *each: told.append(each), informed=True)
        if heard_elsewhere:
            third.create_subscription(Float64, 'told', print, 10)
        try:
            spin_until(executor, lambda: (
                publisher.get_subscription_count() == 1 + heard_elsewhere))
            messages.disturbances.lose('/told', 0.5, seed=0)
            for number in range(1, 21):
                publisher.publish(Float64(data=float(number)))
                messages.hand_over()
                spin_until(executor, messages.settled)
            assert 5 < len(told) < 15
            assert [info for _, info in told] == [
                MessageInfo(round(message.data)) for message, _ in told]
        finally:
            executor.shutdown()
            for each in (node, other, third):  # else they are heard in the domain's next test
                each.destroy_node()


@pytest.mark.slow
def test_what_processes_say_is_kept_when_the_first_who_hears_it_is_killed(diffdrive, files):
    robot = diffdrive({'/**': {'nodes': [
        'diff_drive_controller:one', 'diff_drive_controller:other']}}, params=ROBOT)
    robot.start_process([sys.executable, files / 'in_lockstep.py'], lockstep=True)
    robot.advance(0.2)
    robot.kill('one')
    robot.advance(0.2)
    assert [each.time for each in robot.history('cmd_vel')] == [
        pytest.approx(0.02 * step) for step in range(1, 21)]


@pytest.mark.slow
def test_a_node_that_waits_for_a_topic_of_a_process_waits_in_simulated_time(diffdrive, files):
    robot = diffdrive({
        '/**': {'nodes': ['command_sequence']},
        '/**/command_sequence': {
            'commands': [0.2, 0.0, 1.0], 'wait_for_topics': ['plan'],
            'cmd_vel_topic': 'other_cmd_vel'}}, params=ROBOT)
    robot.listen(Twist, 'other_cmd_vel')

    def speeds():
        return [each.message.linear.x for each in robot.history('other_cmd_vel')]

    robot.advance(0.5)
    assert {*speeds()} == {0.0}
    path = files / 'plans.py'
    path.write_text((files / 'in_lockstep.py').read_text().replace("'cmd_vel'", "'plan'"))
    robot.start_process([sys.executable, path], lockstep=True)
    robot.advance(0.5)
    assert speeds()[-1] == 0.2
