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
Where a fit stands: values of the parameters, windows linearised there, and how these are weighed.

It is the model that :mod:`.gauss_newton` makes steps of; each drive adds its part to the normal
equations.
"""

from dataclasses import dataclass, replace
from typing import List, Tuple

from diffdrive_kinematics.core.calibration.calibration_parameters import CalibrationParameters
from diffdrive_kinematics.core.calibration.fit_problem import Problem
from diffdrive_kinematics.core.calibration.window_residuals import WindowResiduals
from diffdrive_kinematics.core.calibration.window_weights import (
    distance, Variances, window_covariance)
from diffdrive_kinematics.core.kinematics import Array
import numpy as np

Gain = Tuple[List[int], Array, Array]

LONGEST_STEP = CalibrationParameters(
    left=0.05, right=0.05, separation=0.1, x=0.1, y=0.1, yaw=0.3, offset=0.1, drift=2e-3)
"""How far a parameter may move in one step."""


@dataclass(frozen=True)
class FitState:
    """
    Where a fit stands.

    Parameters
    ----------
    problem : Problem
        What is fitted to what.
    values : numpy.ndarray, shape (p,)
        Values of the parameters.
    parts : list of WindowResiduals
        Windows of each drive, linearised there; w in all.
    weights : numpy.ndarray, shape (w,)
        Weights of all windows.
    variances : Variances
        Slip constant and noise of the reference.

    Examples
    --------
    The separation alone, of a robot whose wheels are 0.51 m apart instead of 0.5 m:

    >>> from diffdrive_kinematics.core.calibration import (
    ...     drive_from_rates, odometry_at, windows_between)
    >>> from diffdrive_kinematics.core.calibration.fit_problem import Column
    >>> from diffdrive_kinematics.core.calibration.gauss_newton import descend
    >>> from diffdrive_kinematics.core.kinematics import WheelGeometry
    >>> stamps = np.arange(0.0, 60.0, 0.5)
    >>> rates = 8.0 + 4.0 * np.stack([np.sin(stamps), np.cos(0.7 * stamps)], axis=1)
    >>> bare = drive_from_rates(stamps, rates, stamps, np.zeros((120, 3)))
    >>> truth = odometry_at(WheelGeometry(0.51, 0.125), bare, CalibrationParameters())
    >>> windows = windows_between(bare, (2.0, 10.0), every=0.5, tolerance=0.1)
    >>> problem = Problem(
    ...     WheelGeometry(0.5, 0.125), (replace(bare, reference=truth),), (windows,),
    ...     (Column('wheel_separation_multiplier', 'separation', None),),
    ...     CalibrationParameters(), trust=4.0)
    >>> start = FitState.at(
    ...     problem, problem.initial(), np.ones(len(windows.start)), Variances(1e-6, 1e-6, 1e-6))
    >>> state, _ = descend(start, watch=lambda iteration: None)
    >>> f'{state.values[0]:.3f}'
    '1.020'

    What is left, and what the next step would be made of:

    >>> bool(state.distances().max() < 0.01), state.cost() < start.moved(np.array([0.01])).cost()
    (True, True)
    >>> information, gradient = state.normal_equations()
    >>> information.shape, gradient.shape, state.longest_step()
    ((1, 1), (1,), array([0.1]))
    >>> columns, jacobian, gain = state.gains()[0]

    """

    problem: Problem
    values: Array
    parts: List[WindowResiduals]
    weights: Array
    variances: Variances

    @classmethod
    def at(cls, problem: Problem, values: Array, weights: Array, variances: Variances
           ) -> 'FitState':
        """
        Return the state at some values.

        Parameters
        ----------
        problem : Problem
            What is fitted to what.
        values : numpy.ndarray, shape (p,)
            Values of the parameters.
        weights : numpy.ndarray, shape (w,)
            Weights of all windows.
        variances : Variances
            Slip constant and noise of the reference.

        Returns
        -------
        FitState
            With the windows linearised there.

        Examples
        --------
        See :class:`FitState`.

        """
        return cls(problem, values, problem.parts(values), weights, variances)

    def moved(self, change: Array) -> 'FitState':
        """
        Return the state at other values, with the same weights and variances.

        Parameters
        ----------
        change : numpy.ndarray, shape (p,)
            What to add to the values.

        Returns
        -------
        FitState
            With the windows linearised there.

        Examples
        --------
        See :class:`FitState`.

        """
        values = self.values + change
        return replace(self, values=values, parts=self.problem.parts(values))

    def distances(self) -> Array:
        """
        Return ``sqrt(e^T P^-1 e)`` of all windows, those of the first drive first.

        Returns
        -------
        numpy.ndarray, shape (w,)
            Distances [1].

        Examples
        --------
        See :class:`FitState`.

        """
        return np.concatenate([
            distance(part.error, window_covariance(part, self.variances)) for part in self.parts])

    def cost(self) -> float:
        """
        Return the weighted sum of squared distances.

        Returns
        -------
        float
            What the fit makes least.

        Examples
        --------
        See :class:`FitState`.

        """
        return float(self.weights @ self.distances()**2)

    def longest_step(self) -> Array:
        """
        Return how far each parameter may move in one step.

        Returns
        -------
        numpy.ndarray, shape (p,)
            In the units of the parameters.

        Examples
        --------
        See :class:`FitState`.

        """
        return np.array([getattr(LONGEST_STEP, each.field) for each in self.problem.columns])

    def normal_equations(self) -> Tuple[Array, Array]:
        """
        Return ``H = sum J^T P^-1 J`` and ``g = sum J^T P^-1 e`` over the weighted windows.

        Returns
        -------
        information : numpy.ndarray, shape (p, p)
            H.
        gradient : numpy.ndarray, shape (p,)
            The score g.

        Examples
        --------
        See :class:`FitState`.

        """
        size = len(self.problem.columns)
        information, gradient = np.zeros((size, size)), np.zeros(size)
        for (columns, jacobian, gain), part in zip(self.gains(), self.parts):
            information[np.ix_(columns, columns)] += np.einsum('wpi,wiq->pq', gain, jacobian)
            gradient[columns] += np.einsum('wpi,wi->p', gain, part.error)
        return information, gradient

    def gains(self) -> List[Gain]:
        """
        Return for each drive its columns, J, and the weighted ``J^T P^-1``.

        Returns
        -------
        list of Gain
            Indices of q columns, and arrays of shapes (w, 3, q) and (w, q, 3).

        Examples
        --------
        See :class:`FitState`.

        """
        found, ends = [], np.cumsum([len(each.start) for each in self.problem.windows])
        for number, (part, weight) in enumerate(
                zip(self.parts, np.split(self.weights, ends[:-1]))):
            columns, fields = self.problem.columns_of(number)
            jacobian = part.jacobian[:, :, fields]
            solved = np.linalg.solve(window_covariance(part, self.variances), jacobian)
            found.append((columns, jacobian, weight[:, None, None] * solved.transpose(0, 2, 1)))
        return found
