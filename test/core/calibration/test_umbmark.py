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

"""UMBmark: on robots whose true wheels differ from those that odometry believes in."""

from dataclasses import replace
from functools import lru_cache
import math

from diffdrive_kinematics.core.calibration import corrected, Estimate, ReturnError, umbmark
from diffdrive_kinematics.core.calibration import slip_fit
from diffdrive_kinematics.core.commands import square_course
from diffdrive_kinematics.core.kinematics import advance, Command, Pose, WheelGeometry
from diffdrive_kinematics.core.noise import sample_paths, WheelSlip
import mpmath
import numpy as np
import pytest

NOMINAL = WheelGeometry(0.2, 0.05)
LABMATE = WheelGeometry(0.34, 0.075)
SIDE = 2.0
RUNS, SEEDS = 5, 300
Z = 3.2905  # of 99.9 %, two-sided
ORIGIN = Pose(0.0, 0.0, 0.0)
FEW = [ReturnError(0.01, 0.02), ReturnError(0.02, 0.01)]


def robot(geometry, e_d, e_b):
    """Return the true geometry: wheels that differ by E_d about the same mean, b E_b apart."""
    return replace(geometry, wheel_separation_multiplier=e_b,
                   left_wheel_radius_multiplier=2.0 / (1.0 + e_d),
                   right_wheel_radius_multiplier=2.0 * e_d / (1.0 + e_d))


def true_motion(course, believed, true):
    """Return the commands that the true robot makes of wheel rates for the believed one."""
    moved = []
    for u in course:
        left = (u.v - 0.5 * believed.separation * u.w) / believed.left_radius * true.left_radius
        right = (u.v + 0.5 * believed.separation * u.w) / believed.right_radius * true.right_radius
        moved.append(Command(0.5 * (left + right), (right - left) / true.separation, u.duration))
    return moved


def courses(side, corner_radius):
    """Return the square (clockwise, counter-clockwise)."""
    return [square_course(side=side, speed=0.5, yaw_rate=0.8, clockwise=way,
                          corner_radius=corner_radius) for way in (True, False)]


def centres(side, believed, true, corner_radius=0.0):
    """Return the systematic return errors of both directions; odometry ends at the start."""
    found = []
    for course in courses(side, corner_radius):
        pose = ORIGIN
        for u in true_motion(course, believed, true):
            pose = advance(pose, u.v * u.duration, u.w * u.duration)
        found.append(ReturnError(pose.x, pose.y))
    return found


def largest(side, believed, true, corner_radius=0.0):
    """Return E_max,syst [m] without any noise."""
    return max(math.hypot(*each) for each in centres(side, believed, true, corner_radius))


def still(side, believed, true, corner_radius=0.0):
    """Return what the benchmark says of runs without slip."""
    cw, ccw = centres(side, believed, true, corner_radius)
    return umbmark(believed, side, [cw] * 2, [ccw] * 2, corner_radius=corner_radius)


def runs(side, believed, true, root_k, n, seed):
    """Return the return errors of n runs in each direction with slipping wheels."""
    slip, found = WheelSlip(variance=root_k**2), []
    for way, course in enumerate(courses(side, 0.0)):
        cut = [replace(u, duration=u.duration / 5.0)
               for u in true_motion(course, believed, true) for _ in range(5)]
        end = sample_paths(ORIGIN, cut, true, slip, slip, n=n, seed=(seed, way))
        found.append([ReturnError(*each) for each in zip(end.x[-1].tolist(), end.y[-1].tolist())])
    return found


def remaining(believed, true):
    """Return the true (E_b, E_d) of what odometry believes in."""
    return (true.separation / believed.separation,
            true.right_radius / true.left_radius * believed.left_radius / believed.right_radius)


def slipping_passes(side, believed, true, root_k, passes, seed):
    """Return the geometry after passes of ``RUNS`` runs in each direction."""
    for number in range(passes):
        cw, ccw = runs(side, believed, true, root_k, RUNS, 10 * seed + number)
        believed = corrected(believed, umbmark(believed, side, cw, ccw))
    return believed


