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

"""Slip of the body: its law, its moments, and what sampled paths make of it."""

import math

from diffdrive_kinematics.core.kinematics import advance, Command, Pose, WheelGeometry
from diffdrive_kinematics.core.noise import (
    arcs_along, body_covariance_along, body_variances, BodySlip, CERTAIN, DISTRIBUTIONS,
    NO_BODY_SLIP, propagate, propagated_moments, sample_paths, slip_on_arc, twist_covariance,
    WheelSlip)
from hypothesis import given, settings, strategies as st
import numpy as np
import pytest

LAW = settings(deadline=None, derandomize=True)
GEOMETRY = WheelGeometry(0.2, 0.05)
ORIGIN = Pose(0.0, 0.0, 0.0)
BODY = BodySlip(linear_variance=1e-3, turn_variance=0.01, heading_variance=2e-3)
EACH = pytest.mark.parametrize('body', [
    BodySlip(1e-3), BodySlip(turn_variance=0.01), BodySlip(heading_variance=2e-3), BODY])
variances = st.one_of(st.just(0.0), st.floats(1e-9, 0.1))
bodies = st.builds(BodySlip, variances, variances, variances)


def travel_of(distance, turn):
    """Return (d_l, d_r) of an arc."""
    return distance - 0.5 * turn * GEOMETRY.separation, distance + 0.5 * turn * GEOMETRY.separation


def in_steps(arc, k, body, n):
    """Return the moments after n equal parts of an arc (distance, turn)."""
    pose, moments = Pose(3.0, -1.0, 2.9), CERTAIN
    for _ in range(n):
        pose, moments = propagated_moments(
            moments, pose, GEOMETRY, *travel_of(*(each / n for each in arc)), *k, body)
    return moments


def discrepancy(moments, other):
    """Return the largest ``|dP_ij| / sqrt(P_ii P_jj)``."""
    first, second = (each.second_moment().matrix() for each in (moments, other))
    scale = np.sqrt(np.diag(second))
    return float(np.max(np.abs(first - second) / np.outer(scale, scale)))


@pytest.mark.parametrize(('distance', 'turn', 'expected'), [
    (2.0, 0.0, (2e-3, 4e-3)), (-2.0, 0.0, (2e-3, 4e-3)), (0.0, -0.5, (0.0, 5e-3)),
    (1.0, 3.0, (1e-3, 0.032)), (0.0, 0.0, (0.0, 0.0))])
def test_the_variances_by_hand(distance, turn, expected):
    assert body_variances(BODY, distance, turn) == pytest.approx(expected)
    both, together, heading = slip_on_arc(GEOMETRY, *travel_of(distance, turn), 0.0, 0.0, BODY)
    assert (both, heading) == pytest.approx(expected, rel=1e-12, abs=1e-18)
    assert together == 0.0


@LAW
@given(st.floats(-5.0, 5.0), st.floats(-3.0, 3.0), variances, variances, bodies)
def test_the_slip_of_the_body_is_independent_of_that_of_the_wheels(
        distance, turn, k_left, k_right, body):
    d = travel_of(distance, turn)
    wheels, alone, all_slip = (
        slip_on_arc(GEOMETRY, *d, *k, each) for k, each in (
            ((k_left, k_right), NO_BODY_SLIP), ((0.0, 0.0), body), ((k_left, k_right), body)))
    assert all_slip == pytest.approx(np.add(wheels, alone), rel=1e-12)


@pytest.mark.parametrize('n', range(1, 101))
def test_one_arc_is_n_arcs_for_every_n_and_signs(n):
    worst = 0.0
    for turn in (0.0, 1e-9, 0.1, -0.5, 1.0, 30.0):
        for distance in (0.5, -0.5, 0.0, 20.0):
            for k in ((0.0, 0.0), (1e-5, 3e-5)):
                if distance or turn and k[0]:  # in place the body alone moves no centre
                    one, many = (in_steps((distance, turn), k, BODY, each) for each in (1, n))
                    worst = max(worst, discrepancy(many, one))
    assert worst < 1e-9


@pytest.mark.parametrize('n', [1, 7, 100])
def test_in_place_only_the_turn_counts_and_only_the_heading_is_lost(n):
    moments = in_steps((0.0, 2.0), (0.0, 0.0), BODY, n).second_moment()
    assert moments.tt == pytest.approx(0.02, rel=1e-12)
    assert moments[:-1] == pytest.approx((0.0,) * 5, abs=1e-15)


