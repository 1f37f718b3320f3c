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

"""A drive that is kept: as a CSV file that others read, and as a picture of the way it went."""

import csv
import importlib.util
import math
import re

from diffdrive_kinematics.core.kinematics import (
    advance, Pose, twist_from_wheel_rates, WheelGeometry, wrap_angle)
from diffdrive_kinematics.ros.parameters.package_share import share_directory
from diffdrive_kinematics.tools.keeping import Keeping
from diffdrive_kinematics.tools.robots import Moment
import numpy as np
import pytest
from support.driver import base, S
from support.graph import KHEPERA

pytestmark = pytest.mark.ros

CONFIG = share_directory() / 'config'
FAST = ['--ros-args', '--params-file', str(CONFIG / 'demo.yaml'), '-p', 'real_time_factor:=0.0']
BIAS = {'left': 0.004, 'right': -0.002}
MATPLOTLIB = pytest.mark.skipif(
    importlib.util.find_spec('matplotlib') is None, reason='matplotlib is not installed')


def columns_of(file):
    """Return the columns of a CSV file by their names."""
    with open(file, newline='') as lines:
        rows = list(csv.reader(lines))
    return dict(zip(rows[0], np.array(rows[1:], dtype=float).T))


def test_a_drive_is_kept_as_csv_with_belief_truth_wheels_and_commands(here, tmp_path):
    run = tmp_path / 'run.csv'
    sim = here('diffdrive_sim', [*FAST, '-p', f'record:={run}'])
    assert sim.wait() == 0, sim.output
    assert [file.name for file in tmp_path.iterdir()] == ['run.csv']
    kept = columns_of(run)
    assert list(kept) == [
        'time_sec', 'left_position', 'right_position', 'linear_x', 'angular_z', 'belief_x',
        'belief_y', 'belief_yaw', 'x', 'y', 'yaw']
    time = kept['time_sec']
    assert f'recorded {len(time)} rows in {run}' in sim.output
    assert np.all(np.diff(time) > 0.0) and np.all(np.diff(time) < 0.021)
    for role, names in (('belief', 'belief_x belief_y belief_yaw'), ('truth', 'x y yaw')):
        shown = re.search(rf'^{role} \(\S+\) +(\S+) +(\S+) +(\S+)$', sim.output, re.M).groups()
        ended = [kept[name][-1] for name in names.split()]
        assert [float(each) for each in shown] == pytest.approx(
            [ended[0], ended[1], math.degrees(ended[2])], abs=6e-3)
    assert set(kept['linear_x'].round(9)) == {0.0, 0.1}
    turned = np.diff([kept['left_position'], kept['right_position']]) / np.diff(time)
    geometry = WheelGeometry(KHEPERA['wheel_separation'], KHEPERA['wheel_radius'])
    v, w = twist_from_wheel_rates(geometry, *turned)
    assert v == pytest.approx(kept['linear_x'][:-1], abs=1e-6)  # what holds until the next row
    assert w == pytest.approx(kept['angular_z'][:-1], abs=1e-6)


@pytest.mark.slow
def test_a_kept_drive_calibrates_to_the_bias_of_its_robot_and_plays_again(here, tmp_path):
    run = tmp_path / 'run.csv'
    sim = here('diffdrive_sim', [*FAST, '-p', f'record:={run}'])
    assert sim.wait() == 0, sim.output
    calibrate = here('calibrate', [
        '--ros-args', '--params-file', str(CONFIG / 'demo.yaml'), '-p', f'recordings:=[{run}]',
        '-p', f'output:={tmp_path / "found.yaml"}'])
    assert calibrate.wait() == 0, calibrate.output
    for side, bias in BIAS.items():
        value, error = map(float, re.search(
            rf'{side}_wheel_radius_multiplier +(\S+) +(\S+)', calibrate.output).groups())
        assert abs(value - 1.0 - bias) < 3.0 * error
    again = here('diffdrive_sim', [
        '--ros-args', '--params-file', str(CONFIG / 'recording.yaml'), '-p',
        'wheel_radius:=0.021', '-p', 'wheel_separation:=0.0885', '-p', 'real_time_factor:=0.0',
        '-p', f'recording:={run}'])
    assert again.wait() == 0, again.output
    belief = re.search(r'^belief \(\S+\) +(\S+) +(\S+) +(\S+)$', again.output, re.M).groups()
    assert [float(each) for each in belief] == pytest.approx([0.0, 0.0, 0.0], abs=2e-4)


