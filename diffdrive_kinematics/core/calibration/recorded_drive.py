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

from diffdrive_kinematics.core.calibration.calibration_parameters import CalibrationParameters
from diffdrive_kinematics.core.calibration.recorded_rows import latest_rows
from diffdrive_kinematics.core.kinematics import Array
import numpy as np
from numpy.typing import ArrayLike, NDArray

Indices = NDArray[np.intp]
FROZEN_TRAVEL = 0.05
"""Travel of the wheels [m] from which a pose that stays the same is none."""


@dataclass(frozen=True)
class RecordedDrive:
    """
    Wheel angles and reference poses of one drive; made by ``drive_from_positions`` and its like.

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


def without_frozen_poses(drive: RecordedDrive, *, wheel_radius: float) -> RecordedDrive:
    """
    Return the drive without poses that repeat while the wheels turn, as of a tracker that hangs.

    Parameters
    ----------
    drive : RecordedDrive
        Wheels and reference.
    wheel_radius : float
        Radius of both wheels, roughly [m].

    Returns
    -------
    RecordedDrive
        The first of poses that are the same, and those up to 50 mm of travel later, are kept.

    Examples
    --------
    >>> stamps = np.arange(6.0)
    >>> x = np.array([0.0, 1.0, 1.0, 1.0, 4.0, 5.0])
    >>> drive = drive_from_positions(
    ...     stamps, 8.0 * np.stack([stamps, stamps], axis=1), stamps,
    ...     np.stack([x, 0.0 * x, 0.0 * x], axis=1))
    >>> without_frozen_poses(drive, wheel_radius=0.125).reference[:, 0]
    array([0., 1., 4., 5.])

    """
    turned = np.abs(np.diff(drive.angles, axis=0)).mean(axis=1)
    way = wheel_radius * np.append(0.0, np.cumsum(turned))
    so_far = np.interp(drive.reference_time, drive.time, way)
    new = np.append(True, (np.diff(drive.reference, axis=0) != 0.0).any(axis=1))
    since = np.maximum.accumulate(np.where(new, np.arange(len(new)), 0))
    kept = so_far - so_far[since] <= FROZEN_TRAVEL
    return replace(
        drive, reference_time=drive.reference_time[kept], reference=drive.reference[kept])


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
    stamps, angles, replaced = latest_rows('time', time, 'positions', positions, 2)
    seen, poses, unseen = latest_rows('reference_time', reference_time, 'reference', reference, 3)
    poses[:, 2] = np.unwrap(poses[:, 2])
    return RecordedDrive(stamps, angles, seen, poses, replaced + unseen)


def since_middle(drive: RecordedDrive) -> Array:
    """
    Return the stamps of the reference from the middle of the wheels' stamps.

    Parameters
    ----------
    drive : RecordedDrive
        Wheels, and stamps of the m samples.

    Returns
    -------
    numpy.ndarray, shape (m,)
        Times [s], which a drift of the clocks multiplies.

    Examples
    --------
    See :func:`on_wheel_clock`.

    """
    found: Array = drive.reference_time - 0.5 * (drive.time[0] + drive.time[-1])
    return found


def on_wheel_clock(drive: RecordedDrive, systematic: CalibrationParameters) -> Array:
    """
    Return the stamps of the reference on the clock of the wheels.

    Parameters
    ----------
    drive : RecordedDrive
        Wheels, and stamps of the m samples.
    systematic : CalibrationParameters
        Offset and drift of the clocks.

    Returns
    -------
    numpy.ndarray, shape (m,)
        Stamps [s].

    Examples
    --------
    >>> drive = drive_from_positions([0.0, 2.0], np.zeros((2, 2)), [0.0, 1.5], np.zeros((2, 3)))
    >>> since_middle(drive), on_wheel_clock(drive, CalibrationParameters(offset=0.5))
    (array([-1. ,  0.5]), array([-0.5,  1. ]))

    """
    return drive.reference_time - systematic.offset - systematic.drift * since_middle(drive)
