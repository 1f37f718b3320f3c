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
"""The path of a base: what was published, thinned out and bounded."""

import math

from geometry_msgs.msg import PoseWithCovarianceStamped
from nav_msgs.msg import Odometry, Path
import pytest
from sensor_msgs.msg import JointState
from std_msgs.msg import Empty
from support.graph import JOINTS, KHEPERA, set_stamp, stamp_ns

SETTINGS = {
    **KHEPERA, 'enable_odom_tf': False, 'command_timeout': 0.0, 'path_topic': 'way',
    'path_rate': 20.0, 'odom_frame_id': 'map', 'base_frame_id': 'robot'}


def roll(graph, rate):
    """Let the wheels roll at a rate [rad/s]; return the publisher."""
    wheels = graph.publisher(JointState, 'wheel_rates')
    message = JointState(name=JOINTS, velocity=[rate, rate])
    set_stamp(message, graph.now_ns())
    wheels.publish(message)
    return wheels


def spots(path):
    return [(pose.pose.position.x, pose.pose.position.y) for pose in path.poses]


@pytest.mark.quick
def test_the_path_has_published_poses_that_are_far_enough_apart(graph):
    graph.start('simulated_base', {
        **SETTINGS, 'path_spacing': 0.03, 'initial_pose': [1.0, 2.0, math.pi / 2]})
    paths, odometry = graph.collect(Path, 'way'), graph.collect(Odometry, 'odom')
    graph.wait_for(lambda: graph.node.count_publishers('odom'), 'the base')
    roll(graph, 5.0)
    path = graph.wait_for(
        lambda: paths and len(paths[-1].poses) > 5 and paths[-1], 'a path of some poses')
    assert path.header.frame_id == 'map'
    assert stamp_ns(path) == stamp_ns(path.poses[-1])
    graph.wait_for(
        lambda: odometry and stamp_ns(odometry[-1]) >= stamp_ns(path), 'its odometry')
    published = {stamp_ns(message): message.pose.pose for message in odometry}
    for pose in path.poses:
        assert pose.header.frame_id == 'map'
        if stamp_ns(pose) >= min(published):
            assert pose.pose == published[stamp_ns(pose)]
    gaps = [math.dist(a, b) for a, b in zip(spots(path), spots(path)[1:])]
    assert min(gaps) >= 0.03


def test_the_path_is_bounded_and_loses_its_oldest_poses(graph):
    graph.start('simulated_base', {**SETTINGS, 'path_length': 4, 'path_spacing': 0.0})
    paths = graph.collect(Path, 'way')
    roll(graph, 1.0)
    first = graph.wait_for(lambda: paths and paths[-1].poses and paths[-1], 'a path')
    graph.wait_for(lambda: len(paths[-1].poses) == 4 and spots(paths[-1])[0][0] >
                   spots(first)[-1][0], 'the oldest poses to go')
    assert max(len(path.poses) for path in paths) == 4


def test_a_path_without_news_is_told_only_to_who_has_come_since(graph):
    graph.start('simulated_base', {**SETTINGS, 'publish_rate': 200.0})
    odometry, paths = graph.collect(Odometry, 'odom'), graph.collect(Path, 'way')
    roll(graph, 0.0)
    graph.wait_for(lambda: paths and len(odometry) > 400, 'two seconds at rest')
    assert len(paths) == 1 and len(paths[0].poses) == 1
    late = graph.collect(Path, 'way')
    graph.wait_for(lambda: late, 'the path for the late listener')
    assert late[0] == paths[0]


def test_without_a_topic_there_is_no_path(graph):
    graph.start('simulated_base', {**SETTINGS, 'path_topic': ''})
    odometry = graph.collect(Odometry, 'odom')
    roll(graph, 1.0)
    graph.wait_for(lambda: odometry, 'odometry')
    assert 'nav_msgs/msg/Path' not in {
        kind for _, kinds in graph.node.get_topic_names_and_types() for kind in kinds}


@pytest.mark.parametrize('name, value, words', [
    ('path_length', 0, 'an integer from 1'), ('path_spacing', -1.0, '0 or above'),
    ('path_rate', 0.0, 'Hz'), ('path_topic', 'wheel_rates', 'another topic')])
def test_a_bad_setting_of_the_path_is_refused(graph, name, value, words):
    base = graph.start('simulated_base', {**SETTINGS, name: value})
    assert base.wait() == 2
    assert name in base.output and words in base.output


def test_the_demo_shows_the_paths_of_belief_and_truth(graph):
    beliefs, truths = graph.collect(Path, 'path'), graph.collect(Path, 'ground_truth_path')
    go = graph.publisher(Empty, 'go', listeners=0)
    sim = graph.start('diffdrive_sim', {'real_time_factor': 0.0}, '-p',
                      "command_sequence:wait_for_topics:=['odom', 'ground_truth', 'go']")
    graph.wait_for(lambda: beliefs and truths, 'paths')
    graph.play_out(sim, go)
    graph.wait_for(lambda: len(beliefs[-1].poses) > 40 and len(truths[-1].poses) > 40, 'the rest')
    assert (beliefs[-1].header.frame_id, truths[-1].header.frame_id) == ('odom', 'map')
    assert spots(beliefs[-1])[0] == spots(truths[-1])[0] == (0.0, 0.0)
    assert spots(beliefs[-1])[-1] != spots(truths[-1])[-1]


def test_a_robot_that_is_put_elsewhere_has_a_path_from_there_on_in_its_prefixed_frame(graph):
    graph.start('simulated_base', {
        **SETTINGS, 'path_spacing': 0.01, 'tf_frame_prefix_enable': True,
        'tf_frame_prefix': 'r2/'})
    paths = graph.collect(Path, 'way')
    roll(graph, 5.0)
    graph.wait_for(lambda: paths and len(paths[-1].poses) > 3, 'a path of some poses')
    assert paths[-1].header.frame_id == 'r2/map'
    place = PoseWithCovarianceStamped()
    place.header.frame_id = 'r2/map'
    place.pose.pose.position.x, place.pose.pose.orientation.w = 50.0, 1.0
    graph.publisher(PoseWithCovarianceStamped, 'set_pose').publish(place)
    graph.wait_for(lambda: spots(paths[-1])[-1][0] >= 50.0, 'the path from there')
    assert all(x >= 50.0 for x, _ in spots(paths[-1]))
