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

"""Drives from bags, which are written by rosbags here, against the same drives from CSV."""

import math
import shutil
import sys
from types import SimpleNamespace

from diffdrive_kinematics.core.kinematics import twist_from_wheel_rates, WheelGeometry
from diffdrive_kinematics.tools.calibration import MULTIPLIERS, of_drives
from diffdrive_kinematics.tools.recording_sources import read_commands, read_drives
from geometry_msgs.msg import PoseStamped, PoseWithCovarianceStamped, Twist, TwistStamped
from nav_msgs.msg import Odometry
import numpy as np
import pytest
from support.graph import set_stamp, twist
from support.recorded import load, RADIUS, RUNS, SEPARATION, TICKS_PER_TURN, wheel_positions

bags = pytest.importorskip('support.bags', reason='rosbags is not installed')

GEOMETRY = WheelGeometry(SEPARATION, RADIUS)
EPOCH_NS = 1_700_000_000_000_000_000
VALUES = {
    'recordings': [], 'references': [], 'motion_topic': '/joint_states',
    'reference_topic': 'mocap/pose', 'reference_frames': [], 'encoder_resolution': TICKS_PER_TURN,
    'tick_increments': True, 'gear_ratio': 1.0, 'encoder_range': 0.0, 'position_feedback': True,
    'left_wheel_names': ['left_wheel_joint'], 'right_wheel_names': ['right_wheel_joint'],
    'left_wheel_inverted': False, 'right_wheel_inverted': False, 'mean_radius': '',
    'equal_slip': True}


def posed(kind, time_ns, row):
    """Return a message of a type with the reference pose of a row."""
    message, at = kind(), bags.pose(row['x'], row['y'], row['yaw'])
    if kind is not PoseStamped:
        message.pose.pose = at
    else:
        message.pose = at
    set_stamp(message, time_ns)
    return message


def messages_of(run, kind=PoseStamped, late_ns=5_000_000):
    """Return the messages of a run, each received late by the same time."""
    rows = load(run)
    found = []
    for row, (left, right) in zip(rows, wheel_positions(rows)):
        time_ns = EPOCH_NS + round(row['time_sec'] * 1e9)
        found += [('/joint_states', time_ns + late_ns, bags.joints(time_ns, left, right)),
                  ('/mocap/pose', time_ns + late_ns, posed(kind, time_ns, row))]
    return found


def found_in(recordings, **changes):
    """Return multipliers and slips, and the remarks."""
    drives, commands, remarks = read_drives(
        {**VALUES, 'recordings': list(map(str, recordings)), **changes}, GEOMETRY)
    result = of_drives(
        VALUES, GEOMETRY, drives, commands=commands, clock='delay' if commands else 'auto')
    return [getattr(result.geometry, name) for name in MULTIPLIERS], result.slips, remarks


@pytest.mark.slow
def test_six_runs_give_the_same_wheels_and_slip_as_mcap_as_sqlite3_and_as_csv(tmp_path):
    csv, slips, _ = found_in(RUNS)
    for storage in bags.STORES:
        paths = [bags.write_bag(tmp_path / f'{storage}{number}', messages_of(run), storage)
                 for number, run in enumerate(RUNS)]
        wheels, slip, remarks = found_in(paths)
        assert wheels == pytest.approx(csv, abs=1e-6)
        assert slip == pytest.approx(slips, rel=1e-4)
        assert sum('by the stamps of headers' in remark for remark in remarks) == 12


@pytest.fixture(scope='module')
def few(tmp_path_factory):
    """Return the bags of two runs, one each way, and what they give."""
    directory = tmp_path_factory.mktemp('bags')
    paths = [bags.write_bag(directory / f'run{number}', messages_of(RUNS[number]))
             for number in (0, 3)]
    return paths, found_in(paths)[0]


@pytest.mark.slow
@pytest.mark.parametrize('storage', ['mcap', 'sqlite3'])
def test_single_files_and_directories_whose_metadata_names_another_file_are_read(
        tmp_path, few, storage):
    (first, second), wheels = few
    if storage == 'sqlite3':
        first, second = (bags.write_bag(tmp_path / f'db{number}', messages_of(RUNS[number]),
                                        storage) for number in (0, 3))
    copy = shutil.copytree(second, tmp_path / 'copy')
    single, = (file for file in copy.iterdir() if file.suffix in ('.mcap', '.db3'))
    alone = shutil.copy(single, tmp_path / f'drive{single.suffix}')
    single.rename(single.with_name(f'renamed{single.suffix}'))
    assert found_in([first, alone])[0] == pytest.approx(wheels, abs=1e-12)
    assert found_in([first, copy])[0] == pytest.approx(wheels, abs=1e-12)


