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

"""Transforms: odom -> base_link of a belief, map -> odom of a ground truth (REP-105)."""

import math

from diffdrive_kinematics.core.kinematics import advance, compose, Pose
import pytest
from support.graph import assert_pose, KHEPERA, odometry_of, stamp_ns
from support.stepped import last, nodes, refusal, tell_wheels
from support.tf import transforms_of

pytestmark = pytest.mark.ros

BELIEF = {**KHEPERA, 'command_timeout': 0.0}
TRUTH = {
    **BELIEF, 'enable_odom_tf': False, 'publish_map_odom_tf': True, 'odom_frame_id': 'map',
    'odom_topic': 'ground_truth', 'wheel_motion_topic': 'noisy_wheel_rates',
    'initial_pose': [1.0, 2.0, 0.5]}
RADIUS, SEPARATION = KHEPERA['wheel_radius'], KHEPERA['wheel_separation']


def pose_of(transform):
    at, q = transform.transform.translation, transform.transform.rotation
    return Pose(at.x, at.y, 2.0 * math.atan2(q.z, q.w))


def frames_of(transform):
    return transform.header.frame_id, transform.child_frame_id


def rolled(pose, left, right, seconds):
    """Return the pose after wheel rates [rad/s] for a time [s]."""
    return advance(pose, 0.5 * RADIUS * (left + right) * seconds,
                   RADIUS * (right - left) * seconds / SEPARATION)


def belief(time_ns, pose=Pose(0.3, -0.2, 1.0), frame='odom', base='base_link'):
    return odometry_of(time_ns, pose, frame, base)


def unstamped(message):
    message.header.stamp.nanosec = 2**32 - 1
    return message


def test_tf_is_the_odometry_with_its_stamp_and_frames_exactly_as_written(diffdrive):
    robot = diffdrive(nodes('simulated_base:robot1/simulated_base'), params={
        **BELIEF, 'odom_frame_id': 'my/odom', 'base_frame_id': 'my_base'})
    tell_wheels(robot, velocity=[3.0, 5.0], topic='/robot1/wheel_rates')
    robot.advance(0.5)
    found = transforms_of(robot)
    told = {stamp_ns(each.message): each.message for each in robot.history('/robot1/odom')}
    assert [stamp_ns(one) for one in found] == [*told] and len(found) > 20
    for transform in found:
        message = told[stamp_ns(transform)]
        assert frames_of(transform) == ('my/odom', 'my_base')
        assert transform.transform.translation.x == message.pose.pose.position.x
        assert transform.transform.translation.y == message.pose.pose.position.y
        assert transform.transform.rotation == message.pose.pose.orientation


def test_map_to_odom_to_base_is_the_truth_whatever_the_robot_believes(diffdrive):
    robot = diffdrive(
        nodes('simulated_base', 'simulated_base:ground_truth', ground_truth=TRUTH), params=BELIEF)
    tell_wheels(robot, velocity=[3.0, 5.0])
    tell_wheels(robot, velocity=[3.1, 4.8], topic='noisy_wheel_rates')
    robot.advance(1.0)
    found = transforms_of(robot)
    inner = {stamp_ns(one): one for one in found if frames_of(one) == ('odom', 'base_link')}
    chains = [(one, inner[stamp_ns(one)]) for one in found if frames_of(one) == ('map', 'odom')]
    assert len(chains) > 20
    for outer, inner in chains:
        seconds = stamp_ns(outer) / 1e9
        assert_pose(compose(pose_of(outer), pose_of(inner)),
                    rolled(Pose(1.0, 2.0, 0.5), 3.1, 4.8, seconds))
        assert_pose(pose_of(inner), rolled(Pose(0.0, 0.0, 0.0), 3.0, 5.0, seconds))
    assert {frames_of(one) for one in found} == {('map', 'odom'), ('odom', 'base_link')}