def test_the_recording_that_is_installed_is_played_to_its_end_as_its_file_stands(here):
    sim = here('diffdrive_sim', [
        '--ros-args', '--params-file', str(CONFIG / 'recording.yaml'), '-p', 'clock_step:=0.05',
        '-p', 'real_time_factor:=0.0'])
    assert sim.wait() == 0, sim.output
    kept = columns_of(CONFIG / 'recording.csv')
    pose = Pose(0.0, 0.0, 0.0)
    for held, v, w in zip(np.diff(kept['time_sec']), kept['linear_x'], kept['angular_z']):
        pose = advance(pose, v * held, w * held)
    belief = re.search(r'^belief \(\S+\) +(\S+) +(\S+) +(\S+)$', sim.output, re.M).groups()
    assert [float(each) for each in belief[:2]] == pytest.approx(pose[:2], abs=1e-4)
    assert float(belief[2]) == pytest.approx(math.degrees(wrap_angle(pose.theta)), abs=6e-3)


def test_a_recording_is_played_exactly_although_the_process_stands_still(graph, tmp_path):
    """What was due meanwhile comes at once, and is more than a queue holds."""
    speeds = [(0.2 + 0.1 * math.sin(0.1 * each), math.cos(0.05 * each)) for each in range(100)]
    rows = [f'{0.02 * row:.2f},{v!r},{w!r}\n' for row, (v, w) in enumerate([*speeds, (0.0, 0.0)])]
    drive = tmp_path / 'drive.csv'
    drive.write_text(''.join(['time_sec,linear_x,angular_z\n', *rows]))
    pose = Pose(0.0, 0.0, 0.0)
    for v, w in speeds:
        pose = advance(pose, v * 0.02, w * 0.02)
    sim = graph.start('diffdrive_sim', args=[
        '--ros-args', '--params-file', str(CONFIG / 'recording.yaml'), '-p',
        f'recording:={drive}'])
    graph.wait_for(lambda: ': playing 2.0' in sim.output, 'the course')
    graph.hold_up(sim, 1.5)
    assert sim.wait() == 0, sim.output
    found = re.findall(r'^(?:belief|truth) \(\S+\) +(\S+) +(\S+) +(\S+)$', sim.output, re.M)
    assert len(found) == 2, sim.output
    for x, y, yaw in (map(float, each) for each in found):
        assert (x, y) == pytest.approx(pose[:2], abs=1e-4), sim.output
        assert yaw == pytest.approx(math.degrees(wrap_angle(pose.theta)), abs=6e-3)


STALLED = """
/**:
  ros__parameters:
    {wheel_radius: 0.021, wheel_separation: 0.0885, enable_odom_tf: false,
     enable_stamped_cmd_vel: true, stamp_tolerance: 60.0, cmd_vel_timeout: 0.0}
/**/command_sequence:
  ros__parameters: {commands: [COMMANDS], wait_for_topics: [odom, truth]}
/**/ground_truth:
  ros__parameters:
    {wheel_motion_topic: noisy_wheel_rates, odom_topic: truth, joint_states_topic: truth_joints}
/**/diffdrive_sim:
  ros__parameters:
    nodes: [diff_drive_controller, wheel_noise, simulated_base, 'simulated_base:ground_truth',
            command_sequence]
"""


