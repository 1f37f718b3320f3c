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

"""The wrap convention is (-pi, pi], exactly."""

from fractions import Fraction
import math

from diffdrive_kinematics.core.kinematics import wrap_angle
from hypothesis import given, strategies as st
import numpy as np
import pytest

angles = st.floats(-1e9, 1e9)


@pytest.mark.parametrize(('angle', 'wrapped'), [
    (math.pi, math.pi), (-math.pi, math.pi), (0.0, 0.0), (math.tau, 0.0), (-math.tau, 0.0),
    (math.nextafter(math.pi, 4.0), math.nextafter(math.pi, 4.0) - math.tau),
    (math.nextafter(-math.pi, 0.0), math.nextafter(-math.pi, 0.0))])
def test_the_range_is_open_at_minus_pi_and_closed_at_pi(angle, wrapped):
    assert wrap_angle(angle) == wrapped
    assert wrap_angle(np.array([angle])) == np.array([wrapped])


@given(angles)
def test_a_wrapped_angle_is_in_range_and_whole_turns_away_without_rounding(angle):
    wrapped = wrap_angle(angle)
    assert -math.pi < wrapped <= math.pi
    turns = (Fraction(angle) - Fraction(wrapped)) / Fraction(math.tau)
    assert turns.denominator == 1


@given(st.floats(-math.pi, math.pi, exclude_min=True))
def test_an_angle_in_range_keeps_every_bit(angle):
    assert wrap_angle(angle) == angle


@given(st.lists(angles))
def test_an_array_is_wrapped_like_its_elements(values):
    array = np.array(values, dtype=float)
    assert wrap_angle(array).tolist() == [wrap_angle(value) for value in values]
    assert array.tolist() == values, 'the argument must not be written'