@pytest.mark.parametrize(('e_d', 'e_b', 'signs'), [
    (1.0, 1.0001, (-1, -1, -1, 1)), (1.0, 0.9999, (1, 1, 1, -1)),
    (1.00001, 1.0, (-1, -1, 1, -1)), (0.99999, 1.0, (1, 1, -1, 1))])
def test_a_wrong_separation_and_unequal_wheels_move_the_centres_as_type_a_and_b_do(
        e_d, e_b, signs):
    # Borenstein & Feng 1996: type A moves (x_cw, y_cw, x_ccw, y_ccw) by 2 L alpha times
    # (-1, -1, -1, 1), type B by 2 L beta times (-1, -1, 1, -1); positive for too little turning
    # at corners and for a curve to the left.
    turn = 0.5 * math.pi * (1.0 - 1.0 / e_b)
    curve = (e_d - 1.0) * SIDE / NOMINAL.separation
    true = robot(NOMINAL, e_d, e_b)
    moved = np.array(centres(SIDE, NOMINAL, true)).ravel()
    size = 2.0 * SIDE * (abs(turn) + abs(curve))
    assert moved == pytest.approx(size * np.array(signs), rel=2e-3)
    result = still(SIDE, NOMINAL, true)
    assert result.alpha.value == pytest.approx(turn, abs=5e-8)
    assert result.beta.value == pytest.approx(curve, abs=5e-8)


def test_the_ratios_follow_from_the_angles_as_in_the_paper():
    # Borenstein & Feng 1996: E_b = 90 / (90 - alpha), R = (L / 2) / sin(beta / 2),
    # E_d = (R + b / 2) / (R - b / 2) with the corrected b.  A square of 4 m, 1 and 2 degrees.
    alpha, beta = math.radians(1.0), math.radians(-2.0)
    cw = ReturnError(*[-8.0 * (alpha + beta)] * 2)
    ccw = ReturnError(-8.0 * (alpha - beta), 8.0 * (alpha - beta))
    result = umbmark(LABMATE, 4.0, [cw] * 2, [ccw] * 3)
    assert result.alpha.value == pytest.approx(alpha, rel=1e-12)
    assert result.beta.value == pytest.approx(beta, rel=1e-12)
    assert result.separation_ratio.value == pytest.approx(90.0 / 89.0, rel=1e-12)
    radius, b = 2.0 / math.sin(math.radians(-1.0)), 0.34 * 90.0 / 89.0
    assert result.diameter_ratio.value == pytest.approx(
        (radius + 0.5 * b) / (radius - 0.5 * b), rel=1e-12)


def test_the_x_and_y_forms_are_averaged_and_so_are_the_runs():
    cw = [ReturnError(0.3, 0.1), ReturnError(0.1, 0.1), ReturnError(0.2, 0.4)]
    ccw = [ReturnError(-0.1, 0.2), ReturnError(0.1, 0.2)]
    result = umbmark(LABMATE, 4.0, cw, ccw)
    x_cw, y_cw, x_ccw, y_ccw = 0.2, 0.2, 0.0, 0.2
    assert result.clockwise == pytest.approx((x_cw, y_cw))
    assert result.counterclockwise == pytest.approx((x_ccw, y_ccw))
    assert result.alpha.value == pytest.approx(
        0.5 * (x_cw + x_ccw) / -16.0 + 0.5 * (y_cw - y_ccw) / -16.0)
    assert result.beta.value == pytest.approx(
        0.5 * (x_cw - x_ccw) / -16.0 + 0.5 * (y_cw + y_ccw) / -16.0)
    assert result.error_before == pytest.approx(math.hypot(0.2, 0.2))
    assert result.degrees_of_freedom == 3


@pytest.mark.parametrize('before', [NOMINAL, robot(NOMINAL, 0.97, 1.05)])
def test_a_correction_multiplies_and_leaves_the_mean_radius(before):
    result = still(SIDE, before, robot(NOMINAL, 1.01, 1.02))
    after = corrected(before, result)
    assert after.separation == pytest.approx(before.separation * result.separation_ratio.value)
    assert after.right_radius / after.left_radius == pytest.approx(
        before.right_radius / before.left_radius * result.diameter_ratio.value, rel=1e-14)
    assert after.left_radius + after.right_radius == pytest.approx(
        before.left_radius + before.right_radius, rel=1e-14)
    assert (after.wheel_separation, after.wheel_radius) == (0.2, 0.05)


