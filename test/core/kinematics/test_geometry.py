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

"""Forward and inverse kinematics undo each other, and the turning centre stands still."""

from dataclasses import FrozenInstanceError
import math

from diffdrive_kinematics.core.kinematics import (
    advance, inverse_jacobian, jacobian, Pose, pose_change_from_travel, travel_from_angles,
    turning_centre, turning_radius, twist_from_wheel_rates, wheel_rates_from_twist, WheelGeometry)
from hypothesis import assume, given, strategies as st
import numpy as np
import pytest

multipliers = st.floats(0.5, 2.0)
geometries = st.builds(
    WheelGeometry, wheel_separation=st.floats(0.05, 5.0), wheel_radius=st.floats(0.01, 1.0),
    wheel_separation_multiplier=multipliers, left_wheel_radius_multiplier=multipliers,
    right_wheel_radius_multiplier=multipliers)
rates = st.floats(-100.0, 100.0)
rate_arrays = st.lists(st.tuples(rates, rates), min_size=1, max_size=9).map(
    lambda pairs: np.array(pairs).T)
poses = st.builds(
    Pose, st.floats(-10.0, 10.0), st.floats(-10.0, 10.0), st.floats(-math.pi, math.pi))
SMALL = WheelGeometry(wheel_separation=0.5, wheel_radius=0.1)


@given(geometries, rates, rates)
def test_inverse_after_forward_kinematics_is_identity(geometry, left, right):
    twist = twist_from_wheel_rates(geometry, left, right)
    assert wheel_rates_from_twist(geometry, *twist) == pytest.approx((left, right), abs=1e-12)


@given(geometries, st.floats(-10.0, 10.0), st.floats(-10.0, 10.0))
def test_forward_after_inverse_kinematics_is_identity(geometry, v, w):
    wheels = wheel_rates_from_twist(geometry, v, w)
    assert twist_from_wheel_rates(geometry, *wheels) == pytest.approx((v, w), abs=1e-12)


@given(geometries, rate_arrays)
def test_arrays_convert_like_each_element_and_back(geometry, wheels):
    kept = wheels.copy()
    v, w = twist_from_wheel_rates(geometry, *wheels)
    alone = [twist_from_wheel_rates(geometry, *pair) for pair in wheels.T.tolist()]
    np.testing.assert_array_equal(np.array([v, w]).T, alone)
    np.testing.assert_allclose(wheel_rates_from_twist(geometry, v, w), wheels, atol=1e-12)
    np.testing.assert_array_equal(wheels, kept, 'the argument was written')


def test_shapes_that_broadcast_are_converted_together():
    v, w = twist_from_wheel_rates(SMALL, np.ones((4, 1)), np.zeros(3))
    assert v.shape == w.shape == (4, 3)


@given(geometries, rates, rates)
def test_the_jacobian_times_the_rates_is_the_twist(geometry, left, right):
    np.testing.assert_allclose(
        jacobian(geometry) @ [left, right], twist_from_wheel_rates(geometry, left, right),
        rtol=1e-12, atol=1e-11)


@given(geometries, st.floats(-10.0, 10.0), st.floats(-10.0, 10.0))
def test_the_inverse_jacobian_times_the_twist_is_the_rates(geometry, v, w):
    np.testing.assert_allclose(
        inverse_jacobian(geometry) @ [v, w], wheel_rates_from_twist(geometry, v, w),
        rtol=1e-12, atol=1e-11)


@given(geometries)
def test_the_jacobians_are_inverse_to_each_other(geometry):
    np.testing.assert_allclose(
        jacobian(geometry) @ inverse_jacobian(geometry), np.eye(2), atol=1e-13)
    np.testing.assert_allclose(
        inverse_jacobian(geometry) @ jacobian(geometry), np.eye(2), atol=1e-13)


def test_with_equal_radii_the_jacobian_is_that_of_the_textbook():
    np.testing.assert_allclose(
        jacobian(SMALL), 0.1 * np.array([[0.5, 0.5], [-1.0 / 0.5, 1.0 / 0.5]]), rtol=1e-15)


@pytest.mark.parametrize(('left', 'right', 'v', 'w'), [
    (10.0, 10.0, 1.0, 0.0), (0.0, 10.0, 0.5, 2.0), (10.0, 0.0, 0.5, -2.0),
    (-10.0, 10.0, 0.0, 4.0), (-10.0, -10.0, -1.0, 0.0)])
def test_forward_is_positive_and_counter_clockwise_is_positive(left, right, v, w):
    """R = 0.1, L = 0.5: v = 0.1 (l + r) / 2, w = 0.1 (r - l) / 0.5."""
    assert twist_from_wheel_rates(SMALL, left, right) == pytest.approx((v, w), abs=1e-15)


def test_each_multiplier_scales_its_own_length():
    geometry = WheelGeometry(0.5, 0.1, 2.0, 3.0, 4.0)
    assert (geometry.separation, geometry.left_radius, geometry.right_radius) == pytest.approx(
        (1.0, 0.3, 0.4))


@given(geometries, rates, rates, st.floats(0.0, 10.0))
def test_travel_over_a_time_is_the_twist_times_the_time(geometry, left, right, seconds):
    travel = travel_from_angles(geometry, left * seconds, right * seconds)
    v, w = twist_from_wheel_rates(geometry, left, right)
    assert pose_change_from_travel(geometry, *travel) == pytest.approx(
        (v * seconds, w * seconds), rel=1e-12, abs=1e-10)


