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

"""Several wheels of a side make one position, whatever one of them says."""

import math
import random

from diffdrive_kinematics.core.odometry import Encoder
from diffdrive_kinematics.core.odometry.wheel_comparison import SHARE
from diffdrive_kinematics.core.odometry.wheel_side import SideTrack
from hypothesis import given, strategies
import pytest

NAN = math.nan


def played(rows, others=None):
    """Return the track and its positions after rows of readings, while the other side moves."""
    others = others or [0.1 * number for number in range(len(rows))]
    track, positions = SideTrack.starting_at(rows[0], others[0]), []
    positions.append(track.position)
    for row, other in zip(rows[1:], others[1:]):
        track, position = track.followed(row, other)
        positions.append(position)
    return track, positions


@given(strategies.lists(
    strategies.tuples(*[strategies.floats(-1e3, 1e3)] * 2), min_size=1, max_size=7))
def test_wheels_that_are_all_heard_are_their_mean_to_the_bit(rows):
    """Up to where they are first compared and differ."""
    _, positions = played(rows)
    assert positions == [sum(row) / 2 for row in rows]


@given(strategies.lists(strategies.floats(-0.5, 0.5), min_size=2, max_size=60), strategies.data())
def test_wheels_that_roll_alike_make_the_way_they_roll_whoever_is_heard(steps, data):
    angle, rows, angles = 0.0, [(5.0, -7.0, 100.0)], [0.0]
    for step in steps:
        angle += step
        heard = data.draw(strategies.tuples(*[strategies.booleans()] * 3))
        angles.append(angle)
        rows.append(tuple(start + angle if hear else NAN
                          for start, hear in zip((5.0, -7.0, 100.0), heard)))
    track, positions = played(rows)
    for row, position, expected in zip(rows, positions, angles):
        if all(value != value for value in row):
            assert position != position
        else:
            assert position - positions[0] == pytest.approx(expected, abs=1e-10)
    assert track.disagreement is None


@pytest.mark.parametrize('bad', [NAN, math.inf, -math.inf, 1.7e308])
def test_a_reading_that_is_no_number_is_left_out(bad):
    _, positions = played([(0.0, 1.0), (0.5, 1.5), (1.0, bad), (1.5, 2.5)])
    assert positions == pytest.approx([0.5, 1.0, 1.5, 2.0])


def test_a_wheel_that_is_heard_for_the_first_time_later_moves_nothing():
    _, positions = played([(0.0, NAN), (0.5, NAN), (0.75, 900.0), (1.0, 900.25)])
    assert positions == pytest.approx([0.0, 0.5, 0.75, 1.0])


def test_what_differs_by_some_per_cent_is_their_mean_and_no_disagreement():
    random.seed(1)
    rows, a, b = [], 0.0, 0.0
    for _ in range(5000):
        step = random.uniform(-0.1, 0.2)
        a, b = a + 1.05 * step * random.uniform(0.9, 1.1), b + 0.95 * step
        rows.append((a, b))
    track = SideTrack.starting_at(rows[0])
    for number, row in enumerate(rows):
        track, position = track.followed(row, 0.1 * number)
        assert track.disagreement is None and position == (row[0] + row[1]) / 2


@pytest.mark.parametrize('ticks', [20, 90, 512])
@pytest.mark.parametrize('step', [0.01, 0.1, 0.5])
def test_encoders_that_tick_one_after_the_other_do_not_disagree(ticks, step):
    read = Encoder(resolution=ticks).reading
    rows = [(read(step * number), read(step * number + 0.7 * math.tau / ticks))
            for number in range(500)]
    track = SideTrack.starting_at(rows[0])
    for number, row in enumerate(rows):
        track, _ = track.followed(row, step * number)
        assert track.disagreement is None


@pytest.mark.parametrize('sign', [1.0, -1.0])
@pytest.mark.parametrize('step', [0.02, 0.2])
def test_of_two_wheels_the_one_that_stands_while_the_other_side_moves_is_left_out(sign, step):
    rows = [(3.0, sign * step * number) for number in range(200)]
    track, positions = played(rows, [step * number for number in range(200)])
    assert track.left_out == (True, False)
    assert positions[-1] - positions[0] == pytest.approx(sign * step * 199, abs=1e-9)
    assert track.disagreement.travels[0] == 0.0


