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

"""Bias and slip of a wheel: the law, the sampler against it, and how paths are cut."""

import math

from diffdrive_kinematics.core.noise import (
    DISTRIBUTIONS, effective_ratio, sample_travel, SLIP_MODELS, travel_variance, unit_bound,
    WheelSlip)
from hypothesis import given, settings, strategies as st
import numpy as np
import pytest

LAW = settings(deadline=None, derandomize=True)
Z = 3.2905  # of 99.9 %, two-sided
N = 200_000
slips = st.builds(
    WheelSlip, st.floats(-0.5, 0.5), st.floats(0.0, 0.1), st.sampled_from(SLIP_MODELS),
    st.sampled_from(DISTRIBUTIONS))
MODELS = pytest.mark.parametrize('model', SLIP_MODELS)


def assert_moments(samples, mean, variance):
    """Compare with 99.9 % intervals of the mean and of the variance (chi^2, large n)."""
    n = len(samples)
    assert abs(np.mean(samples) - mean) < Z * math.sqrt(variance / n)
    assert abs(np.var(samples, ddof=1) / variance - 1.0) < Z * math.sqrt(2.0 / (n - 1))


def path_of(slip, travel, cuts, generator):
    """Return N samples of a path that is cut into equal intervals."""
    step = np.full(N, travel / cuts)
    return sum(sample_travel(slip, step, generator) for _ in range(cuts))


@pytest.mark.parametrize(('model', 'travel', 'variance'), [
    ('travel', 2.0, 0.02), ('travel', -2.0, 0.02), ('travel', 0.5, 0.005), ('travel', 0.0, 0.0),
    ('command', 2.0, 0.04), ('command', -2.0, 0.04), ('command', 0.5, 0.0025)])
def test_the_variance_by_hand(model, travel, variance):
    """K = 0.01: 0.01 |d| for the law ``travel``, 0.01 d^2 for the law ``command``."""
    assert travel_variance(WheelSlip(0.3, 0.01, model), travel) == pytest.approx(variance)


@MODELS
@pytest.mark.parametrize('travel', [3.0, -0.2])
def test_mean_and_variance_of_the_samples_are_those_of_the_law(model, travel):
    slip = WheelSlip(0.1, 4e-4, model)
    samples = path_of(slip, travel, 1, np.random.default_rng(1))
    assert_moments(samples, 1.1 * travel, travel_variance(slip, travel))


@MODELS
@pytest.mark.parametrize('distribution', DISTRIBUTIONS)
def test_the_variance_is_that_of_the_law_whatever_the_distribution(model, distribution):
    slip = WheelSlip(0.1, 4e-4, model, distribution)
    samples = path_of(slip, -3.0, 1, np.random.default_rng(1))
    assert_moments(samples, -3.3, travel_variance(slip, -3.0))


@pytest.mark.parametrize('distribution', DISTRIBUTIONS[1:])
@pytest.mark.parametrize('single', [True, False])
def test_bounded_samples_come_up_to_the_bound_of_their_distribution(distribution, single):
    slip, generator = WheelSlip(0.1, 4e-4, 'travel', distribution), np.random.default_rng(3)
    samples = np.array([sample_travel(slip, 3.0, generator) for _ in range(5_000)]) if (
        single) else sample_travel(slip, np.full(5_000, 3.0), generator)
    bound = unit_bound(distribution) * math.sqrt(4e-4 * 3.0)
    assert 0.95 * bound < np.max(np.abs(samples - 3.3)) <= bound * (1.0 + 1e-12)


@pytest.mark.parametrize('travel', [3.0, -0.2])
def test_the_samples_of_single_numbers_follow_the_law_too(travel):
    slip, generator = WheelSlip(-0.05, 4e-4), np.random.default_rng(2)
    samples = [sample_travel(slip, travel, generator) for _ in range(20_000)]
    assert_moments(samples, 0.95 * travel, 4e-4 * abs(travel))


