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

"""The square of UMBmark: closed, of the right length, within its limits."""

import math

from diffdrive_kinematics.core.commands import square_course, square_rounds
from diffdrive_kinematics.core.kinematics import Pose, pose_after, poses_along
from hypothesis import given, settings, strategies as st
import numpy as np
import pytest

LAW = settings(deadline=None, derandomize=True)
ORIGIN = Pose(0.0, 0.0, 0.0)
settings_of_a_square = st.fixed_dictionaries({
    'side': st.floats(0.1, 20.0), 'speed': st.floats(0.01, 3.0),
    'yaw_rate': st.floats(0.01, 5.0), 'clockwise': st.booleans(),
    'pause': st.sampled_from([0.0, 0.7])})
share_of_half_a_side = st.floats(0.0, 1.0)


def radius(square, share):
    """Return a corner radius from none to half the side."""
    return 0.5 * share * square['side']


@LAW
@given(settings_of_a_square, share_of_half_a_side)
def test_a_square_ends_in_the_pose_in_which_it_started(square, share):
    end = pose_after(ORIGIN, square_course(**square, corner_radius=radius(square, share)))
    assert (end.x, end.y) == pytest.approx((0.0, 0.0), abs=1e-13 * square['side'])
    turned = -math.tau if square['clockwise'] else math.tau
    assert end.theta == pytest.approx(turned, rel=1e-14)


@LAW
@given(settings_of_a_square, share_of_half_a_side)
def test_no_motion_is_faster_than_allowed_and_each_is_as_fast_as_allowed(square, share):
    for u in square_course(**square, corner_radius=radius(square, share)):
        assert 0.0 <= u.v <= square['speed']
        assert abs(u.w) <= square['yaw_rate']
        resting = u.v == u.w == 0.0
        fast = max(u.v / square['speed'], abs(u.w) / square['yaw_rate'])
        assert resting or fast == pytest.approx(1.0, rel=1e-12)


@LAW
@given(settings_of_a_square, share_of_half_a_side)
def test_the_way_is_four_shortened_sides_and_a_circle(square, share):
    r = radius(square, share)
    way = math.fsum(u.v * u.duration for u in square_course(**square, corner_radius=r))
    assert way == pytest.approx(4.0 * (square['side'] - 2.0 * r) + math.tau * r, rel=1e-12)


@pytest.mark.parametrize(('clockwise', 'sign'), [(False, 1.0), (True, -1.0)])
def test_a_sharp_square_turns_on_its_corners_to_the_side_that_was_asked_for(clockwise, sign):
    course = square_course(side=2.0, speed=0.5, yaw_rate=0.4, clockwise=clockwise)
    assert [u.v for u in course] == [0.5, 0.0] * 4
    corners = [(2, 0), (2, 2 * sign), (0, 2 * sign), (0, 0)]
    for pose, corner in zip(poses_along(ORIGIN, course)[1::2], corners):
        assert pose[:2] == pytest.approx(corner, abs=1e-14)


@pytest.mark.parametrize('pause', [0.0, 1.5])
def test_rounded_corners_touch_the_sides_of_the_square(pause):
    course = square_course(side=2.0, speed=0.5, yaw_rate=9.0, clockwise=False,
                           corner_radius=0.25, pause=pause)
    poses = poses_along(Pose(0.25, 0.0, 0.0), [u for u in course if u.v])
    touched = [(1.75, 0), (2, 0.25), (2, 1.75), (1.75, 2), (0.25, 2), (0, 1.75), (0, 0.25)]
    for pose, point in zip(poses[1:], touched):
        assert pose[:2] == pytest.approx(point, abs=1e-14)


def test_a_radius_of_half_the_side_makes_a_circle():
    course = square_course(
        side=2.0, speed=0.5, yaw_rate=9.0, clockwise=True, corner_radius=1.0)
    assert [(u.v, u.w) for u in course] == [(0.5, -0.5)] * 4


def test_the_robot_rests_between_motions_and_only_there():
    moving = square_course(side=2.0, speed=0.5, yaw_rate=0.4, clockwise=False)
    course = square_course(side=2.0, speed=0.5, yaw_rate=0.4, clockwise=False, pause=1.5)
    assert course[::2] == moving
    assert [(u.v, u.w, u.duration) for u in course[1::2]] == [(0.0, 0.0, 1.5)] * 7


@pytest.mark.parametrize(('name', 'value'), [
    ('side', 0.0), ('side', -1.0), ('side', math.nan), ('side', math.inf), ('speed', 0.0),
    ('speed', -0.5), ('speed', math.nan), ('yaw_rate', 0.0), ('yaw_rate', -1.0),
    ('yaw_rate', math.inf), ('corner_radius', -0.1), ('corner_radius', 1.01),
    ('corner_radius', math.nan), ('pause', -1.0), ('pause', math.inf)])
def test_a_bad_value_is_refused_by_name(name, value):
    square = {'side': 2.0, 'speed': 0.5, 'yaw_rate': 0.4, 'clockwise': True, name: value}
    with pytest.raises(ValueError, match=f'^{name} is {value!r}, expected '):
        square_course(**square)


@pytest.mark.parametrize('pause', [0.0, 0.7])
def test_rounds_are_squares_each_way_with_a_rest_in_which_each_ends(pause):
    square = {'side': 1.0, 'speed': 0.2, 'yaw_rate': 0.5, 'pause': pause}
    commands, runs = square_rounds(2, **square)
    assert [run.clockwise for run in runs] == [True, True, False, False]
    ends = np.cumsum([command.duration for command in commands])
    begin = 0
    for run in runs:
        once = square_course(clockwise=run.clockwise, **square)
        assert commands[begin:begin + len(once)] == once
        rest = commands[begin + len(once)]
        assert (rest.v, rest.w) == (0.0, 0.0) and rest.duration >= max(1.0, 2.0 * pause)
        begin += len(once) + 1
        assert ends[begin - 2] + pause < run.end + 1e-9 < ends[begin - 1]
        assert poses_along(Pose(0.0, 0.0, 0.0), commands)[begin][:2] == pytest.approx(
            (0.0, 0.0), abs=1e-9)
    assert begin == len(commands)
