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
The response of a robot to its commands, fitted to drives with a reference.

First gain, veer and delay of the heading, by errors of yaw alone; then, with that heading, the
speed, by errors of position.  So no form of the speed changes what is found of the heading.
"""

from dataclasses import replace
from typing import List, NamedTuple, Sequence, Tuple

from diffdrive_kinematics.core.calibration.calibration_parameters import CalibrationParameters
from diffdrive_kinematics.core.calibration.drive_odometry import odometry_at
from diffdrive_kinematics.core.calibration.recorded_drive import RecordedDrive
from diffdrive_kinematics.core.calibration.response_drive import (
    commands_of, reference_motion, responded)
from diffdrive_kinematics.core.calibration.response_forms import (
    DELAYS_S, form_of, GAINS, VEERS, within)
from diffdrive_kinematics.core.calibration.robust_fit import robust_fit
from diffdrive_kinematics.core.calibration.trajectory_windows import (
    COMMANDED, Windows, windows_between, WindowSet)
from diffdrive_kinematics.core.commands import CommandResponse
from diffdrive_kinematics.core.kinematics import Array, WheelGeometry, wrap_angle
from diffdrive_kinematics.core.noise import rotations
import numpy as np

AS_GIVEN, LEAST_WINDOWS = CalibrationParameters(), 3
DELAY_S = 0.2  # where the search starts


class FittedResponse(NamedTuple):
    """
    A response, and where the reference sits on the robot.

    Parameters
    ----------
    response : CommandResponse
        How the robot follows.
    frame : numpy.ndarray, shape (3,)
        Pose (x [m], y [m], yaw [rad]) of the reference's frame on the robot.

    Examples
    --------
    >>> FittedResponse(CommandResponse(0.5, 2.0), np.zeros(3)).response.speed_gain
    1.0

    """

    response: CommandResponse
    frame: Array


_Part = Tuple[RecordedDrive, WindowSet]


def fit_heading(geometry: WheelGeometry, drives: Sequence[RecordedDrive]) -> CommandResponse:
    """
    Return the response with gain and veer of the yaw rate, delay, and the range driven.

    Parameters
    ----------
    geometry : WheelGeometry
        Size and spacing of the wheels, those that the drives were made with.
    drives : sequence of RecordedDrive
        Drives of :func:`.drive_from_commands`.

    Returns
    -------
    CommandResponse
        Without gain or loss of the speed.

    Raises
    ------
    ValueError
        If the drives are too short, or never drive and turn.

    Examples
    --------
    See :func:`fit_form`.

    """
    parts = _parts(drives)
    commands = np.abs(np.concatenate([commands_of(geometry, drive) for drive in drives]))
    speed, yaw_rate = commands.max(axis=0)
    if not (speed > 1e-6 and yaw_rate > 1e-6):
        raise ValueError(
            f'the largest commands are {speed:g} m/s and {yaw_rate:g} rad/s, expected a drive '
            'with both, straights and turns')
    sums = [np.vstack([np.zeros(2), np.cumsum(
        np.diff(drive.time)[:, None] * commands_of(geometry, drive), axis=0)])
        for drive in drives]
    turned = [reference_motion(drive, windows.start, windows.end, np.zeros(3))[:, 2]
              for drive, windows in parts]

    def errors(values: Array) -> Array:
        gain, veer, late = values
        found = []
        for (drive, windows), total, turn in zip(parts, sums, turned):
            asked = np.stack([np.interp(drive.reference_time - late, drive.time, column)
                              for column in total.T], axis=1)
            there = asked[windows.end] - asked[windows.start]
            found.append(wrap_angle(turn - there @ [veer, gain]))
        return np.concatenate(found)[:, None]

    gain, veer, late = robust_fit(errors, np.array([1.0, 0.0, DELAY_S]), np.zeros((0, 3)))
    return CommandResponse(
        round(float(speed), 9), round(float(yaw_rate), 9), yaw_rate_gain=within(gain, GAINS),
        veer=within(veer, VEERS), delay=within(late, DELAYS_S))


def fit_form(
        geometry: WheelGeometry, drives: Sequence[RecordedDrive], heading: CommandResponse,
        form: str) -> FittedResponse:
    """
    Return the response with the share of the speed fitted in a form, and the reference's frame.

    Parameters
    ----------
    geometry : WheelGeometry
        Size and spacing of the wheels, those that the drives were made with.
    drives : sequence of RecordedDrive
        Drives of :func:`.drive_from_commands`.
    heading : CommandResponse
        That of :func:`fit_heading`.
    form : str
        One of ``FORMS``.

    Returns
    -------
    FittedResponse
        The response, and where the reference sits.

    Raises
    ------
    ValueError
        If the drives are too short, or no robot could do what fits best.

    Examples
    --------
    A robot that drives 0.9 of the speed that it is asked for, in commands and in poses:

    >>> from diffdrive_kinematics.core.calibration import drive_from_commands
    >>> geometry, stamps = WheelGeometry(0.5, 0.125), 0.1 * np.arange(600)
    >>> asked = np.stack([np.full(600, 0.2), np.sin(0.3 * stamps)], axis=1)
    >>> bare = drive_from_commands(stamps, asked, stamps, np.zeros((600, 3)), geometry=geometry)
    >>> moved = responded(geometry, bare, CommandResponse(0.2, 1.0, speed_gain=0.9))
    >>> drive = drive_from_commands(
    ...     stamps, asked, stamps, odometry_at(geometry, moved, AS_GIVEN), geometry=geometry)
    >>> found = fit_form(geometry, [drive], fit_heading(geometry, [drive]), 'gains')
    >>> round(found.response.speed_gain, 3), round(found.response.yaw_rate_gain, 3)
    (0.9, 1.0)

    """
    start, penalty, respond = form_of(geometry, drives, heading, form)
    parts, size = _parts(drives), len(start)

    def errors(values: Array) -> Array:
        fitted = FittedResponse(respond(values[:size]), values[size:])
        return np.concatenate([_errors(geometry, part, fitted)[:, :2] for part in parts])

    rows = np.hstack([penalty, np.zeros((len(penalty), 3))])
    found = robust_fit(errors, np.append(start, np.zeros(3)), rows)
    return FittedResponse(respond(found[:size]), found[size:])


def response_errors(
        geometry: WheelGeometry, drives: Sequence[RecordedDrive], fitted: FittedResponse,
        windows: Windows) -> Array:
    """
    Return the errors of windows: the reference's motion minus that of the response.

    Parameters
    ----------
    geometry : WheelGeometry
        Size and spacing of the wheels, those that the drives were made with.
    drives : sequence of RecordedDrive
        Drives of :func:`.drive_from_commands`.
    fitted : FittedResponse
        The response, and where the reference sits.
    windows : Windows
        Which windows.

    Returns
    -------
    numpy.ndarray, shape (w, 3)
        Errors (x [m], y [m], theta [rad]) in the frame of the start.

    Examples
    --------
    >>> from diffdrive_kinematics.core.calibration import drive_from_commands
    >>> stamps, geometry = np.arange(4.0), WheelGeometry(0.5, 0.125)
    >>> drive = drive_from_commands(
    ...     stamps, [[0.5, 0.0]] * 4, stamps, np.zeros((4, 3)), geometry=geometry)
    >>> fitted = FittedResponse(CommandResponse(1.0, 1.0, speed_gain=0.5), np.zeros(3))
    >>> response_errors(geometry, [drive], fitted, Windows((1.0,), every=1.0))[:, 0]
    array([-0.25, -0.25, -0.25])

    """
    return np.concatenate([_errors(geometry, part, fitted) for part in _parts(drives, windows)])


def _parts(drives: Sequence[RecordedDrive], windows: Windows = COMMANDED) -> List[_Part]:
    parts = [_part(drive, windows) for drive in drives]
    count = sum(len(found.start) for _, found in parts)
    if count < LEAST_WINDOWS:
        lengths = ' or '.join(f'{length:g}' for length in windows.lengths)
        raise ValueError(
            f'the reference has {count} windows of {lengths} s in a part of the drives that is '
            f'fitted or compared, expected {LEAST_WINDOWS}')
    return parts


def _part(drive: RecordedDrive, windows: Windows) -> _Part:
    """Return the windows of a drive, and the drive with the samples of the reference they need."""
    start, end, in_gaps = windows_between(drive, windows.lengths, windows.every, windows.tolerance)
    rows, at = np.unique(np.concatenate([start, end]), return_inverse=True)
    return (
        replace(drive, reference_time=drive.reference_time[rows], reference=drive.reference[rows]),
        WindowSet(at[:len(start)], at[len(start):], in_gaps))


def _errors(geometry: WheelGeometry, part: _Part, fitted: FittedResponse) -> Array:
    drive, (start, end, _) = part
    pose = odometry_at(geometry, responded(geometry, drive, fitted.response), AS_GIVEN)
    told = np.einsum('wij,wj->wi', rotations(-pose[start, 2]), pose[end] - pose[start])
    error: Array = reference_motion(drive, start, end, fitted.frame) - told
    error[:, 2] = wrap_angle(error[:, 2])
    return error
