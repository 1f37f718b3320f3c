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
from nav_msgs.msg import Path
import pytest
from support.graph import CONFIG, KHEPERA, stamp_ns
from support.stepped import last, messages, nodes, refusal, tell_wheels

pytestmark = pytest.mark.ros

SETTINGS = {
    **KHEPERA, 'enable_odom_tf': False, 'command_timeout': 0.0, 'path_topic': 'way',
    'path_rate': 20.0, 'odom_frame_id': 'map', 'base_frame_id': 'robot'}


def rolling(diffdrive, rate, **settings):
    """Return a robot whose wheels roll at a rate [rad/s], and how its path is listened to."""
    robot = diffdrive(nodes('simulated_base'), params={**SETTINGS, **settings})
    robot.listen(Path, 'way')
    tell_wheels(robot, velocity=[rate, rate])
    return robot


def spots(path):
    return [(pose.pose.position.x, pose.pose.position.y) for pose in path.poses]


def test_the_path_has_published_poses_that_are_far_enough_apart(diffdrive):
    robot = rolling(diffdrive, 5.0, path_spacing=0.03, initial_pose=[1.0, 2.0, math.pi / 2])
    robot.advance(2.0)
    path = last(robot, 'way')
    assert len(path.poses) > 5 and path.header.frame_id == 'map'
    assert stamp_ns(path) == stamp_ns(path.poses[-1])
    published = {stamp_ns(each.message): each.message.pose.pose for each in robot.history('odom')}
    for pose in path.poses:
        assert pose.header.frame_id == 'map'
        assert pose.pose == published[stamp_ns(pose)]
    gaps = [math.dist(a, b) for a, b in zip(spots(path), spots(path)[1:])]
    assert min(gaps) >= 0.03


def test_the_path_is_bounded_and_loses_its_oldest_poses(diffdrive):
    robot = rolling(diffdrive, 1.0, path_length=4, path_spacing=0.0)
    robot.advance(1.0)
    paths = messages(robot, 'way')
    first = next(path for path in paths if path.poses)
    assert len(paths[-1].poses) == 4 and spots(paths[-1])[0][0] > spots(first)[-1][0]
    assert max(len(path.poses) for path in paths) == 4


def test_a_path_without_news_is_told_only_to_who_has_come_since(diffdrive):
    robot = rolling(diffdrive, 0.0)
    robot.advance(2.0)
    path, = messages(robot, 'way')
    assert len(path.poses) == 1
    robot.listen(Path, 'way')
    robot.advance(1.0)
    assert messages(robot, 'way') == [path, path]


def test_without_a_topic_there_is_no_path(diffdrive):
    robot = diffdrive(nodes('simulated_base'), params={**SETTINGS, 'path_topic': ''})
    tell_wheels(robot, velocity=[1.0, 1.0])
    robot.advance(0.1)
    assert robot.history('odom')
    with pytest.raises(KeyError, match='odom') as unknown:
        robot.history('way')
    assert 'way' not in str(unknown.value).partition('one of')[2]


@pytest.mark.parametrize('name, value, words', [
    ('path_length', 0, 'an integer from 1'), ('path_spacing', -1.0, '0 or above'),
    ('path_rate', 0.0, 'Hz'), ('path_topic', 'wheel_rates', 'another topic')])
def test_a_bad_setting_of_the_path_is_refused(diffdrive, name, value, words):
    refused = refusal(diffdrive, 'simulated_base', {**SETTINGS, name: value})
    assert name in refused and words in refused


def test_the_demo_shows_the_paths_of_belief_and_truth(diffdrive):
    robot = diffdrive(CONFIG / 'demo.yaml')
    for topic in ('path', 'ground_truth_path'):
        robot.listen(Path, topic)
    robot.advance(25.0)
    belief, truth = (last(robot, topic) for topic in ('path', 'ground_truth_path'))
    assert len(belief.poses) > 40 and len(truth.poses) > 40
    assert (belief.header.frame_id, truth.header.frame_id) == ('odom', 'map')
    assert spots(belief)[0] == spots(truth)[0] == (0.0, 0.0)
    assert spots(belief)[-1] != spots(truth)[-1]


def test_a_robot_that_is_put_elsewhere_has_a_path_from_there_on_in_its_prefixed_frame(diffdrive):
    robot = rolling(diffdrive, 5.0, path_spacing=0.01, tf_frame_prefix_enable=True,
                    tf_frame_prefix='r2/')
    robot.advance(0.5)
    path = last(robot, 'way')
    assert len(path.poses) > 3 and path.header.frame_id == 'r2/map'
    place = PoseWithCovarianceStamped()
    place.header.frame_id = 'r2/map'
    place.pose.pose.position.x, place.pose.pose.orientation.w = 50.0, 1.0
    robot.publish('set_pose', place)
    tell_wheels(robot, velocity=[5.0, 5.0])
    robot.advance(0.5)
    path = last(robot, 'way')
    assert len(path.poses) > 3 and all(x >= 50.0 for x, _ in spots(path))
