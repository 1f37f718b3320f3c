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
import signal

from diffdrive_kinematics.core.kinematics import advance, Pose
from diffdrive_kinematics.core.kinematics import compose
from nav_msgs.msg import Odometry
import pytest
from sensor_msgs.msg import JointState
from support.graph import JOINTS, KHEPERA, set_stamp, stamp_ns
from support.tf import transforms

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


def rates(time_ns, left, right):
    message = JointState(name=JOINTS, velocity=[left, right])
    set_stamp(message, time_ns)
    return message


def rolled(pose, left, right, seconds):
    """Return the pose after wheel rates [rad/s] for a time [s]."""
    return advance(pose, 0.5 * RADIUS * (left + right) * seconds,
                   RADIUS * (right - left) * seconds / SEPARATION)


def belief(time_ns, pose=Pose(0.3, -0.2, 1.0), frame='odom', base='base_link'):
    message = Odometry(child_frame_id=base)
    message.header.frame_id = frame
    set_stamp(message, time_ns)
    message.pose.pose.position.x, message.pose.pose.position.y = pose.x, pose.y
    message.pose.pose.orientation.z = math.sin(0.5 * pose.theta)
    message.pose.pose.orientation.w = math.cos(0.5 * pose.theta)
    return message


def unstamped(message):
    message.header.stamp.nanosec = 2**32 - 1
    return message


def assert_same_pose(pose, other, tolerance=1e-9):
    assert pose[:2] == pytest.approx(other[:2], abs=tolerance)
    assert math.remainder(pose.theta - other.theta, math.tau) == pytest.approx(
        0.0, abs=tolerance)


def test_tf_is_the_odometry_with_its_stamp_and_frames_exactly_as_written(graph):
    graph.start('simulated_base', {
        **BELIEF, 'odom_frame_id': 'my/odom', 'base_frame_id': 'my_base'}, '-r', '__ns:=/robot1')
    found = transforms(graph)
    odometry = graph.collect(Odometry, '/robot1/odom')
    graph.publisher(JointState, '/robot1/wheel_rates').publish(rates(graph.now_ns(), 3.0, 5.0))
    graph.wait_for(lambda: len(found) > 20 and len(odometry) > 20, 'transforms')
    told = {stamp_ns(message): message for message in odometry}
    both = [(told[stamp_ns(one)], one) for one in found if stamp_ns(one) in told]
    assert len(both) > 9
    for message, transform in both:
        assert frames_of(transform) == ('my/odom', 'my_base')
        assert transform.transform.translation.x == message.pose.pose.position.x
        assert transform.transform.translation.y == message.pose.pose.position.y
        assert transform.transform.rotation == message.pose.pose.orientation


def test_map_to_odom_to_base_is_the_truth_whatever_the_robot_believes(graph):
    graph.start('simulated_base', BELIEF)
    graph.start('simulated_base', TRUTH, '-r', '__node:=ground_truth')
    found = transforms(graph)
    truth = graph.collect(Odometry, 'ground_truth')
    asked, driven = (
        graph.publisher(JointState, topic) for topic in ('wheel_rates', 'noisy_wheel_rates'))
    start = graph.now_ns()
    asked.publish(rates(start, 3.0, 5.0))
    driven.publish(rates(start, 3.1, 4.8))
    graph.wait_for(lambda: truth, 'the truth')
    heard = stamp_ns(truth[0])

    def chains():
        since = [one for one in found if stamp_ns(one) > heard]
        inner = {stamp_ns(one): one for one in since if frames_of(one) == ('odom', 'base_link')}
        return [(one, inner[stamp_ns(one)]) for one in since
                if frames_of(one) == ('map', 'odom') and stamp_ns(one) in inner]

    graph.wait_for(lambda: len(chains()) > 20, 'chains of transforms')
    for outer, inner in chains():
        seconds = (stamp_ns(outer) - start) / 1e9
        assert_same_pose(compose(pose_of(outer), pose_of(inner)),
                         rolled(Pose(1.0, 2.0, 0.5), 3.1, 4.8, seconds))
        assert_same_pose(pose_of(inner), rolled(Pose(0.0, 0.0, 0.0), 3.0, 5.0, seconds))
    assert {frames_of(one) for one in found} == {('map', 'odom'), ('odom', 'base_link')}


