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

"""What lasts a run: what it does to a path, and whether the belief in it is right."""

import math

from diffdrive_kinematics.core.kinematics import (
    advance, Command, Pose, pose_change_from_travel, WheelGeometry)
from diffdrive_kinematics.core.noise import (
    CERTAIN, draw_session, NO_COVARIANCE, NO_SESSION, propagated_moments, sample_paths,
    sample_travel, session_generator, SessionBelief, SessionError, SessionSpread,
    travel_in_session, WheelSlip)
import numpy as np
import pytest

GEOMETRY = WheelGeometry(0.2, 0.05)
SPREAD = SessionSpread(scale=0.005, separation=0.01, curvature=0.002)
ARCS = [(1.5, 0.0), (0.7, 1.2), (0.0, -2.0), (-0.4, 1e-9), (-1.1, -0.3), (2.0, 7.0)]
STEP = 0.1  # of a wheel [m]


def travel_of(distance, turn):
    """Return (d_l, d_r) of an arc."""
    return distance - 0.5 * turn * GEOMETRY.separation, distance + 0.5 * turn * GEOMETRY.separation


COURSES = {
    'straight': [(5.0, 0.0)],
    'circle': [(2.5, math.pi)] * 2,
    'square': [(1.25, 0.0), (0.0, 0.5 * math.pi)] * 4}


def believed(arcs, heading, spread=SPREAD):
    """Return the belief after arcs."""
    belief = SessionBelief(spread)
    for distance, turn in arcs:
        belief = belief.after(heading, distance, turn)
        heading += turn
    return belief


def driven(arcs, error):
    """Return where a session leads from the origin."""
    pose = Pose(0.0, 0.0, 0.3)
    for arc in arcs:
        pose = advance(pose, *pose_change_from_travel(
            GEOMETRY, *travel_in_session(error, GEOMETRY.separation, *travel_of(*arc))))
    return np.array(pose)


def assert_same(one, other, tolerance):
    one, other = one.matrix(), other.matrix()
    scale = np.sqrt(np.diag(other))
    assert np.all(np.abs(one - other) <= tolerance * np.outer(scale, scale))


@pytest.mark.parametrize(('distance', 'turn'), ARCS)
def test_an_arc_and_its_parts_give_the_same_covariance(distance, turn):
    before = believed(ARCS, 0.4)
    whole = before.after(2.0, distance, turn).covariance()
    for n in range(1, 101):
        belief = before
        for part in range(n):
            belief = belief.after(2.0 + part * turn / n, distance / n, turn / n)
        assert_same(belief.covariance(), whole, 1e-9)


@pytest.mark.parametrize('only', SessionError._fields)
def test_a_column_is_the_derivative_of_where_the_session_leads(only):
    step = 1e-4
    ends = [driven(ARCS, SessionError(0.0, 0.0, 0.0)._replace(**{only: way * step}))
            for way in (-1.0, 1.0)]
    column = (ends[1] - ends[0]) / (2.0 * step)
    covariance = believed(ARCS, 0.3, SessionSpread(**{only: 1e-6})).covariance().matrix()
    assert 1e12 * covariance == pytest.approx(np.outer(column, column), rel=1e-6, abs=1e-8)


def test_what_bows_the_end_are_the_second_derivatives_of_where_the_session_leads():
    step = 1e-3

    def end(separation, curvature):
        x, y, _ = driven(ARCS, SessionError(0.0, step * separation, step * curvature))
        return complex(x, y) / step**2

    belief = believed(ARCS, 0.3)
    by_separation = end(1, 0) - 2.0 * end(0, 0) + end(-1, 0)
    assert by_separation - 2.0 * belief.by_turns == pytest.approx(belief.bow_turns, rel=1e-4)
    assert end(0, 1) - 2.0 * end(0, 0) + end(0, -1) == pytest.approx(
        belief.bow_curvature, rel=1e-4)
    assert 0.25 * (end(1, 1) - end(1, -1) - end(-1, 1) + end(-1, -1)) == pytest.approx(
        -belief.bow_both, rel=1e-3)


def test_the_covariance_is_positive_semidefinite_over_random_drives():
    generator = np.random.default_rng(5)
    for _ in range(50):
        belief = SessionBelief(SPREAD)
        for _ in range(200):
            kind, distance, turn = generator.integers(3), *generator.normal(size=2)
            belief = belief.after(generator.uniform(-3.0, 3.0), *(
                (distance, 0.0), (0.0, 20.0 * turn), (distance, turn))[kind])
            least, _, largest = np.linalg.eigvalsh(belief.covariance().matrix())
            assert least >= -1e-14 * largest


def test_a_known_pose_starts_without_covariance():
    assert believed(ARCS, 0.0).restarted().covariance() == NO_COVARIANCE


