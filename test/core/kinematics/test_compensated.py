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

"""A running sum keeps what rounding takes."""

from fractions import Fraction
import math

from diffdrive_kinematics.core.kinematics import RunningSum
from hypothesis import given, strategies as st
import pytest


def summed(terms, start=0.0):
    total = RunningSum(start)
    for term in terms:
        total = total.plus(term)
    return total


@given(st.floats(-1e12, 1e12), st.floats(-1e12, 1e12))
def test_a_single_addition_loses_nothing(a, b):
    total = RunningSum(a).plus(b)
    assert Fraction(total.high) + Fraction(total.low) == Fraction(a) + Fraction(b)


@given(st.lists(st.floats(-1e6, 1e6), max_size=60))
def test_a_sum_is_right_to_the_last_digit_also_where_it_cancels(terms):
    magnitude = math.fsum(abs(term) for term in terms)
    exact = math.fsum(terms)
    assert abs(summed(terms).value - exact) <= math.ulp(exact) + 1e-29 * magnitude


def test_the_value_is_the_rounded_sum_of_its_parts():
    total = summed([0.1] * 1000)
    assert total.low != 0.0
    assert total.value == total.high == total.high + total.low


def test_a_long_sum_of_small_terms_stays_exact_where_a_plain_sum_drifts():
    """Guard the wheel angles of a long drive, 50 messages a second."""
    step, steps = 0.02 * 7.3, 200_000
    exact = steps * step
    naive = 0.0
    for _ in range(steps):
        naive += step
    assert abs(naive - exact) > 1e-9
    assert abs(summed([step] * steps).value - exact) <= math.ulp(exact)


def test_terms_below_the_last_digit_are_not_lost():
    assert summed([1e-17] * 1000, start=1.0).value == pytest.approx(1.0 + 1e-14, abs=2.3e-16)