def test_a_belief_is_matched_with_the_truth_at_its_stamp_also_when_the_truth_has_moved_on(
        diffdrive):
    robot = diffdrive(nodes('simulated_base:ground_truth'), params=TRUTH)
    robot.advance(1.0)
    start = 10**9
    for left in (2.0, *7 * (9.0,), 0.0):
        tell_wheels(robot, velocity=[left, 5.0 * (left > 0.0)], topic='noisy_wheel_rates')
        robot.advance(0.2)
    robot.advance(1.0)
    assert last(robot, 'ground_truth').twist.twist.linear.x == 0.0
    middle = rolled(Pose(1.0, 2.0, 0.5), 2.0, 5.0, 0.2)
    for milliseconds, expected in [
            (100, rolled(Pose(1.0, 2.0, 0.5), 2.0, 5.0, 0.1)),
            (300, rolled(middle, 9.0, 5.0, 0.1)), (2000, rolled(middle, 9.0, 5.0, 1.4))]:
        stamp = start + milliseconds * 1_000_000
        robot.publish('odom', belief(stamp))
        transform = transforms_of(robot)[-1]
        assert stamp_ns(transform) == stamp and frames_of(transform) == ('map', 'odom')
        assert_pose(compose(pose_of(transform), Pose(0.3, -0.2, 1.0)), expected)


@pytest.mark.parametrize('message, words', [
    (belief(1, base='base_footprint'), "child_frame_id is 'base_footprint', expected 'base_link'"),
    (belief(1, frame='map'), "frame_id is 'map', expected another frame than 'map'"),
    (belief(1, frame=''), "frame_id is '', expected another frame than 'map'"),
    (belief(0), 'stamp is 0, expected the time of the pose'),
    (unstamped(belief(1)), 'stamp is (sec, nanosec) (0, 4294967295)'),
    (belief(1, pose=Pose(math.nan, 0.0, 0.0)), 'expected finite numbers')])
def test_a_belief_that_does_not_fit_is_reported_and_broadcasts_nothing(
        diffdrive, capfd, message, words):
    robot = diffdrive(nodes('simulated_base:ground_truth'), params=TRUTH)
    robot.advance(0.1)
    tell_wheels(robot, velocity=[1.0, 1.0], topic='noisy_wheel_rates')
    robot.advance(0.1)
    robot.publish('odom', message)
    output = capfd.readouterr().err
    assert words in output and "message on 'odom'" in output
    robot.publish('odom', belief(time := round(robot.time * 1e9)))
    assert [stamp_ns(one) for one in transforms_of(robot)] == [time]


@pytest.mark.parametrize('parameters', [
    {}, {'publish_map_odom_tf': False, 'enable_odom_tf': False}], ids=['default', 'off'])
def test_the_belief_is_listened_to_only_where_its_frame_is_to_be_corrected(diffdrive, parameters):
    robot = diffdrive(nodes('simulated_base'), params={
        **BELIEF, **parameters, 'odom_topic': 'ground_truth'})
    with pytest.raises(KeyError, match='odom'):
        robot.history('odom')


def test_two_parents_of_one_frame_are_refused_at_start(diffdrive):
    assert 'enable_odom_tf and publish_map_odom_tf are both true' in refusal(
        diffdrive, 'simulated_base', {**TRUTH, 'enable_odom_tf': True})


@pytest.mark.parametrize('parameters, prefix', [
    ({}, ''), ({'tf_frame_prefix': 'left_alone'}, ''),
    ({'tf_frame_prefix_enable': True}, 'robot1/'),
    ({'tf_frame_prefix_enable': True, 'tf_frame_prefix': '/fleet/a'}, 'fleet/a/'),
    ({'tf_frame_prefix_enable': True, 'tf_frame_prefix': 'b/'}, 'b/')])
def test_frames_have_the_prefix_of_ros2_controllers_where_it_is_enabled(
        diffdrive, parameters, prefix):
    robot = diffdrive(
        nodes('simulated_base:robot1/simulated_base'), params={**BELIEF, **parameters})
    tell_wheels(robot, velocity=[1.0, 1.0], topic='/robot1/wheel_rates')
    robot.advance(0.1)
    odometry = last(robot, '/robot1/odom')
    assert odometry.header.frame_id == f'{prefix}odom'
    assert odometry.child_frame_id == f'{prefix}base_link'
