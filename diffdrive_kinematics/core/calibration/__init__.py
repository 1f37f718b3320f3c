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

UMBmark, least squares on trajectories, the likelihood of slip on windows of a drive, and the
response of a robot to its commands.  An order in which to read the files:

* what is found: ``calibration_parameters``;
* squares: ``square_runs``, ``square_errors``, ``umbmark`` to first order, ``square_fit`` exactly;
* drives: ``recorded_rows``, ``recorded_drive``, ``drive_sources``, ``drive_odometry``;
* windows of drives: ``trajectory_windows``, ``window_residuals``, ``window_weights``;
* the fit of trajectories: ``trajectory_fit``, from which the others are called: ``fit_setup``,
  ``fit_problem``, ``fit_state``, ``gauss_newton``, ``fit_covariance``, ``clock_choice``,
  ``trajectory_result``; of several sessions: ``session_fit``;
* slip: ``drive_slip``, ``slip_window``, ``slip_stack``, ``slip_fit`` by ``variance_components``
  and ``white_errors``, ``slip_choice``, ``slip_result``;
* the response to commands: ``response_choice``, ``response_forms``, ``response_drive``,
  ``response_fit`` by ``robust_fit``.
"""

from diffdrive_kinematics.core.calibration.calibration_parameters import (
    CalibrationParameters, Estimate)
from diffdrive_kinematics.core.calibration.clock_choice import drift_pays
from diffdrive_kinematics.core.calibration.drive_odometry import odometry_at
from diffdrive_kinematics.core.calibration.drive_slip import fit_drive_slip, slip_windows
from diffdrive_kinematics.core.calibration.drive_sources import (
    drive_from_commands, drive_from_rates, drive_from_ticks)
from diffdrive_kinematics.core.calibration.fit_setup import Clock, NO_FRAME
from diffdrive_kinematics.core.calibration.gauss_newton import Iteration
from diffdrive_kinematics.core.calibration.recorded_drive import (
    drive_from_positions, RecordedDrive, without_frozen_poses)
from diffdrive_kinematics.core.calibration.response_choice import (
    fit_response, Prediction, ResponseFit)
from diffdrive_kinematics.core.calibration.response_drive import commands_of, responded
from diffdrive_kinematics.core.calibration.response_fit import (
    fit_form, fit_heading, FittedResponse, response_errors)
from diffdrive_kinematics.core.calibration.response_forms import FORMS
from diffdrive_kinematics.core.calibration.session_fit import (
    fit_sessions, SessionFit, spread_between)
from diffdrive_kinematics.core.calibration.slip_choice import choose_slip, penalised
from diffdrive_kinematics.core.calibration.slip_fit import fit_reference_noise, fit_slip
from diffdrive_kinematics.core.calibration.slip_result import (
    NO_NOISE, ReferenceNoise, SlipFit, SlipModel)
from diffdrive_kinematics.core.calibration.slip_stack import nees_per_dof, SLIP_TERMS
from diffdrive_kinematics.core.calibration.slip_window import slip_window, SlipWindow
from diffdrive_kinematics.core.calibration.square_fit import fit_squares, SquareFit
from diffdrive_kinematics.core.calibration.square_runs import (
    ReturnError, slip_from_squares, Umbmark)
from diffdrive_kinematics.core.calibration.trajectory_fit import fit_trajectory
from diffdrive_kinematics.core.calibration.trajectory_result import Residual, TrajectoryFit
from diffdrive_kinematics.core.calibration.trajectory_windows import (
    COMMANDED, Windows, windows_between, WindowSet)
from diffdrive_kinematics.core.calibration.umbmark import corrected, FEWEST_RUNS, umbmark
from diffdrive_kinematics.core.calibration.window_residuals import linearised, WindowResiduals
from diffdrive_kinematics.core.calibration.window_weights import Variances

__all__ = [
    'COMMANDED', 'CalibrationParameters', 'Clock', 'Estimate', 'FEWEST_RUNS', 'FORMS',
    'FittedResponse', 'Iteration', 'NO_FRAME', 'NO_NOISE', 'Prediction', 'RecordedDrive',
    'ReferenceNoise', 'Residual', 'ResponseFit', 'ReturnError', 'SLIP_TERMS', 'SessionFit',
    'SlipFit', 'SlipModel', 'SlipWindow', 'SquareFit', 'TrajectoryFit', 'Umbmark', 'Variances',
    'WindowResiduals', 'WindowSet', 'Windows', 'choose_slip', 'commands_of', 'corrected',
    'drift_pays', 'drive_from_commands', 'drive_from_positions', 'drive_from_rates',
    'drive_from_ticks', 'fit_drive_slip', 'fit_form', 'fit_heading', 'fit_reference_noise',
    'fit_response', 'fit_sessions', 'fit_slip', 'fit_squares', 'fit_trajectory', 'linearised',
    'nees_per_dof', 'odometry_at', 'penalised', 'responded', 'response_errors',
    'slip_from_squares', 'slip_window', 'slip_windows', 'spread_between', 'umbmark',
    'windows_between', 'without_frozen_poses']