def test_the_correction_of_equal_wheels_is_that_of_the_paper():
    result = still(SIDE, NOMINAL, robot(NOMINAL, 1.01, 1.02))
    after, e_d = corrected(NOMINAL, result), result.diameter_ratio.value
    assert after.left_wheel_radius_multiplier == pytest.approx(2.0 / (e_d + 1.0), rel=1e-14)
    assert after.right_wheel_radius_multiplier == pytest.approx(2.0 / (1.0 / e_d + 1.0), rel=1e-14)


ROBOTS = [(e_d, e_b) for e_d in (1.01, 0.99) for e_b in (1.02, 0.98)]
SQUARES = [(NOMINAL, 2.0), (NOMINAL, 0.5), (LABMATE, 4.0), (WheelGeometry(0.0885, 0.025), 1.0)]


@pytest.mark.parametrize(('e_d', 'e_b'), ROBOTS)
@pytest.mark.parametrize(('nominal', 'side'), SQUARES)
def test_two_passes_find_unequal_wheels_and_a_wrong_separation(nominal, side, e_d, e_b):
    true, believed = robot(nominal, e_d, e_b), nominal
    before = largest(side, believed, true)
    for _ in range(2):
        believed = corrected(believed, still(side, believed, true))
    found = believed.right_radius / believed.left_radius
    assert found - 1.0 == pytest.approx(e_d - 1.0, rel=0.02)
    assert believed.wheel_separation_multiplier - 1.0 == pytest.approx(e_b - 1.0, rel=0.02)
    assert largest(side, believed, true) < before / 50.0


def test_large_errors_on_a_long_square_vanish_over_a_few_passes():
    true, believed = robot(LABMATE, 1.02, 1.05), LABMATE
    for _ in range(4):
        believed = corrected(believed, still(4.0, believed, true))
    assert remaining(believed, true) == pytest.approx((1.0, 1.0), abs=1e-9)


@pytest.mark.parametrize('corner_radius', [0.2, 0.5, 0.9])
def test_rounded_corners_serve_as_well_if_their_radius_is_known(corner_radius):
    small = robot(NOMINAL, 1.00001, 1.0001)
    result = still(SIDE, NOMINAL, small, corner_radius)
    assert result.separation_ratio.value - 1.0 == pytest.approx(1e-4, rel=0.01)
    assert result.diameter_ratio.value - 1.0 == pytest.approx(1e-5, rel=0.01)
    true, believed = robot(NOMINAL, 1.01, 1.02), NOMINAL
    before = largest(SIDE, believed, true, corner_radius)
    for _ in range(2):
        believed = corrected(believed, still(SIDE, believed, true, corner_radius))
    assert largest(SIDE, believed, true, corner_radius) < before / 50.0


@pytest.mark.parametrize('corner_radius', [0.0, 0.5])
def test_the_predicted_error_is_that_of_the_same_wheel_motion_read_anew(corner_radius):
    true = robot(NOMINAL, 1.01, 1.02)
    result = still(SIDE, NOMINAL, true, corner_radius)
    believed = corrected(NOMINAL, result)
    left = []
    for course, error in zip(courses(SIDE, corner_radius), (
            result.clockwise, result.counterclockwise)):
        pose = ORIGIN
        for u in true_motion(course, NOMINAL, believed):
            pose = advance(pose, u.v * u.duration, u.w * u.duration)
        left.append(math.hypot(error.x - pose.x, error.y - pose.y))
    assert result.error_after == pytest.approx(max(left), rel=1e-9)
    assert result.error_before == pytest.approx(largest(SIDE, NOMINAL, true, corner_radius))
    driven = largest(SIDE, believed, true, corner_radius)
    assert result.error_after == pytest.approx(driven, rel=0.2)
    assert 0.0 < result.error_after < 0.2 * result.error_before


