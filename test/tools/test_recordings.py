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

"""Recordings that are not what they seem: a result or one line, whatever is in them."""

import gzip
import math
import resource

from diffdrive_kinematics.core.kinematics import advance, Pose, WheelGeometry
from diffdrive_kinematics.tools.calibration import of_drives
from diffdrive_kinematics.tools.recording_sources import read_commands, read_drives
from diffdrive_kinematics.tools.square_rows import read_square_runs
from hypothesis import given, HealthCheck, settings, strategies as st
import numpy as np
import pytest

GEOMETRY = WheelGeometry(0.2, 0.05)
EPOCH = 1.7e9
POSITIONS = 'time_sec,left_position,right_position,x,y,yaw'
RATES = 'time_sec,left_rate,right_rate,x,y,yaw'
COMMANDS = 'time_sec,linear_x,angular_z,x,y,yaw'
GIB = 2**30


def drive(kind=POSITIONS, seconds=30.0, rate=20.0, start=0.0):
    """Return rows of a drive with curves both ways."""
    pose, angles, rows = Pose(0.0, 0.0, 0.0), np.zeros(2), []
    for number in range(round(seconds * rate)):
        time = number / rate
        rates = np.array([6.0 + 3.0 * math.sin(0.9 * time), 6.0 + 3.0 * math.cos(0.7 * time)])
        left, right = 0.05 * rates
        motion = {POSITIONS: angles, RATES: rates,
                  COMMANDS: (0.5 * (left + right), (right - left) / 0.2)}[kind]
        yaw = math.remainder(pose.theta, math.tau)
        rows.append([start + time, *map(float, motion), float(pose.x), float(pose.y), yaw])
        pose = advance(pose, 0.5 * (left + right) / rate, (right - left) / 0.2 / rate)
        angles = angles + rates / rate
    return rows


def written(path, header, rows):
    path.write_text('\n'.join([header, *(','.join(map(repr, row)) for row in rows)]) + '\n')
    return str(path)


def calibrated(path, reference=''):
    """Return what comes of a file."""
    values = {'recordings': [path], 'references': [reference] if reference else [],
              'mean_radius': '', 'equal_slip': True, 'encoder_resolution': 0.0}
    drives, commands, _ = read_drives(values, GEOMETRY)
    return of_drives(values, GEOMETRY, drives, commands=commands,
                     clock='delay' if commands else 'auto')


def refusal(path, *arguments):
    with pytest.raises(ValueError) as error:
        calibrated(path, *arguments)
    assert len(str(error.value).splitlines()) == 1
    assert path in str(error.value)
    return str(error.value)


@pytest.mark.parametrize('kind', [POSITIONS, RATES, COMMANDS])
@pytest.mark.parametrize('start', [0.0, EPOCH])
def test_a_drive_as_it_should_be_is_taken(tmp_path, kind, start):
    found = calibrated(written(tmp_path / 'a.csv', kind, drive(kind, start=start)))
    assert found.geometry.separation == pytest.approx(0.2, rel=0.01)


def test_iterations_of_the_fit_are_told(tmp_path):
    told = []
    values = {'recordings': [written(tmp_path / 'a.csv', POSITIONS, drive())], 'references': [],
              'mean_radius': '', 'equal_slip': True}
    drives, _, _ = read_drives(values, GEOMETRY)
    of_drives(values, GEOMETRY, drives, clock='none', progress=told.append)
    assert told[:2] == ['fitting, iteration 1', 'fitting, iteration 2']
    assert told[-1] == 'fitting the slip'


@pytest.mark.parametrize('name, scale', [
    ('milliseconds', 1e3), ('microseconds', 1e6), ('nanoseconds', 1e9)])
@pytest.mark.parametrize('start', [0.0, EPOCH])
@pytest.mark.parametrize('kind', [POSITIONS, COMMANDS])
def test_stamps_in_parts_of_a_second_are_named(tmp_path, kind, name, scale, start):
    rows = [[round(row[0] * scale), *row[1:]] for row in drive(kind, start=start)]
    text = refusal(written(tmp_path / 'a.csv', kind, rows))
    assert name in text and 'row' in text and 'divide time_sec by' in text


def test_a_first_row_from_before_the_epoch_is_named(tmp_path):
    rows = drive(start=EPOCH)
    rows[0][0] = 0.0
    text = refusal(written(tmp_path / 'a.csv', POSITIONS, rows))
    assert 'row 1: time_sec is 0' in text and 'delete' in text


