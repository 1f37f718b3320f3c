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

"""Distributions of one variance: moments, shapes, bounds, seeds; and uncertain headings."""

import math

from diffdrive_kinematics.core.noise import (
    DISTRIBUTIONS, draw_unit, heading_variance, sample_heading, unit_bound)
from hypothesis import given, strategies as st
import mpmath
import numpy as np
import pytest

Z = 3.2905  # of 99.9 %, two-sided
KOLMOGOROV = 1.95  # of 99.9 %
N = 200_000
EVERY = pytest.mark.parametrize('distribution', DISTRIBUTIONS)
SHAPES = st.one_of(st.none(), st.integers(0, 40), st.tuples(st.integers(0, 6), st.integers(0, 6)))


def normal_cdf(x):
    return 0.5 * (1.0 + math.erf(x / math.sqrt(2.0)))


def truncated_sigma():
    """Return the standard deviation of a unit normal within +-2, by quadrature."""
    density = lambda x: mpmath.exp(-x * x / 2)  # noqa: E731
    return float(mpmath.sqrt(
        mpmath.quad(lambda x: x * x * density(x), [-2, 0, 2])
        / mpmath.quad(density, [-2, 0, 2])))


def truncated_cdf(x):
    low, high = normal_cdf(-2.0), normal_cdf(2.0)
    return (min(max(normal_cdf(x * truncated_sigma()), low), high) - low) / (high - low)


def triangular_cdf(x):
    rest = max(1.0 - abs(x) / math.sqrt(6.0), 0.0)
    return 1.0 - 0.5 * rest**2 if x > 0.0 else 0.5 * rest**2


def uniform_cdf(x):
    return min(max(0.5 + x / math.sqrt(12.0), 0.0), 1.0)


CDFS = {
    'gaussian': normal_cdf, 'truncated_gaussian': truncated_cdf, 'triangular': triangular_cdf,
    'uniform': uniform_cdf}


def draws(distribution, seed=1):
    return draw_unit(distribution, np.random.default_rng(seed), N)


@EVERY
def test_the_mean_is_zero_and_the_variance_one(distribution):
    sample = draws(distribution)
    fourth = np.mean(sample**4)
    assert abs(np.mean(sample)) < Z / math.sqrt(N)
    assert abs(np.var(sample) - 1.0) < Z * math.sqrt((fourth - 1.0) / N)


@EVERY
def test_the_draws_have_the_shape_of_their_density(distribution):
    """Compare distribution functions at 200 quantiles, after Kolmogorov."""
    points = np.quantile(draws(distribution), np.linspace(0.0, 1.0, 201)[1:-1])
    expected = np.array([CDFS[distribution](x) for x in points])
    assert np.max(np.abs(expected - np.linspace(0.0, 1.0, 201)[1:-1])) < KOLMOGOROV / math.sqrt(N)


@EVERY
def test_draws_of_both_signs_come_up_to_the_bound_and_never_pass_it(distribution):
    sample, bound = draws(distribution), unit_bound(distribution)
    assert np.max(np.abs(sample)) <= bound
    near = 4.0 if distribution == 'gaussian' else 0.98 * bound
    assert np.min(sample) < -near and np.max(sample) > near


def test_the_bounds_by_hand():
    bounds = {distribution: unit_bound(distribution) for distribution in DISTRIBUTIONS}
    assert bounds == {
        'gaussian': math.inf,
        'truncated_gaussian': pytest.approx(2.0 / truncated_sigma(), rel=1e-14),
        'triangular': math.sqrt(6.0), 'uniform': math.sqrt(3.0)}


def test_a_gaussian_draw_is_a_standard_normal_of_numpy_bit_for_bit():
    """Guard that a seed which was used before there were distributions keeps its meaning."""
    drawn, normals = np.random.default_rng(3), np.random.default_rng(3)
    assert draw_unit('gaussian', drawn) == normals.standard_normal()
    assert np.array_equal(draw_unit('gaussian', drawn, (2, 3)), normals.standard_normal((2, 3)))