@EACH
def test_small_slip_of_a_path_has_the_covariance_of_first_order(body):
    rows = np.array([(1.0, 1.3), (-0.2, 0.2), (2.0, 1.0), (-1.0, -1.0), (0.0, 0.3)])
    constants = [1e-9 * each for each in (
        body.linear_variance, body.turn_variance, body.heading_variance)]
    pose, moments = ORIGIN, CERTAIN
    for row in rows:
        pose, moments = propagated_moments(
            moments, pose, GEOMETRY, *row, 0.0, 0.0, BodySlip(*constants))
    gathered = np.einsum('k,kij->ij', constants, body_covariance_along(arcs_along(GEOMETRY, rows)))
    scale = np.sqrt(np.maximum(np.diag(gathered), 1e-20))
    assert moments.second_moment().matrix() / np.outer(scale, scale) == pytest.approx(
        gathered / np.outer(scale, scale), abs=1e-7)


@LAW
@given(st.lists(st.tuples(st.floats(-5.0, 5.0), st.floats(-5.0, 5.0)), min_size=1, max_size=5),
       variances, bodies)
def test_the_second_moment_is_positive_semidefinite(course, k, body):
    pose, moments = ORIGIN, CERTAIN
    for d in course:
        pose, moments = propagated_moments(moments, pose, GEOMETRY, *d, k, k, body)
    values = np.linalg.eigvalsh(moments.second_moment().matrix())
    assert values[0] >= -1e-13 * values[-1]


@pytest.mark.parametrize('n', [1, 10, 500])
def test_twists_of_any_rate_gather_the_variances_of_the_way(n):
    """One second of rates 20 and 30 rad/s."""
    twist, still = (twist_covariance(
        GEOMETRY, (20.0, 30.0), 1e-4, 2e-4, 1.0 / n, floor=0.0, body=body)
        for body in (BODY, NO_BODY_SLIP))
    added = body_variances(BODY, 1.25, 2.5)
    assert (twist.vv - still.vv) / n == pytest.approx(added[0], rel=1e-9)
    assert (twist.ww - still.ww) / n == pytest.approx(added[1], rel=1e-9)
    assert twist.vw == still.vw


@pytest.mark.parametrize(('values', 'name'), [
    ((-1e-9,), 'linear slip variance'), ((0.0, math.nan), 'turn slip variance'),
    ((0.0, 0.0, math.inf), 'heading slip variance'), ((0.0, 0.0, 0.0, 'normal'),
                                                      'slip distribution')])
def test_bad_values_are_refused_by_name(values, name):
    with pytest.raises(ValueError, match=f'^{name} is'):
        BodySlip(*values)


def test_nothing_is_the_default():
    assert BodySlip() == NO_BODY_SLIP and not NO_BODY_SLIP and BODY


def sampled(course, slips, body, n, seed, start=ORIGIN):
    """Return poses after a course of (distance, turn), each in one step of ``propagate``."""
    poses = Pose(*(np.full(n, value) for value in start))
    for step, arc in enumerate(course):
        poses = propagate(
            poses, *travel_of(*arc), GEOMETRY, *slips, seed=(seed, step), body=body)
    return poses


def errors(poses, pose):
    """Return by how much poses are off in x, y and theta, shape (3, n)."""
    return np.stack([poses.x - pose.x, poses.y - pose.y, poses.theta - pose.theta])


@EACH
@pytest.mark.parametrize('course', [
    100 * [(0.2, 0.0)], 100 * [(0.1, 0.05)], 40 * [(-0.1, -0.1)],
    8 * ([(0.25, 0.0)] * 4 + [(0.0, 0.25)] * 3)], ids=['straight', 'arc', 'reverse', 'square'])
def test_sampled_paths_have_the_exact_moments(body, course):
    """Compare 20,000 paths, whose variances have a relative standard error of 1 % and more."""
    slips = (WheelSlip(variance=1e-6),) * 2
    pose, moments = ORIGIN, CERTAIN
    for arc in course:
        pose, moments = propagated_moments(
            moments, pose, GEOMETRY, *travel_of(*arc), 1e-6, 1e-6, body)
    error = errors(sampled(course, slips, body, 20_000, 5), pose)
    expected = moments.second_moment().matrix()
    scale = np.sqrt(np.diag(expected))
    found = error @ error.T / error.shape[1]
    spread = (error[:, None] * error).std(axis=2) / math.sqrt(error.shape[1])
    assert np.all(np.abs(found - expected) < 4.0 * spread + 0.01 * np.outer(scale, scale))
    assert np.mean(error[0] + 1j * error[1]) == pytest.approx(
        moments.mean_error, abs=4.0 * float(np.max(scale[:2])) / math.sqrt(error.shape[1]))


