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

"""Maximum likelihood of slip constants: on slip simulated row by row, whatever the formulas."""

from dataclasses import replace
from functools import lru_cache
import math

from diffdrive_kinematics.core.calibration import (
    fit_reference_noise, fit_slip, nees_per_dof, NO_NOISE, ReferenceNoise, slip_window)
from diffdrive_kinematics.core.kinematics import advance, Pose, WheelGeometry
import numpy as np
import pytest

GEOMETRY = WheelGeometry(0.2, 0.04)
K_LEFT, K_RIGHT, NOISE = 3e-6, 1.5e-6, ReferenceNoise(5e-4, 4e-3)
SEEDS, ROW = 60, 0.007
Z = 3.2905  # of 99.9 %, two-sided
ORIGIN = Pose(0.0, 0.0, 0.0)


def course(number):
    """Return the wheel travel of window ``number``: short and long, both ways, some reverse."""
    bend = (0.0, 0.3, -0.3, 1.0, -0.15, 0.05)[number // 2 % 6]
    way = -1.0 if number % 7 == 3 else 1.0
    rows = (4, 150)[number % 2]
    return way * ROW * np.tile([1.0 - bend, 1.0 + bend], (rows, 1))


COURSES = [course(number) for number in range(80)]


def true_motion(travel, k, generator):
    """Return the poses after slipping wheels, ``SEEDS`` at once."""
    pose = Pose(np.zeros(SEEDS), np.zeros(SEEDS), np.zeros(SEEDS))
    for row in travel:
        slip = np.sqrt(np.abs(row) * k)[:, None] * generator.standard_normal((2, SEEDS))
        left, right = row[:, None] + slip
        pose = advance(pose, 0.5 * (left + right), (right - left) / GEOMETRY.separation)
    return pose


def observed(pose, noise, generator):
    """Return the poses as a noisy reference sees them."""
    return Pose(pose.x + noise.sigma_position * generator.standard_normal(SEEDS),
                pose.y + noise.sigma_position * generator.standard_normal(SEEDS),
                pose.theta + noise.sigma_heading * generator.standard_normal(SEEDS))


@lru_cache(maxsize=None)
def simulated(k_left, k_right, noise, seed):
    """Return lists of windows, one list for each of ``SEEDS`` drives along all courses."""
    generator = np.random.default_rng(seed)
    drives = [[] for _ in range(SEEDS)]
    start = Pose(np.zeros(SEEDS), np.zeros(SEEDS), np.zeros(SEEDS))
    for travel in COURSES:
        end = observed(true_motion(travel, np.array([k_left, k_right]), generator),
                       noise, generator)
        before = observed(start, noise, generator)
        model = slip_window(GEOMETRY, travel, ORIGIN, ORIGIN)
        for number, drive in enumerate(drives):
            ends = (Pose(*(float(value[number]) for value in pose)) for pose in (before, end))
            drive.append(replace(model, error=wrapped(model.error + relative(*ends))))
    return drives


def relative(before, after):
    """Return the pose ``after`` in the frame of ``before``."""
    dx, dy = after.x - before.x, after.y - before.y
    cosine, sine = math.cos(before.theta), math.sin(before.theta)
    return np.array([
        cosine * dx + sine * dy, cosine * dy - sine * dx, after.theta - before.theta])


def wrapped(error):
    """Return the error with its heading wrapped."""
    return np.array([*error[:2], math.remainder(error[2], math.tau)])


def assert_standard_normal(estimates, truth):
    """
    Compare logarithms of estimates with the truth, in units of their standard errors.

    Of a variance the logarithm is far closer to normal.  Bands of 99.9 %, with 0.2 for what is
    left of the bias at this number of windows.
    """
    z = np.array([math.log(each.value / truth) * each.value / each.error for each in estimates])
    assert abs(np.mean(z)) < 0.2 + Z / math.sqrt(len(z))
    assert abs(np.var(z, ddof=1) - 1.0) < 1.2 * Z * math.sqrt(2.0 / (len(z) - 1))


@pytest.mark.slow
def test_one_k_and_the_noise_of_the_reference_are_recovered_within_their_errors():
    fits = [fit_slip(drive) for drive in simulated(K_LEFT, K_LEFT, NOISE, 1)]
    assert all(fit.k_left == fit.k_right for fit in fits)
    assert_standard_normal([fit.k_left for fit in fits], K_LEFT)
    assert_standard_normal([fit.sigma_position for fit in fits], NOISE.sigma_position)
    assert_standard_normal([fit.sigma_heading for fit in fits], NOISE.sigma_heading)


@pytest.mark.slow
def test_a_k_for_each_wheel_is_recovered_within_its_error():
    fits = [fit_slip(drive, equal=False) for drive in simulated(6e-6, K_RIGHT, NOISE, 2)]
    assert_standard_normal([fit.k_left for fit in fits], 6e-6)
    assert_standard_normal([fit.k_right for fit in fits], K_RIGHT)
    assert np.mean([fit.k_left.value > fit.k_right.value for fit in fits]) > 0.9


@pytest.mark.slow
def test_a_known_noise_of_the_reference_is_not_fitted_and_makes_k_more_certain():
    drives = simulated(K_LEFT, K_RIGHT, NOISE, 3)
    fits = [fit_slip(drive, equal=False, noise=NOISE) for drive in drives]
    assert_standard_normal([fit.k_left for fit in fits], K_LEFT)
    assert_standard_normal([fit.k_right for fit in fits], K_RIGHT)
    assert all(fit.noise == NOISE and fit.sigma_heading.error == 0.0 for fit in fits)
    unknown = fit_slip(drives[0], equal=False)
    assert fits[0].k_left.error < unknown.k_left.error


def test_the_noise_of_the_reference_is_recovered_for_known_slip():
    fits = [fit_reference_noise(drive, K_LEFT, K_RIGHT)
            for drive in simulated(K_LEFT, K_RIGHT, NOISE, 3)]
    assert_standard_normal([fit.sigma_position for fit in fits], NOISE.sigma_position)
    assert_standard_normal([fit.sigma_heading for fit in fits], NOISE.sigma_heading)
    assert fits[0].k_left == (K_LEFT, 0.0)


def test_nees_per_dof_is_1_for_the_true_model_and_not_for_a_wrong_one():
    windows = [w for drive in simulated(K_LEFT, K_RIGHT, NOISE, 3) for w in drive]
    band = Z * math.sqrt(2.0 / (3.0 * len(windows)))
    assert abs(np.mean(nees_per_dof(windows, K_LEFT, K_RIGHT, NOISE)) - 1.0) < band
    for k_left, k_right, noise in (
            (0.7 * K_LEFT, K_RIGHT, NOISE), (K_LEFT, 0.6 * K_RIGHT, NOISE),
            (K_LEFT, K_RIGHT, ReferenceNoise(4.5e-4, 4e-3)),
            (K_LEFT, K_RIGHT, ReferenceNoise(5e-4, 3.6e-3))):
        assert np.mean(nees_per_dof(windows, k_left, k_right, noise)) > 1.0 + band


def log_likelihood(windows, k):
    """Return it by definition, for one k and ``NOISE``."""
    total = 0.0
    for window in windows:
        covariance = (k * (window.left + window.right) + NOISE.sigma_position**2 * window.position
                      + NOISE.sigma_heading**2 * window.heading)
        total -= 0.5 * (math.log(np.linalg.det(covariance))
                        + window.error @ np.linalg.inv(covariance) @ window.error)
    return total


def test_the_estimate_is_the_maximum_and_its_error_the_curvature_there():
    windows = simulated(K_LEFT, K_RIGHT, NOISE, 3)[0]
    fit = fit_slip(windows, noise=NOISE)
    k, step = fit.k_left.value, 1e-3 * fit.k_left.value
    low, middle, high = (log_likelihood(windows, k + n * step) for n in (-1, 0, 1))
    assert fit.log_likelihood == pytest.approx(middle, rel=1e-12)
    assert low < middle > high
    assert abs(high - low) / (2.0 * step) * fit.k_left.error < 1e-3
    curvature = (2.0 * middle - low - high) / step**2
    assert fit.k_left.error == pytest.approx(1.0 / math.sqrt(curvature), rel=1e-3)


def test_the_window_depends_on_the_relative_pose_alone_and_wraps_the_heading():
    travel = COURSES[3]
    exact = slip_window(GEOMETRY, travel, ORIGIN, ORIGIN).error
    end = Pose(-exact[0] + 0.01, -exact[1] + 0.02, -exact[2] + 0.03)
    here = slip_window(GEOMETRY, travel, ORIGIN, end)
    assert here.error == pytest.approx([0.01, 0.02, 0.03])
    turn, dx, dy = 2.5, 3.0, -1.0
    moved = [Pose(dx + math.cos(turn) * p.x - math.sin(turn) * p.y,
                  dy + math.sin(turn) * p.x + math.cos(turn) * p.y,
                  p.theta + turn + math.tau * n) for n, p in enumerate((ORIGIN, end))]
    there = slip_window(GEOMETRY, travel, *moved)
    assert there.error == pytest.approx(here.error)
    assert np.array_equal(there.left, here.left)


def test_noise_at_the_two_ends_moves_the_error_as_the_covariance_says():
    """N_p and N_h are sums of outer products of the error's derivatives, found by perturbation."""
    travel, step = COURSES[3], 1e-6
    model = slip_window(GEOMETRY, travel, ORIGIN, ORIGIN)
    ends = [ORIGIN, Pose(*(-model.error))]
    base = slip_window(GEOMETRY, travel, *ends).error
    derivatives = {}
    for end in (0, 1):
        for axis in ('x', 'y', 'theta'):
            moved = list(ends)
            moved[end] = ends[end]._replace(**{axis: getattr(ends[end], axis) + step})
            change = slip_window(GEOMETRY, travel, *moved).error - base
            derivatives[end, axis] = change / step
    outer = {key: np.outer(value, value) for key, value in derivatives.items()}
    position = sum(outer[end, axis] for end in (0, 1) for axis in 'xy')
    heading = outer[0, 'theta'] + outer[1, 'theta']
    assert model.position == pytest.approx(position, abs=1e-5)
    assert model.heading == pytest.approx(heading, abs=1e-5)


def test_rows_at_rest_add_nothing():
    travel = COURSES[3]
    rested = np.concatenate([np.zeros((5, 2)), travel, np.zeros((5, 2))])
    ends = ORIGIN, Pose(0.1, 0.2, 0.3)
    one, other = slip_window(GEOMETRY, travel, *ends), slip_window(GEOMETRY, rested, *ends)
    assert np.array_equal(one.left, other.left) and np.array_equal(one.error, other.error)


def test_without_slip_k_is_near_0_with_an_error_that_is_not():
    for drive in simulated(0.0, 0.0, NOISE, 4)[:10]:
        k = fit_slip(drive).k_left
        assert 0.0 <= k.value < 4.0 * k.error < 1e-6


@pytest.mark.parametrize(('travel', 'said'), [
    (np.zeros((3, 2)), 'travel is 0 throughout'), (np.zeros((0, 2)), 'shape'),
    (np.ones((3, 3)), 'shape'), ([[0.1, math.nan]], 'not finite'),
    ([[math.inf, 0.1]], 'not finite')])
def test_a_window_without_usable_travel_is_refused(travel, said):
    with pytest.raises(ValueError, match=said):
        slip_window(GEOMETRY, travel, ORIGIN, ORIGIN)


@pytest.mark.parametrize('end', [0, 1])
@pytest.mark.parametrize('axis', ['x', 'y', 'theta'])
def test_a_reference_pose_that_is_not_finite_is_refused(end, axis):
    ends = [ORIGIN, ORIGIN]
    ends[end] = ends[end]._replace(**{axis: math.nan})
    with pytest.raises(ValueError, match='reference poses'):
        slip_window(GEOMETRY, COURSES[0], *ends)


def test_windows_that_cannot_identify_the_constants_are_refused():
    windows = simulated(K_LEFT, K_RIGHT, NOISE, 3)[0]
    with pytest.raises(ValueError, match='4 windows, expected at least 5'):
        fit_slip(windows[:4])
    with pytest.raises(ValueError, match='0 windows, expected at least 1'):
        nees_per_dof([], K_LEFT, K_RIGHT, NOISE)
    with pytest.raises(ValueError, match='error that is not finite'):
        fit_slip([*windows, replace(windows[0], error=np.full(3, math.nan))])
    with pytest.raises(ValueError, match='all errors are 0'):
        fit_slip([replace(window, error=np.zeros(3)) for window in windows])
    with pytest.raises(ValueError, match='cannot tell'):
        fit_slip([replace(window, right=window.left) for window in windows], equal=False)


def test_constants_and_noise_out_of_range_are_refused():
    windows = simulated(K_LEFT, K_RIGHT, NOISE, 3)[0]
    with pytest.raises(ValueError, match='k_left'):
        nees_per_dof(windows, -1.0, K_RIGHT, NOISE)
    with pytest.raises(ValueError, match='k_right'):
        fit_reference_noise(windows, K_LEFT, math.nan)
    with pytest.raises(ValueError, match='sigma_heading'):
        fit_slip(windows, noise=ReferenceNoise(0.0, math.inf))
    with pytest.raises(ValueError, match='covariance of window 0 is singular'):
        nees_per_dof(windows, 0.0, 0.0, NO_NOISE)
