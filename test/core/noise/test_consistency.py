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

"""
Belief against sampled truth: the mean and the covariance are those of many runs.

The truth is sampled with the package's noise and its exact arc, in steps so fine that the number
of them no longer counts (a straight path of n steps has 1 / (4 n^2) too little variance across).
It knows nothing of the covariance.
"""

import math
from typing import NamedTuple

from diffdrive_kinematics.core.kinematics import (
    advance, Pose, pose_change_from_travel, WheelGeometry, wrap_angle)
from diffdrive_kinematics.core.noise import (
    DISTRIBUTIONS, NO_COVARIANCE, propagated_covariance, sample_travel, WheelSlip)
import numpy as np
import pytest

GEOMETRY = WheelGeometry(0.4, 0.1)
START = Pose(1.0, -2.0, math.pi)  # truth falls on both sides of the wrap
STEPS = 50  # of a leg
CHI2_3 = 16.27  # of 99.9 %, with 3 degrees of freedom
CHI2_6 = 22.46
MEAN_NEES_OF_1000 = (2.75, 3.26)  # chi^2 of 3000 degrees of freedom over 1000, 99.9 %


def arc(distance, turn):
    half = 0.5 * turn * GEOMETRY.separation
    return distance - half, distance + half


COURSES = {
    'straight': [arc(4.0, 0.0)],
    'circle': [arc(0.5 * math.pi, math.pi)] * 2,
    'square': [arc(1.0, 0.0), arc(0.0, 0.5 * math.pi)] * 4,
    'figure_eight': [arc(0.5 * math.pi, math.pi)] * 2 + [arc(0.5 * math.pi, -math.pi)] * 2,
    'turn_in_place': [arc(0.0, math.pi)] * 3,
    'reverse': [arc(-1.5, 0.0), arc(-1.0, -0.8), arc(-0.5, 0.0)]}
EVERY = pytest.mark.parametrize('course', COURSES)


class Belief(NamedTuple):
    """What is believed after a course: pose, (3, 3) covariance."""

    pose: Pose
    covariance: np.ndarray


def believed(legs, left, right):
    """Return the belief after a course whose bias is known (calibrated)."""
    pose, covariance = START, NO_COVARIANCE
    for d_left, d_right in legs:
        pose, covariance = propagated_covariance(
            covariance, pose, GEOMETRY,
            (1.0 + left.bias) * d_left, (1.0 + right.bias) * d_right,
            left.variance / (1.0 + left.bias), right.variance / (1.0 + right.bias))
    return Belief(pose, covariance.matrix())


def errors(legs, left, right, runs, seed):
    """Return truth minus belief of every run, shape (runs, 3), the angle wrapped."""
    generator = np.random.default_rng(seed)
    truth = Pose(*(np.full(runs, value) for value in START))
    for d_left, d_right in legs:
        nominal = np.full((STEPS, runs), 1.0 / STEPS)
        travel = zip(sample_travel(left, d_left * nominal, generator),
                     sample_travel(right, d_right * nominal, generator))
        for step in travel:
            truth = advance(truth, *pose_change_from_travel(GEOMETRY, *step))
    pose = believed(legs, left, right).pose
    return np.column_stack([
        truth.x - pose.x, truth.y - pose.y,
        wrap_angle(wrap_angle(truth.theta) - wrap_angle(pose.theta))])


def whitened(error, covariance):
    """Return errors that are independent, with variance 1, if the covariance is right."""
    return np.linalg.solve(np.linalg.cholesky(covariance), error.T).T


def mean_statistic(white):
    """Return ``N m^T P^-1 m``, chi^2 with 3 degrees of freedom."""
    return len(white) * float(np.sum(np.mean(white, axis=0)**2))


def covariance_statistic(white):
    """Return ``N / 2 tr((S - I)^2)``, chi^2 with 6 degrees of freedom for large N."""
    return 0.5 * len(white) * float(np.sum((np.cov(white.T) - np.eye(3))**2))


def mean_nees(white):
    """Return the mean of ``e^T P^-1 e``."""
    return float(np.mean(np.sum(white**2, axis=1)))


def assert_consistent(course, left, right, runs, seed):
    legs = COURSES[course]
    white = whitened(errors(legs, left, right, runs, seed), believed(legs, left, right).covariance)
    assert mean_statistic(white) < CHI2_3
    assert covariance_statistic(white) < CHI2_6
    return white


@EVERY
def test_mean_and_covariance_are_those_of_20000_sampled_runs(course):
    """Keep slip so low that the propagation is linear: the formula alone is tested."""
    assert_consistent(course, WheelSlip(0.0, 2e-10), WheelSlip(0.0, 1e-10), 20_000, seed=1)


