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

"""Sequences of held commands: composition, return, and the times of a recording."""

import math

from diffdrive_kinematics.core.kinematics import (
    advance, check_times, Command, Pose, pose_after, poses_along, retraced)
from hypothesis import given, strategies as st
import mpmath
import pytest

START = Pose(1.0, -2.0, 0.5)
commands = st.builds(
    Command, st.floats(-2.0, 2.0), st.floats(-3.0, 3.0), st.floats(0.0, 2.0))
courses = st.lists(commands, max_size=12)


def composed(start, course):
    """Return the pose after the course in 50-digit arithmetic."""
    with mpmath.workdps(50):
        x, y, theta = map(mpmath.mpf, start)
        for u in course:
            half = mpmath.mpf(u.w) * u.duration / 2
            chord = mpmath.mpf(u.v) * u.duration * mpmath.sinc(half)
            x += chord * mpmath.cos(theta + half)
            y += chord * mpmath.sin(theta + half)
            theta += 2 * half
        return Pose(float(x), float(y), float(theta))


@given(courses)
def test_a_course_is_the_composition_of_its_arcs(course):
    assert pose_after(START, course) == pytest.approx(composed(START, course), abs=1e-12)


@given(courses)
def test_there_is_the_start_and_one_pose_after_each_command(course):
    poses = poses_along(START, iter(course))
    assert len(poses) == len(course) + 1
    assert poses[0] == START
    assert poses[-1] == pose_after(START, course)
    for pose, u, following in zip(poses, course, poses[1:]):
        assert following == advance(pose, u.v * u.duration, u.w * u.duration)


@given(courses)
def test_retracing_a_course_leads_back_through_the_same_poses(course):
    there = poses_along(START, course)
    back = poses_along(there[-1], retraced(course))
    for pose, other in zip(back, reversed(there)):
        assert pose == pytest.approx(other, abs=1e-12)


@given(courses)
def test_retracing_twice_is_the_course_itself(course):
    assert retraced(retraced(course)) == course


@given(courses, st.integers(1, 5))
def test_cutting_commands_into_shorter_ones_changes_nothing(course, parts):
    cut = [Command(u.v, u.w, u.duration / parts) for u in course for _ in range(parts)]
    assert pose_after(START, cut) == pytest.approx(pose_after(START, course), abs=1e-12)


def test_a_square_by_hand_ends_where_it_began_after_a_full_turn():
    side, corner = Command(0.5, 0.0, 4.0), Command(0.0, math.pi / 4, 2.0)
    poses = poses_along(Pose(0.0, 0.0, 0.0), [side, corner] * 4)
    corners = [(0, 0), (2, 0), (2, 2), (0, 2), (0, 0)]
    for pose, expected in zip(poses[::2], corners):
        assert pose[:2] == pytest.approx(expected, abs=1e-14)
    assert poses[-1].theta == pytest.approx(math.tau)


def test_a_command_of_no_duration_moves_nothing():
    assert pose_after(START, [Command(3.0, 2.0, 0.0)]) == START


@pytest.mark.parametrize(('values', 'name'), [
    ((math.nan, 0.0, 1.0), 'v'), ((0.0, math.inf, 1.0), 'omega'), ((0.0, 0.0, -1.0), 'duration'),
    ((0.0, 0.0, math.nan), 'duration'), ((0.0, 0.0, math.inf), 'duration')])
def test_a_bad_command_is_refused_by_name(values, name):
    with pytest.raises(ValueError, match=f'^{name} is'):
        Command(*values)


@pytest.mark.parametrize('times', [[], [0.0], [-3.0, 0.0, 0.0, 1e9]])
def test_sorted_times_are_accepted_and_equal_ones_too(times):
    check_times(times)


@pytest.mark.parametrize(('times', 'message'), [
    ([0.0, 2.0, 1.0], 'row 3 is 1.0, expected 2.0 or later'),
    ([0.0, math.nan], 'row 2 is nan'), ([math.inf], 'row 1 is inf'), ([-math.inf], 'row 1')])
def test_bad_times_are_refused_with_the_row_counted_from_one(times, message):
    with pytest.raises(ValueError, match=message):
        check_times(times)
