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

"""Recorded drives of encoders, and where odometry says that they end."""

import math

from diffdrive_kinematics.core.calibration import (
    CalibrationParameters, drive_from_ticks, odometry_at)
import numpy as np
from support.recorded import TICKS_PER_TURN


def encoder_drive(path):
    """Return the drive of a file with encoder ticks and poses in each row."""
    rows = np.genfromtxt(path, delimiter=',', names=True)
    return drive_from_ticks(
        rows['time_sec'], np.stack([rows['left_ticks'], rows['right_ticks']], axis=1),
        rows['time_sec'], np.stack([rows['x'], rows['y'], rows['yaw']], axis=1),
        ticks_per_turn=TICKS_PER_TURN)


def predicted_end(geometry, frame, recorded):
    """Return where odometry from the first reference pose ends, and where the centre is then."""
    theta = recorded.reference[[0, -1], 2] - frame.theta
    lever = np.stack([np.cos(theta) * frame.x - np.sin(theta) * frame.y,
                      np.sin(theta) * frame.x + np.cos(theta) * frame.y], axis=1)
    start, end = recorded.reference[[0, -1], :2] - lever
    x, y, _ = odometry_at(geometry, recorded, CalibrationParameters())[-1]
    c, s = math.cos(theta[0]), math.sin(theta[0])
    return start + [c * x - s * y, s * x + c * y], end