@given(st.sampled_from(DISTRIBUTIONS), SHAPES, st.integers(0, 2**32))
def test_an_array_is_what_its_elements_are_one_by_one(distribution, shape, seed):
    whole, parts = np.random.default_rng(seed), np.random.default_rng(seed)
    drawn = draw_unit(distribution, whole, shape)
    if shape is None:
        assert isinstance(drawn, float)
    else:
        assert drawn.shape == (shape if isinstance(shape, tuple) else (shape,))
    one_by_one = [draw_unit(distribution, parts) for _ in range(np.size(drawn))]
    assert np.ravel(drawn).tolist() == one_by_one
    assert whole.bit_generator.state == parts.bit_generator.state


@pytest.mark.parametrize('name', ['Gaussian', 'normal', ''])
def test_an_unknown_distribution_is_refused_by_name(name):
    for refused in (unit_bound, lambda n: draw_unit(n, np.random.default_rng(0))):
        with pytest.raises(ValueError, match=f"^distribution is '{name}', expected one of"):
            refused(name)


@pytest.mark.parametrize('kappa', [0.0, 1e-3, 0.5, 2.0, 14.0, 25.0, 200.0])
def test_the_variance_of_a_heading_is_that_of_the_bessel_series(kappa):
    """E t^2 = pi^2 / 3 + 4 sum of (-1)^j I_j(kappa) / (j^2 I_0(kappa)); Mardia & Jupp 3.5.4."""
    with mpmath.workdps(40):
        terms = range(1, 60 + int(12 * math.sqrt(kappa)))
        series = mpmath.fsum((-1)**j * mpmath.besseli(j, kappa) / j**2 for j in terms)
        expected = mpmath.pi**2 / 3 + 4 * series / mpmath.besseli(0, kappa)
    assert heading_variance(kappa) == pytest.approx(float(expected), rel=1e-11)


@pytest.mark.parametrize('kappa', [1e5, 1e8, 1e300])
def test_a_concentrated_heading_has_the_variance_of_a_normal(kappa):
    assert heading_variance(kappa) * kappa == pytest.approx(1.0, abs=1.0 / kappa + 1e-13)


@pytest.mark.parametrize('kappa', [0.0, 0.7, 4.0, 90.0])
@pytest.mark.parametrize('mean', [0.0, 1.2, -3.0, 40.0])
def test_sampled_headings_are_in_range_and_have_the_mean_and_the_variance(kappa, mean):
    sample = sample_heading(mean, kappa, np.random.default_rng(7), N)
    assert np.all((-math.pi < sample) & (sample <= math.pi))
    deviation = (sample - mean + math.pi) % math.tau - math.pi
    variance, square = heading_variance(kappa), deviation**2
    assert abs(np.mean(deviation)) < Z * math.sqrt(variance / N)
    assert abs(np.mean(square) - variance) < Z * np.std(square) / math.sqrt(N)


def test_a_heading_is_reproducible_and_a_float_where_no_shape_is_given():
    first, second = (sample_heading(1.0, 5.0, np.random.default_rng(4)) for _ in range(2))
    assert isinstance(first, float)
    assert first == second


@pytest.mark.parametrize(('mean', 'kappa', 'name'), [
    (math.nan, 1.0, 'mean heading'), (math.inf, 1.0, 'mean heading'),
    (0.0, -1.0, 'concentration'), (0.0, math.nan, 'concentration'),
    (0.0, math.inf, 'concentration')])
def test_bad_headings_are_refused_by_name(mean, kappa, name):
    with pytest.raises(ValueError, match=f'^{name} is'):
        sample_heading(mean, kappa, np.random.default_rng(0))
    if name == 'concentration':
        with pytest.raises(ValueError, match='^concentration is'):
            heading_variance(kappa)
