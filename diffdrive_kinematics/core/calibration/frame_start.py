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

"""Where the reference's frame sits on the robot, roughly: where a fit of it starts."""

from typing import Sequence, Tuple

from diffdrive_kinematics.core.calibration.calibration_parameters import CalibrationParameters
from diffdrive_kinematics.core.calibration.drive_odometry import odometry_at
from diffdrive_kinematics.core.calibration.recorded_drive import RecordedDrive
from diffdrive_kinematics.core.calibration.trajectory_windows import WindowSet
from diffdrive_kinematics.core.kinematics import Array, WheelGeometry
import numpy as np
from numpy.typing import NDArray

ROUNDS, TINY = 10, 1e-4
FARTHEST = 3.0
"""Distance of the frame from the robot's centre [m] beyond which it is not believed."""


def frame_from_motion(
        geometry: WheelGeometry, drives: Sequence[RecordedDrive], windows: Sequence[WindowSet]
) -> Tuple[float, float, float]:
    """
    Return the pose of the reference's frame on the robot that explains its displacements best.

    The errors of a calibration are the same for (radii, separation, x, y, yaw) and for (minus
    all of these, yaw + pi), so a search must start on the right side.  With displacements as
    complex numbers, a window in which the robot goes w and turns by t moves the frame at p by
    ``s = a w + (exp(i t) - 1) b`` in its own axes, ``a = exp(-i yaw)``, ``b = a p``.  That is
    linear in a and b; windows that fit badly lose their weight (least absolute errors).

    Parameters
    ----------
    geometry : WheelGeometry
        Size and spacing of the wheels, roughly.
    drives : sequence of RecordedDrive
        Wheels and reference of each drive.
    windows : sequence of WindowSet
        Windows of each.

    Returns
    -------
    tuple of float
        Its x [m], y [m] and yaw [rad]; 0 where the drives do not tell it.

    Examples
    --------
    A tracker that is mounted the wrong way round:

    >>> from diffdrive_kinematics.core.calibration import drive_from_rates, windows_between
    >>> stamps = np.arange(20.0)
    >>> poses = np.stack([stamps, 0.0 * stamps, np.full(20, np.pi)], axis=1)
    >>> drive = drive_from_rates(stamps, np.full((20, 2), 8.0), stamps, poses)
    >>> windows = windows_between(drive, (2.0,), every=1.0, tolerance=0.1)
    >>> abs(frame_from_motion(WheelGeometry(0.5, 0.125), [drive], [windows])[2]) > 3.14
    True

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