class Rosbag2Py:
    """What is used of rosbag2_py, by the names and arguments that it has in Jazzy."""

    StorageOptions = StorageFilter = staticmethod(lambda **fields: SimpleNamespace(**fields))
    ConverterOptions = staticmethod(lambda source, target: (source, target))

    class SequentialReader:

        def open(self, storage, converter):  # noqa: A003
            assert converter == ('cdr', 'cdr')
            try:
                self._reader = bags.Reader(storage.uri)
                self._reader.open()
            except bags.ReaderError as error:
                raise RuntimeError(str(error)) from error
            self._topics = None

        def get_all_topics_and_types(self):
            return [SimpleNamespace(name=each.topic, type=each.msgtype)
                    for each in self._reader.connections]

        def get_metadata(self):
            return SimpleNamespace(topics_with_message_count=[
                SimpleNamespace(message_count=each.msgcount, topic_metadata=SimpleNamespace(
                    name=each.topic, type=each.msgtype)) for each in self._reader.connections])

        def set_filter(self, storage_filter):
            self._left = [
                (each.topic, data, time_ns)
                for each, time_ns, data in self._reader.messages(self._reader.connections)
                if each.topic in storage_filter.topics][::-1]

        def has_next(self):
            return bool(self._left)

        def read_next(self):
            return self._left.pop()


@pytest.mark.slow
def test_a_ros_machine_without_rosbags_reads_the_same(tmp_path, few, monkeypatch):
    (first, second), wheels = few
    single, = second.glob('*.mcap')
    monkeypatch.setitem(sys.modules, 'rosbags.rosbag2', None)
    with pytest.raises(ValueError, match=r"'\.\[bags\]'"):
        found_in([first, single])
    monkeypatch.setitem(sys.modules, 'rosbag2_py', Rosbag2Py)
    assert found_in([first, single])[0] == pytest.approx(wheels, abs=1e-12)
    with pytest.raises(ValueError, match='is not in the bag.*/joint_states'):
        found_in([first], motion_topic='wheels')


@pytest.mark.parametrize('kind', [PoseWithCovarianceStamped, Odometry],
                         ids=lambda kind: kind.__name__)
def test_the_reference_may_be_of_each_type(tmp_path, few, kind):
    paths = [bags.write_bag(tmp_path / f'{number}', messages_of(RUNS[number], kind))
             for number in (0, 3)]
    assert found_in(paths)[0] == pytest.approx(few[1], abs=1e-12)


@pytest.mark.slow
def test_the_reference_may_be_a_transform_of_tf_and_its_frames_are_listed(tmp_path, few):
    paths = []
    for number in (0, 3):
        rows, messages = load(RUNS[number]), messages_of(RUNS[number])[::2]
        for row, (_, received_ns, message) in zip(rows, list(messages)):
            time_ns = received_ns - 5_000_000
            messages += [
                ('/tf', received_ns, bags.transform(
                    time_ns, 'map', 'tracker', row['x'], row['y'], row['yaw'])),
                ('/tf', received_ns, bags.transform(time_ns, 'odom', 'base_link', 0, 0, 0))]
        paths.append(bags.write_bag(tmp_path / f'{number}', messages))
    wheels, _, _ = found_in(
        paths, reference_topic='/tf', reference_frames=['/map', 'tracker'])
    assert wheels == pytest.approx(few[1], abs=1e-12)
    with pytest.raises(ValueError, match=r'\[map, tracker\] \(\d+\), \[odom, base_link\]'):
        found_in(paths, reference_topic='/tf')


@pytest.mark.slow
def test_references_may_be_in_another_file_of_either_kind(tmp_path, few):
    paths, wheels = few
    tables = []
    for number in (0, 3):
        rows = load(RUNS[number])
        tables.append(tmp_path / f'{number}.csv')
        tables[-1].write_text('\n'.join([','.join(rows[0]), *(
            ','.join([f"{row['time_sec'] + EPOCH_NS / 1e9:.6f}", *(
                str(value) for name, value in row.items() if name != 'time_sec')])
            for row in rows)]))
    for recordings, references in ((tables, paths), (paths, tables)):
        assert found_in(recordings, references=list(map(str, references)))[0] == pytest.approx(
            wheels, abs=1e-5)


