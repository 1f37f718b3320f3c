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

"""The clock of the reference: a drift is fitted where it pays, and nowhere else."""

from functools import lru_cache

from diffdrive_kinematics.core.calibration import (
    Clock, drift_pays, fit_drive_slip, fit_trajectory, NO_FRAME, Windows)
import numpy as np
import pytest
from support.drives import Disturbance, drive, GEOMETRY, Truth
from support.end_points import encoder_drive
from support.recorded import RADIUS, RUNS, SEPARATION

DRIFT = 2e-3  # [s/s]: 0.12 s a minute, as in recordings of real robots
NOISE = Disturbance(1e-3, 1e-3, 3e-3)
SEEDS = 40


@lru_cache(maxsize=None)
def chosen(seed, drift):
    """Return a simulated drive and its calibration, the clock chosen by the fit."""
    recorded = drive(seed, Truth(drift=drift), NOISE)
    return recorded, fit_trajectory(GEOMETRY, [recorded])


@pytest.mark.slow
def test_a_clock_that_drifts_is_found_with_its_drift():
    for seed in range(10):
        fit = chosen(seed, DRIFT)[1]
        assert fit.names[-2:] == ('offset of drive 1', 'drift of drive 1')
        assert abs(fit.drifts[0].value - DRIFT) < 4.0 * fit.drifts[0].error < 0.5 * DRIFT
        assert drift_pays(fit.drift_ratios[0])


@pytest.mark.slow
def test_a_clock_that_does_not_drift_keeps_the_offset_alone():
    fits = [chosen(seed, 0.0)[1] for seed in range(SEEDS)]
    kept = [fit for fit in fits if fit.names[-1] == 'offset of drive 1']
    assert len(kept) >= 0.9 * SEEDS
    assert all(fit.drifts[0] == (0.0, 0.0) and not drift_pays(fit.drift_ratios[0])
               for fit in kept)


def test_the_fit_without_a_drift_is_that_of_offsets():
    recorded, fit = chosen(0, 0.0)
    offsets = fit_trajectory(GEOMETRY, [recorded], clock=Clock.OFFSETS)
    assert fit.names == offsets.names
    assert fit.wheel_separation_multiplier == offsets.wheel_separation_multiplier
    assert offsets.drift_ratios == (None,)


@pytest.mark.slow
def test_the_ratio_of_clocks_that_do_not_drift_is_chi_square_of_one_degree():
    ratios = np.array([chosen(seed, 0.0)[1].drift_ratios[0] for seed in range(SEEDS)])
    assert 0.4 < np.mean(ratios) < 2.0
    assert np.mean(ratios > 0.455) == pytest.approx(0.5, abs=0.3)


@pytest.mark.slow
def test_slip_is_recovered_beside_a_clock_that_drifts():
    """With an offset alone the drift counts as slip."""
    drives = [drive(n, Truth(drift=drift), NOISE) for n, drift in enumerate((DRIFT, -DRIFT))]
    slips = [fit_drive_slip(
        GEOMETRY, drives, fit_trajectory(GEOMETRY, drives, clock=clock), terms=('wheels',)).k_left
             for clock in (Clock.AUTO, Clock.OFFSETS)]
    true = NOISE.slip**2
    assert abs(slips[0].value - true) < 3.0 * slips[0].error < 3.0 * true
    assert slips[1].value > 3.0 * true


def test_each_drive_has_a_choice_of_its_own():
    drives = [drive(1, Truth(), NOISE), drive(2, Truth(drift=DRIFT), NOISE)]
    fit = fit_trajectory(GEOMETRY, drives)
    assert [drift_pays(ratio) for ratio in fit.drift_ratios] == [False, True]
    assert fit.names[-3:] == ('offset of drive 1', 'offset of drive 2', 'drift of drive 2')


def test_drives_too_short_for_drifts_are_fitted_with_offsets():
    short = drive(3, seconds=13.0)
    windows = Windows((10.0,), every=0.5)
    assert fit_trajectory(
        GEOMETRY, [short], wheels=False, frame=NO_FRAME, windows=windows,
        clock=Clock.OFFSETS).names == ('offset of drive 1',)
    fit = fit_trajectory(GEOMETRY, [short], wheels=False, frame=NO_FRAME, windows=windows)
    assert 'offset of drive 1' in fit.names


@pytest.mark.slow
def test_clocks_of_a_real_session_drift_and_would_pass_for_slip_or_for_jitter_of_stamps():
    drives = [encoder_drive(path) for path in RUNS]
    nominal = type(GEOMETRY)(SEPARATION, RADIUS)
    fit = fit_trajectory(nominal, drives)
    assert all(map(drift_pays, fit.drift_ratios))
    minute = 60.0 * np.array([each.value for each in fit.drifts])
    assert np.all((minute > 0.02) & (minute < 0.14))
    offsets = fit_trajectory(nominal, drives, clock=Clock.OFFSETS)
    assert offsets.variances.slip > 3.0 * fit.variances.slip
    jitter, with_offsets = (
        fit_drive_slip(nominal, drives, each, terms=('wheels',)).sigma_time.value
        for each in (fit, offsets))
    assert with_offsets > 2.0 * jitter
