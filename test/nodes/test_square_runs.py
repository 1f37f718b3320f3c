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

"""Runs around a square that the simulator drives, notes and calibrates by itself."""

import os
import re

from diffdrive_kinematics.nodes import diffdrive_sim
from diffdrive_kinematics.ros.parameters.package_share import share_directory
from diffdrive_kinematics.tools.square_rows import read_square_runs
import pytest
from support.graph import KHEPERA
from support.inside import initialised

pytestmark = pytest.mark.ros

CONFIG = share_directory() / 'config'
FILES = [part for name in ('squares.yaml', 'true.yaml')
         for part in ('--params-file', str(CONFIG / name))]
HEADER = ('clockwise,true_x,true_y,odom_x,odom_y,'
          'square_side,square_corner_radius,left_radius,right_radius,separation')
TRUE_RATIO, TRUE_SEPARATION = 1.002 / 0.998, 1.01


def simulated(here, *settings, status=0):
    """Return what the shipped robot of squares says with settings."""
    sim = here('diffdrive_sim', [
        '--ros-args', *FILES, *(part for each in settings for part in ('-p', each))])
    assert sim.wait() == status, sim.output
    return sim.output


@pytest.mark.slow
def test_one_command_drives_notes_and_calibrates_runs_both_ways(here, tmp_path):
    runs, found = tmp_path / 'runs.csv', tmp_path / 'found.yaml'
    said = simulated(here, 'square_rounds:=5', f'square_runs:={runs}', f'calibration:={found}')
    clockwise, counterclockwise = read_square_runs(str(runs), 1.0)
    assert len(clockwise) == len(counterclockwise) == 5
    assert len({*clockwise, *counterclockwise}) == 10  # each run slips in its own way
    for name, truth in (('E_d', TRUE_RATIO), ('E_b', TRUE_SEPARATION)):
        value, error = map(float, re.search(
            rf'^{name} \(.*\) +(\S+) +(\S+)$', said, re.M).groups())
        assert abs(value - truth) < 3.355 * error, said  # Student's t of 99 %
    assert f'wrote {found}' in said
    calibrate = here('calibrate', [
        '--ros-args', *(part for n, value in (
            *KHEPERA.items(), ('square_runs', runs), ('square_side', 1.0),
            ('output', tmp_path / 'again.yaml')) for part in ('-p', f'{n}:={value}'))])
    assert calibrate.wait() == 0, calibrate.output
    table = calibrate.output[:calibrate.output.index('wrote')]
    assert table in said  # it says the same of the same runs


@pytest.mark.slow
def test_a_run_is_added_to_the_runs_that_are_there(here, tmp_path):
    runs = tmp_path / 'runs.csv'
    for number, clockwise in enumerate(('true', 'false', 'true'), start=1):
        said = simulated(here, f'square_runs:={runs}', f'wheel_noise:seed:={number}',
                         f'command_sequence:square_clockwise:={clockwise}')
        assert re.search(rf'run 1 of 1, {"" if clockwise == "true" else "counter"}clockwise', said)
    assert [len(each) for each in read_square_runs(str(runs), 1.0)] == [2, 1]
    lines = runs.read_text().splitlines()
    assert lines[0] == HEADER and len(lines) == 4
    end = re.search(r'^truth \(\S+\) +(\S+) +(\S+)', said, re.M).groups()
    noted = list(map(float, lines[-1].split(',')))
    assert noted[1:3] == pytest.approx([float(each) for each in end], abs=1e-4)


def test_interrupted_runs_say_that_there_is_no_calibration_and_how_to_go_on(graph, tmp_path):
    runs, found = tmp_path / 'runs.csv', tmp_path / 'found.yaml'
    settings = 'square_rounds:=10', 'real_time_factor:=50.0', f'square_runs:={runs}', (
        f'calibration:={found}')
    sim = graph.start('diffdrive_sim', args=[
        '--ros-args', *FILES, *(part for each in settings for part in ('-p', each))])
    graph.wait_for(lambda: 'run 1 of 20' in sim.output, 'a run to end')
    assert sim.stop() == 0, sim.output
    done = len(runs.read_text().splitlines()) - 1
    assert f'interrupted after {done} of 20 runs: no calibration' in sim.output
    assert 'calibrate --ros-args' in sim.output and f'square_runs:={runs}' in sim.output
    assert not found.exists()


def test_a_file_of_something_else_is_refused_before_the_drive_and_stays(here, tmp_path):
    other = tmp_path / 'runs.csv'
    other.write_text('time_sec,x\n1,2\n')
    assert 'expected a new file, or one with' in simulated(
        here, f'square_runs:={other}', status=2)
    assert other.read_text() == 'time_sec,x\n1,2\n'


def test_runs_of_another_square_are_refused_before_the_drive(here, tmp_path):
    runs = tmp_path / 'runs.csv'
    runs.write_text(text := f'{HEADER}\n1,0.01,0.02,0.0,0.0,2.0,0.0,0.021,0.021,0.0885\n')
    said = simulated(here, f'square_runs:={runs}', status=2)
    assert 'row 1: square_side is 2 m and now 1 m' in said and ' s   belief' not in said
    assert runs.read_text() == text


@pytest.mark.parametrize('name', ['record', 'square_runs', 'picture'])
def test_a_pipe_is_refused_before_the_drive_where_a_file_has_to_be(here, tmp_path, name):
    pipe = tmp_path / ('runs.svg' if name == 'picture' else 'runs.csv')
    os.mkfifo(pipe)
    said = simulated(here, f'{name}:={pipe}', status=2)
    assert f'{name} is' in said and 'a pipe or a device' in said and ' s   belief' not in said


@pytest.mark.parametrize('settings, words', [
    (['calibration:=c.yaml'], 'square_runs is not set'),
    (['square_runs:=runs.csv', 'command_sequence:loop:=true'], 'without loop'),
    (['square_runs:=runs.csv', 'command_sequence:square_side:=0.0',
      'command_sequence:commands:=[0.1, 0.0, 1.0]'], 'square_side'),
    (['square_runs:=runs.csv', 'diffdrive_sim:nodes:=[command_sequence, diff_drive_controller, '
      'simulated_base]', 'command_sequence:wait_for_topics:=[odom]'], 'expected one robot')])
def test_what_cannot_be_noted_is_refused_before_the_drive(here, tmp_path, settings, words):
    said = simulated(here, *(
        each.replace('runs.csv', str(tmp_path / 'runs.csv')) for each in settings), status=2)
    assert words in said and ' s   belief' not in said
    assert not list(tmp_path.iterdir())


@pytest.mark.slow
def test_runs_that_do_not_scatter_are_warned_about_and_write_no_slip(here, tmp_path):
    found = tmp_path / 'found.yaml'
    said = simulated(
        here, 'square_rounds:=2', f'square_runs:={tmp_path / "runs.csv"}',
        f'calibration:={found}', 'wheel_noise:left_slip_variance:=0.0',
        'wheel_noise:right_slip_variance:=0.0')
    assert 'do not scatter' in said and 'seed' in said
    assert 'slip_variance' not in found.read_text().split('/**/')[0]


def test_a_fault_of_the_program_is_not_taken_for_one_of_the_parameters(monkeypatch):
    def fail(*_):
        raise ValueError('not of a parameter')

    monkeypatch.setattr(diffdrive_sim.DiffDriveSim, 'run', fail)
    with initialised({'nodes': ['robot_description'], **KHEPERA}):
        with pytest.raises(ValueError, match='not of a parameter'):
            diffdrive_sim.work(None)
