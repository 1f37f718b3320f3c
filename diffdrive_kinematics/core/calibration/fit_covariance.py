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
How well parameters are known: their covariance, and what is refused as not identified.

The errors of overlapping windows are not independent; the inverse of the information would be
too small a covariance of what is fitted.  What is independent is the slip of each interval and
the noise of each sample of the reference.  The score ``sum J^T P^-1 e`` is a sum over these too,
so its covariance S is known, and that of the parameters is the sandwich ``H^-1 S H^-1``,
``H = sum J^T P^-1 J`` (Huber 1967; White 1980, Econometrica 48(4)), the model of the package in
its middle.
"""

from dataclasses import replace
from typing import List

from diffdrive_kinematics.core.calibration.calibration_parameters import CalibrationParameters
from diffdrive_kinematics.core.calibration.fit_problem import Problem
from diffdrive_kinematics.core.calibration.fit_state import FitState
from diffdrive_kinematics.core.calibration.gauss_newton import inverse_of
from diffdrive_kinematics.core.calibration.white_errors import from_entries
from diffdrive_kinematics.core.calibration.window_weights import START_VARIANCES, Variances
from diffdrive_kinematics.core.kinematics import Array
import numpy as np

LARGEST_ERROR = CalibrationParameters(
    left=0.1, right=0.1, separation=0.1, x=0.05, y=0.05, yaw=0.2, offset=0.5, drift=0.1)
"""Standard error from which a field counts as not identified; frame x and y: in separations."""
FINEST = Variances(1e-8, 1e-8, 1e-8)
"""Least slip and noise (0.1 mm, 0.1 mrad) with which identifiability is judged."""
SAME_DRIVE = 'expected m and rad, the left wheel first, forward positive, and one time'
"""What wheels and reference that do not agree may lack."""


def parameter_covariance(state: FitState) -> Array:
    """
    Return the covariance ``H^-1 S H^-1`` of the parameters (Huber 1967; White 1980).

    Parameters
    ----------
    state : FitState
        Where the fit stands.

    Returns
    -------
    numpy.ndarray, shape (p, p)
        Covariance, in the squared units of the parameters.

    Examples
    --------
    >>> from diffdrive_kinematics.core.calibration import (
    ...     Clock, drive_from_rates, Variances, Windows)
    >>> from diffdrive_kinematics.core.calibration.fit_setup import problem_of
    >>> from diffdrive_kinematics.core.kinematics import WheelGeometry
    >>> stamps = np.arange(20.0)
    >>> drive = drive_from_rates(stamps, np.full((20, 2), 8.0), stamps, np.zeros((20, 3)))
    >>> problem = problem_of(
    ...     WheelGeometry(0.5, 0.125), [drive], wheels=False, clock=Clock.DELAY, frame=None,
    ...     windows=Windows())
    >>> windows = len(problem.windows[0].start)
    >>> state = FitState.at(
    ...     problem, problem.initial(), np.ones(windows), Variances(1e-6, 1e-6, 1e-6))
    >>> covariance = parameter_covariance(state)
    >>> covariance.shape, taken_by_fit(state, covariance).shape == (windows, 3, 3)
    ((4, 4), True)

    """
    score = np.zeros((len(state.values), len(state.values)))
    for number, (columns, _, gain) in enumerate(state.gains()):
        score[np.ix_(columns, columns)] += _score_covariance(state, number, gain)
    inverse = inverse_of(state.normal_equations()[0])
    found: Array = inverse @ score @ inverse
    return found


def taken_by_fit(state: FitState, covariance: Array) -> Array:
    """
    Return what the fit takes out of the errors of each window, ``J C J^T``.

    Parameters
    ----------
    state : FitState
        Where the fit stands.
    covariance : numpy.ndarray, shape (p, p)
        Covariance C of the parameters.

    Returns
    -------
    numpy.ndarray, shape (w, 3, 3)
        Covariances of (x [m], y [m], theta [rad]).

    Examples
    --------
    See :func:`parameter_covariance`.

    """
    found = []
    for number, part in enumerate(state.parts):
        columns, fields = state.problem.columns_of(number)
        jacobian = part.jacobian[:, :, fields]
        found.append(jacobian @ covariance[np.ix_(columns, columns)] @ jacobian.transpose(0, 2, 1))
    return np.concatenate(found)


def _score_covariance(state: FitState, number: int, gain: Array) -> Array:
    """Return the part of S of one drive, whose windows have the factors ``J^T P^-1``."""
    part, windows, variances = state.parts[number], state.problem.windows[number], state.variances
    samples = len(state.problem.drives[number].reference)
    size = gain.shape[1]
    pulled = gain @ part.along
    bounds, known, at = np.unique(
        np.concatenate([part.first, part.last + 1]), return_index=True, return_inverse=True)
    change = np.zeros((len(bounds), size, 3))  # constant from one bound to the next
    np.add.at(change, at[:len(pulled)], pulled)
    np.subtract.at(change, at[len(pulled):], pulled)
    carried = np.cumsum(change, axis=0)[:-1]
    spread = from_entries(np.diff(np.concatenate([*part.passed], axis=1)[:, known], axis=1))
    by_sample = np.zeros((samples, size, 3))
    np.add.at(by_sample, windows.start, gain @ part.at_start)
    np.add.at(by_sample, windows.end, gain @ part.at_end)
    noise = np.array([variances.position, variances.position, variances.heading])
    by_slip = np.einsum('bpi,bij,bqj->pq', carried, spread, carried, optimize=True)
    score: Array = (variances.slip * by_slip
                    + np.tensordot(by_sample * noise, by_sample, ((0, 2), (0, 2))))
    return score


def course_state(problem: Problem) -> FitState:
    """
    Return the state in which odometry is its own reference: it shows what the course tells.

    Parameters
    ----------
    problem : Problem
        What is fitted to what.

    Returns
    -------
    FitState
        At the truth, all windows with their full weight.

    Examples
    --------
    See :func:`refuse_unidentified`.

    """
    course = problem.as_the_wheels_tell()
    windows = sum(len(each.start) for each in problem.windows)
    return FitState.at(course, course.initial(), np.ones(windows), START_VARIANCES)


def unidentified(state: FitState) -> List[int]:
    """
    Return which parameters have a standard error as large as the parameter may be.

    The prior of that size keeps the matrix regular; where it alone tells the standard error, the
    data say nothing.

    Parameters
    ----------
    state : FitState
        Where the fit stands.

    Returns
    -------
    list of int
        Indices of their columns.

    Examples
    --------
    See :func:`refuse_unidentified`.

    """
    usual = Variances(*(max(pair) for pair in zip(state.variances, FINEST)))
    limit = _limits(state)
    information, _ = replace(state, variances=usual).normal_equations()
    scaled = information * np.outer(limit, limit) + 1e-4 * np.eye(len(limit))
    errors = limit * np.sqrt(np.diag(np.linalg.inv(scaled)))
    return [n for n, error in enumerate(errors) if error > limit[n]]


def refuse_unidentified(state: FitState, *, course: bool = False) -> None:
    """
    Raise where the standard error of a parameter is as large as the parameter may be.

    Parameters
    ----------
    state : FitState
        Where the fit stands.
    course : bool
        The state is that of :func:`course_state`, instead of what the reference tells.

    Raises
    ------
    ValueError
        If there is such a parameter; it is named.

    Examples
    --------
    A straight drive says nothing about the separation:

    >>> from diffdrive_kinematics.core.calibration import (
    ...     Clock, drive_from_rates, NO_FRAME, Windows)
    >>> from diffdrive_kinematics.core.calibration.fit_setup import problem_of
    >>> from diffdrive_kinematics.core.kinematics import WheelGeometry
    >>> stamps = np.arange(20.0)
    >>> drive = drive_from_rates(stamps, np.full((20, 2), 8.0), stamps, np.zeros((20, 3)))
    >>> problem = problem_of(
    ...     WheelGeometry(0.5, 0.125), [drive], wheels=True, clock=Clock.NONE, frame=NO_FRAME,
    ...     windows=Windows())
    >>> unidentified(course_state(problem))
    [2]
    >>> refuse_unidentified(course_state(problem), course=True)  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    ...
    ValueError: the data do not identify wheel_separation_multiplier (standard error over 0.1), ...

    """
    lost, limit, columns = unidentified(state), _limits(state), state.problem.columns
    if lost:
        said = ', '.join(f'{columns[n].name} (standard error over {limit[n]:.2g})' for n in lost)
        raise ValueError(
            f'the data do not identify {said}, expected drives with straights and curves both '
            f'ways'
            if course else
            f'wheels and reference do not agree well enough to tell {said}, though the course '
            f'would: {SAME_DRIVE}')


def _limits(state: FitState) -> Array:
    """Return how large the standard errors of the parameters may be."""
    problem = state.problem
    return np.array([
        getattr(LARGEST_ERROR, each.field)
        * (problem.geometry.separation if each.field in ('x', 'y') else 1.0)
        for each in problem.columns])
