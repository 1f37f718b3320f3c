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

"""How a trajectory fit is set up: its parameters, its windows (are there enough?), its start."""

import enum
import math
from typing import List, Optional, Sequence, Tuple

from diffdrive_kinematics.core.calibration.calibration_parameters import (
    CalibrationParameters, FRAME, NAMES, WHEELS)
from diffdrive_kinematics.core.calibration.drive_odometry import odometry_at
from diffdrive_kinematics.core.calibration.fit_problem import Column, Problem
from diffdrive_kinematics.core.calibration.recorded_drive import RecordedDrive
from diffdrive_kinematics.core.calibration.trajectory_windows import (
    Windows, windows_between, WindowSet)
from diffdrive_kinematics.core.kinematics import Array, check_finite, Pose, WheelGeometry
import numpy as np
from numpy.typing import NDArray

ROUNDS, TINY = 10, 1e-4
FARTHEST = 3.0
"""Distance of the frame from the robot's centre [m] beyond which it is not believed."""
NO_FRAME = Pose(0.0, 0.0, 0.0)


class Clock(enum.Enum):
    """
    What is fitted of the time between wheels and reference.

    Examples
    --------
    >>> Clock.DELAY.value
    'one delay for all drives'

    """

    NONE = 'none'
    DELAY = 'one delay for all drives'
    OFFSETS = 'an offset for each drive'
    DRIFTS = 'an offset and a drift for each drive'
    AUTO = 'an offset for each drive, and a drift where it pays'


def problem_of(
        geometry: WheelGeometry, drives: Sequence[RecordedDrive], *, wheels: bool, clock: Clock,
        frame: Optional[Pose], windows: Windows) -> Problem:
    """
    Return what is fitted to what.

    Parameters
    ----------
    geometry : WheelGeometry
        Where the fit starts.
    drives : sequence of RecordedDrive
        Drives of one robot.
    wheels : bool
        Fit the wheels.
    clock : Clock
        What is fitted of the time; offsets alone for AUTO (see :mod:`.clock_choice`).
    frame : Pose or None
        Pose of the reference's frame on the robot; None: fit it.
    windows : Windows
        Which windows are fitted.

    Returns
    -------
    Problem
        Parameters and windows.

    Raises
    ------
    ValueError
        If there is no drive, nothing to fit, a frame that is not finite, no common time, or too
        few windows.

    Examples
    --------
    >>> import numpy as np
    >>> from diffdrive_kinematics.core.calibration import drive_from_rates
    >>> stamps = np.arange(20.0)
    >>> drive = drive_from_rates(stamps, np.full((20, 2), 8.0), stamps, np.zeros((20, 3)))
    >>> problem = problem_of(
    ...     WheelGeometry(0.5, 0.125), [drive], wheels=False, clock=Clock.OFFSETS, frame=None,
    ...     windows=Windows())
    >>> [each.name for each in problem.columns]
    ['frame_x', 'frame_y', 'frame_yaw', 'offset of drive 1']

    """
    if not drives:
        raise ValueError('drives is empty, expected at least one drive')
    columns = _columns(len(drives), wheels, clock, frame is None)
    if not columns:
        raise ValueError('wheels, frame and clock are all given, expected something to fit')
    held: Sequence[float] = [check_finite('frame', float(value)) for value in frame or NO_FRAME]
    for n, drive in enumerate(drives):
        wheel, seen = drive.time, drive.reference_time
        if seen[-1] <= wheel[0] or wheel[-1] <= seen[0]:
            raise ValueError(
                f'drive {n + 1} has wheels from {wheel[0]:.3f} to {wheel[-1]:.3f} s and a '
                f'reference from {seen[0]:.3f} to {seen[-1]:.3f} s, expected stamps of the same '
                'time')
    chosen = tuple(windows_between(drive, windows.lengths, windows.every, windows.tolerance)
                   for drive in drives)
    number = sum(len(each.start) for each in chosen)
    if number < fewest_windows(len(columns)):
        raise ValueError(
            f'there are {number} windows with motion and a reference at both ends for '
            f'{len(columns)} parameters ({sum(each.in_gaps for each in chosen)} in gaps), '
            f'expected at least {fewest_windows(len(columns))}')
    if frame is None:
        held = _frame_from_motion(geometry, drives, chosen)
    start = CalibrationParameters(x=held[0], y=held[1], yaw=held[2])
    return Problem(geometry, tuple(drives), chosen, tuple(columns), start, windows.trust)


def fewest_windows(columns: int) -> int:
    """
    Return how many windows a fit needs, each of which tells three numbers.

    Parameters
    ----------
    columns : int
        Number of parameters.

    Returns
    -------
    int
        Two thirds of a window for each parameter, and two more.

    Examples
    --------
    >>> fewest_windows(7)
    7

    """
    return math.ceil(2 * columns / 3) + 2


def _columns(drives: int, wheels: bool, clock: Clock, frame: bool) -> List[Column]:
    """Return the parameters of a fit."""
    columns = [Column(NAMES[field], field, None)
               for field in ((*WHEELS,) if wheels else ()) + ((*FRAME,) if frame else ())]
    if clock is Clock.DELAY:
        columns.append(Column('delay', 'offset', None))
    elif clock is not Clock.NONE:
        for n in range(drives):
            columns.append(Column(f'offset of drive {n + 1}', 'offset', n))
            if clock is Clock.DRIFTS:
                columns.append(Column(f'drift of drive {n + 1}', 'drift', n))
    return columns


def _frame_from_motion(
        geometry: WheelGeometry, drives: Sequence[RecordedDrive], windows: Sequence[WindowSet]
) -> Tuple[float, float, float]:
    """
    Return the pose of the reference's frame on the robot that explains its displacements best.

    It is where a fit starts: x [m], y [m] and yaw [rad], 0 where the drives do not tell it.  The
    errors of a calibration are the same for (radii, separation, x, y, yaw) and for (minus all of
    these, yaw + pi), so a search must start on the right side.  With displacements as complex
    numbers, a window in which the robot goes w and turns by t moves the frame at p by
    ``s = a w + (exp(i t) - 1) b`` in its own axes, ``a = exp(-i yaw)``, ``b = a p``.  That is
    linear in a and b; windows that fit badly lose their weight (least absolute errors).
    """
    nothing = CalibrationParameters()
    moves = [(_displacements(odometry_at(geometry, drive, nothing), chosen),
              _displacements(drive.reference, chosen),
              drive.reference[chosen.end, 2] - drive.reference[chosen.start, 2])
             for drive, chosen in zip(drives, windows)]
    wheels, seen, turns = (np.concatenate(each) for each in zip(*moves))
    model = np.stack([wheels, np.exp(1j * turns) - 1.0], axis=1)
    weights = np.ones(len(seen))
    for _ in range(ROUNDS):
        (a, b), *_ = np.linalg.lstsq(weights[:, None] * model, weights * seen, rcond=1e-3)
        left = np.abs(seen - model @ np.array([a, b]))
        weights = 1.0 / np.sqrt(np.maximum(left, TINY))
    if not 0.1 < abs(a) < 10.0:
        return 0.0, 0.0, 0.0
    place = complex(b / a) if abs(b / a) < FARTHEST else 0j
    return place.real, place.imag, float(-np.angle(a))


def _displacements(poses: Array, windows: WindowSet) -> NDArray[np.complex128]:
    """Return where windows end, in the frame of their start."""
    apart = poses[windows.end] - poses[windows.start]
    found: NDArray[np.complex128] = (
        (apart[:, 0] + 1j * apart[:, 1]) * np.exp(-1j * poses[windows.start, 2]))
    return found