@pytest.mark.parametrize('root_k', [5e-4, 1e-3, 2e-3])
@pytest.mark.parametrize(('nominal', 'side'), [(NOMINAL, 2.0), (LABMATE, 4.0)])
def test_two_passes_with_slip_improve_the_systematic_error_tenfold(nominal, side, root_k):
    true = robot(nominal, 1.01, 1.02)
    before = largest(side, nominal, true)
    ratios = [before / largest(side, slipping_passes(side, nominal, true, root_k, 2, seed), true)
              for seed in range(20)]
    assert np.median(ratios) > 10.0


def test_one_pass_improves_errors_of_the_published_size_by_an_order_of_magnitude():
    # Borenstein & Feng 1996: eight experiments with a LabMate on a square of 4 m, E_max,syst
    # from 232-423 mm to 12-35 mm, "at least one order of magnitude".
    true = robot(LABMATE, 1.0015, 1.003)
    before = largest(4.0, LABMATE, true)
    assert 0.232 < before < 0.423
    after = [largest(4.0, slipping_passes(4.0, LABMATE, true, 5e-4, 1, seed), true)
             for seed in range(20)]
    assert np.median(after) < 0.035
    assert np.median(before / np.array(after)) > 10.0


def share_within(quantile, degrees):
    """Return the probability that Student's t is within +-quantile."""
    x = quantile**2 / (degrees + quantile**2)
    return float(mpmath.betainc(0.5, 0.5 * degrees, 0.0, x, regularized=True))


def assert_student(z, degrees):
    """Compare the shares within 1 and 2 standard errors with binomial bounds of 99.9 %."""
    for quantile in (1.0, 2.0):
        expected = share_within(quantile, degrees)
        bound = Z * math.sqrt(expected * (1.0 - expected) / len(z))
        assert abs(np.mean(np.abs(z) < quantile) - expected) < bound


def deviations(result, alpha, beta, e_b, e_d):
    """Return how many standard errors each estimate is off."""
    return [(estimate.value - truth) / estimate.error for estimate, truth in zip(
        (result.alpha, result.beta, result.separation_ratio, result.diameter_ratio),
        (alpha, beta, e_b, e_d))]


def angles(believed, true):
    """Return the true alpha and beta; beta to first order."""
    e_b, e_d = remaining(believed, true)
    return (0.5 * math.pi * (1.0 - 1.0 / e_b),
            2.0 * (e_d - 1.0) / (e_d + 1.0) * SIDE / true.separation)


@lru_cache(maxsize=None)
def many_runs():
    """Return runs of a robot with small errors: 10 in each direction for each of 1000 seeds."""
    return runs(SIDE, NOMINAL, robot(NOMINAL, 1.001, 1.002), 1e-3, 10000, 3)


@pytest.mark.parametrize(('clockwise', 'counterclockwise'), [(5, 5), (3, 7), (10, 2), (2, 2)])
def test_standard_errors_cover_small_errors_as_student_says(clockwise, counterclockwise):
    true = robot(NOMINAL, 1.001, 1.002)
    cw, ccw = many_runs()
    z = np.array([
        deviations(umbmark(NOMINAL, SIDE, cw[at:at + clockwise], ccw[at:at + counterclockwise]),
                   *angles(NOMINAL, true), *remaining(NOMINAL, true))
        for at in range(0, len(cw), 10)])
    for column in z.T:
        assert_student(column, clockwise + counterclockwise - 2)


@pytest.mark.slow
def test_standard_errors_cover_what_is_left_after_a_first_pass_of_large_errors():
    true = robot(NOMINAL, 1.01, 1.02)
    z = []
    for seed in range(SEEDS):
        believed = slipping_passes(SIDE, NOMINAL, true, 1e-3, 1, seed)
        result = umbmark(
            believed, SIDE, *runs(SIDE, believed, true, 1e-3, RUNS, 10 * seed + 5))
        z.append(deviations(result, *angles(believed, true), *remaining(believed, true)))
    for column in np.array(z).T:
        assert_student(column, 2 * RUNS - 2)