@pytest.mark.parametrize('value', [1e300, -1e13, math.inf, math.nan])
@pytest.mark.parametrize('kind', [POSITIONS, RATES, COMMANDS])
def test_a_value_that_cannot_be_is_named_with_its_row_and_column(tmp_path, kind, value):
    for column, name in enumerate(kind.split(',')):
        rows = drive(kind)
        rows[99][column] = value
        text = refusal(written(tmp_path / 'a.csv', kind, rows))
        assert f'row 100: {name} is {value:.15g}' in text


def test_a_pose_of_another_file_that_cannot_be_is_named_with_its_file(tmp_path):
    rows = drive()
    motion = written(tmp_path / 'a.csv', POSITIONS, rows)
    rows[99][4] = 1e300
    reference = str(tmp_path / 'b.csv')
    written(tmp_path / 'b.csv', 'time_sec,x,y,yaw', [[row[0], *row[3:]] for row in rows])
    with pytest.raises(ValueError, match=r'b\.csv, row 100: y is 1e\+300, expected'):
        calibrated(motion, reference)


def test_yaw_in_degrees_is_named_with_its_column(tmp_path):
    for wrapped in (True, False):
        rows = drive()
        yaw = np.degrees(np.unwrap([row[5] for row in rows]))
        for row, angle in zip(rows, yaw):
            row[5] = math.remainder(angle, 360.0) if wrapped else float(angle)
        text = refusal(written(tmp_path / 'a.csv', POSITIONS, rows))
        assert 'yaw' in text and 'row' in text and 'degrees, expected radians' in text


@pytest.mark.parametrize('scale, name', [(1e3, 'millimetres'), (1e2, 'centimetres')])
def test_a_reference_in_parts_of_a_metre_is_named(tmp_path, scale, name):
    rows = [[*row[:3], scale * row[3], scale * row[4], row[5]] for row in drive()]
    text = refusal(written(tmp_path / 'a.csv', POSITIONS, rows))
    assert f'{name}, expected metres' in text and 'row' in text and 'x and y' in text


@pytest.mark.parametrize('kind, columns, scale, words', [
    (POSITIONS, (1, 2), 180.0 / math.pi, 'left_position and right_position'),
    (RATES, (1, 2), 180.0 / math.pi, 'degrees'), (RATES, (1, 2), 30.0 / math.pi, 'rpm'),
    (COMMANDS, (1,), 1e3, 'linear_x'), (COMMANDS, (2,), 180.0 / math.pi, 'angular_z')])
def test_motion_in_other_units_is_named(tmp_path, kind, columns, scale, words):
    rows = drive(kind)
    for row in rows:
        for column in columns:
            row[column] *= scale
    text = refusal(written(tmp_path / 'a.csv', kind, rows))
    assert words in text and 'looks like' in text


@pytest.mark.parametrize('header, row, words', [
    ('time_sec,linear_x,angular_z', '0,0,50,0,10', 'row 1 has 5 fields for the 3 columns'),
    ('time_sec,linear_x,angular_z', '"0,0","0,50","0,10"', "row 1: time_sec is '0,0'"),
    ('time_sec;linear_x;angular_z', '0;0,50;0,10', 'commas between them'),
    ('time_sec,linear_x,linear_x,angular_z', '0,1,2,3', "['linear_x'] twice"),
    ('time_sec,linear_x,angular_z', '0,0.5', "none for the column 'angular_z'"),
    ('time_sec,linear_x,angular_z', '0,500,0', 'linear_x is 500, expected at most 20 m/s'),
    ('time_sec,linear_x,angular_z', '0,0.5,45', 'angular_z is 45')])
def test_commands_that_would_be_played_wrongly_are_refused(tmp_path, header, row, words):
    path = tmp_path / 'a.csv'
    path.write_text(f'{header}\n{row}\n')
    with pytest.raises(ValueError) as error:
        read_commands(str(path), 'cmd_vel')
    assert words in str(error.value) and len(str(error.value).splitlines()) == 1


def test_a_comma_at_the_end_of_each_row_is_no_further_column(tmp_path):
    path = tmp_path / 'a.csv'
    path.write_text('time_sec,linear_x,angular_z\n0,0.5,0.1,\n1,0.5,0.1,\n')
    assert read_commands(str(path), 'cmd_vel') == [(0.0, 0.5, 0.1), (1.0, 0.5, 0.1)]


def test_a_course_of_few_long_commands_is_no_course_in_milliseconds(tmp_path):
    path = tmp_path / 'a.csv'
    path.write_text('time_sec,linear_x,angular_z\n' + ''.join(
        f'{20 * n},0.2,0.1\n' for n in range(8)))
    assert len(read_commands(str(path), 'cmd_vel')) == 8