@given(geometries, poses, st.floats(-2.0, 2.0), st.sampled_from([1.0, -1.0]))
def test_one_wheel_stopped_turns_about_that_wheel(geometry, pose, travel, side):
    """``side`` is +1 where the left wheel stands: it is half a separation to the left."""
    def standing_wheel(at):
        lever = 0.5 * side * geometry.separation
        return at.x - lever * math.sin(at.theta), at.y + lever * math.cos(at.theta)

    assume(abs(travel) > 1e-6)
    travels = (0.0, travel) if side > 0.0 else (travel, 0.0)
    moved = advance(pose, *pose_change_from_travel(geometry, *travels))
    assert standing_wheel(moved) == pytest.approx(standing_wheel(pose), abs=1e-12)
    assert turning_centre(geometry, pose, *travels) == pytest.approx(
        standing_wheel(pose), abs=1e-12)


@given(geometries, poses, st.floats(0.01, 2.0))
def test_equal_and_opposite_travel_turns_in_place(geometry, pose, travel):
    distance, turn = pose_change_from_travel(geometry, -travel, travel)
    assert distance == 0.0
    assert turn == pytest.approx(2.0 * travel / geometry.separation)
    assert advance(pose, distance, turn)[:2] == pose[:2]
    assert turning_radius(geometry, -travel, travel) == 0.0
    assert turning_centre(geometry, pose, -travel, travel) == pose[:2]


@given(geometries, poses, st.floats(-2.0, 2.0), st.floats(-2.0, 2.0))
def test_the_turning_centre_is_one_radius_from_the_start_and_from_the_end(
        geometry, pose, left, right):
    assume(abs(right - left) > 1e-3)
    radius = turning_radius(geometry, left, right)
    centre = turning_centre(geometry, pose, left, right)
    moved = advance(pose, *pose_change_from_travel(geometry, left, right))
    assert math.dist(centre, pose[:2]) == pytest.approx(abs(radius), abs=1e-11)
    assert math.dist(centre, moved[:2]) == pytest.approx(abs(radius), rel=1e-9, abs=1e-9)
    assert turning_centre(geometry, moved, left, right) == pytest.approx(
        centre, rel=1e-9, abs=1e-9)


@given(geometries, rates, rates)
def test_speed_is_yaw_rate_times_turning_radius(geometry, left, right):
    speeds = travel_from_angles(geometry, left, right)
    assume(abs(speeds[1] - speeds[0]) > 1e-6)
    v, w = twist_from_wheel_rates(geometry, left, right)
    assert w * turning_radius(geometry, *speeds) == pytest.approx(v, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize(('d_left', 'd_right', 'radius'), [
    (1.0, 3.0, 0.5),  # 0.5 * 4 / (2 * 2): the centre is to the left
    (3.0, 1.0, -0.5),  # mirrored: to the right
    (-1.0, -3.0, 0.5),  # in reverse about the same centre
    (0.0, 1.0, 0.25), (1.0, 0.0, -0.25), (-1.0, 1.0, 0.0),
    (1.0, 1.0, math.inf), (-2.0, -2.0, math.inf)])
def test_the_turning_radius_by_hand(d_left, d_right, radius):
    """``r_c = L (d_l + d_r) / (2 (d_r - d_l))`` with L = 0.5."""
    assert turning_radius(SMALL, d_left, d_right) == pytest.approx(radius, abs=1e-15)


def test_parallel_travel_has_its_centre_at_infinity():
    centre = turning_centre(SMALL, Pose(1.0, 2.0, 1.0), 0.7, 0.7)
    assert centre == (-math.inf, math.inf)


@pytest.mark.parametrize('function', [
    turning_radius, lambda geometry, *travel: turning_centre(geometry, Pose(0., 0., 0.), *travel)])
@pytest.mark.parametrize(('travel', 'message'), [
    ((0.0, 0.0), 'd_left and d_right are 0'), ((math.nan, 1.0), 'd_left is nan'),
    ((1.0, math.inf), 'd_right is inf')])
def test_wheels_at_rest_or_not_finite_have_no_turning_radius(function, travel, message):
    with pytest.raises(ValueError, match=message):
        function(SMALL, *travel)


FIELDS = (
    'wheel_separation', 'wheel_radius', 'wheel_separation_multiplier',
    'left_wheel_radius_multiplier', 'right_wheel_radius_multiplier')


@pytest.mark.parametrize('name', FIELDS)
@pytest.mark.parametrize('value', [0.0, -1.0, math.nan, math.inf])
def test_a_length_or_factor_that_is_not_finite_and_positive_is_refused_by_name(name, value):
    with pytest.raises(ValueError, match=f'^{name} is {value!r}'):
        WheelGeometry(**{'wheel_separation': 0.5, 'wheel_radius': 0.1, name: value})


@pytest.mark.parametrize('multiplier', FIELDS[2:])
@pytest.mark.parametrize('extreme', [1e-200, 1e-6, 1e8, 1e200])
def test_an_effective_length_that_no_robot_has_is_refused(multiplier, extreme):
    with pytest.raises(ValueError, match=rf'\* {multiplier} is .* from 1e-6 to 1e6 m'):
        WheelGeometry(0.5, 0.1, **{multiplier: extreme})


def test_a_geometry_is_a_frozen_value():
    with pytest.raises(FrozenInstanceError):
        SMALL.wheel_radius = 0.2
    assert SMALL == WheelGeometry(0.5, 0.1)
    assert hash(SMALL) == hash(WheelGeometry(0.5, 0.1))