@pytest.mark.parametrize('cuts', [2, 10, 40])
def test_slip_with_travel_does_not_depend_on_how_a_path_is_cut(cuts):
    slip = WheelSlip(0.02, 1e-3, 'travel')
    assert_moments(path_of(slip, 2.0, cuts, np.random.default_rng(cuts)), 2.04, 2e-3)


@pytest.mark.parametrize('cuts', [2, 10, 40])
def test_slip_with_the_command_falls_with_the_number_of_cuts(cuts):
    """Guard what the documentation says about LaValle 2.37: it depends on the message rate."""
    slip = WheelSlip(0.02, 1e-3, 'command')
    assert_moments(path_of(slip, 2.0, cuts, np.random.default_rng(cuts)), 2.04, 4e-3 / cuts)


@LAW
@given(slips, st.integers(0, 2**32))
def test_no_travel_is_no_noise(slip, seed):
    generator = np.random.default_rng(seed)
    assert sample_travel(slip, 0.0, generator) == 0.0
    assert not sample_travel(slip, np.zeros(3), generator).any()


@LAW
@given(st.floats(-0.5, 0.5), st.sampled_from(SLIP_MODELS), st.floats(-10.0, 10.0))
def test_no_variance_leaves_the_bias_alone(bias, model, travel):
    sample = sample_travel(WheelSlip(bias, 0.0, model), travel, np.random.default_rng(0))
    assert sample == (1.0 + bias) * travel


@LAW
@given(slips, st.lists(st.floats(-10.0, 10.0), min_size=1, max_size=9), st.integers(0, 2**32))
def test_the_same_seed_gives_the_same_bits_for_arrays_and_for_their_elements(slip, travel, seed):
    generators = [np.random.default_rng(seed) for _ in range(3)]
    array = np.array(travel)
    samples = sample_travel(slip, array, generators[0])
    assert samples.tolist() == sample_travel(slip, array, generators[1]).tolist()
    alone = [sample_travel(slip, d, generators[2]) for d in travel]
    np.testing.assert_allclose(samples, alone, rtol=1e-15)
    assert array.tolist() == travel, 'the argument was written'
    assert generators[0].bit_generator.state == generators[2].bit_generator.state


@pytest.mark.parametrize('travel', [1.0, 0.0, -2.0])
@pytest.mark.parametrize('variance', [0.0, 1e-9, 0.1])
def test_one_normal_is_drawn_whatever_the_travel_and_the_slip(travel, variance):
    generator, other = np.random.default_rng(5), np.random.default_rng(5)
    sample_travel(WheelSlip(variance=variance), travel, generator)
    other.standard_normal()
    assert generator.bit_generator.state == other.bit_generator.state


@pytest.mark.parametrize(('nominal', 'effective', 'ratio'), [
    (2.0, 2.2, 1.1), (-2.0, -1.0, 0.5), (2.0, 0.0, 0.0), (0.0, 0.0, 1.25), (0.0, 0.3, 1.25),
    (0.04, -5.0, 1.25),  # sigma = sqrt(0.01 * 0.04) = 0.02 is half of 0.04: unknown
    (0.041, 0.0205, 0.5)])
def test_the_ratio_is_effective_over_nominal_and_the_bias_where_that_is_unknown(
        nominal, effective, ratio):
    assert effective_ratio(WheelSlip(0.25, 0.01), nominal, effective) == pytest.approx(ratio)


@pytest.mark.parametrize(('values', 'name'), [
    ((-1.0, 0.0), 'bias'), ((math.nan, 0.0), 'bias'), ((math.inf, 0.0), 'bias'),
    ((0.0, -1e-9), 'slip variance'), ((0.0, math.nan), 'slip variance'),
    ((0.0, math.inf), 'slip variance'), ((0.0, 0.0, 'Travel'), 'slip model'),
    ((0.0, 0.0, 'travel', 'normal'), 'slip distribution')])
def test_bad_values_are_refused_by_name(values, name):
    with pytest.raises(ValueError, match=f'^{name} is'):
        WheelSlip(*values)


def test_gaussian_slip_with_travel_is_the_default():
    assert WheelSlip() == WheelSlip(0.0, 0.0, 'travel', 'gaussian')
