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
What is fitted to what: the parameters of a calibration, and the drives and windows it is from.

Some parameters are shared by all drives (wheels, frame, a delay), others belong to one (its
clock).
"""

from dataclasses import dataclass, replace
from typing import List, NamedTuple, Optional, Sequence, Tuple

from diffdrive_kinematics.core.calibration.calibration_parameters import (
    CalibrationParameters, FIELDS)
from diffdrive_kinematics.core.calibration.drive_odometry import odometry_at
from diffdrive_kinematics.core.calibration.recorded_drive import RecordedDrive
from diffdrive_kinematics.core.calibration.trajectory_windows import WindowSet
from diffdrive_kinematics.core.calibration.window_residuals import linearised, WindowResiduals
from diffdrive_kinematics.core.kinematics import Array, WheelGeometry
import numpy as np


class Column(NamedTuple):
    """
    A parameter of a fit.

    Parameters
    ----------
    name : str
        What the user calls it.
    field : str
        Its field of CalibrationParameters.
    drive : int or None
        Index of the drive that it belongs to; None: all of them.

    Examples
    --------
    >>> Column('offset of drive 1', 'offset', 0).field
    'offset'

    """

    name: str
    field: str
    drive: Optional[int]


@dataclass(frozen=True)
class Problem:
    """
    What is fitted to what.

    Parameters
    ----------
    geometry : WheelGeometry
        Where the fit starts.
    drives : tuple of RecordedDrive
        The drives.
    windows : tuple of WindowSet
        Windows of each drive, w in all.
    columns : tuple of Column
        The p parameters.
    start : CalibrationParameters
        Values to start from, and those of what is not fitted.
    trust : float
        Distance up to which a window counts in full [1].

    Examples
    --------
    The separation alone, of a drive without turns:

    >>> from diffdrive_kinematics.core.calibration import drive_from_rates, windows_between
    >>> stamps = np.arange(5.0)
    >>> drive = drive_from_rates(stamps, np.full((5, 2), 8.0), stamps, np.zeros((5, 3)))
    >>> problem = Problem(
    ...     WheelGeometry(0.5, 0.125), (drive,), (windows_between(drive, (2.0,), 1.0, 0.1),),
    ...     (Column('wheel_separation_multiplier', 'separation', None),),
    ...     CalibrationParameters(), trust=4.0)
    >>> problem.columns_of(0), problem.indices(('separation',)), problem.initial()
    (([0], [2]), [0], array([1.]))
    >>> problem.systematics(np.array([1.02]))[0].separation
    1.02
    >>> len(problem.parts(problem.initial())[0].error)
    3
    >>> problem.as_the_wheels_tell().drives[0].reference[-1].round(6)
    array([4., 0., 0.])

    """

    geometry: WheelGeometry
    drives: Tuple[RecordedDrive, ...]
    windows: Tuple[WindowSet, ...]
    columns: Tuple[Column, ...]
    start: CalibrationParameters
    trust: float

    def systematics(self, values: Array) -> List[CalibrationParameters]:
        """
        Return the systematic errors of each drive.

        Parameters
        ----------
        values : numpy.ndarray, shape (p,)
            Values of the parameters.

        Returns
        -------
        list of CalibrationParameters
            One for each drive.

        Examples
        --------
        See :class:`Problem`.

        """
        found = []
        for number in range(len(self.drives)):
            mine = {each.field: float(value) for each, value in zip(self.columns, values)
                    if each.drive in (None, number)}
            found.append(self.start._replace(**mine))
        return found

    def parts(self, values: Array) -> List[WindowResiduals]:
        """
        Return the linearised windows of each drive.

        Parameters
        ----------
        values : numpy.ndarray, shape (p,)
            Values of the parameters.

        Returns
        -------
        list of WindowResiduals
            One for each drive.

        Examples
        --------
        See :class:`Problem`.

        """
        return [linearised(self.geometry, drive, windows, systematic)
                for drive, windows, systematic in zip(
                    self.drives, self.windows, self.systematics(values))]

    def initial(self) -> Array:
        """
        Return the values to start from.

        Returns
        -------
        numpy.ndarray, shape (p,)
            Values of the parameters.

        Examples
        --------
        See :class:`Problem`.

        """
        return np.array([getattr(self.start, each.field) for each in self.columns])

    def as_the_wheels_tell(self) -> 'Problem':
        """
        Return the problem with odometry as its reference.

        It tells what the course identifies; the noise of a real reference looks like motion.

        Returns
        -------
        Problem
            The same drives, followed without errors.

        Examples
        --------
        See :class:`Problem`.

        """
        drives = tuple(
            replace(each, reference=odometry_at(self.geometry, each, self.start))
            for each in self.drives)
        return replace(self, drives=drives, start=CalibrationParameters())

    def columns_of(self, drive: int) -> Tuple[List[int], List[int]]:
        """
        Return the columns that act on a drive, and their fields.

        Parameters
        ----------
        drive : int
            Index of the drive, from 0.

        Returns
        -------
        columns : list of int
            Indices of the columns.
        fields : list of int
            Indices of their fields of CalibrationParameters.

        Examples
        --------
        See :class:`Problem`.

        """
        found = [(n, FIELDS.index(each.field)) for n, each in enumerate(self.columns)
                 if each.drive in (None, drive)]
        return [n for n, _ in found], [field for _, field in found]

    def indices(self, fields: Sequence[str]) -> List[int]:
        """
        Return which columns are of some fields, in the order of the columns.

        Parameters
        ----------
        fields : sequence of str
            Fields of CalibrationParameters.

        Returns
        -------
        list of int
            Indices of the columns.

        Examples
        --------
        See :class:`Problem`.

        """
        return [n for n, each in enumerate(self.columns) if each.field in fields]
