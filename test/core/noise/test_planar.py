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

"""Poses and covariances that others give: what is taken, what is refused."""

import math

from diffdrive_kinematics.core.noise import (
    NO_COVARIANCE, planar_covariance, planar_pose, PoseCovariance, yaw_from_quaternion)
from hypothesis import given, strategies as st
import numpy as np
import pytest


def about_z(yaw, scale=1.0):
    return 0.0, 0.0, scale * math.sin(0.5 * yaw), scale * math.cos(0.5 * yaw)


def spatial(block):
    """Return the 36 numbers whose block of x, y and yaw is ``block``, the others being 7."""
    matrix = np.full((6, 6), 7.0)
    matrix[np.ix_((0, 1, 5), (0, 1, 5))] = block
    return matrix.flatten()


@given(st.floats(-math.pi, math.pi), st.floats(0.991, 1.009))
def test_the_yaw_of_a_turn_about_z_is_its_angle_whatever_small_error_its_length_has(yaw, scale):
    found = yaw_from_quaternion(about_z(yaw, scale))
    assert math.remainder(found - yaw, math.tau) == pytest.approx(0.0, abs=1e-15 * 8)


@given(*3 * [st.floats(-1.5, 1.5)])
def test_the_yaw_of_a_robot_that_is_not_level_is_the_direction_of_its_nose(yaw, pitch, roll):
    """Build the quaternion of yaw, pitch and roll, one after the other, from its definition."""
    (sy, cy), (sp, cp), (sr, cr) = (
        (math.sin(0.5 * angle), math.cos(0.5 * angle)) for angle in (yaw, pitch, roll))
    quaternion = (cy * cp * sr - sy * sp * cr, cy * sp * cr + sy * cp * sr,
                  sy * cp * cr - cy * sp * sr, cy * cp * cr + sy * sp * sr)
    assert yaw_from_quaternion(quaternion) == pytest.approx(yaw, abs=1e-9)


def test_a_covariance_that_is_symmetric_but_for_rounding_is_made_so():
    block = np.eye(3)
    block[0, 1], block[1, 0] = 0.5, 0.5 + 2e-9
    assert planar_covariance(spatial(block)).xy == pytest.approx(0.5 + 1e-9, abs=1e-15)


def test_both_signs_of_a_quaternion_are_one_rotation():
    assert yaw_from_quaternion((-0.0, 0.0, -math.sin(0.5), -math.cos(0.5))) == pytest.approx(1.0)


@pytest.mark.parametrize('quaternion', [
    (0.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.02), (0.0, 0.0, 0.0, 0.98), (1.0, 1.0, 1.0, 1.0),
    (0.0, 0.0, math.nan, 1.0), (0.0, math.inf, 0.0, 1.0)])
def test_what_is_no_rotation_is_refused(quaternion):
    with pytest.raises(ValueError, match='orientation .* expected a quaternion of length 1'):
        planar_pose(0.0, 0.0, quaternion)


@pytest.mark.parametrize('x, y', [(math.nan, 0.0), (0.0, math.inf), (1e13, 0.0)])
def test_a_position_that_is_not_finite_or_is_absurd_is_refused(x, y):
    with pytest.raises(ValueError, match='position'):
        planar_pose(x, y, about_z(0.0))


def test_the_block_of_x_y_and_yaw_is_taken_and_nothing_else():
    block = [[0.4, 0.1, -0.05], [0.1, 0.3, 0.02], [-0.05, 0.02, 0.2]]
    assert planar_covariance(spatial(block)) == PoseCovariance(0.4, 0.1, -0.05, 0.3, 0.02, 0.2)


def test_zeros_and_certain_directions_are_fine():
    assert planar_covariance([0.0] * 36) == NO_COVARIANCE
    assert planar_covariance(spatial(np.diag([1.0, 0.0, 1e-12]))).yy == 0.0


@given(st.lists(st.integers(-500, 500), min_size=9, max_size=9),  # variances up to 1e12
       st.lists(st.floats(-3.0, 3.0), min_size=3, max_size=3))
def test_every_covariance_is_taken_whatever_its_units(numbers, exponents):
    root = np.reshape(numbers, (3, 3)) * np.power(10.0, exponents)[:, None]
    block = root @ root.T
    assert planar_covariance(spatial(block)).matrix() == pytest.approx(block, rel=1e-12)


@pytest.mark.parametrize('block', [
    np.diag([-1.0, 1.0, 1.0]), np.diag([1.0, 1.0, -1e-9]),
    [[1.0, 2.0, 0.0], [2.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    [[1.0, 0.0, 0.002], [0.0, 1.0, 0.0], [0.002, 0.0, 1e-6]],
    [[1.0, 0.0, 0.0011], [0.0, 1.0, 0.0], [0.0011, 0.0, 1e-6]],
    [[0.0, 0.0, 0.1], [0.0, 1.0, 0.0], [0.1, 0.0, 1.0]],
    [[0.0, 0.0, 1e-4], [0.0, 1.0, 0.0], [1e-4, 0.0, 1.0]],
    [[1.0, 0.1, 0.0], [0.2, 1.0, 0.0], [0.0, 0.0, 1.0]],
    np.diag([math.nan, 1.0, 1.0]), np.diag([math.inf, 1.0, 1.0])])
def test_what_is_no_covariance_is_refused(block):
    with pytest.raises(ValueError, match=r'covariance of \(x, y, yaw\)'):
        planar_covariance(spatial(block))
