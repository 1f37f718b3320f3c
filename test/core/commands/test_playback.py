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

from diffdrive_kinematics.core.commands import course_from_commands, course_from_recording
from diffdrive_kinematics.core.kinematics import Command
from hypothesis import given, strategies as st
import pytest

durations = st.integers(0, 10**10).map(lambda ns: ns / 1e9)
commands = st.lists(st.builds(
    Command, st.floats(-1.0, 1.0), st.floats(-1.0, 1.0), durations), min_size=1, max_size=6
).filter(lambda listed: any(command.duration for command in listed))


@given(commands)
def test_a_course_is_its_commands_and_a_zero_at_the_end(listed):
    course = course_from_commands(listed)
    assert [(a.v, a.w) for a in course.twists] == [*((u.v, u.w) for u in listed), (0.0, 0.0)]
    for played, given_command in zip(course.commands(), listed):
        assert played.duration == pytest.approx(given_command.duration, abs=1e-9)


@given(commands, st.lists(st.integers(0, 7 * 10**10), max_size=9))
def test_every_twist_is_due_once_and_in_order_however_often_one_looks(listed, looks):
    course = course_from_commands(listed)
    played = []
    for elapsed_ns in (*sorted(looks), course.length_ns):
        due = course.due(len(played), elapsed_ns)
        assert all(twist.offset_ns <= elapsed_ns for twist in due)
        played += due
    assert tuple(played) == course.twists


def test_a_recording_holds_each_row_until_the_next_and_its_last_row_ends_it():
    course = course_from_recording([(3.0, 0.1, 0.0), (3.5, 0.2, 1.0), (4.5, 9.0, 9.0)])
    assert course.commands() == [Command(0.1, 0.0, 0.5), Command(0.2, 1.0, 1.0)]
    assert course.twists[-1] == (1_500_000_000, 0.0, 0.0)


def test_of_rows_with_the_same_time_the_last_one_wins_and_the_others_are_counted():
    course = course_from_recording(
        [(0.0, 0.1, 0.0), (1.0, 0.5, 0.0), (1.0, 0.6, 0.0), (1.0, 0.7, 0.0), (2.0, 0.0, 0.0)])
    assert course.duplicates == 2
    assert course.commands() == [Command(0.1, 0.0, 1.0), Command(0.7, 0.0, 1.0)]


@pytest.mark.parametrize('rows, words', [
    ([], 'no rows'),
    ([(0.0, 0.1, 0.0), (0.0, 0.2, 0.0)], 'one time only'),
    ([(0.0, 0.1, 0.0), (float('nan'), 0.1, 0.0)], 'time in row 2 is nan'),
    ([(0.0, 0.1, 0.0), (1.0, 0.1, float('inf'))], 'angular_z in row 2 is inf'),
    ([(1.0, 0.1, 0.0), (0.5, 0.1, 0.0)], 'expected 1.0 or later')])
def test_a_bad_recording_is_refused_with_its_row(rows, words):
    with pytest.raises(ValueError, match=words):
        course_from_recording(rows)


@pytest.mark.parametrize('listed, words', [
    ([], 'commands is empty'), ([Command(0.1, 0.0, 0.0)], 'commands last 0 s')])
def test_a_course_that_takes_no_time_is_refused(listed, words):
    with pytest.raises(ValueError, match=words):
        course_from_commands(listed)
