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

"""The demo recorded into a bag: what others read in it, and what calibrate makes of it."""

from collections import Counter
import re

from diffdrive_kinematics.ros.parameters.package_share import share_directory
import pytest

DEMO = share_directory() / 'config' / 'demo.yaml'
BIAS = {'left': 0.004, 'right': -0.002}


def test_a_recorded_demo_is_read_by_others_and_calibrates_to_its_bias(graph, tmp_path):
    rosbags, mcap = pytest.importorskip('rosbags.rosbag2'), pytest.importorskip('mcap.reader')
    bag, written = tmp_path / 'run.mcap', tmp_path / 'found.yaml'
    record = ['--ros-args', '-p', f'record:={bag}', '-p', 'real_time_factor:=0.0']
    sim = graph.start('diffdrive_sim', args=record)
    assert sim.wait() == 0, sim.output
    assert [file.name for file in tmp_path.iterdir()] == ['run.mcap']
    with rosbags.Reader(bag) as reader:
        kinds = {each.topic: each.msgtype for each in reader.connections}
        read = Counter(each.topic for each, _, _ in reader.messages(reader.connections))
    with open(bag, 'rb') as file:
        found = mcap.make_reader(file, validate_crcs=True)
        assert Counter(
            channel.topic for _, channel, _ in found.iter_messages()) == read
    assert kinds['/ground_truth'] == kinds['/odom'] == 'nav_msgs/msg/Odometry'
    assert kinds['/joint_states'] == 'sensor_msgs/msg/JointState' and '/clock' in kinds
    assert read['/odom'] > 1000 and f'{sum(read.values())} messages' in sim.output

    calibrate = graph.start('calibrate', args=[
        '--ros-args', '--params-file', str(DEMO), '-p', f'recordings:=[{bag}]', '-p',
        f'output:={written}'])
    assert calibrate.wait() == 0, calibrate.output
    assert calibrate.output.count('by the stamps of headers') == 2
    for side, bias in BIAS.items():
        value, error = map(float, re.search(
            rf'{side}_wheel_radius_multiplier +(\S+) +(\S+)', calibrate.output).groups())
        assert abs(value - 1.0 - bias) < 3.0 * error

    before = bag.read_bytes()
    again = graph.start('diffdrive_sim', args=record)
    assert again.wait() == 2 and 'which exists' in again.output
    assert bag.read_bytes() == before and len(list(tmp_path.iterdir())) == 2


def test_a_drive_in_real_time_that_is_ended_leaves_what_was_recorded(graph, tmp_path):
    rosbags, bag = pytest.importorskip('rosbags.rosbag2'), tmp_path / 'run.mcap'
    sim = graph.start('diffdrive_sim', args=[
        '--ros-args', '--params-file', str(DEMO), '-p', 'clock_step:=0.0', '-p',
        f'record:={bag}'])
    graph.wait_for(
        lambda: re.search(r' [1-9]\S* of 24.0 s', sim.output), 'some of the course')
    assert sim.stop() == 0, sim.output
    with rosbags.Reader(bag) as reader:
        topics = {each.topic for each in reader.connections if each.msgcount}
    assert {'/cmd_vel', '/wheel_rates', '/odom', '/ground_truth', '/joint_states'} <= topics


def test_a_recording_that_cannot_be_written_is_refused_before_the_drive(graph, tmp_path):
    for path, words in ((tmp_path / 'no' / 'run.mcap', 'a directory that can be written'),
                        (tmp_path / 'run.bag', 'an .mcap file')):
        sim = graph.start('diffdrive_sim', args=['--ros-args', '-p', f'record:={path}'])
        assert sim.wait() == 2 and words in sim.output
        assert 'Traceback' not in sim.output