def test_where_the_other_side_stands_too_it_is_not_known_which_wheel_is_right():
    track, positions = played([(3.0, 0.1 * number) for number in range(200)], [4.0] * 200)
    assert track.left_out == (False, False) and track.disagreement
    assert positions[-1] - positions[0] == pytest.approx(0.05 * 199)


def test_a_wheel_that_turns_again_takes_part_again_and_nothing_jumps():
    rows = [(0.0, 0.1 * number) for number in range(100)]
    rows += [(0.1 * number, 9.9 + 0.1 * number) for number in range(100)]
    track, positions = played(rows)
    assert track.left_out == (False, False) and track.disagreement is None
    assert positions[-1] - positions[0] == pytest.approx(19.8, abs=1e-9)
    steps = [b - a for a, b in zip(positions[20:], positions[21:])]
    assert min(steps) > -1e-9 and max(steps) < 0.1 + 1e-9


def test_a_wheel_that_is_left_out_stays_out_while_nothing_shows_which_one_is_right():
    """On the spot about a side that stands."""
    others = [min(0.1 * number, 10.0) for number in range(300)]
    track, positions = played([(0.0, 0.1 * number) for number in range(300)], others)
    assert track.left_out == (True, False)
    assert positions[-1] - positions[0] == pytest.approx(29.9, abs=1e-9)


@pytest.mark.parametrize('wrong', [0.0, 0.5, 2.0, -1.0])
def test_of_three_wheels_the_one_that_differs_from_the_median_is_left_out(wrong):
    rows = [(0.1 * number, wrong * 0.1 * number, 0.1 * number) for number in range(200)]
    track, positions = played(rows, [0.0] * 200)
    assert track.left_out == (False, True, False)
    assert positions[-1] == pytest.approx(19.9, abs=1e-9)


@pytest.mark.parametrize('every', [2, 5, 9, 20])
@pytest.mark.parametrize('wheels', [2, 3])
def test_a_stuck_encoder_is_found_however_often_its_neighbour_says_nothing(every, wheels):
    rows = [(NAN if number % every == every - 1 else 0.02 * number, 1.0, 0.02 * number)[:wheels]
            for number in range(3000)]
    track, positions = played(rows, [0.02 * number for number in range(3000)])
    assert track.left_out[1] and track.disagreement
    ways = [position for position in positions if position == position]
    assert ways[-1] - ways[0] == pytest.approx(0.02 * 2999, abs=0.05)


@given(strategies.lists(strategies.floats(0.01, 0.3), min_size=20, max_size=80), strategies.data())
def test_a_wheel_that_comes_in_is_compared_by_what_it_goes_from_there_on(steps, data):
    """Rates are summed up while they are heard only, positions go on meanwhile."""
    angle, rows = 0.0, []
    first = data.draw(strategies.integers(0, len(steps)))
    silent = data.draw(strategies.integers(0, len(steps)))
    for number, step in enumerate(steps):
        angle += step
        rows.append((angle, angle - 7.0, NAN if number < first else angle + 90.0,
                     NAN if silent <= number < silent + 15 else angle))
    track = SideTrack.starting_at(rows[0])
    for row in rows[1:]:
        track, _ = track.followed(row, row[0])
        assert track.disagreement is None


@pytest.mark.parametrize('share, differs', [
    (1.0 - SHARE - 0.02, True), (1.0 - SHARE + 0.02, False)])
def test_of_two_wheels_that_both_turn_differently_the_mean_counts_and_it_is_told(share, differs):
    track, positions = played([(0.1 * number, share * 0.1 * number) for number in range(200)])
    assert track.left_out == (False, False)
    assert (track.disagreement is not None) == differs
    assert positions[-1] == pytest.approx(0.5 * (1.0 + share) * 19.9)


def test_a_side_of_which_nothing_is_heard_goes_on_where_the_wheels_have_got_to():
    _, positions = played([(0.0, 0.0), (0.5, 0.5), (NAN, NAN), (1.5, NAN), (2.0, 2.0)])
    assert positions[2] != positions[2]
    assert positions[3:] == pytest.approx([1.5, 2.0])


def test_nothing_heard_at_first_is_no_position_and_what_comes_then_is_where_it_begins():
    _, positions = played([(NAN, NAN), (NAN, 4.0), (1.0, 4.5)])
    assert positions[0] != positions[0]
    assert positions[1:] == pytest.approx([4.0, 4.5])