@EVERY
def test_the_belief_is_consistent_over_1000_runs(course):
    """Take the slip of a hard floor, sqrt(k) = 0.0005 and 0.0006 sqrt(m)."""
    white = assert_consistent(course, WheelSlip(0.0, 36e-8), WheelSlip(0.0, 25e-8), 1_000, seed=2)
    low, high = MEAN_NEES_OF_1000
    assert low < mean_nees(white) < high


@pytest.mark.parametrize('distribution', DISTRIBUTIONS)
def test_every_distribution_has_the_covariance_of_its_variance(distribution):
    slip = WheelSlip(0.0, 1e-10, 'travel', distribution)
    assert_consistent('square', slip, slip, 20_000, seed=3)


@EVERY
def test_a_known_bias_moves_the_mean_and_the_covariance_is_about_it(course):
    assert_consistent(
        course, WheelSlip(0.1, 1e-10), WheelSlip(-0.05, 2e-10), 20_000, seed=4)


def test_an_unknown_bias_is_found_out():
    """Guard the power of the tests: 0.1 % of one wheel that the belief does not know."""
    legs, slip = COURSES['straight'], WheelSlip(0.0, 1e-7)
    error = errors(legs, WheelSlip(0.001, 1e-7), slip, 1_000, seed=5)
    biased = believed(legs, WheelSlip(0.001, 1e-7), slip).pose
    error = error + (np.array(biased) - np.array(believed(legs, slip, slip).pose))
    white = whitened(error, believed(legs, slip, slip).covariance)
    assert mean_statistic(white) > CHI2_3


@pytest.mark.parametrize('factor', [0.75, 1.33])
def test_a_slip_variance_that_is_off_by_a_quarter_is_found_out(factor):
    legs, slip = COURSES['square'], WheelSlip(0.0, 1e-7)
    wrong = WheelSlip(0.0, factor * 1e-7)
    white = whitened(
        errors(legs, slip, slip, 1_000, seed=6), believed(legs, wrong, wrong).covariance)
    assert covariance_statistic(white) > CHI2_6
    assert not MEAN_NEES_OF_1000[0] < mean_nees(white) < MEAN_NEES_OF_1000[1]


def slip_for(course, yaw):
    """Return the slip that gives a course a final yaw standard deviation [rad]."""
    unit = WheelSlip(0.0, 1.0)
    return WheelSlip(0.0, yaw**2 / believed(COURSES[course], unit, unit).covariance[2, 2])


@pytest.mark.parametrize(('course', 'yaw'), [
    ('straight', 0.01), ('reverse', 0.01), ('circle', 0.05), ('square', 0.1),
    ('figure_eight', 0.2), ('turn_in_place', 0.2)])
def test_the_belief_is_consistent_over_1000_runs_up_to_this_yaw(course, yaw):
    """
    Note how far the linear propagation of a course carries.

    What breaks it is not the yaw alone but the way that it pose_jacobians: a closed course stays
    consistent further than a straight of ten wheel separations, whose variance along the track
    is small.
    """
    slip = slip_for(course, yaw)
    low, high = MEAN_NEES_OF_1000
    assert low < mean_nees(assert_consistent(course, slip, slip, 1_000, seed=2)) < high


@pytest.mark.parametrize('course', ['circle', 'square', 'figure_eight', 'turn_in_place'])
def test_the_covariance_of_a_closed_course_holds_up_to_a_yaw_of_0_2_rad(course):
    slip = slip_for(course, 0.2)
    white = whitened(
        errors(COURSES[course], slip, slip, 1_000, seed=8),
        believed(COURSES[course], slip, slip).covariance)
    assert covariance_statistic(white) < CHI2_6


@pytest.mark.slow
def test_a_straight_goes_wrong_along_the_track_as_the_documentation_says():
    """Var x is 1 + d^2 s^2 / (3 L^2) times as large, and x short by d s / (2 L) of its sigma."""
    slip = slip_for('straight', 0.1)
    error = -errors(COURSES['straight'], slip, slip, 50_000, seed=9)  # heading pi
    covariance = believed(COURSES['straight'], slip, slip).covariance
    assert np.var(error[:, 0]) / covariance[0, 0] == pytest.approx(1.0 + 1.0 / 3.0, abs=0.03)
    assert np.mean(error[:, 0]) / math.sqrt(covariance[0, 0]) == pytest.approx(-0.5, abs=0.03)


@EVERY
def test_the_yaw_is_exact_up_to_a_standard_deviation_of_0_2_rad(course):
    slip = slip_for(course, 0.2)
    yaw = errors(COURSES[course], slip, slip, 20_000, seed=7)[:, 2]
    assert abs(np.mean(yaw)) < 3.29 * 0.2 / math.sqrt(20_000)
    assert np.var(yaw) / 0.04 == pytest.approx(1.0, abs=3.29 * math.sqrt(2.0 / 20_000))
