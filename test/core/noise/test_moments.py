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
Exact moments of the pose, against their differential equations, and by laws.

The module integrates squares of what slip does to the rest of an arc; the equations here are of
moments as they grow along it, and are integrated with Runge-Kutta steps.  They share nothing.
"""

import cmath
import math

from diffdrive_kinematics.core.kinematics import Pose, pose_change_from_travel, WheelGeometry
from diffdrive_kinematics.core.noise import (
    arc_moments, CERTAIN, followed, gaussian_moments, heading_moments, NO_COVARIANCE,
    PoseCovariance, propagated_covariance, propagated_moments, second_moment_after, slip_on_arc)
from diffdrive_kinematics.core.noise.integrated_moments import integrated_moments
from diffdrive_kinematics.core.noise.turning_moments import turning_moments
from hypothesis import assume, given, settings, strategies as st
import numpy as np
import pytest

LAW = settings(deadline=None, derandomize=True, max_examples=200)
GEOMETRY = WheelGeometry(0.2, 0.05)
ORIGIN = Pose(0.0, 0.0, 0.0)
STEPS = 2000
travels = st.one_of(st.just(0.0), st.floats(-5.0, 5.0))
slips = st.one_of(st.just(0.0), st.floats(1e-9, 0.1))
headings = st.floats(-math.pi, math.pi)


def travel_of(distance, turn, geometry=GEOMETRY):
    """Return (d_l, d_r) of an arc."""
    return distance - 0.5 * turn * geometry.separation, distance + 0.5 * turn * geometry.separation


def grown(distance, turn, slip):
    """Return (second moment about the published pose, mean error) by Runge-Kutta."""
    q, c, v = slip

    def slope(t, state):
        m, f, h, _, _, _ = state
        u, e = cmath.exp(1j * turn * t), math.exp(-0.5 * v * t)
        to, half = u.conjugate(), 0.5j * c
        return np.array([
            -distance * u * (1.0 - e) + half * u * e,
            2.0 * distance * to * (1.0 - e) - 0.5 * v * (f + m.conjugate())
            + half * to * (1.0 + e),
            distance * u * (e**4 - 2.0 * e + 1.0) - 0.5 * v * (h + m)
            + half * u * (3.0 * e**4 - e),
            2.0 * (distance * u * f + half * u * (f + m.conjugate())).real + q,
            2.0 * (distance * u * h + half * u * (h + m)) + q * u**2 * e**4,
            (1j * distance * v * t - 0.5 * c * v * t + c) * u * e])

    state, step = np.zeros(6, complex), 1.0 / STEPS
    for number in range(STEPS):
        t = number * step
        one = slope(t, state)
        two = slope(t + 0.5 * step, state + 0.5 * step * one)
        three = slope(t + 0.5 * step, state + 0.5 * step * two)
        state += step / 6.0 * (one + 2.0 * two + 2.0 * three
                               + slope(t + step, state + step * three))
    m, _, _, a, b, g = state
    return PoseCovariance(
        0.5 * (a + b).real, 0.5 * b.imag, g.real, 0.5 * (a - b).real, g.imag, v), m


def discrepancy(covariance, other, still=0.0):
    """Return the largest ``|dP_ij| / sqrt(P_ii P_jj)``, P_ii counted as ``still`` or more."""
    first, second = (p.second_moment().matrix() for p in (covariance, other))
    scale = np.sqrt(np.maximum(np.diag(second), still))
    return float(np.max(np.abs(first - second) / np.outer(scale, scale)))


def in_steps(geometry, pose, d, k, n, moments=CERTAIN):
    """Return (pose, moments) after n equal steps."""
    for _ in range(n):
        pose, moments = propagated_moments(moments, pose, geometry, d[0] / n, d[1] / n, *k)
    return pose, moments


def lowest_eigenvalue(covariance, length):
    """Return the lowest over the highest eigenvalue, with theta counted as a length."""
    scale = np.diag([1.0, 1.0, length])
    values = np.linalg.eigvalsh(scale @ covariance.matrix() @ scale)
    return values[0] / values[-1] if values[-1] > 0.0 else values[0]


@pytest.mark.parametrize(('distance', 'turn', 'slip'), [
    (1.0, 0.0, (1e-4, 0.0, 0.01)), (20.0, 0.0, (1e-4, 2e-4, 0.04)), (3.0, 0.1, (1e-3, 1e-3, 0.3)),
    (-2.0, 1.5, (1e-3, -2e-3, 0.2)), (0.0, -3.0, (2e-3, 1e-3, 0.5)), (1.0, 8.0, (0.1, 0.1, 2.0)),
    (2.0, 0.001, (1e-6, 0.0, 1e-4)), (0.5, -0.02, (1e-6, 1e-6, 1e-3))])
def test_the_moments_solve_their_differential_equations(distance, turn, slip):
    found = arc_moments(distance, turn, slip)
    moments, mean = grown(distance, turn, slip)
    assert found.mean_error == pytest.approx(mean, rel=1e-9)
    expected = moments.matrix()
    scale = np.sqrt(np.diag(expected))
    assert np.max(np.abs(found.second_moment().matrix() - expected)
                  / np.outer(scale, scale)) < 1e-9


@LAW
@given(st.floats(-15.0, 15.0), st.floats(0.05, 0.3), st.booleans(), st.floats(1e-9, 0.01),
       st.floats(1e-9, 0.01))
def test_closed_form_and_quadrature_agree(separations, turn, right, k_left, k_right):
    """On radii where one gives way to the other."""
    distance, turn = separations * 0.2 * turn, -turn if right else turn
    slip = slip_on_arc(GEOMETRY, *travel_of(distance, turn), k_left, k_right)
    closed = turning_moments(distance, turn, slip)
    integrated = integrated_moments(distance, turn, slip, swings=True)
    assert discrepancy(closed, integrated) < 1e-10
    assert closed.mean_error == pytest.approx(integrated.mean_error, rel=1e-9)
    for name in ('x_swing', 'y_swing'):
        assert getattr(closed, name) == pytest.approx(
            getattr(integrated, name), rel=1e-9, abs=1e-9 * abs(integrated.x_swing))


@pytest.mark.parametrize('variance', [20.0, 75.0, 1e4])
def test_a_heading_that_is_quite_lost_on_an_arc_that_turns_keeps_its_moments(variance):
    """The mean of ``e^{i phi}`` is below the last digit of 1, or even 0."""
    slip = 0.0025 * variance, 0.0005 * variance, variance
    half = arc_moments(2.0, 0.5, tuple(0.5 * each for each in slip))
    way = 2.0 * (cmath.exp(0.5j) - 1.0) / 0.5j * cmath.exp(0.5j)
    halves, whole = followed(half, 0.5, way, half), arc_moments(4.0, 1.0, slip)
    assert discrepancy(halves, whole) < 1e-9
    assert whole.x_swing == pytest.approx(halves.x_swing, rel=1e-9)
    assert whole.y_swing == pytest.approx(halves.y_swing, rel=1e-9)


@LAW
@given(headings, st.floats(-5.0, 5.0), st.floats(-1.0, 1.0), slips, slips)
def test_a_second_moment_without_swings_is_that_of_all_moments(
        heading, distance, turn, k_left, k_right):
    d = travel_of(distance, turn)
    pose, before = propagated_moments(
        gaussian_moments(PoseCovariance(0.01, 0.001, 0.002, 0.02, 0.003, 0.04)),
        Pose(0.0, 0.0, heading), GEOMETRY, 0.3, 0.5, k_left, k_right)
    after, moments = propagated_moments(before, pose, GEOMETRY, *d, k_left, k_right)
    arc = arc_moments(*pose_change_from_travel(GEOMETRY, *d),
                      slip_on_arc(GEOMETRY, *d, k_left, k_right), swings=False)
    assert second_moment_after(
        before, pose.theta, complex(after.x - pose.x, after.y - pose.y), arc
    ) == moments.second_moment()


@pytest.mark.parametrize('n', range(1, 101))
def test_one_step_is_n_steps_for_every_n_and_signs(n):
    worst = 0.0
    for turn in (0.0, 1e-9, 0.1, -0.5, 1.0, 30.0):
        for distance in (0.5, -0.5, 0.0, 20.0):
            for k in ((1e-5, 3e-5), (1e-2, 1e-3)):
                d = travel_of(distance, turn)
                if any(d):
                    one, many = (in_steps(GEOMETRY, Pose(3.0, -1.0, 2.9), d, k, steps)[1]
                                 for steps in (1, n))
                    worst = max(worst, discrepancy(many, one))
    assert worst < 1e-9


@LAW
@given(st.floats(0.05, 2.0), headings, st.floats(-3.0, 3.0), st.floats(-20.0, 20.0),
       st.integers(2, 100), st.floats(1e-9, 1e-2), st.floats(1e-9, 1e-2), st.floats(0.0, 0.5))
def test_one_step_is_n_steps_from_any_start(
        separation, heading, turn, distance, n, k_left, k_right, known):
    geometry = WheelGeometry(separation, 0.05)
    d = travel_of(distance, turn, geometry)
    assume(max(map(abs, d)) > 1e-6)
    start = gaussian_moments(PoseCovariance(
        0.01, 0.0, 0.05 * known**2, 0.02, -0.05 * known**2, known**2))
    one, many = (in_steps(geometry, Pose(0.0, 0.0, heading), d, (k_left, k_right), steps, start)[1]
                 for steps in (1, n))
    assert discrepancy(many, one) < 1e-9


def test_small_slip_has_the_covariance_of_first_order():
    pose, course = ORIGIN, [(1.0, 1.3), (-0.2, 0.2), (2.0, 1.0), (-1.0, -1.0)]
    moments, expected, there = CERTAIN, NO_COVARIANCE, ORIGIN
    for d in course:
        there, expected = propagated_covariance(expected, there, GEOMETRY, *d, 1e-12, 3e-12)
        pose, moments = propagated_moments(moments, pose, GEOMETRY, *d, 1e-12, 3e-12)
    assert pose == there
    assert moments.second_moment() == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize('n', [1, 100])
def test_a_straight_loses_no_digits_along_the_track(n):
    """Var x is Q to first order, 1e-10 of Var y here; the rest is below 1e-15 of it."""
    d, k = 1e4, 1e-22
    moments = in_steps(GEOMETRY, ORIGIN, (d, d), (k, k), n)[1].second_moment()
    assert moments.xx == pytest.approx(0.5 * k * d, rel=1e-12)
    assert moments.yy == pytest.approx(2.0 * k * d**3 / (3.0 * 0.2**2), rel=1e-12)


def expected_after(start, way, heads):
    """Return the second moment after a known way from start errors (x, y, phi) with weights."""
    (x, y, phi), weights = start
    error = np.array([
        x + (way * (np.exp(1j * (phi + heads)) - np.exp(1j * heads))).real,
        y + (way * (np.exp(1j * (phi + heads)) - np.exp(1j * heads))).imag, phi])
    return (weights * error) @ error.T


def test_a_gaussian_start_swings_by_its_own_moments():
    """Against Gauss-Hermite quadrature over the joint density of position and heading."""
    root = np.array([[0.3, 0.0, 0.0], [0.1, 0.2, 0.0], [0.25, -0.1, 0.2]])
    nodes, weights = np.polynomial.hermite_e.hermegauss(24)
    grid = np.stack(np.meshgrid(nodes, nodes, nodes, indexing='ij')).reshape(3, -1)
    weight = np.prod(np.stack(np.meshgrid(weights, weights, weights, indexing='ij')), axis=0)
    start = gaussian_moments(PoseCovariance.from_matrix(root @ root.T))
    for heading, way in ((0.4, 2.0 - 1.0j), (-2.0, 0.5j)):
        world = way * cmath.exp(1j * heading)
        expected = expected_after((root @ grid, weight.ravel() / weight.sum()), way, heading)
        found = followed(start, heading, world, CERTAIN).second_moment()
        assert found.matrix() == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize('concentration', [0.0, 1.0, 30.0, 1e4])
def test_a_von_mises_start_swings_by_its_own_moments(concentration):
    """Drive a known way, then one with slip, against an average over the density."""
    phi, weights = np.polynomial.legendre.leggauss(400)
    phi = min(math.pi, 14.0 / math.sqrt(concentration or 1.0)) * phi
    weights = weights * np.exp(concentration * (np.cos(phi) - 1.0))
    start = heading_moments(concentration)
    found = followed(start, 0.3, 2.0 * cmath.exp(0.3j), CERTAIN)
    expected = expected_after(
        (np.array([0.0 * phi, 0.0 * phi, phi]), weights / weights.sum()), 2.0, 0.3)
    assert found.second_moment().matrix() == pytest.approx(expected, rel=1e-9, abs=1e-12)
    slip = slip_on_arc(GEOMETRY, 1.0, 1.3, 1e-3, 2e-3)
    distance, turn = pose_change_from_travel(GEOMETRY, 1.0, 1.3)
    arc = arc_moments(distance, turn, slip)
    way = distance * (cmath.exp(1j * turn) - 1.0) / (1j * turn)
    at = 0.3
    after = followed(found, at, way * cmath.exp(1j * at), arc)
    known = [followed(CERTAIN, at + each, way * cmath.exp(1j * (at + each)), arc) for each in phi]
    offsets = 2.0 * (np.exp(1j * (at + phi)) - cmath.exp(1j * at)) + way * (
        np.exp(1j * (at + phi)) - cmath.exp(1j * at))
    total = np.zeros((3, 3))
    for each, offset, weight, angle in zip(known, offsets, weights / weights.sum(), phi):
        mean = np.array([
            (offset + each.mean_error).real, (offset + each.mean_error).imag, angle])
        total += weight * (each.spread.matrix() + np.outer(mean, mean))
    assert after.second_moment().matrix() == pytest.approx(total, rel=1e-9, abs=1e-12)


@LAW
@given(headings, st.lists(st.tuples(travels, travels), min_size=1, max_size=5), slips, slips)
def test_the_second_moment_is_positive_semidefinite(heading, course, k_left, k_right):
    assume(all(not way or abs(way) > 1e-100 for d in course for way in d))  # no underflow
    pose, moments = Pose(0.0, 0.0, heading), CERTAIN
    for d in course:
        pose, moments = propagated_moments(moments, pose, GEOMETRY, *d, k_left, k_right)
        assert lowest_eigenvalue(moments.spread, 0.2) > -1e-13
        assert lowest_eigenvalue(moments.second_moment(), 0.2) > -1e-13


@pytest.mark.slow
@pytest.mark.parametrize('k', [1e-9, 1e-4])
def test_it_is_still_positive_semidefinite_after_1e6_updates(k):
    """Drive straight, turn in place, reverse and turn, over and over."""
    arcs = []
    for d in ((0.01, 0.01), (-0.004, 0.004), (-0.006, -0.006), (0.01, 0.012)):
        distance, turn = pose_change_from_travel(GEOMETRY, *d)
        way = distance * ((cmath.exp(1j * turn) - 1.0) / (1j * turn) if turn else 1.0)
        arcs.append((turn, way, arc_moments(distance, turn, slip_on_arc(GEOMETRY, *d, k, k))))
    moments, heading = CERTAIN, 0.0
    for _ in range(250_000):
        for turn, way, arc in arcs:
            moments = followed(moments, heading, way * cmath.exp(1j * heading), arc)
            heading = math.remainder(heading + turn, math.tau)
    covariance = moments.second_moment()
    assert all(map(math.isfinite, covariance))
    assert lowest_eigenvalue(covariance, 0.2) > -1e-12
    assert lowest_eigenvalue(moments.spread, 0.2) > -1e-12


def test_no_travel_and_no_slip_add_nothing():
    start, pose = gaussian_moments(PoseCovariance(1.0, 0.1, 0.2, 2.0, 0.3, 3.0)), Pose(1.0, 2.0, 3)
    same = propagated_moments(start, pose, GEOMETRY, 0.0, 0.0, 1e-4, 1e-4)[1]
    assert same.second_moment() == pytest.approx(start.second_moment(), rel=1e-14)
    none = propagated_moments(CERTAIN, pose, GEOMETRY, 1.0, -2.0, 0.0, 0.0)[1]
    assert none.second_moment() == NO_COVARIANCE


@pytest.mark.parametrize('bad', [-1e-9, math.nan, math.inf])
def test_a_slip_variance_that_cannot_be_is_refused_by_name(bad):
    with pytest.raises(ValueError, match='^left slip variance is'):
        propagated_moments(CERTAIN, ORIGIN, GEOMETRY, 1.0, 1.0, bad, 0.0)
    with pytest.raises(ValueError, match='^right slip variance is'):
        propagated_moments(CERTAIN, ORIGIN, GEOMETRY, 1.0, 1.0, 0.0, bad)
    with pytest.raises(ValueError, match='^concentration is'):
        heading_moments(-1.0)
