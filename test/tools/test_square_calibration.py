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

"""What ``calibrate`` says of runs around a square, and what of it goes into the params file."""

import re

from diffdrive_kinematics.core.calibration import ReturnError
from diffdrive_kinematics.core.kinematics import WheelGeometry
from diffdrive_kinematics.tools.calibration import of_squares, table
from diffdrive_kinematics.tools.calibration_file import params_text
import pytest

VALUES = {'square_side': 2.0, 'square_corner_radius': 0.0}
BEFORE = WheelGeometry(0.2, 0.05, wheel_separation_multiplier=1.0095)
SCATTER = [(0.02, 0.0), (-0.02, 0.01), (0.0, -0.01)]


def calibration(cw, ccw):
    """Return the calibration from three runs each way about these centres [m]."""
    return of_squares(VALUES, BEFORE, *(
        [ReturnError(centre[0] + x, centre[1] + y) for x, y in SCATTER] for centre in (cw, ccw)))


def test_a_correction_within_its_error_is_said_to_be_none_and_the_file_keeps_the_value():
    found = calibration((-0.003, -0.003), (-0.003, 0.003))
    said = table(found)
    for name, kept in (('E_d', 'the radius multipliers stay'),
                       ('E_b', 'wheel_separation_multiplier stays')):
        assert re.search(rf'^{name}: no correction: .* \(95 %\): {kept}', said, re.M), said
    text = params_text(found, 'found.yaml')
    assert set(re.findall(r'wheel_separation_multiplier: (\S+)', text)) == {'1.0095'}
    assert set(re.findall(r'_wheel_radius_multiplier: (\S+)', text)) == {'1.0'}


def test_a_correction_beyond_its_error_is_made_and_the_other_value_stays():
    found = calibration((-0.2, -0.2), (-0.2, 0.2))
    said = table(found)
    assert 'E_d: no correction' in said and 'E_b: no correction' not in said
    text = params_text(found, 'found.yaml')
    separation, = set(re.findall(r'wheel_separation_multiplier: (\S+)', text))
    assert float(separation) > 1.03
    assert set(re.findall(r'_wheel_radius_multiplier: (\S+)', text)) == {'1.0'}


def test_what_is_left_is_a_prediction_that_counts_the_scatter():
    found = calibration((-0.2, -0.2), (-0.2, 0.2))
    said, (gain,) = table(found), found.gains
    assert re.search(r'^ +measured +predicted$', said, re.M)
    assert re.search('^predicted: .* in as many new runs', said, re.M)
    assert 1e3 * found.source[0].error_before == pytest.approx(gain.before)
    assert gain.after > 1e3 * found.source[0].error_after


def test_the_report_says_what_a_square_cannot_tell():
    assert re.search('^known from a square: .* mean radius is kept', table(
        calibration((-0.2, -0.2), (-0.2, 0.2))), re.M)
