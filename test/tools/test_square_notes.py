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

"""The file of runs around a square: what may be added to it, and what is made of it."""

from dataclasses import replace

from diffdrive_kinematics.core.commands import SquareRun
from diffdrive_kinematics.core.kinematics import Pose, WheelGeometry
from diffdrive_kinematics.tools.robots import Moment
from diffdrive_kinematics.tools.square_notes import calibration_of_runs, SquareNotes, Squares
import pytest

HEADER = ('clockwise,true_x,true_y,odom_x,odom_y,'
          'square_side,square_corner_radius,left_radius,right_radius,separation')
ROW = ',0.01,0.02,0.0,0.0,1.0,0.0,0.05,0.05,0.25'
GEOMETRY, ORIGIN = WheelGeometry(0.25, 0.05), Pose(0.0, 0.0, 0.0)
SETTINGS = {'square_side': 1.0, 'square_corner_radius': 0.0}


def notes(path, *ways, calibrates=False):
    """Return the notes of a course with runs these ways round, not begun."""
    runs = tuple(SquareRun(way, 10.0 * n) for n, way in enumerate(ways, start=1))
    start = Moment('', 0, None, None, ORIGIN, GEOMETRY)
    return SquareNotes(str(path), [Squares(runs, lambda: 0.0, SETTINGS)], [start],
                       calibrates=calibrates)


@pytest.mark.parametrize('row, words', [
    ('1' + ROW.replace('1.0,0.0', '2.0,0.0'), 'row 2: square_side is 2 m and now 1 m'),
    ('1' + ROW.replace(',0.25', ',0.2525'), 'row 2: separation is 0.2525 m and now 0.25 m'),
    ('1' + ROW[:-1], 'row 2: separation is 0.2 m and now 0.25 m'),
    ('1' + ROW[:20], 'row 2 has 6 fields and none for'), ('7' + ROW, 'row 2: clockwise is 7.0'),
    ('1,x' + ROW[5:], "row 2: true_x is 'x")],
    ids=['other side', 'multiplier', 'cut within a number', 'cut', 'neither way', 'no number'])
def test_rows_of_other_settings_and_bad_ones_are_refused_and_the_file_stays(tmp_path, row, words):
    runs = tmp_path / 'runs.csv'
    runs.write_text(text := f'{HEADER}\n1{ROW}\n{row}')
    with pytest.raises(ValueError, match=words):
        notes(runs, True)
    assert runs.read_text() == text


def test_a_row_that_lacks_its_end_of_line_alone_is_one(tmp_path):
    (tmp_path / 'runs.csv').write_text(f'{HEADER}\n1{ROW}')
    notes(tmp_path / 'runs.csv', True)


def test_runs_that_will_be_too_few_for_a_calibration_are_refused_those_there_counted(tmp_path):
    runs = tmp_path / 'runs.csv'
    with pytest.raises(ValueError, match='1 clockwise and 1 counterclockwise runs, .*at least 2'):
        notes(runs, True, False, calibrates=True)
    notes(runs, True, False)  # nothing is to be made of them yet
    notes(runs, True, False, True, False, calibrates=True)
    runs.write_text(f'{HEADER}\n1{ROW}\n')
    with pytest.raises(ValueError, match='2 clockwise and 1 counterclockwise'):
        notes(runs, True, False, calibrates=True)
    runs.write_text(f'{HEADER}\n1{ROW}\n0{ROW}\n')
    notes(runs, True, False, calibrates=True)


def test_runs_are_calibrated_by_what_they_were_driven_with_or_not_at_all(tmp_path):
    """A second pass needs the corrections of the first, and other rows would spoil them."""
    runs = tmp_path / 'runs.csv'
    values = {**SETTINGS, 'square_runs': str(runs)}
    runs.write_text('\n'.join([HEADER, *(
        f'{way}{ROW}'.replace('0.02', f'0.0{n}') for n in (1, 2, 3) for way in (0, 1)), '']))
    assert calibration_of_runs(values, GEOMETRY).geometry
    with pytest.raises(ValueError, match='row 1: separation is 0.25 m and now 0.2525 m'):
        calibration_of_runs(values, replace(GEOMETRY, wheel_separation_multiplier=1.01))
    with pytest.raises(ValueError, match='row 1: square_side is 1 m and now 2 m'):
        calibration_of_runs({**values, 'square_side': 2.0}, GEOMETRY)
    by_hand = [','.join(line.split(',')[:5]) for line in runs.read_text().splitlines()]
    runs.write_text('\n'.join(by_hand))
    assert calibration_of_runs({**values, 'square_side': 2.0}, GEOMETRY)
