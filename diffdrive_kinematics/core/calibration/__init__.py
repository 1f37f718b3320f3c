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

"""
Measuring a robot: its wheels, its bias and its slip, from squares or recorded drives.

UMBmark, least squares on trajectories, and the likelihood of slip on windows of a drive.
"""

from diffdrive_kinematics.core.calibration.calibration_problem import (
    Column, distances_of, FRAME, newton_step, Problem, refuse_unidentified, SAME_DRIVE, sandwich,
    taken_by_fit, WHEELS)
from diffdrive_kinematics.core.calibration.drive_slip import fit_drive_slip, slip_windows
from diffdrive_kinematics.core.calibration.estimate import Estimate
from diffdrive_kinematics.core.calibration.recording import (
    drive_from_commands, drive_from_positions, drive_from_rates, drive_from_ticks,
    RecordedDrive)
from diffdrive_kinematics.core.calibration.slip_fit import (
    fit_reference_noise, fit_slip, nees_per_dof, NO_NOISE, ReferenceNoise, slip_window, SlipFit,
    SlipWindow)
from diffdrive_kinematics.core.calibration.square_errors import (
    angles_of_runs, ratios_of_angles, SquareAngles)
from diffdrive_kinematics.core.calibration.square_slip import slip_from_squares
from diffdrive_kinematics.core.calibration.trajectory_fit import (
    Clock, COMMANDED, fit_trajectory, NO_FRAME, Residual, TrajectoryFit, Windows)
from diffdrive_kinematics.core.calibration.trajectory_windows import (
    CalibrationParameters, linearised, odometry_at, WindowResiduals, windows_between, WindowSet)
from diffdrive_kinematics.core.calibration.umbmark import corrected, ReturnError, Umbmark, umbmark
from diffdrive_kinematics.core.calibration.window_weights import (
    distance, score_covariance, START_VARIANCES, updated_variances, Variances, window_covariance,
    window_weights)

__all__ = [
    'COMMANDED', 'Clock', 'Column', 'Estimate', 'FRAME', 'WindowResiduals', 'NO_FRAME', 'NO_NOISE',
    'Problem', 'ReferenceNoise', 'Residual', 'ReturnError', 'SAME_DRIVE', 'START_VARIANCES',
    'RecordedDrive', 'SlipFit', 'SlipWindow', 'SquareAngles', 'CalibrationParameters',
    'TrajectoryFit', 'Umbmark',
    'Variances', 'WHEELS', 'WindowSet', 'Windows', 'angles_of_runs', 'corrected', 'distance',
    'distances_of', 'fit_reference_noise', 'fit_drive_slip', 'fit_slip', 'fit_trajectory',
    'linearised', 'nees_per_dof', 'newton_step', 'odometry_at', 'ratios_of_angles',
    'refuse_unidentified', 'sandwich', 'score_covariance', 'drive_from_commands',
    'drive_from_positions', 'drive_from_rates', 'drive_from_ticks', 'slip_windows',
    'slip_from_squares', 'slip_window', 'taken_by_fit', 'umbmark', 'updated_variances',
    'window_covariance', 'window_weights', 'windows_between']
