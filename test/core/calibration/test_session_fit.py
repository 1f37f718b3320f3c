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

"""What differs between runs is found from drives, and only where there are enough of them."""

from dataclasses import replace
import math

from diffdrive_kinematics.core.calibration import (
    Clock, fit_sessions, fit_trajectory, spread_between)
from diffdrive_kinematics.core.noise import draw_session, session_generator, SessionSpread
import numpy as np
import pytest
from support.drives import drive, GEOMETRY, Truth

SPREAD = SessionSpread(scale=0.004, separation=0.008, curvature=0.008)
WITHIN = 1e-3  # above the standard error within a drive of each of the three
RUNS = 8
Z = 3.2905  # of 99.9 %, two-sided


def chi_square_bounds(degrees):
    """Return the central 99.9 % interval of chi-square over its degrees (Wilson & Hilferty)."""
    width = math.sqrt(2.0 / (9.0 * degrees))
    return tuple((1.0 - 2.0 / (9.0 * degrees) + sign * Z * width)**3 for sign in (-1.0, 1.0))


def true_in_session(scale, separation, curvature):
    """Return the robot as it is in a session."""
    usual = Truth()
    wider = usual.separation * (1.0 + separation)
    half = 0.5 * curvature * GEOMETRY.separation * wider
    return usual._replace(
        left=usual.left * (1.0 + scale) * (1.0 - half),
        right=usual.right * (1.0 + scale) * (1.0 + half), separation=wider)


def drives_of(spread, seed, runs=RUNS):
    """Return a drive of each of several sessions."""
    drawn = draw_session(spread, session_generator(seed), runs)
    return [drive(100 * seed + run, true_in_session(*each), seconds=60.0)
            for run, each in enumerate(zip(*drawn))]


def fitted(drives, clock=Clock.OFFSETS, mean_radius=True):
    fit = fit_trajectory(GEOMETRY, drives, clock=clock, mean_radius=mean_radius)
    return fit_sessions(
        GEOMETRY, [[each] for each in drives], fit, clock=clock, mean_radius=mean_radius)


@pytest.mark.slow
@pytest.mark.parametrize('seed', [1, 2, 3])
def test_the_spread_of_sessions_is_found_within_its_chi_square_bounds(seed):
    found, (low, high) = fitted(drives_of(SPREAD, seed)), chi_square_bounds(RUNS - 1)
    assert found.sessions == RUNS
    for name in ('scale', 'separation', 'curvature'):
        spread, true = getattr(found, name), getattr(SPREAD, name)
        assert low * true**2 - WITHIN**2 < spread.value**2 < high * (true**2 + WITHIN**2)
        assert 0.1 * true < spread.error < true


@pytest.mark.slow
def test_it_is_that_of_what_the_sessions_had_but_for_the_errors_of_the_drives():
    drawn = draw_session(SPREAD, session_generator(1), RUNS)
    found = fitted(drives_of(SPREAD, 1))
    for spread, values in zip(found[:3], drawn):
        assert spread.value == pytest.approx(values.std(ddof=1), abs=2.0 * WITHIN)


@pytest.mark.slow
def test_one_robot_that_is_always_the_same_has_next_to_none():
    found = fitted(drives_of(SessionSpread(), 4))
    assert all(spread.value < WITHIN for spread in found[:3])


def test_without_a_fitted_mean_radius_there_is_no_scale():
    found = fitted(drives_of(SPREAD, 5, 3), mean_radius=False)
    assert found.scale is None
    assert found.separation.value > 0.0


@pytest.mark.slow
def test_clocks_that_are_chosen_for_all_are_those_of_each():
    assert fitted(drives_of(SPREAD, 6, 3), Clock.AUTO).sessions == 3


@pytest.mark.slow
def test_fewer_than_three_drives_that_tell_the_wheels_say_nothing():
    drives = drives_of(SPREAD, 7, 3)
    assert fitted(drives[:2]) is None
    still = replace(drives[2], angles=np.outer(drives[2].angles[:, 0], [1.0, 1.0]))
    fit = fit_trajectory(GEOMETRY, drives)
    assert fit_sessions(
        GEOMETRY, [[each] for each in (*drives[:2], still)], fit, clock=Clock.OFFSETS) is None


@pytest.mark.slow
def test_drives_of_one_session_are_fitted_together():
    sessions = [drives_of(SessionSpread(), 10 + number, 2) for number in range(3)]
    sessions[2] = [drive(90 + n, Truth(separation=1.1 * Truth().separation), seconds=60.0)
                   for n in range(2)]
    drives = [each for session in sessions for each in session]
    fit = fit_trajectory(GEOMETRY, drives)
    found = fit_sessions(GEOMETRY, sessions, fit, clock=Clock.OFFSETS)
    assert found.sessions == 3
    assert found.separation.value == pytest.approx(0.1 / math.sqrt(3.0), rel=0.1)
    assert found.scale.value < WITHIN and found.curvature.value < WITHIN


@pytest.mark.slow
def test_the_spread_of_unequal_errors_is_unbiased_and_knows_its_error():
    """Draw estimates of 12 runs with errors of half to twice the spread, 4,000 times."""
    generator, errors = np.random.default_rng(8), np.geomspace(0.25, 1.0, 12)
    found = [spread_between(generator.normal(0.0, np.sqrt(1.0 + errors**2)), errors)
             for _ in range(4000)]
    squares = np.array([each.value for each in found])**2
    assert abs(squares.mean() - 1.0) < 4.0 * squares.std() / math.sqrt(4000) + 0.01
    spreads = np.array([each.value for each in found])
    assert np.median([each.error for each in found]) == pytest.approx(spreads.std(), rel=0.15)


def test_scatter_within_the_errors_is_no_spread():
    assert spread_between([1.0, 1.1, 0.9], [0.5, 0.5, 0.5]).value == 0.0
    assert spread_between([1.0, 1.0, 1.0], [0.0, 0.0, 0.0]) == (0.0, 0.0)


@pytest.mark.parametrize('scale', [1e-6, 1.0, 1e6])
def test_the_spread_has_the_unit_of_the_values(scale):
    values, errors = np.array([1.0, 1.3, 0.8, 1.1]), np.array([0.05, 0.1, 0.05, 0.2])
    one = spread_between(values, errors)
    assert spread_between(scale * values, scale * errors) == pytest.approx(
        [scale * each for each in one], rel=1e-9)
