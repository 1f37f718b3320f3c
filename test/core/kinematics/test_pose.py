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

"""Chains of poses."""

import math

from diffdrive_kinematics.core.kinematics import between, compose, inverse, Pose, wrap_angle
from hypothesis import given, strategies as st
import pytest

poses = st.builds(
    Pose, st.floats(-9.0, 9.0), st.floats(-9.0, 9.0), st.floats(-math.pi, math.pi))


def assert_same_pose(pose, other):
    assert pose[:2] == pytest.approx(other[:2], abs=1e-12)
    assert wrap_angle(pose.theta - other.theta) == pytest.approx(0.0, abs=1e-12)


@given(poses, poses, poses)
def test_chains_of_poses_are_a_group(a, b, c):
    assert_same_pose(compose(compose(a, b), c), compose(a, compose(b, c)))
    assert_same_pose(compose(a, inverse(a)), Pose(0.0, 0.0, 0.0))
    assert_same_pose(compose(inverse(a), a), Pose(0.0, 0.0, 0.0))
    assert -math.pi < compose(a, b).theta <= math.pi
    assert -math.pi < inverse(a).theta <= math.pi


def test_what_is_ahead_of_a_robot_that_faces_left_is_to_the_left():
    ahead = compose(Pose(1.0, 2.0, math.pi / 2), Pose(3.0, 0.0, 0.0))
    assert_same_pose(ahead, Pose(1.0, 5.0, math.pi / 2))


@given(poses, poses, poses)
def test_the_pose_between_two_does_not_depend_on_the_frame_they_are_seen_from(a, b, c):
    assert_same_pose(between(compose(c, a), compose(c, b)), between(a, b))
    assert_same_pose(compose(a, between(a, b)), b)
    assert_same_pose(between(a, b), compose(inverse(a), b))


def test_the_turn_between_two_poses_counts_whole_turns():
    assert between(Pose(0.0, 0.0, 1.0), Pose(0.0, 0.0, 8.0)).theta == 7.0
