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

"""Checks name the value, say what it is, and say what was expected."""

import math
import re

from diffdrive_kinematics.core.kinematics import (
    check_above, check_count, check_duration, check_finite, check_non_negative, check_positive,
    check_rate, is_sane, LARGEST)
import numpy as np
import pytest

NOT_FINITE = [math.nan, math.inf, -math.inf]


def above_minus_one(name, value):
    return check_above(name, value, -1.0)


@pytest.mark.parametrize(('check', 'good'), [
    (check_finite, [-1.0, 0.0, 1e308, 5e-324]),
    (check_positive, [5e-324, 1.0, 1e308]),
    (check_non_negative, [0.0, -0.0, 5e-324, 1e308]),
    (above_minus_one, [-0.999, 0.0, 1e308])])
def test_a_good_value_comes_back_as_the_same_float(check, good):
    assert [check('x', value) for value in good] == good


@pytest.mark.parametrize(('check', 'bad'), [
    (check_finite, []),
    (check_positive, [0.0, -0.0, -5e-324, -1.0]),
    (check_non_negative, [-5e-324, -1.0]),
    (above_minus_one, [-1.0, -2.0])])
def test_a_bad_value_is_refused_with_its_name_its_value_and_what_was_expected(check, bad):
    for value in NOT_FINITE + bad:
        with pytest.raises(ValueError) as error:
            check('the_name', value)
        assert 'the_name' in str(error.value)
        assert repr(value) in str(error.value)
        assert 'expected a finite number' in str(error.value)


@pytest.mark.parametrize(('check', 'low', 'high'), [
    (check_rate, 1e-6, 1e6), (check_duration, 0.0, 1e9)])
def test_rates_and_durations_have_a_range_with_its_ends(check, low, high):
    assert [check('x', value) for value in (low, 1.0, high)] == [low, 1.0, high]
    for bad in (*NOT_FINITE, math.nextafter(low, -1.0), math.nextafter(high, math.inf)):
        with pytest.raises(ValueError, match=f'^the_name is {re.escape(repr(bad))}, expected a'):
            check('the_name', bad)


@pytest.mark.parametrize(
    'check', [check_finite, check_positive, check_non_negative, above_minus_one])
def test_an_integer_is_accepted_and_becomes_a_float(check):
    assert type(check('x', 3)) is float


def test_a_count_comes_back_as_a_python_int_and_may_have_any_least_value():
    assert [check_count('n', value, -1) for value in (-1, 0, np.int8(3), 2**70)] == [
        -1, 0, 3, 2**70]
    assert type(check_count('n', np.uint8(64))) is int
    for bad in (-2, False, True, 0.0, None):
        with pytest.raises(ValueError, match=f'^n is {bad!r}, expected an integer, -1 or above$'):
            check_count('n', bad, -1)


def test_the_bound_is_named_where_there_is_one():
    with pytest.raises(ValueError, match='above -1.0'):
        above_minus_one('bias', -1.5)


@pytest.mark.parametrize('value', [0.0, LARGEST, -LARGEST])
def test_values_up_to_the_largest_are_sane(value):
    assert is_sane(value, 1.0)


@pytest.mark.parametrize(
    'value', [*NOT_FINITE, math.nextafter(LARGEST, math.inf), math.nextafter(-LARGEST, -math.inf)])
def test_one_value_that_is_not_sane_spoils_them_all(value):
    assert not is_sane(1.0, value)
    assert not is_sane(value, 1.0)
