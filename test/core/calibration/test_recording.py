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


"""Recorded drives: what the four forms of wheel data amount to, and what is refused."""

import math

from diffdrive_kinematics.core.calibration import (
    drive_from_commands, drive_from_positions, drive_from_rates, drive_from_ticks)
from diffdrive_kinematics.core.kinematics import WheelGeometry
import numpy as np
import pytest

TIME = [0.0, 1.0, 3.0]
SEEN, POSES = [0.0, 2.0, 4.0], [[0.0, 0.0, 3.0], [1.0, 0.0, -3.0], [1.0, 2.0, -2.0]]


def test_rates_are_held_until_the_next_stamp():
    recorded = drive_from_rates(TIME, [[1.0, 2.0], [3.0, -1.0], [9.0, 9.0]], SEEN, POSES)
    np.testing.assert_allclose(recorded.angles, [[0.0, 0.0], [1.0, 2.0], [7.0, 0.0]])


def test_ticks_are_turned_into_angles_and_those_of_the_first_row_do_not_matter():
    ticks = [[50, 50], [25, -100], [100, 0]]
    recorded = drive_from_ticks(TIME, ticks, SEEN, POSES, ticks_per_turn=100.0)
    rolled = np.diff(recorded.angles, axis=0)
    np.testing.assert_allclose(rolled, math.tau * np.array([[0.25, -1.0], [1.0, 0.0]]))


def test_commands_become_angles_through_the_nominal_geometry():
    geometry = WheelGeometry(0.4, 0.1)
    recorded = drive_from_commands(
        TIME, [[0.5, 1.0], [0.0, -1.0], [0.0, 0.0]], SEEN, POSES, geometry=geometry)
    np.testing.assert_allclose(recorded.angles[1], [3.0, 7.0])
    np.testing.assert_allclose(recorded.angles[2], [3.0 + 4.0, 7.0 - 4.0])


def test_yaw_is_unwrapped():
    recorded = drive_from_positions(TIME, np.zeros((3, 2)), SEEN, POSES)
    np.testing.assert_allclose(recorded.reference[:, 2], [3.0, math.tau - 3.0, math.tau - 2.0])


def test_of_rows_with_one_stamp_the_last_wins_and_the_others_are_counted():
    recorded = drive_from_positions(
        [0.0, 1.0, 1.0, 1.0], [[0.0, 0.0], [5.0, 5.0], [6.0, 6.0], [1.0, 2.0]],
        [0.0, 0.0, 4.0], POSES)
    np.testing.assert_allclose(recorded.angles, [[0.0, 0.0], [1.0, 2.0]])
    assert recorded.reference[0, 0] == 1.0
    assert recorded.duplicates == 3
    ticks = drive_from_ticks([0.0, 1.0, 1.0], [[0, 0], [1, 1], [2, 2]], SEEN, POSES,
                             ticks_per_turn=math.tau)
    np.testing.assert_allclose(ticks.angles, [[0.0, 0.0], [3.0, 3.0]])
    rates = drive_from_rates([0.0, 0.0, 1.0], np.ones((3, 2)), SEEN, POSES)
    assert rates.duplicates == ticks.duplicates == 1


def test_a_part_has_the_rows_between_two_stamps():
    recorded = drive_from_positions(
        np.arange(10.0), np.ones((10, 2)), np.arange(10.0) + 0.5, np.zeros((10, 3)))
    part = recorded.between(2.0, 5.0)
    assert part.time.tolist() == [2.0, 3.0, 4.0, 5.0]
    assert part.reference_time.tolist() == [2.5, 3.5, 4.5]
    with pytest.raises(ValueError, match='time has shape'):
        recorded.between(20.0, 30.0)


@pytest.mark.parametrize('change, message', [
    ({'time': [0.0, 2.0, 1.0]}, r'time is 1.0 in row 2 after 2.0, expected stamps that do not'),
    ({'time': [0.0, math.nan, 1.0]}, 'time is nan in row 1, expected finite'),
    ({'time': [0.0]}, r'time has shape \(1,\), expected \(n,\) with n at least 2'),
    ({'time': [1.0, 1.0, 1.0]}, 'time has 1 different stamps, expected at least 2'),
    ({'positions': np.zeros((3, 3))}, r'positions has shape \(3, 3\), expected \(3, 2\)'),
    ({'positions': [[0.0, 0.0], [math.inf, 0.0], [0.0, 0.0]]},
     r'positions is \[inf, 0.0\] in row 1, expected finite'),
    ({'reference_time': [0.0, 5.0, 4.0]}, 'reference_time is 4.0 in row 2 after 5.0'),
    ({'reference': np.zeros((2, 3))}, r'reference has shape \(2, 3\), expected \(3, 3\)'),
    ({'reference': np.full((3, 3), math.nan)}, 'reference is .nan, nan, nan. in row 0')])
def test_bad_rows_are_refused_by_name_and_row(change, message):
    good = {'time': TIME, 'positions': np.zeros((3, 2)), 'reference_time': SEEN,
            'reference': POSES}
    with pytest.raises(ValueError, match=message):
        drive_from_positions(**{**good, **change})


def test_a_bad_resolution_is_refused():
    with pytest.raises(ValueError, match='ticks_per_turn is 0.0'):
        drive_from_ticks(TIME, np.zeros((3, 2)), SEEN, POSES, ticks_per_turn=0.0)