@pytest.mark.slow
def test_twists_of_odometry_are_rates_and_twists_without_stamps_are_commands_when_received(
        tmp_path, few):
    paths = {Odometry: [], Twist: [], TwistStamped: []}
    for number in (0, 3):
        rows, seen = load(RUNS[number]), messages_of(RUNS[number])[1::2]
        times = np.array([row['time_sec'] for row in rows])
        angles = np.array(wheel_positions(rows))
        rates = np.diff(angles, axis=0) / np.diff(times)[:, None]
        speeds = list(zip(*twist_from_wheel_rates(GEOMETRY, *rates.T)))
        for kind in paths:
            messages = list(seen)
            for time, (v, w) in zip(times, speeds):
                time_ns = EPOCH_NS + round(time * 1e9)
                message, told = kind(), twist(v, w)
                if kind is Twist:
                    message = told
                else:
                    set_stamp(message, time_ns)
                    if kind is Odometry:
                        message.twist.twist = told
                    else:
                        message.twist = told
                messages.append(('/motion', time_ns, message))
            paths[kind].append(bags.write_bag(tmp_path / f'{kind.__name__}{number}', messages))
    rated, _, remarks = found_in(paths[Odometry], motion_topic='/motion')
    assert rated == pytest.approx(few[1], abs=2e-3) and 'Odometry' in remarks[0]
    plain, _, remarks = found_in(paths[Twist], motion_topic='motion')
    assert 'by the time of reception' in remarks[0] and 'stamps of headers' in remarks[1]
    assert found_in(paths[TwistStamped], motion_topic='motion')[0] == pytest.approx(
        plain, abs=1e-9)
    assert 0.5 * (plain[0] + plain[1]) == pytest.approx(1.0)  # the mean radius is kept


@pytest.mark.parametrize('changes, words', [
    ({'motion_topic': 'wheels'}, "motion_topic 'wheels' is not in the bag"),
    ({'motion_topic': 'mocap/pose'}, 'is of type geometry_msgs/msg/PoseStamped'),
    ({'reference_topic': 'joint_states'}, 'is of type sensor_msgs/msg/JointState'),
    ({'left_wheel_names': ['l'], 'right_wheel_names': ['r']}, 'set left_wheel_names')])
def test_a_topic_that_is_not_there_is_refused_with_those_that_are(few, changes, words):
    with pytest.raises(ValueError, match=words) as error:
        found_in(few[0], **changes)
    text = str(error.value)
    assert '\n' not in text and str(few[0][0]) in text
    if 'left_wheel_names' not in changes:
        assert '/joint_states (sensor_msgs/msg/JointState, ' in text
        assert '/mocap/pose (geometry_msgs/msg/PoseStamped, ' in text


def test_a_reference_in_millimetres_is_refused_with_the_word_metres(tmp_path):
    messages = messages_of(RUNS[0])
    for topic, _, message in messages:
        if topic == '/mocap/pose':
            message.pose.position.x *= 1000.0
            message.pose.position.y *= 1000.0
    with pytest.raises(ValueError, match='millimetres, expected metres'):
        found_in([bags.write_bag(tmp_path / 'mm', messages)])


@pytest.mark.parametrize('storage', ['mcap', 'sqlite3'])
def test_a_damaged_bag_is_read_or_refused_in_one_line(tmp_path, storage):
    whole = bags.write_bag(tmp_path / 'whole', messages_of(RUNS[0])[:800], storage)
    file, = (file for file in whole.iterdir() if file.suffix in ('.mcap', '.db3'))
    content, generator = file.read_bytes(), np.random.default_rng(5)
    for number in range(20):
        damaged = bytearray(content)
        if number % 2:
            del damaged[int(generator.integers(len(content))):]
        else:
            for at in generator.integers(len(content), size=20):
                damaged[at] = int(generator.integers(256))
        path = tmp_path / f'{number}{file.suffix}'
        path.write_bytes(damaged)
        try:
            found_in([path])
        except ValueError as error:
            assert len(str(error).splitlines()) == 1, error


def test_commands_of_a_bag_are_played_at_their_times(tmp_path):
    told = [(0, 0.1, 0.0), (1_500_000_000, 0.2, -0.5), (2_000_000_000, 0.0, 0.0)]
    path = bags.write_bag(tmp_path / 'bag', [
        ('/cmd_vel', EPOCH_NS + time_ns, twist(v, w)) for time_ns, v, w in told])
    assert read_commands(str(path), 'cmd_vel') == [(t / 1e9, v, w) for t, v, w in told]
    with pytest.raises(ValueError, match=r'/cmd_vel \(geometry_msgs/msg/Twist, 3\)'):
        read_commands(str(path), 'base/cmd_vel')
    fast = bags.write_bag(tmp_path / 'fast', [
        ('/cmd_vel', EPOCH_NS + n * 10**9, twist(math.nan if n else 0.1, 0.0))
        for n in range(3)])
    with pytest.raises(ValueError, match='message 2 .*linear.x'):
        read_commands(str(fast), 'cmd_vel')
