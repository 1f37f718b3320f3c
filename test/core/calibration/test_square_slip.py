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

"""Slip from the scatter of return errors."""

import math

from diffdrive_kinematics.core.calibration import ReturnError, slip_from_squares
from diffdrive_kinematics.core.commands import square_course
from diffdrive_kinematics.core.kinematics import Pose, WheelGeometry
from diffdrive_kinematics.core.noise import sample_paths, WheelSlip
import numpy as np
import pytest

GEOMETRY = WheelGeometry(0.2, 0.04)
SIDE, K, SEEDS, RUNS = 2.0, 1e-6, 300, 5
Z_999 = 3.29


def runs(clockwise, n, seed, radius=0.0):
    """Return where n runs with slip end, of a robot that believes to return to the start."""
    slip = WheelSlip(0.0, K)
    course = square_course(side=SIDE, speed=1.0, yaw_rate=1.0, clockwise=clockwise,
                           corner_radius=radius)
    paths = sample_paths(Pose(0.0, 0.0, 0.0), course, GEOMETRY, slip, slip, n=n, seed=seed)
    return [ReturnError(x, y) for x, y in zip(paths.x[-1].tolist(), paths.y[-1].tolist())]


@pytest.mark.parametrize('radius', [0.0, 0.3])
def test_the_slip_that_moved_the_robot_is_found_with_its_standard_error(radius):
    cw, ccw = (runs(way, SEEDS * RUNS, seed, radius) for seed, way in enumerate((True, False)))
    found = [
        slip_from_squares(GEOMETRY, SIDE, cw[RUNS * i:RUNS * i + RUNS],
                          ccw[RUNS * i:RUNS * i + RUNS], corner_radius=radius)
        for i in range(SEEDS)]
    k, freedom = np.array([each.value for each in found]), 2 * (2 * RUNS - 2)
    assert np.mean(k) / K == pytest.approx(1.0, abs=Z_999 * math.sqrt(2.0 / freedom / SEEDS))
    assert np.std(k) / K == pytest.approx(math.sqrt(2.0 / freedom), rel=0.2)
    assert [each.error / each.value for each in found] == pytest.approx(
        [math.sqrt(2.0 / freedom)] * SEEDS)


def test_systematic_errors_are_not_taken_for_slip():
    cw, ccw = runs(True, RUNS, 1), runs(False, RUNS, 2)
    moved = [ReturnError(run.x + 0.3, run.y - 0.1) for run in cw]
    assert slip_from_squares(GEOMETRY, SIDE, moved, ccw).value == pytest.approx(
        slip_from_squares(GEOMETRY, SIDE, cw, ccw).value, rel=1e-9)


def test_two_runs_show_no_scatter_and_are_refused():
    with pytest.raises(ValueError, match='2 runs, expected at least 3'):
        slip_from_squares(GEOMETRY, SIDE, runs(True, 1, 0), runs(False, 1, 0))
