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


"""Which terms of slip a fit takes up: those that made the errors, and no others."""

from dataclasses import replace
from functools import lru_cache

from diffdrive_kinematics.core.calibration import (
    choose_slip, Clock, fit_drive_slip, fit_slip, fit_trajectory, nees_per_dof, NO_NOISE,
    ReferenceNoise, SLIP_TERMS, slip_window)
from diffdrive_kinematics.core.calibration.slip_choice import penalised
from diffdrive_kinematics.core.calibration.slip_stack import (
    noise_covariance, slip_covariance, slip_parts, stacked_windows)
from diffdrive_kinematics.core.calibration.variance_components import _Data, _scales, _scored
from diffdrive_kinematics.core.kinematics import Pose, WheelGeometry
from diffdrive_kinematics.core.noise import BodySlip, NO_BODY_SLIP
import numpy as np
import pytest
from support.drives import Disturbance, drive, GEOMETRY, Truth

ROBOT = WheelGeometry(0.25, 0.033)
ORIGIN = Pose(0.0, 0.0, 0.0)
NOISE = ReferenceNoise(5e-4, 2e-3)
WHEELS = (1e-6, NO_BODY_SLIP)
BODY = (0.0, BodySlip(1e-3, 1e-2, 4e-3))  # as of robots without encoders
SEEDS = 10


