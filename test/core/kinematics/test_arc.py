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

"""The exact arc, against laws of rigid motion and against 50-digit arithmetic."""

import math

from diffdrive_kinematics.core.kinematics import advance, Pose, sinc
from hypothesis import given, strategies as st
import mpmath
import numpy as np
import pytest

ORIGIN = Pose(0.0, 0.0, 0.0)
poses = st.builds(
    Pose, st.floats(-100.0, 100.0), st.floats(-100.0, 100.0), st.floats(-math.pi, math.pi))
distances = st.floats(-10.0, 10.0)
turns = st.floats(-10.0, 10.0)
MAGNITUDES = np.logspace(-12.0, math.log10(math.pi), 400).tolist()


def same(pose, other, tolerance=1e-13):
    return pose == pytest.approx(other, rel=1e-14, abs=tolerance)


def error_of_change(heading, distance, turn):
    """Return the error of the position, per distance, against 50 digits."""
    moved = advance(Pose(0.0, 0.0, heading), distance, turn)
    with mpmath.workdps(50):
        half = mpmath.mpf(turn) / 2
        chord = distance * mpmath.sin(half) / half
        return float(mpmath.hypot(
            moved.x - chord * mpmath.cos(heading + half),
            moved.y - chord * mpmath.sin(heading + half)) / abs(distance))


@pytest.mark.parametrize('distance', [1.0, -0.37, 123.4, 1e-3])
@pytest.mark.parametrize('sign', [1.0, -1.0])
def test_from_heading_zero_the_error_is_below_5e_16_of_the_distance(distance, sign):
    """Sweep the turn from 1e-12 to pi; measured 3.05e-16."""
    assert max(error_of_change(0.0, distance, sign * turn) for turn in MAGNITUDES) < 5e-16


@pytest.mark.parametrize('heading', [1e-3, 0.5, -1.0, math.pi / 2, 2.0, -3.0, math.pi])
@pytest.mark.parametrize('sign', [1.0, -1.0])
def test_from_any_heading_the_error_is_below_7e_16_of_the_distance(heading, sign):
    """
    Measure the change of position from the origin: at most 4.7e-16, at heading pi.

    The rounding of theta + turn / 2 alone is 4.4e-16 beyond 4 rad: the bound is wider by that.
    """
    worst = max(
        error_of_change(heading, distance, sign * turn)
        for turn in MAGNITUDES[::2] for distance in (1.0, -2.7))
    assert worst < 7e-16


@pytest.mark.parametrize('turn', [0.0, 5e-324, -5e-324, 1e-308, 1e-160])
def test_the_smallest_turns_are_the_straight_line(turn):
    assert same(advance(ORIGIN, 3.0, turn), (3.0, 0.0, 0.0), 1e-150)


@given(poses, distances, turns, st.floats(0.0, 1.0))
def test_two_part_arcs_are_one_arc(pose, distance, turn, part):
    rest = 1.0 - part
    there = advance(advance(pose, part * distance, part * turn), rest * distance, rest * turn)
    assert same(there, advance(pose, distance, turn))


@given(poses, distances, turns)
def test_two_half_arcs_are_one_arc(pose, distance, turn):
    half = advance(pose, 0.5 * distance, 0.5 * turn)
    assert same(advance(half, 0.5 * distance, 0.5 * turn), advance(pose, distance, turn))


@given(poses, distances, turns)
def test_an_arc_and_its_reverse_lead_back(pose, distance, turn):
    assert same(advance(advance(pose, distance, turn), -distance, -turn), pose)


@given(poses, distances, turns)
def test_moving_the_start_moves_the_end_alike(pose, distance, turn):
    change = advance(ORIGIN, distance, turn)
    cosine, sine = math.cos(pose.theta), math.sin(pose.theta)
    assert same(advance(pose, distance, turn), (
        pose.x + cosine * change.x - sine * change.y,
        pose.y + sine * change.x + cosine * change.y, pose.theta + change.theta))


@given(distances, turns)
def test_the_chord_is_never_longer_than_the_arc(distance, turn):
    end = advance(ORIGIN, distance, turn)
    assert math.hypot(end.x, end.y) <= abs(distance) * (1.0 + 4e-16)


@pytest.mark.parametrize(('distance', 'turn', 'end'), [
    (2.0, 0.0, (2.0, 0.0, 0.0)),
    (-2.0, 0.0, (-2.0, 0.0, 0.0)),
    (0.0, 1.5, (0.0, 0.0, 1.5)),
    # quarter circles of radius 1 about (0, 1) to the left and (0, -1) to the right
    (math.pi / 2, math.pi / 2, (1.0, 1.0, math.pi / 2)),
    (math.pi / 2, -math.pi / 2, (1.0, -1.0, -math.pi / 2)),
    (-math.pi / 2, -math.pi / 2, (-1.0, 1.0, -math.pi / 2)),
    (math.pi, math.pi, (0.0, 2.0, math.pi)),
    (math.tau, math.tau, (0.0, 0.0, math.tau))])
def test_lines_turns_in_place_and_circles_by_hand(distance, turn, end):
    assert same(advance(ORIGIN, distance, turn), end, 1e-15)


def test_the_heading_is_not_wrapped():
    assert advance(Pose(0.0, 0.0, 3.0), 0.0, 100.0).theta == 103.0


@given(st.lists(st.tuples(poses, distances, turns), min_size=1, max_size=20))
def test_arrays_of_poses_move_like_each_pose_alone(moves):
    columns = [np.array(column) for column in zip(
        *((*pose, distance, turn) for pose, distance, turn in moves))]
    copies = [column.copy() for column in columns]
    together = advance(Pose(*columns[:3]), *columns[3:])
    alone = [advance(*move) for move in moves]
    np.testing.assert_allclose(np.array(together).T, alone, rtol=1e-15, atol=1e-14)
    np.testing.assert_array_equal(columns, copies, 'an argument was written')


@pytest.mark.parametrize('shape', [(3,), (2, 3), ()])
@pytest.mark.parametrize('which', ['pose', 'distance', 'turn'])
def test_one_array_argument_broadcasts_over_the_others(which, shape):
    value = np.full(shape, 0.25)
    pose, distance, turn = {
        'pose': (Pose(value, value, value), 0.25, 0.25),
        'distance': (Pose(0.25, 0.25, 0.25), value, 0.25),
        'turn': (Pose(0.25, 0.25, 0.25), 0.25, value)}[which]
    moved = advance(pose, distance, turn)
    alone = advance(Pose(0.25, 0.25, 0.25), 0.25, 0.25)
    assert np.shape(moved.x) == shape
    np.testing.assert_allclose(
        np.array(np.broadcast_arrays(*moved)).reshape(3, -1).T,
        np.broadcast_to(alone, (value.size, 3)), rtol=1e-15)


@pytest.mark.parametrize('angle', [0.0, 5e-324, 1e-9, 1e-3, 1.0, math.pi, 20.0])
def test_sinc_is_right_to_the_last_digit_even_and_the_same_for_arrays(angle):
    with mpmath.workdps(50):
        exact = float(mpmath.sinc(mpmath.mpf(angle)))
    assert sinc(angle) == pytest.approx(exact, rel=3e-16, abs=0.0)
    assert sinc(-angle) == sinc(angle)
    assert sinc(np.array([angle]))[0] == pytest.approx(sinc(angle), rel=3e-16, abs=0.0)
