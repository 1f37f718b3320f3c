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
Calibration from recorded drives: nonlinear least squares over windows between reference poses.

Fitted together are factors on the radii and the separation, where the reference's frame sits on
the robot, and how the clocks are off (or how late commands are followed).  The errors of windows
of several lengths (:mod:`.window_residuals`) are weighed by the covariance that slip and the
reference's noise give them; these variances are estimated along with the rest, and windows that
are not credible under them lose their weight (:mod:`.window_weights`).  The iteration is that of
Gauss and Newton (:mod:`.gauss_newton`).

What the data do not identify is refused: a straight drive says nothing about the separation, a
drive without turns nothing about where the reference's frame sits.
"""

from dataclasses import replace
from functools import partial
import math
from typing import List, Optional, Sequence, Tuple

from diffdrive_kinematics.core.calibration.calibration_parameters import (
    Estimate, FRAME, NAMES, WHEELS)
from diffdrive_kinematics.core.calibration.clock_choice import chosen_clocks, Ratios
from diffdrive_kinematics.core.calibration.fit_covariance import (
    course_state, parameter_covariance, refuse_unidentified, SAME_DRIVE, taken_by_fit)
from diffdrive_kinematics.core.calibration.fit_problem import Problem
from diffdrive_kinematics.core.calibration.fit_setup import Clock, problem_of
from diffdrive_kinematics.core.calibration.fit_state import FitState
from diffdrive_kinematics.core.calibration.gauss_newton import (
    descend, Iteration, newton_step, Watch)
from diffdrive_kinematics.core.calibration.recorded_drive import RecordedDrive
from diffdrive_kinematics.core.calibration.trajectory_result import Residual, TrajectoryFit
from diffdrive_kinematics.core.calibration.trajectory_windows import Windows
from diffdrive_kinematics.core.calibration.window_weights import (
    MEDIAN, START_VARIANCES, updated_variances, Variances, window_weights)
from diffdrive_kinematics.core.kinematics import Array, Pose, WheelGeometry
import numpy as np

COARSE, ALTERNATING = 5, 40
"""Rounds up to which the variances are only scaled, and from which they and weights are held."""


def _ignored(iteration: Iteration) -> None:
    """Watch a search without a word."""


def fit_trajectory(
        geometry: WheelGeometry, drives: Sequence[RecordedDrive], *, wheels: bool = True,
        mean_radius: bool = True, clock: Clock = Clock.AUTO, frame: Optional[Pose] = None,
        windows: Windows = Windows(), watch: Watch = _ignored) -> TrajectoryFit:
    """
    Return the systematic errors that explain the reference best, with standard errors.

    Standard errors hold where slip and the reference's noise are white; what else there is in the
    errors of the windows counts as slip and noise.

    Parameters
    ----------
    geometry : WheelGeometry
        Where the fit starts; true sizes within some 20 %.
    drives : sequence of RecordedDrive
        Drives of one robot with one mounting of the reference.
    wheels : bool
        Fit the wheels, instead of taking the geometry as it is.
    mean_radius : bool
        False: divide the factors of the wheels by the mean of those of the radii, so that yaw
        stays as fitted and distance as given.  How much of a commanded distance a robot covers
        changes with what it does, and is no property of its wheels.
    clock : Clock
        What is fitted of the time; AUTO chooses by likelihood (see :mod:`.clock_choice`).
    frame : Pose, optional
        Pose of the reference's frame on the robot, where it is known; fitted where it is not.
    windows : Windows
        Which windows are fitted.
    watch : callable
        Told of each :class:`.Iteration`, to show how far the fit is; what it raises ends it.

    Returns
    -------
    TrajectoryFit
        Estimates, their covariance, and the residual before and after.

    Raises
    ------
    ValueError
        If there is no drive, nothing to fit, too few windows, a number that is not finite, a
        parameter that the data do not identify, or no end of the iteration.

    Examples
    --------
    The wheels are 0.51 m apart instead of 0.5 m, and the reference is at the robot's centre:

    >>> from diffdrive_kinematics.core.calibration import (
    ...     CalibrationParameters, Clock, drive_from_rates, NO_FRAME, odometry_at)
    >>> geometry, stamps = WheelGeometry(0.5, 0.125), np.arange(0.0, 60.0, 0.5)
    >>> rates = 8.0 + 4.0 * np.stack([np.sin(stamps), np.cos(0.7 * stamps)], axis=1)
    >>> bare = drive_from_rates(stamps, rates, stamps, np.zeros((120, 3)))
    >>> truth = odometry_at(WheelGeometry(0.51, 0.125), bare, CalibrationParameters())
    >>> fit = fit_trajectory(
    ...     geometry, [replace(bare, reference=truth)], frame=NO_FRAME, clock=Clock.NONE)
    >>> f'{fit.systematic(0).separation:.3f}, {fit.corrected(geometry).separation:.3f} m'
    '1.020, 0.510 m'

    """
    problem = problem_of(
        geometry, drives, wheels=wheels, clock=clock, frame=frame, windows=windows)
    try:
        with np.errstate(all='ignore'):  # what comes of it is judged
            return _fitted(problem, clock, wheels and not mean_radius, watch)
    except np.linalg.LinAlgError as error:
        raise ValueError(
            f'wheels and reference do not agree well enough to be fitted ({error}): '
            f'{SAME_DRIVE}') from error


def _fitted(problem: Problem, clock: Clock, mean_radius_kept: bool, watch: Watch) -> TrajectoryFit:
    """Return the fit; ``LinAlgError`` where the numbers leave all bounds."""
    solve = partial(_solved, watch=watch)
    ratios: Ratios = (None,) * len(problem.drives)
    (state, trace), ratios = (
        chosen_clocks(problem, solve) if clock is Clock.AUTO else (solve(problem), ratios))
    covariance = parameter_covariance(state)
    if mean_radius_kept:
        state, change = _with_mean_radius_kept(state)
        covariance = change @ covariance @ change.T
    after = _residual(state)
    return _result(state, covariance, _before(state, after, watch), after, trace, ratios)


def _before(state: FitState, after: Residual, watch: Watch) -> Residual:
    """Return the residual of the same windows with the wheels as given."""
    problem = state.problem
    if not problem.indices(WHEELS):
        return after
    others = tuple(each for each in problem.columns if each.field not in WHEELS)
    bare = replace(problem, columns=others)
    start = FitState.at(bare, bare.initial(), state.weights, state.variances)
    return _residual(descend(start, watch)[0] if others else start)


def _solved(problem: Problem, watch: Watch) -> Tuple[FitState, List[Iteration]]:
    """Alternate between parameters, variances and weights until nothing changes."""
    refuse_unidentified(course_state(problem), course=True)
    windows = sum(len(each.start) for each in problem.windows)
    state = FitState.at(problem, problem.initial(), np.ones(windows), START_VARIANCES)
    trace = []
    for number in range(ALTERNATING):
        state = _reweighted(state, coarse=number < COARSE)
        step = newton_step(state)
        trace.append(Iteration(state.cost(), step.size))
        watch(trace[-1])
        state = state.moved(step.change)
        if number > COARSE + 3 and step.small:
            break
    state, last = descend(state, watch)
    refuse_unidentified(state)
    return state, trace + last


def _reweighted(state: FitState, *, coarse: bool) -> FitState:
    """Return the state with the weights and variances that its errors tell."""
    distances, trust = state.distances(), state.problem.trust
    if coarse:
        scale = max(float(np.median(distances)) / MEDIAN, 1e-6)
        return replace(
            state, weights=window_weights(distances / scale, trust),
            variances=Variances(*(scale**2 * each for each in state.variances)))
    state = replace(state, weights=window_weights(distances, trust))
    taken = taken_by_fit(state, parameter_covariance(state))
    return replace(state, variances=updated_variances(
        state.parts, distances, taken, state.variances, 6))


def _residual(state: FitState) -> Residual:
    squares = state.weights[:, None] * np.concatenate([part.error for part in state.parts])**2
    mean = squares.sum(axis=0) / state.weights.sum()
    return Residual(math.sqrt(mean[0] + mean[1]), math.sqrt(mean[2]))


def _with_mean_radius_kept(state: FitState) -> Tuple[FitState, Array]:
    """Return the state with the wheels divided by their mean radius, and its derivative."""
    at = state.problem.indices(WHEELS)
    wheels, values = state.values[at], state.values.copy()
    mean = 0.5 * (wheels[0] + wheels[1])
    change = np.eye(len(values))
    change[np.ix_(at, at)] = np.eye(3) / mean - np.outer(wheels, [0.5, 0.5, 0.0]) / mean**2
    values[at] = wheels / mean
    return replace(state, values=values, parts=state.problem.parts(values)), change


def _result(
        state: FitState, covariance: Array, before: Residual, after: Residual,
        trace: List[Iteration], ratios: Ratios) -> TrajectoryFit:
    problem, errors = state.problem, np.sqrt(np.diag(covariance))
    systematics = problem.systematics(state.values)

    def estimate(field: str, drive: int = 0) -> Estimate:
        found = [float(error) for each, error in zip(problem.columns, errors)
                 if each.field == field and each.drive in (None, drive)]
        return Estimate(float(getattr(systematics[drive], field)), *(found or [0.0]))

    drives = range(len(problem.drives))
    return TrajectoryFit(
        **{NAMES[field]: estimate(field) for field in (*WHEELS, *FRAME)},
        offsets=tuple(estimate('offset', drive) for drive in drives),
        drifts=tuple(estimate('drift', drive) for drive in drives),
        names=tuple(each.name for each in problem.columns), covariance=covariance,
        variances=state.variances, before=before, after=after, windows=len(state.weights),
        in_gaps=sum(each.in_gaps for each in problem.windows),
        outliers=int(np.count_nonzero(state.weights == 0.0)), trace=tuple(trace),
        drift_ratios=ratios)
