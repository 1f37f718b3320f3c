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

"""What the report and the file of a calibration say of other sessions."""

from diffdrive_kinematics.core.calibration import Estimate, SessionFit
from diffdrive_kinematics.tools.calibration import of_drives, table
from diffdrive_kinematics.tools.calibration_file import params_text
from diffdrive_kinematics.tools.calibration_remarks import session_parameters, session_remark
import pytest
from support.drives import drive, GEOMETRY, Truth
import yaml

VALUES = {'mean_radius': '', 'equal_slip': False}
ONLY = 'hold for this session only'


def calibrated(separations, **values):
    drives = [drive(number, Truth(separation=separation), seconds=60.0)
              for number, separation in enumerate(separations)]
    return of_drives({**VALUES, **values}, GEOMETRY, drives, clock='offsets')


def test_three_drives_tell_what_differs_and_the_file_has_it():
    calibration = calibrated([1.02, 1.03, 1.04])
    text = table(calibration)
    assert ONLY not in text
    assert 'session_separation_stddev [1]' in text
    assert 'session_*: what differs between the 3 drives' in text
    written = yaml.safe_load(params_text(calibration, 'calibration.yaml'))
    shared = written['/**']['ros__parameters']
    assert shared['session_separation_stddev'] == pytest.approx(0.01, abs=0.005)
    assert shared['session_scale_stddev'] < 0.002
    assert shared['session_curvature_stddev'] < 0.002
    truth = written['/**/ground_truth']['ros__parameters']
    assert [truth[name] for name in truth if name.startswith('session')] == [0.0] * 3
    noise = written['/**/wheel_noise']['ros__parameters']
    assert noise['wheel_separation_multiplier'] == pytest.approx(1.03, abs=0.01)


@pytest.mark.slow
def test_fewer_say_in_a_line_what_their_standard_errors_speak_of():
    calibration = calibrated([1.02, 1.04])
    assert sum(ONLY in line for line in table(calibration).splitlines()) == 1
    assert 'session' not in params_text(calibration, 'calibration.yaml')


@pytest.mark.slow
def test_a_mean_radius_that_is_kept_tells_no_scale():
    calibration = calibrated([1.02, 1.03, 1.04], mean_radius='keep')
    assert 'not the scale' in table(calibration)
    assert set(calibration.sessions) == {
        'session_separation_stddev', 'session_curvature_stddev'}


def test_what_the_nodes_refuse_is_not_written_and_warned_about():
    sessions = SessionFit(None, Estimate(0.2, 0.05), Estimate(0.2, 0.05), sessions=3)
    assert session_parameters(sessions) == {'session_curvature_stddev': 0.2}
    assert 'WARNING: session_separation_stddev is not written' in session_remark(sessions)
