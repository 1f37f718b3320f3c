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

"""Putting the robot elsewhere: ``set_pose``, and the reset to where it began."""

import math
import signal

from geometry_msgs.msg import PoseWithCovarianceStamped
from nav_msgs.msg import Odometry
import pytest
from sensor_msgs.msg import JointState
from std_srvs.srv import Trigger
from support.graph import JOINTS, KHEPERA, pose_of, set_stamp

RADIUS = KHEPERA['wheel_radius']
BASE = {**KHEPERA, 'enable_odom_tf': False, 'command_timeout': 0.0}
VARIANCES = {0: 0.25, 1: 0.01, 6: 0.01, 7: 0.36, 35: 0.0685}


def pose_message(x=3.0, y=-2.0, yaw=1.0, frame='odom', scale=1.0, covariance=VARIANCES):
    message = PoseWithCovarianceStamped()
    message.header.frame_id = frame
    pose = message.pose.pose
    pose.position.x, pose.position.y = x, y
    pose.orientation.z, pose.orientation.w = (
        scale * math.sin(0.5 * yaw), scale * math.cos(0.5 * yaw))
    for index, value in covariance.items():
        message.pose.covariance[index] = value
    return message


class Robot:
    """A base whose wheels tell rates and positions; a message is an angle [rad] further on."""

    def __init__(self, graph, **parameters):
        self.graph = graph
        self.base = graph.start('simulated_base', {**BASE, **parameters})
        self.odometry = graph.collect(Odometry, 'odom')
        self.joints = graph.collect(JointState, 'joint_states')
        self.wheels = graph.publisher(JointState, 'wheel_rates')
        self.poses = graph.publisher(
            PoseWithCovarianceStamped, parameters.get('set_pose_topic', 'set_pose'))
        self.angle = 40.0
        self.message = JointState(name=JOINTS)

    def roll(self, angle):
        """Tell the wheels' position, an angle [rad] further on than before."""
        self.angle += angle
        self.message.position = [self.angle, self.angle]
        set_stamp(self.message, self.graph.now_ns())
        self.wheels.publish(self.message)

    def pose(self):
        return pose_of(self.odometry[-1])

    def wait_for_pose(self, *pose):
        self.graph.wait_for(
            lambda: self.odometry and self.pose() == pytest.approx(pose, abs=1e-9),
            f'pose {pose}', timeout=20.0)

    def driven(self, x=RADIUS):
        self.roll(0.0)
        self.wait_for_pose(0.0, 0.0, 0.0)
        self.roll(x / RADIUS)
        self.wait_for_pose(x, 0.0, 0.0)
        return self


@pytest.mark.parametrize('topic', ['set_pose', 'initialpose'])
def test_a_robot_that_is_put_elsewhere_has_that_pose_and_covariance_and_drives_on_from_there(
        graph, topic):
    robot = Robot(graph, set_pose_topic=topic, covariance_floor=0.0).driven()
    robot.poses.publish(pose_message())
    robot.wait_for_pose(3.0, -2.0, 1.0)
    message = robot.odometry[-1]
    assert {index: value for index, value in enumerate(message.pose.covariance) if value} \
        == VARIANCES
    assert list(robot.joints[-1].position) == pytest.approx([1.0, 1.0], abs=1e-12)
    robot.roll(2.0)
    way = 2.0 * RADIUS
    robot.wait_for_pose(3.0 + way * math.cos(1.0), -2.0 + way * math.sin(1.0), 1.0)


def test_a_robot_that_is_put_elsewhere_stands_until_the_wheels_are_heard_again(graph):
    robot = Robot(graph)
    robot.wheels.publish(JointState(name=JOINTS, velocity=[5.0, 5.0]))
    graph.wait_for(lambda: robot.odometry and robot.pose()[0] > 0.01, 'motion')
    robot.poses.publish(pose_message())
    robot.wait_for_pose(3.0, -2.0, 1.0)
    count = len(robot.odometry)
    graph.wait_for(lambda: len(robot.odometry) > count + 9, 'more odometry')
    robot.wait_for_pose(3.0, -2.0, 1.0)
    assert robot.odometry[-1].twist.twist.linear.x == 0.0
    robot.wheels.publish(JointState(name=JOINTS, velocity=[5.0, 5.0]))
    graph.wait_for(lambda: robot.odometry[-1].twist.twist.linear.x > 0.1, 'motion')


@pytest.mark.parametrize('message, words', [
    (pose_message(frame='map'), "frame_id is 'map', expected 'odom'"),
    (pose_message(frame=''), "frame_id is '', expected 'odom'"),
    (pose_message(x=math.nan), 'position (x, y) is (nan, -2.0), expected finite numbers'),
    (pose_message(yaw=math.nan), 'expected a quaternion of length 1'),
    (pose_message(scale=0.0), 'expected a quaternion of length 1'),
    (pose_message(scale=2.0), 'expected a quaternion of length 1'),
    (pose_message(covariance={0: -1.0}), 'expected a symmetric matrix of finite numbers'),
    (pose_message(covariance={0: 1.0, 7: 1.0, 1: 2.0, 6: 2.0}), 'a variance below 0'),
    (pose_message(covariance={35: math.inf}), 'expected a symmetric matrix of finite numbers')])
def test_a_bad_pose_is_refused_with_a_clear_word_and_moves_nothing(graph, message, words):
    robot = Robot(graph).driven()
    robot.poses.publish(message)
    graph.wait_for(lambda: words in robot.base.output, 'a report')
    assert "message on 'set_pose'" in robot.base.output
    count = len(robot.odometry)
    graph.wait_for(lambda: len(robot.odometry) > count + 2, 'more odometry')
    robot.wait_for_pose(RADIUS, 0.0, 0.0)
    robot.poses.publish(pose_message(scale=1.001, covariance={}))
    robot.wait_for_pose(3.0, -2.0, 1.0)
    assert robot.base.stop(signal.SIGTERM) == 0


def test_a_reset_is_the_pose_and_the_angles_of_the_start_and_no_jump_after_it(graph):
    robot = Robot(graph, covariance_floor=0.0).driven()
    robot.poses.publish(pose_message())
    robot.wait_for_pose(3.0, -2.0, 1.0)
    answer = graph.call(Trigger, 'simulated_base/reset', Trigger.Request())
    assert answer.success and "x 0.000 m, y 0.000 m, yaw 0.0000 rad in 'odom'" in answer.message
    robot.wait_for_pose(0.0, 0.0, 0.0)
    graph.wait_for(lambda: list(robot.joints[-1].position) == [0.0, 0.0], 'the angles')
    assert not any(robot.odometry[-1].pose.covariance)
    robot.roll(0.5)
    robot.wait_for_pose(0.5 * RADIUS, 0.0, 0.0)
    graph.wait_for(lambda: list(robot.joints[-1].position) == pytest.approx(
        [0.5, 0.5], abs=1e-12), 'the angles')


def test_a_reset_goes_to_the_initial_pose_also_before_anything_was_heard(graph):
    robot = Robot(graph, initial_pose=[1.0, 2.0, 0.5])
    robot.poses.publish(pose_message())
    graph.wait_for(lambda: 'pose set' in robot.base.output, 'the pose to be set')
    assert graph.call(Trigger, 'simulated_base/reset', Trigger.Request()).success
    robot.roll(0.0)
    robot.wait_for_pose(1.0, 2.0, 0.5)


def test_no_pose_can_be_set_where_the_topic_is_off(graph):
    graph.start('simulated_base', {**BASE, 'set_pose_topic': ''})
    graph.publisher(JointState, 'wheel_rates')
    assert graph.node.count_subscribers('set_pose') == 0