def test_what_is_due_while_a_process_stands_still_on_real_time_is_driven_and_read(graph, tmp_path):
    """The course ends meanwhile: its end is not that of what lies in queues."""
    course = [(0.2, 0.0, 0.8), (0.1, 0.5, 0.5), (0.3, 0.0, 0.2), (0.2, -0.5, 0.2), (0.1, 0.0, 0.1)]
    file = tmp_path / 'stalled.yaml'
    file.write_text(STALLED.replace('COMMANDS', ', '.join(
        str(value) for command in course for value in command)))
    pose = Pose(0.0, 0.0, 0.0)
    for v, w, seconds in course:
        pose = advance(pose, v * seconds, w * seconds)
    sim = graph.start('diffdrive_sim', args=['--ros-args', '--params-file', str(file)])
    graph.wait_for(lambda: ' of 1.8 s ' in sim.output, 'the course')
    graph.hold_up(sim, 2.0)
    assert sim.wait() == 0, sim.output
    found = re.findall(r'^(?:belief|truth) \(\S+\) +(\S+) +(\S+) +(\S+)$', sim.output, re.M)
    assert len(found) == 2, sim.output
    for x, y, yaw in (map(float, each) for each in found):
        assert (x, y) == pytest.approx(pose[:2], abs=1e-4), sim.output
        assert yaw == pytest.approx(math.degrees(wrap_angle(pose.theta)), abs=6e-3)
    assert 'clock step' not in sim.output


def test_a_recording_in_another_package_is_refused(graph):
    sequence = graph.start('command_sequence', {'recording': 'package://other/drive.csv'})
    assert sequence.wait() == 2
    assert 'expected package://diffdrive_kinematics/' in sequence.output


def test_a_robot_without_a_truth_is_kept_without_its_columns(here, tmp_path):
    run = tmp_path / 'run.csv'
    sim = here('diffdrive_sim', [
        *FAST, '-p', 'diffdrive_sim:nodes:=[command_sequence, diff_drive_controller, '
        'simulated_base]', '-p', 'command_sequence:wait_for_topics:=[odom]', '-p',
        f'record:={run}'])
    assert sim.wait() == 0, sim.output
    assert 'belief_x' in columns_of(run) and not {'x', 'y', 'yaw'} & set(columns_of(run))


def test_a_csv_file_of_several_robots_is_refused_with_what_keeps_them(here, tmp_path):
    sim = here('diffdrive_sim', [
        '--ros-args', '--params-file', str(CONFIG / 'two_robots.yaml'), '-p',
        f'record:={tmp_path / "run.csv"}'])
    assert sim.wait() == 2
    assert 'expected one robot' in sim.output and '.mcap' in sim.output
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize('name', ['run.csv', 'run.mcap', 'run.png'])
def test_what_is_kept_replaces_no_file_unless_it_is_told_to(here, tmp_path, name):
    if name.endswith('.mcap'):
        pytest.importorskip('rosbags')
    file = tmp_path / name
    file.write_text('mine')
    keep = [*FAST, '-p', f'{"picture" if name.endswith(".png") else "record"}:={file}']
    sim = here('diffdrive_sim', keep)
    assert sim.wait() == 2 and 'which exists' in sim.output
    assert file.read_text() == 'mine' and len(list(tmp_path.iterdir())) == 1
    sim = here('diffdrive_sim', [*keep, '-p', 'overwrite:=true'])
    assert sim.wait() == 0, sim.output
    assert b'mine' not in file.read_bytes() and len(list(tmp_path.iterdir())) == 1


def test_a_drive_in_real_time_that_is_ended_leaves_what_was_kept(graph, tmp_path):
    run = tmp_path / 'run.csv'
    sim = graph.start('diffdrive_sim', args=[
        '--ros-args', '--params-file', str(CONFIG / 'demo.yaml'), '-p', 'clock_step:=0.0', '-p',
        f'record:={run}'])
    graph.wait_for(
        lambda: re.search(r' [1-9]\S* of 24.0 s', sim.output), 'some of the course')
    assert sim.stop() == 0, sim.output
    time = columns_of(run)['time_sec']
    (ended,) = re.findall(r'the recording ends at (\S+) s because .* interrupted', sim.output)
    assert len(time) > 1 and float(ended) == pytest.approx(time[-1] - time[0], abs=0.006)


