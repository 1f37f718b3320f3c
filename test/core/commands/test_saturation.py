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

"""Saturation scales both wheels by one factor."""

import math

from diffdrive_kinematics.core.commands import saturate
from diffdrive_kinematics.core.kinematics import turning_radius, WheelGeometry
from hypothesis import given, strategies as st
import pytest

rates = st.floats(-1e6, 1e6).filter(lambda rate: rate == 0.0 or abs(rate) > 1e-6)
bounds = st.floats(1e-3, 1e6)


@given(rates, rates, bounds)
def test_no_wheel_ever_exceeds_the_bound(left, right, bound):
    result = saturate(left, right, bound)
    assert abs(result.left) <= bound
    assert abs(result.right) <= bound
    assert 0.0 <= result.factor <= 1.0


@given(rates, rates, bounds)
def test_the_ratio_and_the_signs_of_the_rates_are_kept(left, right, bound):
    result = saturate(left, right, bound)
    assert result.left * right == pytest.approx(left * result.right, rel=1e-15)
    assert result.left == pytest.approx(left * result.factor, rel=1e-15)
    assert (math.copysign(1.0, result.left), math.copysign(1.0, result.right)) == (
        math.copysign(1.0, left), math.copysign(1.0, right))


@given(rates, rates, bounds)
def test_the_faster_wheel_is_at_the_bound_where_the_bound_cuts(left, right, bound):
    result = saturate(left, right, bound)
    peak = max(abs(left), abs(right))
    if peak > bound:
        assert result.factor < 1.0
        assert max(abs(result.left), abs(result.right)) == pytest.approx(bound, rel=1e-15)
    else:
        assert result == (left, right, 1.0)


@pytest.mark.parametrize(('left', 'right'), [(1.0, 3.0), (-30.0, 10.0), (0.0, 8.0)])
def test_the_turning_radius_is_kept(left, right):
    geometry = WheelGeometry(0.5, 0.1)
    result = saturate(left, right, 2.0)
    assert turning_radius(geometry, result.left, result.right) == pytest.approx(
        turning_radius(geometry, left, right), rel=1e-14)


@pytest.mark.parametrize('none', [math.nan, math.inf])
def test_nan_or_infinity_means_no_bound(none):
    assert saturate(-1e300, 2.0, none) == (-1e300, 2.0, 1.0)


@pytest.mark.parametrize(('left', 'right', 'bound', 'expected'), [
    (4.0, 8.0, 4.0, (2.0, 4.0, 0.5)),  # 8 -> 4 is a factor of 1/2
    (-8.0, 4.0, 4.0, (-4.0, 2.0, 0.5)),
    (0.0, 0.0, 4.0, (0.0, 0.0, 1.0)),
    (4.0, -4.0, 4.0, (4.0, -4.0, 1.0))])  # at the bound is within it
def test_examples_by_hand(left, right, bound, expected):
    assert saturate(left, right, bound) == expected


def test_the_last_digit_of_the_factor_does_not_pass_the_bound():
    """Guard a scaled peak that rounds to above the bound."""
    bound, rate = 2.8, 4.9
    assert rate * (bound / rate) > bound, 'the case that is guarded'
    assert saturate(rate, -rate, bound)[:2] == (bound, -bound)
