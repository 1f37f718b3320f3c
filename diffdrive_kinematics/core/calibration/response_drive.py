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

"""Drives of which the commands are known: what was asked for, and what a response makes of it."""

from dataclasses import replace

from diffdrive_kinematics.core.calibration.recorded_drive import Indices, RecordedDrive
from diffdrive_kinematics.core.commands import CommandResponse
from diffdrive_kinematics.core.kinematics import (
    Array, twist_from_wheel_rates, wheel_rates_from_twist, WheelGeometry)
from diffdrive_kinematics.core.noise import rotations
import numpy as np

SAME, LONGEST_S = 1e-9, 0.25
"""Difference of commands [m/s, rad/s] that are the same, and for how long they are joined [s]."""


def commands_of(geometry: WheelGeometry, drive: RecordedDrive) -> Array:
    """
    Return the commands of a drive, each held until the next stamp.

    Parameters
    ----------
    geometry : WheelGeometry
        Size and spacing of the wheels, those that the drive was made with.
    drive : RecordedDrive
        A drive of :func:`.drive_from_commands`.

    Returns
    -------
    numpy.ndarray, shape (n - 1, 2)
        Twists v [m/s], w [rad/s].

    Examples
    --------
    See :func:`responded`.

    """
    rates = np.diff(drive.angles, axis=0) / np.diff(drive.time)[:, None]
    return np.stack(twist_from_wheel_rates(geometry, *rates.T), axis=1)


def responded(
        geometry: WheelGeometry, drive: RecordedDrive, response: CommandResponse) -> RecordedDrive:
    """
    Return a drive as the response to its commands has it, with the delay.

    Parameters
    ----------
    geometry : WheelGeometry
        Size and spacing of the wheels.
    drive : RecordedDrive
        A drive of :func:`.drive_from_commands`.
    response : CommandResponse
        How the robot follows.

    Returns
    -------
    RecordedDrive
        Wheels as they would have to roll for it, and the same reference.

    Examples
    --------
    >>> from diffdrive_kinematics.core.calibration import drive_from_commands
    >>> geometry, response = WheelGeometry(0.5, 0.125), CommandResponse(1.0, 1.0, speed_gain=0.5)
    >>> drive = drive_from_commands(
    ...     [0.0, 2.0], [[0.5, 0.0], [0.0, 0.0]], [0.0, 1.0], np.zeros((2, 3)), geometry=geometry)
    >>> commands_of(geometry, drive), responded(geometry, drive, response).angles[-1]
    (array([[0.5, 0. ]]), array([4., 4.]))

    """
    moved = _motions(response, commands_of(geometry, drive))
    rates = np.stack(wheel_rates_from_twist(geometry, *moved.T), axis=1)
    rolled = np.cumsum(np.diff(drive.time)[:, None] * rates, axis=0)
    return replace(drive, time=drive.time + response.delay,
                   angles=np.vstack([np.zeros(2), rolled]))


def _motions(response: CommandResponse, commands: Array) -> Array:
    """Return what the robot does where these are asked for, as ``motion_of`` has it for one."""
    edge = np.array([response.max_speed, response.max_yaw_rate])
    v, w = np.clip(commands, -edge, edge).T
    share = response.share(w / np.where(v == 0.0, 1.0, v))
    moved: Array = np.stack([response.speed_gain * share * v,
                             response.yaw_rate_gain * w + response.veer * v], axis=1)
    return moved


def with_commands_joined(geometry: WheelGeometry, drive: RecordedDrive) -> RecordedDrive:
    """
    Return the drive with a row for each command that is another one, or a quarter of a second old.

    Parameters
    ----------
    geometry : WheelGeometry
        Size and spacing of the wheels.
    drive : RecordedDrive
        A drive of :func:`.drive_from_commands`, with many repeated commands.

    Returns
    -------
    RecordedDrive
        The same motion in fewer rows.

    Examples
    --------
    >>> from diffdrive_kinematics.core.calibration import drive_from_commands
    >>> geometry, stamps = WheelGeometry(0.5, 0.125), 0.1 * np.arange(11)
    >>> drive = drive_from_commands(
    ...     stamps, [[0.5, 0.0]] * 11, stamps, np.zeros((11, 3)), geometry=geometry)
    >>> with_commands_joined(geometry, drive).time.round(1)
    array([0. , 0.3, 0.5, 0.8, 1. ])

    """
    other = (np.abs(np.diff(commands_of(geometry, drive), axis=0)) > SAME).any(axis=1)
    tick = np.diff(np.floor(drive.time[:-1] / LONGEST_S)) > 0.0
    kept = np.concatenate([[True], other | tick, [True]])
    return replace(drive, time=drive.time[kept], angles=drive.angles[kept])


def reference_motion(drive: RecordedDrive, start: Indices, end: Indices, frame: Array) -> Array:
    """
    Return how the robot moved between samples of the reference, in the frame of the start.

    Parameters
    ----------
    drive : RecordedDrive
        With the reference.
    start, end : numpy.ndarray of int, shape (w,)
        Rows of the reference.
    frame : numpy.ndarray, shape (3,)
        Pose (x [m], y [m], yaw [rad]) of the reference's frame on the robot.

    Returns
    -------
    numpy.ndarray, shape (w, 3)
        Relative poses (x [m], y [m], theta [rad]), theta not wrapped.

    Examples
    --------
    >>> from diffdrive_kinematics.core.calibration import drive_from_rates
    >>> drive = drive_from_rates(
    ...     [0.0, 1.0], [[8.0, 8.0]] * 2, [0.0, 1.0], [[0.0, 0.0, 0.0], [1.0, 0.5, 0.0]])
    >>> reference_motion(drive, [0], [1], np.zeros(3))
    array([[1. , 0.5, 0. ]])

    """
    begin, apart = drive.reference[start], drive.reference[end] - drive.reference[start]
    found: Array = np.einsum('wij,wj->wi', rotations(frame[2] - begin[:, 2]), apart)
    turned = rotations(found[:, 2])[:, :2, :2]
    found[:, :2] += frame[:2] - turned @ frame[:2]
    return found