def test_an_interrupted_recording_is_as_long_as_its_rows_however_late_it_is_closed(tmp_path):
    now_ns, pose = 5 * S, Pose(0.0, 0.0, 0.0)
    keeping = Keeping(
        lambda: [Moment('', now_ns, base().predict(now_ns), None, pose, base().geometry)],
        lambda: now_ns)
    keeping.begin({'record': str(tmp_path / 'run.csv'), 'picture': '', 'overwrite': False,
                   'calibration': ''}, [])
    for now_ns in (7 * S, 8 * S, 9 * S + S // 2):
        keeping.note()
    now_ns = 30 * S
    assert keeping.close(finished=False, interrupted=True)[-1] == (
        'the recording ends at 2.50 s because the course was interrupted')


@pytest.mark.parametrize('record', ['run.csv', ''])
def test_only_where_something_is_kept_there_is_something_to_note_on_the_way(tmp_path, record):
    pose = Pose(0.0, 0.0, 0.0)
    keeping = Keeping(
        lambda: [Moment('', S, base().predict(S), None, pose, base().geometry)], lambda: S)
    assert not keeping.notes
    keeping.begin({'record': record and str(tmp_path / record), 'picture': '',
                   'overwrite': False, 'calibration': ''}, [])
    assert keeping.notes == bool(record)
    keeping.discard()


@MATPLOTLIB
def test_a_drive_is_kept_beside_files_that_have_come_meanwhile(graph, tmp_path):
    run, picture = tmp_path / 'run.csv', tmp_path / 'run.png'
    sim = graph.start('diffdrive_sim', args=[
        '--ros-args', '-p', f'record:={run}', '-p', f'picture:={picture}', '-p',
        'real_time_factor:=1.0'])
    graph.wait_for(lambda: ' 2.4 of 24.0 s' in sim.output, 'some of the course')
    run.write_text('mine')
    picture.write_text('mine')
    assert sim.stop() == 0, sim.output
    assert run.read_text() == picture.read_text() == 'mine'
    assert len(columns_of(tmp_path / 'run_2.csv')['time_sec']) > 1
    assert (tmp_path / 'run_2.png').read_bytes().startswith(b'\x89PNG')
    for kept in ('run_2.csv', 'run_2.png', 'truth', 'x [m]'):
        assert kept in sim.output


def test_what_cannot_be_completed_loses_nothing_else():
    class Table:

        def close(self):
            raise ValueError('the disk is full')

    class Picture:

        def close(self):
            return 'wrote a.png'

    keeping = Keeping(list, int)
    keeping._kept = lambda: (Table(), Picture())
    assert keeping.close(finished=True, interrupted=False) == ['wrote a.png']
    with pytest.raises(ValueError, match='the disk is full'):
        keeping.check()


@MATPLOTLIB
@pytest.mark.parametrize(('name', 'begins'), [('a.png', b'\x89PNG'), ('a.svg', b'<?xml')])
def test_the_way_of_a_drive_is_drawn_at_its_end(here, tmp_path, name, begins):
    sim = here('diffdrive_sim', [*FAST, '-p', f'picture:={tmp_path / name}'])
    assert sim.wait() == 0, sim.output
    assert (tmp_path / name).read_bytes().startswith(begins)
    assert f'wrote {tmp_path / name}' in sim.output and '[WARN]' not in sim.output


def test_a_picture_without_matplotlib_is_refused_before_the_drive(graph, tmp_path):
    (tmp_path / 'matplotlib').mkdir()
    (tmp_path / 'matplotlib' / '__init__.py').write_text('raise ImportError("not here")')
    source = share_directory()
    sim = graph.start(
        'diffdrive_sim', args=[*FAST, '-p', f'picture:={tmp_path / "a.png"}'], cwd=tmp_path,
        environment={'PYTHONPATH': f'{tmp_path}:{source}'})
    assert sim.wait() == 2, sim.output
    assert "pip install '.[plot]'" in sim.output and 'Traceback' not in sim.output
    assert 'of 24.0 s' not in sim.output and not (tmp_path / 'a.png').exists()


@pytest.mark.slow
def test_keeping_a_drive_changes_nothing_of_it(here, tmp_path):
    tables = []
    for keep in ([], ['-p', f'record:={tmp_path / "run.csv"}']):
        sim = here('diffdrive_sim', [*FAST, *keep])
        assert sim.wait() == 0, sim.output
        tables.append(sim.output[sim.output.index('x [m]'):sim.output.index('times real time')])
        tables[-1] = tables[-1].rpartition('\n')[0]
    assert tables[0] == tables[1]
