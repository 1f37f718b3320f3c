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
Belief against sampled truth on courses of 20 m, up to a yaw standard deviation of 0.3 rad.

NEES is that of the second moment about the published pose, so its mean is 3 whatever the errors'
distribution; how far a mean of 1,000 runs may be from it follows from their own scatter.
"""

import math

from diffdrive_kinematics.core.kinematics import (
    advance, Pose, pose_change_from_travel, WheelGeometry)
from diffdrive_kinematics.core.noise import (
    CERTAIN, NO_COVARIANCE, propagated_covariance, propagated_moments, sample_travel, WheelSlip)
import numpy as np
import pytest

GEOMETRY = WheelGeometry(0.2, 0.05)
ORIGIN = Pose(0.0, 0.0, 0.0)
RUNS, STEP = 1_000, 0.1  # of a wheel [m]: then a step has 1 / (4 n^2) too little across, n = 200


def travel_of(distance, turn):
    """Return (d_l, d_r) of an arc."""
    return distance - 0.5 * turn * GEOMETRY.separation, distance + 0.5 * turn * GEOMETRY.separation


TURN = travel_of(0.0, 0.5 * math.pi)
COURSES = {  # of 20 m each
    'straight': [travel_of(20.0, 0.0)],
    'slalom': [travel_of(1.0, sign * 1.5) for sign in (1, -1, -1, 1) * 5],
    'circle': [travel_of(10.0, math.pi)] * 2,
    'square': [travel_of(5.0, 0.0), TURN] * 4,
    'lawnmower': [leg for sign in (1, -1) * 2 for leg in (
        travel_of(4.0, 0.0), travel_of(0.0, sign * 0.5 * math.pi), travel_of(1.0, 0.0),
        travel_of(0.0, sign * 0.5 * math.pi))]}


def slip_for(course, yaw):
    """Return the k [m] of both wheels that gives a final yaw standard deviation [rad]."""
    return yaw**2 / sum(
        abs(d_left) + abs(d_right) for d_left, d_right in COURSES[course]) * 0.2**2


def believed(course, k):
    """Return the published pose and its moments."""
    pose, moments = ORIGIN, CERTAIN
    for d in COURSES[course]:
        pose, moments = propagated_moments(moments, pose, GEOMETRY, *d, k, k)
    return pose, moments


def sampled(course, k, runs, seed):
    """Return the ends of runs (x, y, theta), shape (runs, 3)."""
    generator, slip = np.random.default_rng(seed), WheelSlip(variance=k)
    truth = Pose(*np.zeros((3, runs)))
    for d in COURSES[course]:
        steps = math.ceil(max(map(abs, d)) / STEP)
        nominal = [np.full(runs, way / steps) for way in d]
        for _ in range(steps):
            travel = (sample_travel(slip, way, generator) for way in nominal)
            truth = advance(truth, *pose_change_from_travel(GEOMETRY, *travel))
    return np.column_stack(truth)


def nees(error, covariance):
    """Return ``e^T P^-1 e / 3`` of each run."""
    return np.sum(error @ np.linalg.inv(covariance.matrix()) * error, axis=1) / 3.0


@pytest.mark.parametrize('yaw', [0.02, 0.1, 0.2, 0.3])
@pytest.mark.parametrize('course', COURSES)
def test_nees_is_1_per_degree_of_freedom(course, yaw):
    k = slip_for(course, yaw)
    pose, moments = believed(course, k)
    assert math.sqrt(moments.spread.tt) == pytest.approx(yaw, rel=1e-9)
    found = nees(sampled(course, k, RUNS, 1) - np.array(pose), moments.second_moment())
    assert abs(found.mean() - 1.0) < 4.0 * found.std() / math.sqrt(RUNS)


@pytest.mark.parametrize(('course', 'yaw'), [('straight', 0.1), ('slalom', 0.3), ('square', 0.3)])
def test_mean_and_moments_are_those_of_many_runs(course, yaw):
    k = slip_for(course, yaw)
    pose, moments = believed(course, k)
    error = sampled(course, k, 20_000, 2) - np.array(pose)
    mean = error.mean(axis=0)
    far = np.abs(mean - np.array([moments.mean_error.real, moments.mean_error.imag, 0.0]))
    assert np.all(far < 4.0 * error.std(axis=0) / math.sqrt(20_000))
    expected = moments.second_moment().matrix()
    scale = np.sqrt(np.diag(expected))
    products = error[:, :, None] * error[:, None, :]
    assert np.all(np.abs(products.mean(axis=0) - expected)
                  < 4.0 * products.std(axis=0) / math.sqrt(20_000) + 1e-3 * np.outer(scale, scale))


def test_first_order_is_found_out_on_the_straight():
    """Guard the power of the tests: 21 and more where 1 is right."""
    k = slip_for('straight', 0.1)
    pose, covariance = propagated_covariance(
        NO_COVARIANCE, ORIGIN, GEOMETRY, *COURSES['straight'][0], k, k)
    assert nees(sampled('straight', k, RUNS, 1) - np.array(pose), covariance).mean() > 15.0
