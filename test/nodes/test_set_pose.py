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

from geometry_msgs.msg import PoseWithCovarianceStamped
import pytest
from std_srvs.srv import Trigger
from support.graph import KHEPERA, pose_of
from support.stepped import last, nodes, tell_wheels

pytestmark = pytest.mark.ros

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


class Rolling:
    """A base whose wheels tell positions; a message is an angle [rad] further on."""

    def __init__(self, diffdrive, **parameters):
        self.robot = diffdrive(nodes('simulated_base'), params={**BASE, **parameters})
        self._topic = parameters.get('set_pose_topic', 'set_pose')
        self._angle = 40.0

    def roll(self, angle):
        """Tell the wheels' position, an angle [rad] further on than before."""
        self._angle += angle
        tell_wheels(self.robot, [self._angle, self._angle])
        self.robot.advance(0.02)

    def put(self, message):
        self.robot.publish(self._topic, message)
        self.robot.advance(0.02)

    def assert_pose(self, *pose):
        assert pose_of(last(self.robot, 'odom')) == pytest.approx(pose, abs=1e-9)

    def angles(self):
        return list(last(self.robot, 'joint_states').position)

    def driven(self):
        self.roll(0.0)
        self.assert_pose(0.0, 0.0, 0.0)
        self.roll(1.0)
        self.assert_pose(RADIUS, 0.0, 0.0)
        return self


@pytest.mark.parametrize('topic', ['set_pose', 'initialpose'])
def test_a_robot_that_is_put_elsewhere_has_that_pose_and_covariance_and_drives_on_from_there(
        diffdrive, topic):
    base = Rolling(diffdrive, set_pose_topic=topic, covariance_floor=0.0).driven()
    base.put(pose_message())
    base.assert_pose(3.0, -2.0, 1.0)
    covariance = last(base.robot, 'odom').pose.covariance
    assert {index: value for index, value in enumerate(covariance) if value} == VARIANCES
    assert base.angles() == pytest.approx([1.0, 1.0], abs=1e-12)
    base.roll(2.0)
    way = 2.0 * RADIUS
    base.assert_pose(3.0 + way * math.cos(1.0), -2.0 + way * math.sin(1.0), 1.0)


def test_a_robot_that_is_put_elsewhere_stands_until_the_wheels_are_heard_again(diffdrive):
    base = Rolling(diffdrive)
    tell_wheels(base.robot, velocity=[5.0, 5.0])
    base.robot.advance(0.5)
    assert last(base.robot, 'odom').pose.pose.position.x > 0.01
    base.put(pose_message())
    for _ in range(10):
        base.assert_pose(3.0, -2.0, 1.0)
        assert last(base.robot, 'odom').twist.twist.linear.x == 0.0
        base.robot.advance(0.02)
    tell_wheels(base.robot, velocity=[5.0, 5.0])
    base.robot.advance(0.1)
    assert last(base.robot, 'odom').twist.twist.linear.x == pytest.approx(5.0 * RADIUS)


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
def test_a_bad_pose_is_refused_with_a_clear_word_and_moves_nothing(
        diffdrive, capfd, message, words):
    base = Rolling(diffdrive).driven()
    base.put(message)
    output = capfd.readouterr().err
    assert words in output and "message on 'set_pose'" in output
    base.robot.advance(0.1)
    base.assert_pose(RADIUS, 0.0, 0.0)
    base.put(pose_message(scale=1.001, covariance={}))
    base.assert_pose(3.0, -2.0, 1.0)


def test_a_reset_is_the_pose_and_the_angles_of_the_start_and_no_jump_after_it(diffdrive):
    base = Rolling(diffdrive, covariance_floor=0.0).driven()
    base.put(pose_message())
    base.assert_pose(3.0, -2.0, 1.0)
    answer = base.robot.call(Trigger, 'simulated_base/reset', Trigger.Request())
    assert answer.success and "x 0.000 m, y 0.000 m, yaw 0.0000 rad in 'odom'" in answer.message
    base.robot.advance(0.02)
    base.assert_pose(0.0, 0.0, 0.0)
    assert base.angles() == [0.0, 0.0]
    assert not any(last(base.robot, 'odom').pose.covariance)
    base.roll(0.5)
    base.assert_pose(0.5 * RADIUS, 0.0, 0.0)
    assert base.angles() == pytest.approx([0.5, 0.5], abs=1e-12)


def test_a_reset_goes_to_the_initial_pose_also_before_anything_was_heard(diffdrive, capfd):
    base = Rolling(diffdrive, initial_pose=[1.0, 2.0, 0.5])
    base.put(pose_message())
    assert 'pose set' in capfd.readouterr().err
    assert base.robot.call(Trigger, 'simulated_base/reset', Trigger.Request()).success
    base.roll(0.0)
    base.assert_pose(1.0, 2.0, 0.5)


def test_no_pose_can_be_set_where_the_topic_is_off(diffdrive):
    robot = diffdrive(nodes('simulated_base'), params={**BASE, 'set_pose_topic': ''})
    robot.advance(0.1)
    with pytest.raises(KeyError, match='set_pose'):
        robot.history('set_pose')
