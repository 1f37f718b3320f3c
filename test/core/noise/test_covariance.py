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
Covariance along the arc, against the arc itself in 40-digit arithmetic, and by laws.

No formula of the module is repeated: the gradient is what the end of an arc does when a wheel
slips at some point of it, and the covariance the integral of its outer product.
"""

import math

from diffdrive_kinematics.core.kinematics import (
    advance, Pose, pose_change_from_travel, WheelGeometry)
from diffdrive_kinematics.core.noise import (
    moved_covariance, NO_COVARIANCE, PoseCovariance, propagated_covariance, slip_covariance,
    twist_covariance)
from hypothesis import assume, given, settings, strategies as st
import mpmath
import numpy as np
import pytest

LAW = settings(deadline=None, derandomize=True, max_examples=300)
GEOMETRY = WheelGeometry(0.4, 0.1)
separations = st.floats(0.05, 2.0)
headings = st.floats(-math.pi, math.pi)
travels = st.one_of(st.just(0.0), st.floats(-5.0, 5.0))
slips = st.one_of(st.just(0.0), st.floats(1e-9, 0.1))
arcs = st.lists(st.tuples(travels, travels), min_size=1, max_size=5)


def travel_of(distance, turn, geometry=GEOMETRY):
    """Return (d_l, d_r) of an arc."""
    return distance - 0.5 * turn * geometry.separation, distance + 0.5 * turn * geometry.separation


def moved(pose, d_left, d_right, separation):
    """Return the pose after an arc, in the arithmetic of mpmath; poses are lists."""
    half = (d_right - d_left) / (2 * mpmath.mpf(separation))
    chord = (d_left + d_right) / 2 * (mpmath.sin(half) / half if half else 1)
    return [pose[0] + chord * mpmath.cos(pose[2] + half),
            pose[1] + chord * mpmath.sin(pose[2] + half), pose[2] + 2 * half]


def end_with_slip(separation, heading, d, part, slip):
    """Return the end of an arc on which the wheels slip by ``slip`` after ``part`` of it."""
    pose = [mpmath.mpf(0), mpmath.mpf(0), mpmath.mpf(heading)]
    for way in ([part * w for w in d], slip, [(1 - part) * w for w in d]):
        pose = moved(pose, *way, separation)
    return pose


def gradient(separation, heading, d, part, wheel):
    """Return d(pose at the end) / d(slip of a wheel at a point), by central difference."""
    step = mpmath.mpf('1e-15')
    ends = [end_with_slip(separation, heading, d, part, [
        sign * step if w == wheel else mpmath.mpf(0) for w in (0, 1)]) for sign in (1, -1)]
    return np.array([float((a - b) / (2 * step)) for a, b in zip(*ends)])


def integrated(separation, heading, d_left, d_right, k_left, k_right, nodes=24):
    """Return the (3, 3) integral of the outer product of the gradients along the arc."""
    with mpmath.workdps(40):
        d = [mpmath.mpf(d_left), mpmath.mpf(d_right)]
        total = np.zeros((3, 3))
        for s, weight in zip(*np.polynomial.legendre.leggauss(nodes)):
            for wheel, k in enumerate((k_left, k_right)):
                g = gradient(separation, heading, d, (1 + mpmath.mpf(float(s))) / 2, wheel)
                total += 0.5 * weight * k * abs(float(d[wheel])) * np.outer(g, g)
    return total


def discrepancy(covariance, other, still=0.0):
    """Return the largest ``|dP_ij| / sqrt(P_ii P_jj)``, P_ii counted as ``still`` or more."""
    first, second = (
        p.matrix() if isinstance(p, PoseCovariance) else p for p in (covariance, other))
    scale = np.sqrt(np.maximum(np.diag(second), still))
    return float(np.max(np.abs(first - second) / np.outer(scale, scale)))


def in_steps(geometry, pose, d_left, d_right, k, n, start=NO_COVARIANCE):
    """Return (pose, covariance) after n equal steps."""
    covariance = start
    for _ in range(n):
        pose, covariance = propagated_covariance(
            covariance, pose, geometry, d_left / n, d_right / n, *k)
    return pose, covariance


def lowest_eigenvalue(covariance, length):
    """Return the lowest over the highest eigenvalue, with theta counted as a length."""
    scale = np.diag([1.0, 1.0, length])
    values = np.linalg.eigvalsh(scale @ covariance.matrix() @ scale)
    return values[0] / values[-1] if values[-1] > 0.0 else values[0]


@pytest.mark.parametrize('distance', [0.0, 0.02, -1.0, 40.0])
@pytest.mark.parametrize('heading', [-2.0, 0.0])
def test_slip_covariance_is_the_integral_for_turns_from_1e_12_to_6_rad(distance, heading):
    """Sweep across the change from series to closed form at 1 rad; measured 6e-15."""
    turns = [*np.logspace(-12.0, -2.0, 6), 0.1, 0.3, 0.5, 0.9, 0.999999, 1.0, 1.000001, 1.5, 3.1,
             6.0]
    worst = 0.0
    for turn in (sign * turn for turn in turns for sign in (1.0, -1.0)):
        d = travel_of(distance, turn)
        covariance = slip_covariance(GEOMETRY, heading, *d, 3e-4, 1e-4)
        worst = max(worst, discrepancy(covariance, integrated(0.4, heading, *d, 3e-4, 1e-4)))
    assert worst < 1e-12


@pytest.mark.parametrize('turn', [17.0, -40.0])
def test_slip_covariance_is_the_integral_for_many_turns(turn):
    d = travel_of(1.3, turn)
    covariance = slip_covariance(GEOMETRY, 0.7, *d, 3e-4, 1e-4)
    assert discrepancy(covariance, integrated(0.4, 0.7, *d, 3e-4, 1e-4, nodes=70)) < 1e-12


@pytest.mark.parametrize('d', [(1.0, 1.0), (-2.0, -2.0), (0.0, 0.5), (-0.3, 0.0), (0.4, -0.4)])
@pytest.mark.parametrize('k', [(0.0, 1e-4), (1e-4, 0.0), (2e-4, 1e-4)])
def test_slip_covariance_is_the_integral_on_straights_pivots_and_with_one_slipping_wheel(d, k):
    covariance = slip_covariance(GEOMETRY, 0.3, *d, *k).matrix()
    expected = integrated(0.4, 0.3, *d, *k)
    assert np.allclose(covariance, expected, rtol=1e-12, atol=1e-18)


def test_the_straight_line_by_hand():
    """With k on both wheels: Var theta 2 k d / L^2, Var x k d / 2, Var y 2 k d^3 / (3 L^2)."""
    covariance = slip_covariance(GEOMETRY, 0.0, 3.0, 3.0, 1e-4, 1e-4)
    assert covariance == pytest.approx(
        (1.5e-4, 0.0, 0.0, 18e-4 / 0.16, 9e-4 / 0.16, 6e-4 / 0.16), rel=1e-14, abs=1e-20)


def test_the_turn_in_place_by_hand():
    """
    Half a turn, d = pi L / 2: k d / 4 in x and in y, 2 k d / L^2 of yaw.

    An error of travel moves the centre along the heading of its time and nothing else, as the
    robot does not go on from there: ``cos^2`` and ``sin^2`` have the mean 1/2.
    """
    d = 0.5 * math.pi * 0.4  # half a turn
    covariance = slip_covariance(GEOMETRY, -0.5 * math.pi, -d, d, 1e-4, 1e-4)
    assert covariance == pytest.approx(
        (2.5e-5 * d, 0.0, 0.0, 2.5e-5 * d, 0.0, 2e-4 * d / 0.16), rel=1e-14, abs=1e-20)


@LAW
@given(separations, headings, st.floats(-0.5, 0.5), st.floats(-2.0, 2.0), st.integers(1, 100),
       st.floats(1e-8, 1e-2), st.floats(1e-8, 1e-2))
def test_one_step_is_n_steps(separation, heading, turn, distance, n, k_left, k_right):
    """
    Compose up to 0.5 rad.

    On a pivot P_xx or P_yy can vanish, and the rounding of the heading is then all there is of
    it: below 1e-10 of their sum they count as that.
    """
    geometry = WheelGeometry(separation, 0.1)
    d = travel_of(distance, turn, geometry)
    assume(max(map(abs, d)) > 1e-9)
    pose = Pose(0.0, 0.0, heading)
    one = in_steps(geometry, pose, *d, (k_left, k_right), 1)[1]
    many = in_steps(geometry, pose, *d, (k_left, k_right), n)[1]
    assert discrepancy(many, one, still=1e-10 * (one.xx + one.yy)) < 1e-9


@pytest.mark.parametrize('n', range(1, 101))
def test_one_step_is_n_steps_for_every_n_and_signs(n):
    """Let 1 rad and 30 rad pass too; the criterion asks for 1e-9 up to 0.5 rad."""
    worst = 0.0
    for turn in (0.0, 1e-9, 0.1, 0.5, -0.5, 1.0, 30.0):
        for distance in (0.5, -0.5, 0.0):
            d = travel_of(distance, turn)
            if any(d):
                one, many = (
                    in_steps(GEOMETRY, Pose(3.0, -1.0, 2.9), *d, (1e-4, 3e-4), steps)[1]
                    for steps in (1, n))
                worst = max(worst, discrepancy(many, one))
    assert worst < 1e-12


@LAW
@given(headings, st.lists(st.tuples(travels, travels), min_size=2, max_size=4), headings)
def test_turning_the_start_turns_the_covariance(heading, course, angle):
    def end(theta):
        pose, covariance = Pose(0.0, 0.0, theta), NO_COVARIANCE
        for d in course:
            pose, covariance = propagated_covariance(covariance, pose, GEOMETRY, *d, 1e-4, 2e-4)
        return covariance
    turned, there = end(heading).rotated(angle), end(heading + angle)
    size = there.xx + there.yy + there.tt
    assert turned == pytest.approx(there, rel=1e-12, abs=1e-12 * size + 1e-300)


def test_exchanging_wheels_mirrors_the_covariance():
    left = slip_covariance(GEOMETRY, 0.0, 0.7, 1.1, 2e-4, 1e-4)
    right = slip_covariance(GEOMETRY, 0.0, 1.1, 0.7, 1e-4, 2e-4)
    assert right == pytest.approx(
        (left.xx, -left.xy, -left.xt, left.yy, left.yt, left.tt), rel=1e-13)


@LAW
@given(headings, st.floats(-3.0, 3.0), st.floats(-3.0, 3.0), st.integers(0, 2**32))
def test_motion_moves_errors_as_a_perturbed_start_moves(heading, distance, turn, seed):
    root = np.random.default_rng(seed).normal(size=(3, 3))
    start = PoseCovariance.from_matrix(root @ root.T)
    pose, step = np.array([0.4, -0.2, heading]), 1e-6
    jacobian = np.transpose([
        (np.array(advance(Pose(*(pose + error)), distance, turn))
         - np.array(advance(Pose(*(pose - error)), distance, turn))) / (2.0 * step)
        for error in step * np.eye(3)])
    there = moved_covariance(
        start, Pose(*pose), advance(Pose(*pose), distance, turn), NO_COVARIANCE)
    expected = jacobian @ start.matrix() @ jacobian.T
    assert there.matrix() == pytest.approx(expected, abs=1e-7 * np.trace(expected))


@pytest.mark.slow
@LAW
@given(separations, headings, arcs, slips, slips)
def test_the_covariance_is_positive_semidefinite(separation, heading, course, k_left, k_right):
    geometry = WheelGeometry(separation, 0.1)
    pose, covariance = Pose(0.0, 0.0, heading), NO_COVARIANCE
    for d in course:
        alone = slip_covariance(geometry, float(pose.theta), *d, k_left, k_right)
        assert lowest_eigenvalue(alone, separation) > -1e-13
        pose, covariance = propagated_covariance(
            covariance, pose, geometry, *d, k_left, k_right)
        assert np.array_equal(covariance.matrix(), covariance.matrix().T)
        assert lowest_eigenvalue(covariance, separation) > -1e-13


@LAW
@given(headings, slips, slips)
def test_no_travel_adds_nothing(heading, k_left, k_right):
    start, pose = PoseCovariance(1.0, 0.1, 0.2, 2.0, 0.3, 3.0), Pose(1.0, 2.0, heading)
    assert slip_covariance(GEOMETRY, heading, 0.0, 0.0, k_left, k_right) == NO_COVARIANCE
    assert propagated_covariance(start, pose, GEOMETRY, 0.0, 0.0, k_left, k_right) == (
        pose, start)


def test_no_slip_adds_nothing():
    assert slip_covariance(GEOMETRY, 0.4, 1.0, -2.0, 0.0, 0.0) == NO_COVARIANCE


def test_a_matrix_and_back_is_the_covariance_and_a_sum_is_no_joined_tuple():
    covariance = PoseCovariance(1.0, 2.0, 3.0, 4.0, 5.0, 6.0)
    assert covariance.matrix().tolist() == [[1, 2, 3], [2, 4, 5], [3, 5, 6]]
    assert PoseCovariance.from_matrix(covariance.matrix()) == covariance
    assert covariance.plus(covariance).matrix().tolist() == (2 * covariance.matrix()).tolist()


@LAW
@given(headings, st.integers(0, 2**32))
def test_a_rotated_covariance_is_that_of_the_rotated_error(angle, seed):
    root = np.random.default_rng(seed).normal(size=(3, 3))
    c, s = math.cos(angle), math.sin(angle)
    rotation = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    rotated = PoseCovariance.from_matrix(root @ root.T).rotated(angle)
    assert rotated.matrix() == pytest.approx(rotation @ root @ root.T @ rotation.T, abs=1e-12)


def test_the_covariance_of_the_twist_by_hand():
    """With R = 0.1, u = (-20, 10), T = 0.02: q = (2 k_l T, 1 k_r T)."""
    twist = twist_covariance(GEOMETRY, (-20.0, 10.0), 1e-4, 3e-4, 0.02, floor=1e-6)
    assert twist == pytest.approx(
        (5e-4 / 0.08 + 1e-6, 1e-4 / 0.016, 5e-4 / 0.0032 + 1e-6), rel=1e-13)


def test_the_covariance_of_the_twist_is_that_of_the_travel_over_the_period():
    """Map independent travel errors of variance q through the kinematics."""
    geometry = WheelGeometry(0.5, 0.1, 1.1, 0.9, 1.2)
    rates, k, period = (5.0, -8.0), (1e-4, 3e-4), 0.05
    q = [k[0] * 5.0 * 0.09 * period, k[1] * 8.0 * 0.12 * period]
    to_twist = np.transpose([
        pose_change_from_travel(geometry, *wheel) for wheel in ((1.0, 0.0), (0.0, 1.0))]) / period
    expected = to_twist @ np.diag(q) @ to_twist.T
    twist = twist_covariance(geometry, rates, *k, period, floor=0.0)
    assert twist == pytest.approx((expected[0, 0], expected[0, 1], expected[1, 1]), rel=1e-13)


def test_twists_of_any_rate_gather_the_yaw_variance_of_the_path():
    yaw = slip_covariance(GEOMETRY, 0.0, 2.0, 3.0, 1e-4, 2e-4).tt
    for n in (1, 10, 500):  # one second of rates 20 and 30 rad/s
        twist = twist_covariance(GEOMETRY, (20.0, 30.0), 1e-4, 2e-4, 1.0 / n, floor=0.0)
        assert n * twist.ww / n**2 == pytest.approx(yaw, rel=1e-13)


def test_a_robot_at_rest_reports_the_floor():
    assert twist_covariance(GEOMETRY, (0.0, 0.0), 1e-4, 1e-4, 0.02) == (1e-9, 0.0, 1e-9)


@pytest.mark.parametrize('bad', [-1e-9, math.nan, math.inf])
def test_bad_values_are_refused_by_name(bad):
    def twist(k_left=0.0, k_right=0.0, period=0.1, floor=0.0):
        return twist_covariance(GEOMETRY, (1.0, 1.0), k_left, k_right, period, floor)
    for name, call in (
            ('left slip variance', lambda: slip_covariance(GEOMETRY, 0.0, 1.0, 1.0, bad, 0.0)),
            ('right slip variance', lambda: slip_covariance(GEOMETRY, 0.0, 1.0, 1.0, 0.0, bad)),
            ('left slip variance', lambda: twist(k_left=bad)),
            ('right slip variance', lambda: twist(k_right=bad)),
            ('period', lambda: twist(period=bad)), ('floor', lambda: twist(floor=bad))):
        with pytest.raises(ValueError, match=f'^{name} is'):
            call()
    with pytest.raises(ValueError, match='^period is'):
        twist(period=0.0)


def test_a_matrix_of_another_shape_is_refused():
    with pytest.raises(ValueError, match=r'^matrix has shape \(6, 6\), expected \(3, 3\)'):
        PoseCovariance.from_matrix(np.zeros((6, 6)))
