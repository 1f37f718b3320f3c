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
Windows between reference poses: their lengths, where they start, and which ones are lost.

A window begins and ends at samples of the reference, and the odometry is read there: a sample's
noise is then in one place, and no pose is made up in a gap.
"""

from dataclasses import dataclass
import math
from typing import NamedTuple, Sequence, Tuple

from diffdrive_kinematics.core.calibration.recorded_drive import Indices, RecordedDrive
from diffdrive_kinematics.core.kinematics import Array, check_positive
import numpy as np


@dataclass(frozen=True)
class Windows:
    """
    Which windows are fitted, and how far their errors are trusted.

    Parameters
    ----------
    lengths : tuple of float
        Lengths [s]; the noise of the reference shows in short windows, slip and wrong wheels
        in long ones.
    every : float
        Windows of each length start so far apart [s].
    tolerance : float
        How far [s] a sample of the reference may be from where a window should start or end.
    trust : float
        Distance ``sqrt(e^T P^-1 e)`` up to which a window counts in full; beyond it its pull
        stays the same, and gross outliers count nothing.  Small where the model is poor.

    Raises
    ------
    ValueError
        If there is no length, or a number is not finite and above 0.

    Examples
    --------
    >>> Windows(lengths=(1.0, 5.0)).every
    0.5

    """

    lengths: Tuple[float, ...] = (2.0, 10.0)
    every: float = 0.5
    tolerance: float = 0.1
    trust: float = 4.0

    def __post_init__(self) -> None:
        if not self.lengths:
            raise ValueError('lengths is empty, expected at least one length of windows')
        for length in self.lengths:
            check_positive('a length of windows', length)
        check_positive('every', self.every)
        check_positive('tolerance', self.tolerance)
        check_positive('trust', self.trust)


COMMANDED = Windows((5.0, 10.0), every=1.0, trust=1.0)
"""For drives of which only the commands are known: a robot that does not follow one for a while
makes heavy tails."""


class WindowSet(NamedTuple):
    """
    Rows of the reference at which windows start and end.

    Parameters
    ----------
    start, end : numpy.ndarray of int, shape (w,)
        Rows of the reference.
    in_gaps : int
        Windows that were lost to gaps.

    Examples
    --------
    See :func:`windows_between`.

    """

    start: Indices
    end: Indices
    in_gaps: int


def windows_between(
        drive: RecordedDrive, lengths: Sequence[float], every: float, tolerance: float
) -> WindowSet:
    """
    Return windows of some lengths that start at even times.

    Each begins and ends at the reference's sample nearest to where it should.  A window with no
    sample within the tolerance lies in a gap; one in which no wheel turns is left out, too,
    as are those beyond the stamps of the wheels.

    Parameters
    ----------
    drive : RecordedDrive
        Wheels and reference of one drive.
    lengths : sequence of float
        Lengths of the windows [s].
    every : float
        Time from the start of one to that of the next [s].
    tolerance : float
        How far a sample may be from where a window should start or end [s].

    Returns
    -------
    WindowSet
        Windows of the first length, then of the next one.

    Examples
    --------
    >>> from diffdrive_kinematics.core.calibration import drive_from_rates
    >>> stamps = np.arange(5.0)
    >>> drive = drive_from_rates(stamps, np.full((5, 2), 8.0), stamps, np.zeros((5, 3)))
    >>> windows = windows_between(drive, lengths=(2.0,), every=1.0, tolerance=0.1)
    >>> windows.start.tolist(), windows.end.tolist()
    ([0, 1, 2], [2, 3, 4])

    """
    seen = drive.reference_time
    low, high = max(seen[0], drive.time[0]), min(seen[-1], drive.time[-1])
    starts, ends, lost = [], [], 0
    for length in lengths:
        count = max(math.ceil((high - length + 1e-9 - low) / every), 0)
        begin = _grid_near(seen, low, every, count, tolerance)
        start, end = _nearest(seen, begin), _nearest(seen, begin + length)
        there = ((np.abs(seen[start] - begin) <= tolerance)
                 & (np.abs(seen[end] - begin - length) <= tolerance)
                 & (seen[start] >= low) & (seen[end] <= high) & (end > start))
        lost += count - int(np.count_nonzero(there))
        starts.append(start[there])
        ends.append(end[there])
    start, end = np.concatenate(starts), np.concatenate(ends)
    way = np.append(0.0, np.cumsum(np.abs(np.diff(drive.angles, axis=0)).sum(axis=1)))
    so_far = np.interp(seen, drive.time, way)
    moving = so_far[end] > so_far[start]
    return WindowSet(start[moving], end[moving], lost)


def _grid_near(stamps: Array, low: float, every: float, count: int, tolerance: float) -> Array:
    """Return those of ``low + every k``, k < count, to which a stamp may be near enough."""
    step, wide = (low + every) - low, 1 + int(tolerance // every)
    near = np.floor((stamps - low) / step)[:, None] + np.arange(1 - wide, 1 + wide)
    numbers: Array = np.unique(near).astype(np.float64)
    found: Array = low + step * numbers[(numbers >= 0) & (numbers < count)]
    return found


def _nearest(stamps: Array, wanted: Array) -> Indices:
    after = np.clip(np.searchsorted(stamps, wanted), 1, len(stamps) - 1)
    return after - (wanted - stamps[after - 1] <= stamps[after] - wanted)