def test_a_belief_is_matched_with_the_truth_at_its_stamp_also_when_the_truth_has_moved_on(graph):
    graph.start('simulated_base', TRUTH, '-r', '__node:=ground_truth')
    found = transforms(graph)
    truth = graph.collect(Odometry, 'ground_truth')
    wheels = graph.publisher(JointState, 'noisy_wheel_rates')
    beliefs = graph.publisher(Odometry, 'odom')
    start = graph.now_ns()
    for number, left in enumerate((2.0, *7 * (9.0,), 0.0)):
        stamp = start + number * 200_000_000
        graph.wait_for(lambda: graph.now_ns() >= stamp, 'the time of the message')
        wheels.publish(rates(stamp, left, 5.0 * (left > 0.0)))
    graph.wait_for(lambda: truth and truth[-1].twist.twist.linear.x == 0.0, 'the truth')
    middle = rolled(Pose(1.0, 2.0, 0.5), 2.0, 5.0, 0.2)
    for milliseconds, expected in [
            (100, rolled(Pose(1.0, 2.0, 0.5), 2.0, 5.0, 0.1)),
            (300, rolled(middle, 9.0, 5.0, 0.1)), (2000, rolled(middle, 9.0, 5.0, 1.4))]:
        stamp = start + milliseconds * 1_000_000
        beliefs.publish(belief(stamp))
        transform = graph.wait_for(lambda: [
            one for one in found if stamp_ns(one) == stamp], 'the transform')[0]
        assert frames_of(transform) == ('map', 'odom')
        assert_same_pose(compose(pose_of(transform), Pose(0.3, -0.2, 1.0)), expected)


@pytest.mark.parametrize('message, words', [
    (belief(1, base='base_footprint'), "child_frame_id is 'base_footprint', expected 'base_link'"),
    (belief(1, frame='map'), "frame_id is 'map', expected another frame than 'map'"),
    (belief(1, frame=''), "frame_id is '', expected another frame than 'map'"),
    (belief(0), 'stamp is 0, expected the time of the pose'),
    (unstamped(belief(1)), 'stamp is (sec, nanosec) (0, 4294967295)'),
    (belief(1, pose=Pose(math.nan, 0.0, 0.0)), 'expected finite numbers')])
def test_a_belief_that_does_not_fit_is_reported_and_broadcasts_nothing(graph, message, words):
    truth = graph.start('simulated_base', TRUTH, '-r', '__node:=ground_truth')
    found = transforms(graph)
    odometry = graph.collect(Odometry, 'ground_truth')
    graph.publisher(JointState, 'noisy_wheel_rates').publish(rates(graph.now_ns(), 1.0, 1.0))
    graph.wait_for(lambda: odometry, 'the truth')
    beliefs = graph.publisher(Odometry, 'odom')
    beliefs.publish(message)
    graph.wait_for(lambda: words in truth.output, 'a report')
    assert "message on 'odom'" in truth.output
    good = belief(graph.now_ns())
    beliefs.publish(good)
    graph.wait_for(lambda: found, 'a transform')
    assert [stamp_ns(one) for one in found] == [stamp_ns(good)]
    assert truth.stop(signal.SIGTERM) == 0


@pytest.mark.parametrize('parameters', [
    {}, {'publish_map_odom_tf': False, 'enable_odom_tf': False}], ids=['default', 'off'])
def test_the_belief_is_listened_to_only_where_its_frame_is_to_be_corrected(graph, parameters):
    graph.start('simulated_base', {**BELIEF, **parameters, 'odom_topic': 'ground_truth'})
    graph.publisher(JointState, 'wheel_rates')
    assert graph.node.count_subscribers('odom') == 0


def test_two_parents_of_one_frame_are_refused_at_start(graph):
    base = graph.start('simulated_base', {**TRUTH, 'enable_odom_tf': True})
    assert base.wait() == 2
    assert 'enable_odom_tf and publish_map_odom_tf are both true' in base.output
    assert 'Traceback' not in base.output


@pytest.mark.parametrize('parameters, prefix', [
    ({}, ''), ({'tf_frame_prefix': 'left_alone'}, ''),
    ({'tf_frame_prefix_enable': True}, 'robot1/'),
    ({'tf_frame_prefix_enable': True, 'tf_frame_prefix': '/fleet/a'}, 'fleet/a/'),
    ({'tf_frame_prefix_enable': True, 'tf_frame_prefix': 'b/'}, 'b/')])
def test_frames_have_the_prefix_of_ros2_controllers_where_it_is_enabled(
        graph, parameters, prefix):
    graph.start('simulated_base', {**BELIEF, **parameters}, '-r', '__ns:=/robot1')
    odometry = graph.collect(Odometry, '/robot1/odom')
    graph.publisher(JointState, '/robot1/wheel_rates').publish(rates(graph.now_ns(), 1.0, 1.0))
    graph.wait_for(lambda: odometry, 'odometry')
    assert odometry[-1].header.frame_id == f'{prefix}odom'
    assert odometry[-1].child_frame_id == f'{prefix}base_link'
