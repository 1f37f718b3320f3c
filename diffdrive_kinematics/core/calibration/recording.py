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
What was recorded of one drive: the angles of the wheels, and reference poses beside them.

The reference (motion capture, a tracker, a map) has stamps of its own, on a clock of its own,
and may have gaps.  Its yaw may come wrapped; it is unwrapped here once, so samples that turn by
less than half a turn from one to the next are needed.
"""

from dataclasses import dataclass, replace
from typing import Tuple

from diffdrive_kinematics.core.kinematics import (
    check_positive, wheel_rates_from_twist, WheelGeometry)
import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = [
    'RecordedDrive', 'drive_from_commands', 'drive_from_positions', 'drive_from_rates',
    'drive_from_ticks']

Array = NDArray[np.float64]


@dataclass(frozen=True)
class RecordedDrive:
    """
    Wheel angles and reference poses of one drive; made by the functions of this module.

    Parameters
    ----------
    time : numpy.ndarray, shape (n,)
        Stamps of the wheels [s], strictly increasing.
    angles : numpy.ndarray, shape (n, 2)
        Angles (left, right) [rad] that the wheels have rolled so far.
    reference_time : numpy.ndarray, shape (m,)
        Stamps of the reference [s], strictly increasing.
    reference : numpy.ndarray, shape (m, 3)
        Poses (x [m], y [m], yaw [rad]) of the reference's frame on the robot, yaw unwrapped.
    duplicates : int
        Rows, of wheels and reference, that a later row with the same stamp replaced.

    Examples
    --------
    >>> drive = drive_from_positions(
    ...     time=[0.0, 1.0], positions=[[0.0, 0.0], [8.0, 8.0]],
    ...     reference_time=[0.0, 1.0], reference=[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    >>> drive.angles.shape, drive.reference.shape, drive.duplicates
    ((2, 2), (2, 3), 0)

    """

    time: Array
    angles: Array
    reference_time: Array
    reference: Array
    duplicates: int = 0

    def between(self, start: float, end: float) -> 'RecordedDrive':
        """
        Return the part of the drive between two times, both included.

        Parameters
        ----------
        start, end : float
            First and last time [s], of either clock.

        Returns
        -------
        RecordedDrive
            Rows of the wheels and of the reference that lie there.

        Raises
        ------
        ValueError
            If fewer than two rows of the wheels or of the reference lie there.

        Examples
        --------
        >>> seconds = np.arange(10.0)
        >>> drive = drive_from_positions(seconds, np.zeros((10, 2)), seconds, np.zeros((10, 3)))
        >>> drive.between(2.0, 5.0).time
        array([2., 3., 4., 5.])

        """
        wheels = (self.time >= start) & (self.time <= end)
        seen = (self.reference_time >= start) & (self.reference_time <= end)
        return drive_from_positions(
            self.time[wheels], self.angles[wheels], self.reference_time[seen],
            self.reference[seen])


def drive_from_positions(
        time: ArrayLike, positions: ArrayLike, reference_time: ArrayLike,
        reference: ArrayLike) -> RecordedDrive:
    """
    Return the drive of wheel positions, as of a joint state.

    Of rows with the same stamp the last one wins.

    Parameters
    ----------
    time : array_like, shape (n,)
        Stamps [s], n >= 2, not falling.
    positions : array_like, shape (n, 2)
        Wheel angles (left, right) [rad].
    reference_time : array_like, shape (m,)
        Stamps [s], m >= 2, not falling.
    reference : array_like, shape (m, 3)
        Poses (x [m], y [m], yaw [rad]); yaw may be wrapped.

    Returns
    -------
    RecordedDrive
        Wheels and reference, yaw unwrapped.

    Raises
    ------
    ValueError
        If a shape is another one, a number is not finite, stamps fall, or fewer than two
        different stamps are left.

    Examples
    --------
    >>> drive = drive_from_positions(
    ...     [0.0, 1.0], [[0.0, 0.0], [0.5, 1.0]],
    ...     [0.0, 1.0], [[0.0, 0.0, 3.0], [-0.1, 0.0, -3.0]])
    >>> drive.reference[:, 2].round(3)
    array([3.   , 3.283])

    """
    stamps, angles, replaced = _series('time', time, 'positions', positions, 2)
    seen, poses, unseen = _series('reference_time', reference_time, 'reference', reference, 3)
    poses[:, 2] = np.unwrap(poses[:, 2])
    return RecordedDrive(stamps, angles, seen, poses, replaced + unseen)


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
    stamps, held, replaced = _series('time', time, 'rates', rates, 2)
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
    stamps, increments = _checked('time', time, 'ticks', ticks, 2)
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
    stamps, commands = _checked('time', time, 'twists', twists, 2)
    left, right = wheel_rates_from_twist(geometry, commands[:, 0], commands[:, 1])
    return drive_from_rates(stamps, np.stack([left, right], axis=1), reference_time, reference)


def _series(
        time_name: str, time: ArrayLike, name: str, rows: ArrayLike, width: int
) -> Tuple[Array, Array, int]:
    """Return stamps and rows without those that a later row replaces, and how many these are."""
    stamps, values = _checked(time_name, time, name, rows, width)
    last = np.append(np.diff(stamps) > 0.0, True)
    if np.count_nonzero(last) < 2:
        raise ValueError(
            f'{time_name} has {np.count_nonzero(last)} different stamps, expected at least 2')
    return stamps[last], values[last], int(np.count_nonzero(~last))


def _checked(
        time_name: str, time: ArrayLike, name: str, rows: ArrayLike, width: int
) -> Tuple[Array, Array]:
    """Return new arrays of the stamps and the rows, or raise unless they fit together."""
    stamps, values = np.array(time, dtype=np.float64), np.array(rows, dtype=np.float64)
    if stamps.ndim != 1 or len(stamps) < 2:
        raise ValueError(f'{time_name} has shape {stamps.shape}, expected (n,) with n at least 2')
    if values.shape != (len(stamps), width):
        raise ValueError(
            f'{name} has shape {values.shape}, expected {(len(stamps), width)} as '
            f'{time_name} has {len(stamps)} stamps')
    for what, finite in ((time_name, np.isfinite(stamps)), (name, np.isfinite(values).all(1))):
        if not finite.all():
            row = int(np.argmin(finite))
            value = (stamps if what == time_name else values)[row].tolist()
            raise ValueError(f'{what} is {value} in row {row}, expected finite numbers')
    falls = np.diff(stamps) < 0.0
    if falls.any():
        row = int(np.argmax(falls)) + 1
        raise ValueError(
            f'{time_name} is {stamps[row]} in row {row} after {stamps[row - 1]}, '
            f'expected stamps that do not fall')
    return stamps, values