def test_standard_errors_of_the_ratios_follow_those_of_the_angles():
    # By differences, where the correlation of alpha and beta (3 and 7 runs) counts.
    true = robot(WheelGeometry(0.4, 0.05), 1.05, 1.1)
    nominal = WheelGeometry(0.4, 0.05)
    cw, ccw = runs(0.5, nominal, true, 2e-3, 7, 4)
    cw = cw[:3]
    at = umbmark(nominal, 0.5, cw, ccw)
    pooled = (at.alpha.error**2 / (1.0 / 3.0 + 1.0 / 7.0)) * 64.0 * 0.25
    step, variance = 1e-5, {'separation_ratio': 0.0, 'diameter_ratio': 0.0}
    for moved, n in ((0, 3), (1, 7)):
        shifted = [cw, ccw]
        shifted[moved] = [ReturnError(each.x + step, each.y) for each in shifted[moved]]
        other = umbmark(nominal, 0.5, *shifted)
        for name in variance:
            slope = (getattr(other, name).value - getattr(at, name).value) / step
            variance[name] += slope**2 * pooled / n
    for name, expected in variance.items():
        assert getattr(at, name).error == pytest.approx(math.sqrt(expected), rel=1e-3)


def test_runs_that_do_not_scatter_have_no_standard_error():
    result = still(SIDE, NOMINAL, robot(NOMINAL, 1.01, 1.02))
    for estimate in (result.alpha, result.beta, result.separation_ratio, result.diameter_ratio):
        assert estimate.error == pytest.approx(0.0, abs=1e-15)


def test_an_estimate_is_the_same_thing_for_every_calibration():
    assert slip_fit.Estimate is Estimate


@pytest.mark.parametrize(('clockwise', 'counterclockwise', 'message'), [
    ([], FEW, 'there are 0 clockwise runs, expected at least 2 in either direction'),
    (FEW, [], 'there are 0 counterclockwise runs, expected at least 2'),
    (FEW, FEW[:1], 'there are 1 counterclockwise runs, expected at least 2'),
    ([*FEW, ReturnError(0.0, math.nan)], FEW, r'clockwise run 3 has .* \(0.0, nan\), expected'),
    (FEW, [ReturnError(math.inf, 0.0), *FEW], r'counterclockwise run 1 has .* \(inf, 0.0\)'),
    ([ReturnError(1e200, 0.0)] * 2, FEW, r'clockwise run 1 has .* \(1e\+200, 0.0\)'),
    ([ReturnError(-3.0, -3.0)] * 2, [ReturnError(-3.0, 3.0)] * 2,
     r'alpha is 0.75\d* rad, expected within \+-0.3 rad: .* too large for first-order'),
    ([ReturnError(3.0, 3.0)] * 2, [ReturnError(-3.0, 3.0)] * 2,
     r'beta is -0.75\d* rad, expected within \+-0.3 rad')])
def test_bad_runs_are_refused_by_name(clockwise, counterclockwise, message):
    with pytest.raises(ValueError, match=f'^{message}'):
        umbmark(NOMINAL, SIDE, clockwise, counterclockwise)


@pytest.mark.parametrize('side', [0.0, -2.0, math.nan, math.inf])
def test_a_bad_side_is_refused_by_name(side):
    with pytest.raises(ValueError, match=f'^side is {side!r}, expected'):
        umbmark(NOMINAL, side, FEW, FEW)


@pytest.mark.parametrize('corner_radius', [-0.1, 1.1, math.nan])
def test_a_bad_corner_radius_is_refused_by_name(corner_radius):
    with pytest.raises(ValueError, match=f'^corner_radius is {corner_radius!r}, expected'):
        umbmark(NOMINAL, SIDE, FEW, FEW, corner_radius=corner_radius)


@pytest.mark.parametrize(('separation', 'sign', 'e_d'), [
    (1.0, 1.0, r'4\.9\d+'), (1.0, -1.0, r'0\.\d+'), (2.0, 1.0, 'inf')])
def test_a_square_that_is_too_short_to_tell_the_wheels_apart_is_refused(separation, sign, e_d):
    cw, ccw = ReturnError(*[-0.06 * sign] * 2), ReturnError(0.06 * sign, -0.06 * sign)
    with pytest.raises(ValueError, match=f'^E_d is {e_d}, expected from 0.5 to 2: a square of '):
        umbmark(WheelGeometry(separation, 0.05), 0.15, [cw] * 2, [ccw] * 2)