@pytest.mark.parametrize('yaw', [0.02, 0.1, 0.3])
@pytest.mark.parametrize('course', [
    200 * [(0.1, 0.0)], 200 * [(0.1, 0.05 * math.pi)],
    4 * (50 * [(0.1, 0.0)] + 10 * [(0.0, 0.05 * math.pi)])], ids=['straight', 'circle', 'square'])
def test_nees_of_20_m_is_1_whatever_the_yaw(course, yaw):
    """Over 1,000 runs, within four of its own standard errors; a constant scales with the yaw."""
    turn, way = (sum(abs(each[i]) for each in course) for i in (1, 0))
    body = BodySlip(0.05 * yaw**2, yaw**2 / (turn + 0.2 * way), 0.2 * yaw**2 / (turn + 0.2 * way))
    pose, moments = ORIGIN, CERTAIN
    for arc in course:
        pose, moments = propagated_moments(
            moments, pose, GEOMETRY, *travel_of(*arc), 0.0, 0.0, body)
    assert moments.spread.tt == pytest.approx(yaw**2)
    error = errors(sampled(course, (WheelSlip(),) * 2, body, 1000, 11), pose)
    nees = np.sum(error * np.linalg.solve(moments.second_moment().matrix(), error), axis=0) / 3.0
    assert abs(nees.mean() - 1.0) < 4.0 * nees.std() / math.sqrt(len(nees))


@pytest.mark.parametrize('distribution', DISTRIBUTIONS)
@pytest.mark.parametrize('arc', [(0.3, 0.0), (-0.3, 0.0), (0.2, 0.3), (0.0, -0.3)])
def test_one_step_of_samples_has_the_variances_asked_for(arc, distribution):
    """And as wide across as many steps have it, within 1 %."""
    body = BodySlip(2e-4, 1e-3, 2e-3, distribution)
    variances, n = body_variances(body, *arc), 200_000
    poses = sampled([arc], (WheelSlip(),) * 2, body, n, 1)
    pose = advance(ORIGIN, *arc)
    assert np.var(poses.theta) == pytest.approx(variances[1], rel=0.015)
    direction = 0.5 * arc[1]
    error = errors(poses, pose)
    along, across = (math.cos(direction) * error[0] + math.sin(direction) * error[1],
                     math.cos(direction) * error[1] - math.sin(direction) * error[0])
    _, moments = propagated_moments(
        CERTAIN, ORIGIN, GEOMETRY, *travel_of(*arc), 0.0, 0.0, BodySlip(2e-4, 1e-3, 2e-3))
    expected = moments.spread.rotated(-direction)
    if arc[0]:
        assert np.var(along) == pytest.approx(expected.xx, rel=0.02)
        assert np.var(across) == pytest.approx(expected.yy, rel=0.02)
    else:
        assert np.hypot(along, across).max() == 0.0


def test_the_slip_of_the_body_leaves_the_draws_of_the_wheels_as_they_are():
    slips = (WheelSlip(variance=1e-5),) * 2
    tiny = BodySlip(1e-30, 1e-30, 1e-30)
    for with_body, without in zip(*(
            sampled([(0.2, 0.1)], slips, body, 40_000, 3) for body in (tiny, NO_BODY_SLIP))):
        np.testing.assert_allclose(with_body, without, rtol=1e-12, atol=1e-13)


@pytest.mark.parametrize('distribution', ['gaussian', 'uniform'])
def test_samples_do_not_depend_on_threads_or_on_what_else_is_in_the_chunk(distribution):
    body = BodySlip(1e-3, 0.01, 1e-3, distribution)
    slip, n = WheelSlip(variance=1e-5, distribution=distribution), 40_001
    poses, travel = Pose(*np.zeros((3, n))), np.linspace(0.0, 0.5, n)
    one, two, alike = (
        propagate(poses, d, d, GEOMETRY, slip, slip, seed=2, threads=threads, body=body)
        for d, threads in ((travel, 1), (travel, 2), (0.5, 1)))
    for a, b, c in zip(one, two, alike):
        np.testing.assert_array_equal(a, b)
        assert a[-1] == pytest.approx(c[-1], rel=1e-12)


def test_sample_paths_have_the_slip_of_the_body_in_every_step():
    commands = 5 * [Command(0.2, 0.0, 1.0)]
    paths = sample_paths(ORIGIN, commands, GEOMETRY, WheelSlip(), WheelSlip(), n=20_000, seed=1,
                         body=BodySlip(heading_variance=0.01))
    assert np.var(paths.theta, axis=1) == pytest.approx(
        0.002 * np.arange(6), rel=4.0 * math.sqrt(2.0 / 20_000))