def test_runs_of_a_square_in_millimetres_are_refused_with_the_word_metres(tmp_path):
    path = tmp_path / 'runs.csv'
    path.write_text('clockwise,true_x,true_y,odom_x,odom_y\n1,-31,-30,1,0\n')
    with pytest.raises(ValueError, match='row 1: .*expected metres'):
        read_square_runs(str(path), 1.0)


@pytest.mark.parametrize('number', ['nan', 'inf'])
def test_a_run_whose_end_is_no_place_is_refused_by_its_row(tmp_path, number):
    path = tmp_path / 'runs.csv'
    path.write_text('clockwise,true_x,true_y,odom_x,odom_y\n'
                    f'1,{number},0.0,0.0,0.0\n0,0.01,0.0,0.0,0.0\n')
    with pytest.raises(ValueError, match='row 1'):
        read_square_runs(str(path), 1.0)


GOOD = [','.join(map(repr, row)) for row in drive(seconds=15.0)]
CHARACTERS = st.sampled_from('0123456789,.;-+eE "\'\tnaif_\x00\xff\u2212')
MUTATIONS = st.sampled_from([
    'field', 'scale', 'shift', 'order', 'repeat', 'cut', 'bytes', 'encoding', 'header', 'gap'])


@st.composite
def mutated(draw):
    """Return the bytes of a good file after one to three mutations."""
    header, rows, encoding = POSITIONS, [row.split(',') for row in GOOD], 'utf-8'
    raw = False
    for mutation in draw(st.lists(MUTATIONS, min_size=1, max_size=3)):
        at, column = draw(st.integers(0, len(rows) - 1)), draw(st.integers(0, 5))
        if mutation == 'field':
            rows[at][column:column + 1] = draw(st.one_of(
                st.text(CHARACTERS, max_size=6), st.floats().map(repr))).split(',')
        elif mutation == 'scale':
            factor = draw(st.sampled_from([0.0, -1.0, 1e-3, 57.3, 1e2, 1e3, 1e6, 1e9, 1e300]))
            for row in rows:
                row[column:column + 1] = [repr(factor * _number(row, column))]
        elif mutation == 'shift':
            for row in rows[at:]:
                row[column:column + 1] = [repr(_number(row, column) + 1e5)]
        elif mutation == 'order':
            rows = draw(st.sampled_from([rows[::-1], rows[at:] + rows[:at], sorted(rows)]))
        elif mutation == 'repeat':
            rows = rows[:at] + [list(row) for row in rows[:at]] + rows[at:]
            rows = rows[:1000]
        elif mutation == 'cut':
            rows = rows[at:] or rows
        elif mutation == 'gap':
            for row in rows[at:]:
                row[0:1] = [repr(_number(row, 0) + 86400.0)]
        elif mutation == 'header':
            header = draw(st.sampled_from([
                '', POSITIONS.upper(), POSITIONS.replace('yaw', 'x'), POSITIONS + ',more',
                POSITIONS.replace(',', ';'), RATES, COMMANDS, 'time_sec']))
        elif mutation == 'encoding':
            encoding = draw(st.sampled_from(['utf-16', 'utf-8-sig', 'latin-1', 'cp500']))
        else:
            raw = True
    text = '\n'.join([header, *(','.join(row) for row in rows)]) + '\n'
    content = bytearray(text.encode(encoding, errors='replace'))
    if raw:
        for at in draw(st.lists(st.integers(0, len(content) - 1), min_size=1, max_size=5)):
            content[at] = draw(st.integers(0, 255))
        del content[draw(st.integers(0, len(content))):]
    return bytes(content)


def _number(row, column):
    try:
        return float(row[column])
    except (ValueError, IndexError):
        return 0.0


@pytest.mark.slow
@settings(max_examples=200, suppress_health_check=[*HealthCheck])
@given(content=mutated(), zipped=st.booleans())
def test_a_mutated_file_ends_in_a_result_or_one_line(tmp_path_factory, content, zipped):
    path = tmp_path_factory.mktemp('mutated') / ('a.csv.gz' if zipped else 'a.csv')
    path.write_bytes(gzip.compress(content) if zipped and len(content) % 3 else content)
    before = resource.getrlimit(resource.RLIMIT_AS)
    with open('/proc/self/statm', encoding='ascii') as file:
        now = int(file.read().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (now + 2 * GIB, before[1]))
    try:
        found = calibrated(str(path))
        assert all(map(math.isfinite, (found.geometry.separation, *found.slips)))
    except ValueError as error:
        assert len(str(error).splitlines()) == 1, error
    finally:
        resource.setrlimit(resource.RLIMIT_AS, before)
