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

"""The plan view of a calibration: the way by odometry, laid over that of the reference."""

from dataclasses import replace

from diffdrive_kinematics.core.calibration import (
    CalibrationParameters, drive_from_rates, odometry_at)
from diffdrive_kinematics.core.kinematics import compose, Pose, WheelGeometry
from diffdrive_kinematics.tools.calibration_drawing import way_by_odometry
import numpy as np
import pytest

GEOMETRY = WheelGeometry(0.5, 0.125)
TRUE = CalibrationParameters(left=0.99, right=1.01, separation=1.03)
FRAME, START = Pose(0.3, -0.2, 2.0), Pose(5.0, -3.0, 1.0)


def driven():
    """Return a drive of wheels that are as TRUE, with the reference at FRAME on the robot."""
    stamps = np.arange(0.0, 60.0, 0.1)
    rates = 8.0 + 4.0 * np.stack([np.sin(stamps), np.cos(0.7 * stamps)], axis=1)
    drive = drive_from_rates(stamps, rates, stamps, np.zeros((600, 3)))
    poses = [compose(compose(START, Pose(*row)), FRAME)
             for row in odometry_at(GEOMETRY, drive, TRUE).tolist()]
    return replace(drive, reference=np.array(poses))


def test_odometry_with_the_true_wheels_lies_on_the_reference_wherever_that_sits_on_the_robot():
    drive = driven()
    way = way_by_odometry(GEOMETRY, drive, TRUE, FRAME)
    assert way == pytest.approx(drive.reference[:, :2], abs=1e-9)


def test_odometry_with_other_wheels_begins_there_and_leaves_it():
    drive = driven()
    way = way_by_odometry(GEOMETRY, drive, CalibrationParameters(), FRAME)
    off = np.hypot(*(way - drive.reference[:, :2]).T)
    assert off[0] < 1e-12 and off[-1] > 0.5
