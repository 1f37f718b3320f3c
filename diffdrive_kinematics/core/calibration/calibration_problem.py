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
The least squares problem of a calibration: its parameters, its steps, and what it identifies.

Some parameters are shared by all drives (wheels, frame, a delay), others belong to one (its
clock), so each drive adds its part to the normal equations of Gauss and Newton.
"""

from dataclasses import dataclass, replace
from typing import List, NamedTuple, Optional, Sequence, Tuple

from diffdrive_kinematics.core.calibration.recording import RecordedDrive
from diffdrive_kinematics.core.calibration.trajectory_windows import (
    CalibrationParameters, linearised, odometry_at, WindowResiduals, WindowSet)
from diffdrive_kinematics.core.calibration.window_weights import (
    distance, score_covariance, Variances, window_covariance)
from diffdrive_kinematics.core.kinematics import WheelGeometry
import numpy as np
from numpy.typing import NDArray

__all__ = [
    'FRAME', 'SAME_DRIVE', 'WHEELS', 'Column', 'Problem', 'distances_of', 'newton_step',
    'refuse_unidentified', 'sandwich', 'taken_by_fit']

Array = NDArray[np.float64]
Gain = Tuple[List[int], Array, Array]

WHEELS = ('left_wheel_radius_multiplier', 'right_wheel_radius_multiplier',
          'wheel_separation_multiplier')
FRAME = ('frame_x', 'frame_y', 'frame_yaw')
FIELDS = CalibrationParameters._fields
STEP = np.array([0.05, 0.05, 0.1, 0.1, 0.1, 0.3, 0.1, 2e-3])
"""Longest step of each field of CalibrationParameters in one iteration."""
LARGEST_ERROR = np.array([0.1, 0.1, 0.1, 0.05, 0.05, 0.2, 0.5, 0.1])
"""Standard error from which a field counts as not identified; frame x and y: in separations."""
FINEST = Variances(1e-8, 1e-8, 1e-8)
"""Least slip and noise (0.1 mm, 0.1 mrad) with which identifiability is judged."""

SAME_DRIVE = 'expected m and rad, the left wheel first, forward positive, and one time'
"""What wheels and reference that do not agree may lack."""


class Column(NamedTuple):
    """
    A parameter of a fit.

    Parameters
    ----------
    name : str
        What the user calls it.
    field : int
        Index of its field of CalibrationParameters.
    drive : int or None
        Index of the drive that it belongs to; None: all of them.

    Examples
    --------
    >>> Column('offset of drive 1', FIELDS.index('offset'), 0).field
    6

    """

    name: str
    field: int
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
    The separation alone, of a robot whose wheels are 0.51 m apart instead of 0.5 m:

    >>> from diffdrive_kinematics.core.calibration import drive_from_rates
    >>> from diffdrive_kinematics.core.calibration import windows_between
    >>> stamps = np.arange(0.0, 60.0, 0.5)
    >>> rates = 8.0 + 4.0 * np.stack([np.sin(stamps), np.cos(0.7 * stamps)], axis=1)
    >>> bare = drive_from_rates(stamps, rates, stamps, np.zeros((120, 3)))
    >>> truth = odometry_at(WheelGeometry(0.51, 0.125), bare, CalibrationParameters())
    >>> windows = windows_between(bare, (2.0, 10.0), every=0.5, tolerance=0.1)
    >>> problem = Problem(
    ...     WheelGeometry(0.5, 0.125), (replace(bare, reference=truth),), (windows,),
    ...     (Column(WHEELS[2], 2, None),), CalibrationParameters(), trust=4.0)
    >>> problem.mine(0), problem.as_the_wheels_tell().start == CalibrationParameters()
    (([0], [2]), True)

    Each step linearises anew:

    >>> values, variances = problem.initial(), Variances(1e-6, 1e-6, 1e-6)
    >>> weights = np.ones(len(windows.start))
    >>> for _ in range(5):
    ...     parts = problem.parts(values)
    ...     step, _ = newton_step(problem, parts, weights, variances)
    ...     values = values + step
    >>> f'{problem.systematics(values)[0].separation:.3f}'
    '1.020'

    What is left, and how well the separation is known:

    >>> parts = problem.parts(values)
    >>> bool(distances_of(parts, variances).max() < 0.01)
    True
    >>> refuse_unidentified(problem, parts, variances)
    >>> covariance = sandwich(problem, parts, weights, variances)
    >>> covariance.shape, taken_by_fit(problem, parts, covariance).shape == (len(weights), 3, 3)
    ((1, 1), True)

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
            mine = {FIELDS[each.field]: float(value) for each, value in zip(self.columns, values)
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
        return np.array([self.start[each.field] for each in self.columns])

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

    def mine(self, drive: int) -> Tuple[List[int], List[int]]:
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
        found = [(n, each.field) for n, each in enumerate(self.columns)
                 if each.drive in (None, drive)]
        return [n for n, _ in found], [field for _, field in found]


def distances_of(parts: Sequence[WindowResiduals], variances: Variances) -> Array:
    """
    Return ``sqrt(e^T P^-1 e)`` of all windows, those of the first drive first.

    Parameters
    ----------
    parts : sequence of WindowResiduals
        Windows of each drive, w in all.
    variances : Variances
        Slip constant and noise of the reference.

    Returns
    -------
    numpy.ndarray, shape (w,)
        Distances [1].

    Examples
    --------
    See :class:`Problem`.

    """
    return np.concatenate([
        distance(part.error, window_covariance(part, variances)) for part in parts])


def _split(problem: Problem, weights: Array) -> List[Array]:
    """Return the weights of each drive."""
    ends = np.cumsum([len(each.start) for each in problem.windows])
    return np.split(weights, ends[:-1])


def _gains(
        problem: Problem, parts: Sequence[WindowResiduals], weights: Array, variances: Variances
) -> List[Gain]:
    """Return for each drive its columns, J, and the weighted ``J^T P^-1``."""
    found = []
    for number, (part, weight) in enumerate(zip(parts, _split(problem, weights))):
        columns, fields = problem.mine(number)
        jacobian = part.jacobian[:, :, fields]
        solved = np.linalg.solve(window_covariance(part, variances), jacobian)
        found.append((columns, jacobian, weight[:, None, None] * solved.transpose(0, 2, 1)))
    return found


def _information(
        problem: Problem, gains: Sequence[Gain]) -> Array:
    """Return H, shape (p, p)."""
    total = np.zeros((len(problem.columns), len(problem.columns)))
    for columns, jacobian, gain in gains:
        total[np.ix_(columns, columns)] += np.einsum('wpi,wiq->pq', gain, jacobian)
    return total


def newton_step(
        problem: Problem, parts: Sequence[WindowResiduals], weights: Array, variances: Variances
) -> Tuple[Array, Array]:
    """
    Return the step of Gauss and Newton, shortened where it is long, and ``H^-1``.

    Parameters
    ----------
    problem : Problem
        What is fitted to what.
    parts : sequence of WindowResiduals
        Windows of each drive, at the present values.
    weights : numpy.ndarray, shape (w,)
        Weights of all windows.
    variances : Variances
        Slip constant and noise of the reference.

    Returns
    -------
    step : numpy.ndarray, shape (p,)
        What to add to the values.
    inverse : numpy.ndarray, shape (p, p)
        ``H^-1``, ``H = sum J^T P^-1 J`` over the weighted windows.

    Examples
    --------
    See :class:`Problem`.

    """
    gains = _gains(problem, parts, weights, variances)
    pull = np.zeros(len(problem.columns))
    for (columns, _, gain), part in zip(gains, parts):
        pull[columns] += np.einsum('wpi,wi->p', gain, part.error)
    inverse = _inverse(_information(problem, gains))
    step = -inverse @ pull
    longest = np.max(np.abs(step) / STEP[[each.field for each in problem.columns]])
    return step / max(longest, 1.0), inverse


def _inverse(information: Array) -> Array:
    """Return the inverse of a positive definite matrix whose units differ."""
    size = np.sqrt(np.maximum(np.diag(information), 1e-300))
    scaled = information / np.outer(size, size)
    found: Array = np.linalg.pinv(scaled, rcond=1e-14, hermitian=True) / np.outer(size, size)
    return found


def refuse_unidentified(
        problem: Problem, parts: Sequence[WindowResiduals], variances: Variances,
        weights: Optional[Array] = None) -> None:
    """
    Raise where the standard error of a parameter is as large as the parameter may be.

    The prior of that size keeps the matrix regular; where it alone tells the standard error, the
    data say nothing.  Without weights it is the course that is judged, with them the fit.

    Parameters
    ----------
    problem : Problem
        What is fitted to what.
    parts : sequence of WindowResiduals
        Windows of each drive.
    variances : Variances
        Slip constant and noise of the reference.
    weights : numpy.ndarray, shape (w,), optional
        Weights of all windows.

    Raises
    ------
    ValueError
        If there is such a parameter; it is named.

    Examples
    --------
    See :class:`Problem`.

    """
    fitted = weights is not None
    if weights is None:
        weights = np.ones(sum(len(each.start) for each in problem.windows))
    usual = Variances(*(max(pair) for pair in zip(variances, FINEST)))
    limit = LARGEST_ERROR[[each.field for each in problem.columns]].copy()
    scale = np.array([problem.geometry.separation if each.name in FRAME[:2] else 1.0
                      for each in problem.columns])
    limit *= scale
    information = _information(problem, _gains(problem, parts, weights, usual))
    scaled = information * np.outer(limit, limit) + 1e-4 * np.eye(len(limit))
    errors = limit * np.sqrt(np.diag(np.linalg.inv(scaled)))
    lost = [n for n, error in enumerate(errors) if error > limit[n]]
    if lost:
        said = ', '.join(f'{problem.columns[n].name} (standard error over {limit[n]:.2g})'
                         for n in lost)
        raise ValueError(
            f'wheels and reference do not agree well enough to tell {said}, though the course '
            f'would: {SAME_DRIVE}'
            if fitted else
            f'the data do not identify {said}, expected drives with straights and curves both '
            f'ways, or these values given')


def taken_by_fit(problem: Problem, parts: Sequence[WindowResiduals], covariance: Array) -> Array:
    """
    Return what the fit takes out of the errors of each window, ``J C J^T``.

    Parameters
    ----------
    problem : Problem
        What is fitted to what.
    parts : sequence of WindowResiduals
        Windows of each drive, w in all.
    covariance : numpy.ndarray, shape (p, p)
        Covariance C of the parameters.

    Returns
    -------
    numpy.ndarray, shape (w, 3, 3)
        Covariances of (x [m], y [m], theta [rad]).

    Examples
    --------
    See :class:`Problem`.

    """
    found = []
    for number, part in enumerate(parts):
        columns, fields = problem.mine(number)
        jacobian = part.jacobian[:, :, fields]
        found.append(jacobian @ covariance[np.ix_(columns, columns)]
                     @ jacobian.transpose(0, 2, 1))
    return np.concatenate(found)


def sandwich(
        problem: Problem, parts: Sequence[WindowResiduals], weights: Array, variances: Variances
) -> Array:
    """
    Return the covariance ``H^-1 S H^-1`` of the parameters (Huber 1967; White 1980).

    Windows overlap, so ``H^-1`` alone would be too small; see :mod:`.window_weights`.

    Parameters
    ----------
    problem : Problem
        What is fitted to what.
    parts : sequence of WindowResiduals
        Windows of each drive, at the present values.
    weights : numpy.ndarray, shape (w,)
        Weights of all windows.
    variances : Variances
        Slip constant and noise of the reference.

    Returns
    -------
    numpy.ndarray, shape (p, p)
        Covariance, in the squared units of the parameters.

    Examples
    --------
    See :class:`Problem`.

    """
    gains = _gains(problem, parts, weights, variances)
    score = np.zeros((len(problem.columns), len(problem.columns)))
    for number, (columns, _, gain) in enumerate(gains):
        score[np.ix_(columns, columns)] += score_covariance(
            parts[number], problem.windows[number], gain, variances,
            len(problem.drives[number].reference))
    inverse = _inverse(_information(problem, gains))
    found: Array = inverse @ score @ inverse
    return found
