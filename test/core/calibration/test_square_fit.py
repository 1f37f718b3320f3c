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

"""Few runs around a square: standard errors, corrections that are none, predicted errors."""

import math

from diffdrive_kinematics.core.calibration import fit_squares, ReturnError
from diffdrive_kinematics.core.calibration.calibration_parameters import (
    share_within, student_quantile)
from diffdrive_kinematics.core.kinematics import Command, Pose, pose_after, WheelGeometry
import mpmath
import numpy as np
import pytest

NOMINAL = WheelGeometry(0.2, 0.05)
SIDE, K = 2.0, 1e-6
E_B, E_D = 1.02, 1.01
SEEDS, FEWER_SEEDS, PARTS = 2000, 500, 5
Z = 3.2905  # of 99.9 %, two-sided
FEW = [3, 2, 4, 5]


def return_errors(generator, e_b, e_d, runs, clockwise, k=K):
    """Return where runs end whose odometry returns, of robots (s,), shape (s, runs, 2)."""
    e_b, e_d = np.reshape(e_b, (-1, 1)), np.reshape(e_d, (-1, 1))
    separation, turn = NOMINAL.separation, 0.25 * math.pi * NOMINAL.separation
    turn *= -1.0 if clockwise else 1.0
    at, heading = np.zeros((2, len(e_b), runs))
    at = at.astype(complex)
    for travels in 4 * [*PARTS * [(SIDE, SIDE)], *PARTS * [(-turn, turn)]]:
        left, right = (
            travel / PARTS * factor + math.sqrt(k * abs(travel) / PARTS)
            * generator.standard_normal(at.shape)
            for travel, factor in zip(travels, (2.0 / (1.0 + e_d), 2.0 * e_d / (1.0 + e_d))))
        turned = (right - left) / (separation * e_b)
        at += 0.5 * (left + right) * np.sinc(0.5 * turned / math.pi) * np.exp(
            1j * (heading + 0.5 * turned))
        heading = heading + turned
    return np.stack([at.real, at.imag], axis=-1)


def fits(generator, e_b, e_d, runs, k=K):
    """Return the fit for each robot, and E_max,syst of its runs."""
    both = [return_errors(generator, e_b, e_d, runs, way, k) for way in (True, False)]
    found = [fit_squares(NOMINAL, SIDE, *([ReturnError(*run) for run in way] for way in pair))
             for pair in zip(*(errors.tolist() for errors in both))]
    return found, largest(both)


def largest(both):
    """Return E_max,syst of the runs of both directions, shape (s,)."""
    return np.maximum(*(np.hypot(*errors.mean(axis=1).T) for errors in both))


def left_over(found, e_b, e_d):
    """Return the E_b and E_d that odometry is wrong by with the corrected geometry."""
    after = [each.geometry for each in found]
    return (e_b / np.array([each.wheel_separation_multiplier for each in after]),
            e_d / np.array([each.right_wheel_radius_multiplier / each.left_wheel_radius_multiplier
                            for each in after]))


def assert_student(found, name, truth, runs):
    """Compare the share within Student's t of 95 % with its sampling error of 99.9 %."""
    value, error = np.array([getattr(each.umbmark, name) for each in found]).T
    share = np.mean(np.abs(value - truth) / error < student_quantile(0.95, 2 * runs - 2))
    assert abs(share - 0.95) < Z * math.sqrt(0.95 * 0.05 / len(found)), (name, share)


def rms(values):
    """Return the root mean square."""
    return float(np.sqrt(np.mean(np.square(values))))


@pytest.mark.parametrize('degrees', [1, 2, 3, 4, 7, 8, 30])
def test_student_is_that_of_the_incomplete_beta_function(degrees):
    for t in (0.1, 1.0, 2.776, 12.0):
        exact = mpmath.betainc(
            0.5, 0.5 * degrees, 0.0, t**2 / (degrees + t**2), regularized=True)
        assert share_within(t, degrees) == pytest.approx(float(exact), abs=1e-14)
        if 1.0 - exact > 1e-6:  # else the share has too few digits
            assert student_quantile(float(exact), degrees) == pytest.approx(t, rel=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize('runs', FEW)
def test_standard_errors_of_few_runs_cover_as_student_says_and_the_prediction_comes_true(runs):
    # In two passes: of wheels that are 1 % and 2 % off, and of what the first pass left.
    generator, e_b, e_d = np.random.default_rng(runs), np.full(SEEDS, E_B), np.full(SEEDS, E_D)
    before = None
    for number in range(2):
        found, measured = fits(generator, e_b, e_d, runs)
        if before is not None:
            assert rms(before) / rms(measured) == pytest.approx(1.0, abs=0.1)
        assert_student(found, 'separation_ratio', e_b, runs)
        assert_student(found, 'diameter_ratio', e_d, runs)
        before, (e_b, e_d) = [each.predicted_error for each in found], left_over(found, e_b, e_d)
    both = [return_errors(generator, e_b, e_d, runs, way) for way in (True, False)]
    assert 0.9 < rms(before) / rms(largest(both)) < 1.45


def test_wheels_that_are_right_are_left_alone_in_95_of_100_calibrations():
    found, _ = fits(np.random.default_rng(1), np.ones(FEWER_SEEDS), np.ones(FEWER_SEEDS), 3)
    bound = Z * math.sqrt(0.95 * 0.05 / FEWER_SEEDS)
    for counts, names in (
            ('separation_counts', ['wheel_separation_multiplier']),
            ('diameters_count', ['left_wheel_radius_multiplier',
                                 'right_wheel_radius_multiplier'])):
        alone = np.array([not getattr(each, counts) for each in found])
        assert abs(alone.mean() - 0.95) < bound
        for name in names:
            same = [getattr(each.geometry, name) == getattr(NOMINAL, name) for each in found]
            assert (np.array(same) == alone).all()


@pytest.mark.parametrize('corner_radius', [0.0, 0.4])
def test_large_errors_without_slip_are_found_in_one_pass(corner_radius):
    true = WheelGeometry(0.2, 0.05, wheel_separation_multiplier=1.05,
                         left_wheel_radius_multiplier=0.985, right_wheel_radius_multiplier=1.015)
    ends = []
    for way in (-1.0, 1.0):
        believed = 4 * [(SIDE - 2.0 * corner_radius, 0.0),
                        (0.5 * math.pi * corner_radius, way * 0.5 * math.pi)]
        motion = []
        for along, turn in believed:
            left, right = ((along + side * turn * 0.1) * multiplier for side, multiplier in (
                (-1.0, 0.985), (1.0, 1.015)))
            motion.append(Command(0.5 * (left + right), (right - left) / true.separation, 1.0))
        end = pose_after(Pose(0.0, 0.0, 0.0), motion)
        ends.append([ReturnError(float(end.x), float(end.y))] * 2)
    found = fit_squares(NOMINAL, SIDE, *ends, corner_radius=corner_radius)
    assert found.geometry.wheel_separation_multiplier == pytest.approx(1.05, rel=1e-9)
    assert found.geometry.left_wheel_radius_multiplier == pytest.approx(0.985, rel=1e-9)
    assert found.geometry.right_wheel_radius_multiplier == pytest.approx(1.015, rel=1e-9)
    assert found.umbmark.error_after < 1e-8 and found.predicted_error < 1e-8


def test_runs_that_no_wheels_explain_are_refused():
    cw, ccw = ReturnError(-1.8, -1.8), ReturnError(-1.2, 1.2)
    with pytest.raises(ValueError, match='expected'):
        fit_squares(WheelGeometry(2.0, 0.05), 1.5, [cw] * 2, [ccw] * 2)