@lru_cache(maxsize=None)
def models():
    """Return windows without errors: long and short ones, curves both ways, turns in place."""
    found = []
    for number in range(150):
        bend = (0.0, 0.4, -0.4, 1.5, -0.2, 0.1)[number // 2 % 6]
        mean = 0.0 if number % 9 == 4 else (-0.02 if number % 7 == 3 else 0.02)
        rows = (15, 100)[number % 2]
        travel = np.tile([mean - 0.01 * bend, mean + 0.01 * bend], (rows, 1)) + 1e-4
        twist = 10.0 * travel[0].mean(), 10.0 * np.diff(travel[0])[0] / ROBOT.separation
        found.append(slip_window(ROBOT, travel, ORIGIN, ORIGIN, twists=[twist, twist]))
    return found


def drawn(seed, k, body, noise=NOISE):
    """Return the windows with errors that slip and noise make."""
    stack = stacked_windows(models(), 5)
    covariance = slip_covariance(stack, k, k, body) + noise_covariance(stack, noise)
    normal = np.random.default_rng(seed).standard_normal((len(covariance), 3))
    values, axes = np.linalg.eigh(covariance)
    errors = np.einsum('nij,nj->ni', axes, np.sqrt(np.maximum(values, 0.0)) * normal)
    return [replace(window, error=error) for window, error in zip(models(), errors)]


@pytest.mark.slow
def test_errors_of_wheels_choose_the_wheels():
    chosen = [choose_slip(drawn(seed, *WHEELS)).terms for seed in range(SEEDS)]
    assert chosen.count(('wheels',)) >= 0.9 * SEEDS


@pytest.mark.slow
def test_errors_of_the_body_choose_the_body_and_predict_new_errors():
    fits = [choose_slip(drawn(seed, *BODY)) for seed in range(SEEDS)]
    right = [fit for fit in fits if fit.terms == ('linear', 'turn', 'heading')]
    assert len(right) >= 0.9 * SEEDS
    for fit in right:
        for name in fit.terms:
            true = getattr(BODY[1], f'{name}_variance')
            assert abs(getattr(fit, name).value - true) < 4.0 * getattr(fit, name).error
    fresh = np.concatenate([nees_per_dof(
        drawn(1000 + seed, *BODY), 0.0, 0.0, fit.noise, fit.body)
        for seed, fit in enumerate(right)])
    assert np.mean(fresh) == pytest.approx(1.0, abs=0.1)


@pytest.mark.parametrize('constant', ['linear', 'turn', 'heading'])
def test_a_body_that_slips_in_one_way_is_found(constant):
    body = BodySlip(**{f'{constant}_variance': getattr(BODY[1], f'{constant}_variance')})
    chosen = [choose_slip(drawn(seed, 0.0, body)).terms for seed in range(3)]
    assert chosen.count((constant,)) >= 2


@pytest.mark.slow
def test_the_best_set_is_the_one_whose_constants_all_pay():
    fit = choose_slip(drawn(1, *BODY), equal=False)
    assert fit.rivals[0].terms == fit.terms
    assert fit.rivals[0].constants == 3 and len(fit.rivals) > 10
    scores = [penalised(rival) for rival in fit.rivals]
    assert scores == sorted(scores)
    assert fit.rivals[0].log_likelihood == fit.log_likelihood
    alone, = (rival for rival in fit.rivals if rival.terms == ('wheels',))
    assert alone.constants == 2
    assert 2.0 * (fit.log_likelihood - alone.log_likelihood) > 6.63


def maxima(windows):
    """Return the costs [1] at which searches from many starts end, the law being the wheels'."""
    stack = stacked_windows(windows, 5)
    parts = np.stack([*slip_parts(stack, ('wheels',), equal=True), stack.position, stack.heading])
    data = _Data.of(stack.error, parts, np.zeros_like(stack.left), np.ones(len(windows)))
    scale, generator = _scales(stack.error, parts), np.random.default_rng(1)
    least = np.array([1e-12, 1e-8, 1e-8])
    starts = [scale * 10.0**generator.uniform(-4.0, 0.3, 3) for _ in range(12)]
    return [_scored(data, np.maximum(start, least), least)[1] for start in starts]


@pytest.mark.slow
def test_of_two_maxima_far_apart_the_better_one_is_found():
    """As of a robot that is known by its commands, whose slip is not that of the wheels."""
    apart = []
    for seed in range(3):
        windows = [replace(window, time=np.zeros((3, 3))) for window in drawn(
            seed, 0.0, BodySlip(1e-3, 1e-2, 0.0), ReferenceNoise(1e-3, 1e-3))]
        costs = maxima(windows)
        apart.append(max(costs) - min(costs))
        assert -fit_slip(windows).log_likelihood < min(costs) + 0.5
    assert max(apart) > 2.0  # there are two, and where a search starts decides


@pytest.mark.slow
def test_a_perfect_reference_lets_no_fit_collapse():
    """A covariance that is nearly singular would call a millimetre impossible."""
    turns = [window for window in models() if abs(window.body[0, 0, 0]) < 0.05]
    assert len(turns) > 10
    generator = np.random.default_rng(1)
    exact = [replace(window, error=np.array([0.0, 0.0, generator.normal(
        0.0, 0.1 * np.sqrt(window.body[1, 2, 2]))])) for window in turns]
    for fit in (choose_slip(exact), choose_slip(drawn(1, *WHEELS, NO_NOISE))):
        assert fit.noise.sigma_position >= 1e-4 and fit.noise.sigma_heading >= 1e-4
        fresh = drawn(2, fit.k_left.value, fit.body, ReferenceNoise(2e-4, 2e-4))
        assert np.mean(nees_per_dof(
            fresh, fit.k_left.value, fit.k_left.value, fit.noise, fit.body)) < 5.0


@pytest.mark.slow
def test_with_a_perfect_reference_the_slip_is_right():
    """The floor of the noise takes little of it away."""
    found = [fit_slip(drawn(seed, *WHEELS, NO_NOISE)).k_left.value for seed in range(10)]
    assert np.mean(found) == pytest.approx(WHEELS[0], rel=0.15)


@pytest.mark.slow
def test_stamps_that_jitter_are_no_slip_of_the_body():
    """They move the reference along its way, and most where it turns fast."""
    noise = NOISE._replace(sigma_time=8e-3)
    for seed in range(3):
        windows = drawn(seed, *WHEELS, noise)
        fit = choose_slip(windows)
        assert fit.terms == ('wheels',)
        assert fit.sigma_time.value == pytest.approx(8e-3, rel=0.3)
        without = choose_slip([replace(each, time=np.zeros((3, 3))) for each in windows])
        assert without.log_likelihood < fit.log_likelihood - 20.0
        assert without.sigma_time == (0.0, 0.0)


def test_terms_out_of_order_or_unknown_are_refused():
    for terms in (('turn', 'linear'), ('sideways',)):
        with pytest.raises(ValueError, match='expected some of .* in that order'):
            fit_slip(drawn(0, *WHEELS), terms=terms)
    with pytest.raises(ValueError, match='4 windows, expected at least 5'):
        choose_slip(drawn(0, *WHEELS)[:4])


@pytest.mark.slow
@pytest.mark.parametrize('disturbance, expected', [
    (Disturbance(1e-3, 1e-3, 3e-3), ('wheels',)),
    (Disturbance(0.0, 1e-3, 3e-3, body=(1e-4, 5e-4, 0.0)), ('linear', 'turn'))])
def test_slip_of_drives_is_of_the_kind_and_size_that_was_put_in(disturbance, expected):
    drives = [drive(seed, Truth(), disturbance) for seed in range(6)]
    fit = fit_drive_slip(GEOMETRY, drives, fit_trajectory(GEOMETRY, drives, clock=Clock.AUTO))
    assert fit.terms == expected
    true = {'wheels': disturbance.slip**2, **dict(zip(SLIP_TERMS[1:], disturbance.body))}
    for name in expected:
        found = fit.k_left if name == 'wheels' else getattr(fit, name)
        assert abs(found.value - true[name]) < 4.0 * found.error < 4.0 * true[name]


def test_drives_without_a_window_are_refused_with_the_number_of_windows():
    drives = [drive(0, Truth(), seconds=60.0)]
    fit = fit_trajectory(GEOMETRY, drives, clock=Clock.NONE)
    with pytest.raises(ValueError, match='0 windows, expected at least'):
        fit_drive_slip(GEOMETRY, drives, fit, lengths=(500.0,))
