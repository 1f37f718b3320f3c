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

"""Slip constants of a real robot, from some runs of a session, predict its other runs."""

from diffdrive_kinematics.core.calibration import fit_slip, nees_per_dof
import numpy as np
import pytest
from support.recorded import RUNS
from support.systematic import calibrated, encoder_recording, NOMINAL, transferred, windows_of

SHORT, LONG, EVERY = 2.0, 10.0, 2.0  # [s], of the windows for the fit
FITTED, PREDICTED = (0, 1, 3, 4), (2, 5)  # two of three runs each way round, and the third
STARTS = 4


@pytest.fixture(scope='module')
def recordings():
    """Return all runs of the session."""
    assert len(RUNS) == 6
    return [encoder_recording(path) for path in RUNS]


@pytest.fixture(scope='module')
def training(recordings):
    """Return the calibration of some runs, and the slip fitted to them."""
    runs = [recordings[n] for n in FITTED]
    systematics = calibrated(runs)
    windows = [
        window for run, each in zip(runs, systematics) for length in (SHORT, LONG)
        for window in windows_of(run, each, (length,), every_seconds=EVERY)]
    return systematics[0], fit_slip(windows)


def prediction(recordings, systematics, seconds, fit):
    """Return NEES per dof of disjoint windows, over some starts of the first."""
    found = []
    for recording, each in zip(recordings, systematics):
        period = recording.time[1] - recording.time[0]
        for start in range(STARTS):
            windows = windows_of(
                recording, each, (seconds,), round(start * seconds / STARTS / period))
            found.extend(nees_per_dof(windows, fit.k_left.value, fit.k_right.value, fit.noise))
    assert len(found) > 30 / seconds * len(recordings) * STARTS
    return float(np.mean(found))


def test_the_two_directions_are_in_both_parts(recordings):
    for part in (FITTED, PREDICTED):
        ways = {float(np.sign(recordings[n].reference[-1, 2])) for n in part}
        assert ways == {-1.0, 1.0}


def test_the_constants_are_those_of_a_hard_floor_and_of_motion_capture(training):
    systematic, fit = training
    assert 4e-4 < np.sqrt(fit.k_left.value) < 2.5e-3
    assert fit.k_left.error < fit.k_left.value
    assert 2e-4 < fit.sigma_position.value < 1.5e-3
    assert 1e-3 < fit.sigma_heading.value < 6e-3
    assert systematic.separation == pytest.approx(0.2013, abs=5e-4)
    assert systematic.left == pytest.approx(0.998, abs=2e-3)
    assert systematic.right == pytest.approx(0.997, abs=2e-3)


@pytest.mark.parametrize('seconds', [5.0, 10.0])
def test_the_errors_of_the_other_runs_are_as_large_as_predicted(recordings, training, seconds):
    systematic, fit = training
    runs = [recordings[n] for n in PREDICTED]
    nees = prediction(runs, transferred(runs, systematic, session_frame=False), seconds, fit)
    assert 0.4 < nees < 2.0


@pytest.mark.parametrize('seconds', [5.0, 10.0])
def test_without_the_calibration_systematic_errors_show_as_too_much_slip(
        recordings, training, seconds):
    runs = [recordings[n] for n in PREDICTED]
    nominal = transferred(runs, NOMINAL, session_frame=False)
    assert prediction(runs, nominal, seconds, training[1]) > 3.0
