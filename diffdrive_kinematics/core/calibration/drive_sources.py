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

"""Recorded drives of wheel rates, encoder ticks or commands."""

from dataclasses import replace

from diffdrive_kinematics.core.calibration.recorded_drive import (
    drive_from_positions, RecordedDrive)
from diffdrive_kinematics.core.calibration.recorded_rows import checked_rows, latest_rows
from diffdrive_kinematics.core.kinematics import (
    check_positive, wheel_rates_from_twist, WheelGeometry)
import numpy as np
from numpy.typing import ArrayLike


def drive_from_rates(
        time: ArrayLike, rates: ArrayLike, reference_time: ArrayLike,
        reference: ArrayLike) -> RecordedDrive:
    """
    Return the drive of wheel rates, each held until the next stamp.

    Parameters
    ----------
    time : array_like, shape (n,)
        Stamps [s], n >= 2, not falling.
    rates : array_like, shape (n, 2)
        Wheel rates (left, right) [rad/s].
    reference_time : array_like, shape (m,)
        Stamps [s], m >= 2, not falling.
    reference : array_like, shape (m, 3)
        Poses (x [m], y [m], yaw [rad]); yaw may be wrapped.

    Returns
    -------
    RecordedDrive
        Wheels, from angles of 0, and reference.

    Raises
    ------
    ValueError
        As :func:`drive_from_positions`.

    Examples
    --------
    >>> drive = drive_from_rates(
    ...     [0.0, 0.5, 1.0], [[2.0, 2.0], [2.0, 4.0], [0.0, 0.0]], [0.0, 1.0], np.zeros((2, 3)))
    >>> drive.angles[-1]
    array([2., 3.])

    """
    stamps, held, replaced = latest_rows('time', time, 'rates', rates, 2)
    rolled = np.cumsum(np.diff(stamps)[:, None] * held[:-1], axis=0)
    drive = drive_from_positions(
        stamps, np.vstack([np.zeros(2), rolled]), reference_time, reference)
    return replace(drive, duplicates=drive.duplicates + replaced)


def drive_from_ticks(
        time: ArrayLike, ticks: ArrayLike, reference_time: ArrayLike, reference: ArrayLike, *,
        ticks_per_turn: float) -> RecordedDrive:
    """
    Return the drive of encoder increments, each since the row before.

    The increments of all rows count, those with the same stamp too; that of the first row, which
    belongs to the time before it, does not matter.

    Parameters
    ----------
    time : array_like, shape (n,)
        Stamps [s], n >= 2, not falling.
    ticks : array_like, shape (n, 2)
        Encoder increments (left, right).
    reference_time : array_like, shape (m,)
        Stamps [s], m >= 2, not falling.
    reference : array_like, shape (m, 3)
        Poses (x [m], y [m], yaw [rad]); yaw may be wrapped.
    ticks_per_turn : float
        Ticks of one turn of a wheel.

    Returns
    -------
    RecordedDrive
        Wheels and reference.

    Raises
    ------
    ValueError
        As :func:`drive_from_positions`; if ``ticks_per_turn`` is not finite and above 0.

    Examples
    --------
    >>> drive = drive_from_ticks(
    ...     [0.0, 1.0], [[0, 0], [512, 1024]], [0.0, 1.0], np.zeros((2, 3)), ticks_per_turn=1024)
    >>> (drive.angles[-1] / np.pi).round(6)
    array([1., 2.])

    """
    scale = 2.0 * np.pi / check_positive('ticks_per_turn', ticks_per_turn)
    stamps, increments = checked_rows('time', time, 'ticks', ticks, 2)
    return drive_from_positions(
        stamps, scale * np.cumsum(increments, axis=0), reference_time, reference)


def drive_from_commands(
        time: ArrayLike, twists: ArrayLike, reference_time: ArrayLike, reference: ArrayLike, *,
        geometry: WheelGeometry) -> RecordedDrive:
    """
    Return the drive of commanded twists, each held until the next stamp.

    They become the wheel rates that a robot of this geometry is asked for; a fit that starts
    from the same geometry then says how the robot follows its commands.

    Parameters
    ----------
    time : array_like, shape (n,)
        Stamps [s], n >= 2, not falling.
    twists : array_like, shape (n, 2)
        Commands (v [m/s], w [rad/s]).
    reference_time : array_like, shape (m,)
        Stamps [s], m >= 2, not falling.
    reference : array_like, shape (m, 3)
        Poses (x [m], y [m], yaw [rad]); yaw may be wrapped.
    geometry : WheelGeometry
        Size and spacing of the wheels.

    Returns
    -------
    RecordedDrive
        Wheels as commanded, from angles of 0, and reference.

    Raises
    ------
    ValueError
        As :func:`drive_from_positions`.

    Examples
    --------
    >>> drive = drive_from_commands(
    ...     [0.0, 1.0], [[0.375, 0.5], [0.0, 0.0]], [0.0, 1.0], np.zeros((2, 3)),
    ...     geometry=WheelGeometry(0.5, 0.125))
    >>> drive.angles[-1]
    array([2., 4.])

    """
    stamps, commands = checked_rows('time', time, 'twists', twists, 2)
    left, right = wheel_rates_from_twist(geometry, commands[:, 0], commands[:, 1])
    return drive_from_rates(stamps, np.stack([left, right], axis=1), reference_time, reference)