def errors_of_runs(course, k, spread, runs=1_000):
    """Return the errors of runs with slip and a session each, and the moments of the slip."""
    slip, generator = WheelSlip(variance=k), np.random.default_rng(1)
    error = draw_session(spread, session_generator(2), runs)
    truth, pose, moments = Pose(*np.zeros((3, runs))), Pose(0.0, 0.0, 0.0), CERTAIN
    for arc in COURSES[course]:
        d = travel_of(*arc)
        steps = math.ceil(max(map(abs, d)) / STEP)
        nominal = travel_in_session(error, GEOMETRY.separation, *(way / steps for way in d))
        for _ in range(steps):
            travel = (sample_travel(slip, way, generator) for way in nominal)
            truth = advance(truth, *pose_change_from_travel(GEOMETRY, *travel))
        pose, moments = propagated_moments(moments, pose, GEOMETRY, *d, k, k)
    return np.column_stack(truth) - np.array(pose), moments.second_moment()


def nees(errors, covariance):
    """Return ``e^T P^-1 e / 3`` of each run."""
    return np.sum(errors @ np.linalg.inv(covariance.matrix()) * errors, axis=1) / 3.0


@pytest.mark.parametrize('course', COURSES)
def test_nees_is_1_per_degree_of_freedom_with_slip_and_session(course):
    errors, of_slip = errors_of_runs(course, 1e-6, SPREAD)
    found = nees(errors, of_slip.plus(believed(COURSES[course], 0.0).covariance()))
    assert abs(found.mean() - 1.0) < 4.0 * found.std() / math.sqrt(len(found))
    assert nees(errors, of_slip).mean() > 1.5  # without the session it is found out


@pytest.mark.parametrize('yaw', [0.02, 0.1, 0.2])
@pytest.mark.parametrize('course', COURSES)
def test_a_session_that_turns_the_robot_far_bows_its_end_and_nees_stays_1(course, yaw):
    spread = SessionSpread(0.001, 0.005, yaw / 5.0)
    errors, of_slip = errors_of_runs(course, 1e-6, spread)
    found = nees(errors, of_slip.plus(believed(COURSES[course], 0.0, spread).covariance()))
    assert abs(found.mean() - 1.0) < 4.0 * found.std() / math.sqrt(len(found))


def test_sampled_paths_have_one_session_each():
    none, arcs = WheelSlip(), [(0.2, 0.1)] * 20
    paths = sample_paths(
        Pose(0.0, 0.0, 0.3), [Command(v, w, 1.0) for v, w in arcs], GEOMETRY, none, none, n=1000,
        seed=3, session=SPREAD)
    error = draw_session(SPREAD, session_generator(3), 1000)
    for run in (0, 1, 999):
        expected = driven(arcs, SessionError(*(column[run] for column in error)))
        assert [column[-1, run] for column in paths] == pytest.approx(expected, abs=1e-12)


def test_paths_without_a_session_are_what_they_were_to_the_bit():
    course, slip = [Command(0.2, 0.1, 1.0)] * 3, WheelSlip(variance=1e-4)
    one, other = (
        sample_paths(Pose(0.0, 0.0, 0.0), course, GEOMETRY, slip, slip, n=10, seed=3, **session)
        for session in ({}, {'session': NO_SESSION}))
    assert all(np.array_equal(a, b) for a, b in zip(one, other))


def test_one_seed_draws_one_session_and_another_draws_another():
    assert draw_session(SPREAD, session_generator(4)) == draw_session(SPREAD, session_generator(4))
    assert draw_session(SPREAD, session_generator(4)) != draw_session(SPREAD, session_generator(5))


def test_twice_the_spread_is_twice_the_error_of_the_same_run():
    once = draw_session(SPREAD, session_generator(4))
    twice = draw_session(SessionSpread(0.01, 0.02, 0.004), session_generator(4))
    assert twice == pytest.approx([2.0 * value for value in once], rel=1e-12)


def test_drawn_sessions_have_the_standard_deviations_that_were_set():
    runs = 20_000
    for drawn, stddev in zip(draw_session(SPREAD, session_generator(6), runs), (
            SPREAD.scale, SPREAD.separation, SPREAD.curvature)):
        assert abs(drawn.mean()) < 4.0 * stddev / math.sqrt(runs)
        assert abs(drawn.std() / stddev - 1.0) < 4.0 / math.sqrt(2.0 * runs)


def test_a_session_makes_of_a_turn_in_place_a_turn_in_place():
    left, right = travel_in_session(SessionError(0.01, 0.25, 0.5), 0.4, -1.0, 1.0)
    assert left == -right
    assert right == pytest.approx(1.01 / 1.25)


@pytest.mark.parametrize(('name', 'value', 'expected'), [
    ('scale', -0.1, '0 or above'), ('scale', 0.2, '0.1 or below'),
    ('separation', math.nan, 'finite'), ('curvature', -1.0, '0 or above')])
def test_a_spread_out_of_range_is_refused_by_name(name, value, expected):
    with pytest.raises(ValueError, match=f'session {name} stddev is .*{expected}'):
        SessionSpread(**{name: value})
