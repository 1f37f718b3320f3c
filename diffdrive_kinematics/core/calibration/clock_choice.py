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
Which clocks of a reference drift: an offset for each drive, and a drift where it pays.

A drift stays if the likelihood ratio of the fit with it to that without is over 6.63, which a
clock that does not drift exceeds in 1 % of all drives (Wilks 1938).  The windows of a fit
overlap, so its likelihood counts the same errors several times; the ratio is therefore taken in
its quadratic form ``(drift / standard error)^2`` (Wald 1943), with the standard error that allows
for overlaps (:mod:`.fit_covariance`; Varin, Reid & Firth 2011, Statistica Sinica 21(1), eq. 2.3).
"""

from dataclasses import replace
from typing import Callable, List, Optional, Tuple

from diffdrive_kinematics.core.calibration.fit_covariance import (
    course_state, parameter_covariance, unidentified)
from diffdrive_kinematics.core.calibration.fit_problem import Column, Problem
from diffdrive_kinematics.core.calibration.fit_setup import fewest_windows
from diffdrive_kinematics.core.calibration.fit_state import FitState
from diffdrive_kinematics.core.calibration.gauss_newton import Iteration

LEAST_RATIO = 6.635
"""Likelihood ratio from which a parameter pays: 1 % of chi square with one degree of freedom."""

Ratios = Tuple[Optional[float], ...]
Solved = Tuple[FitState, List[Iteration]]


def drift_pays(ratio: Optional[float]) -> bool:
    """
    Return whether a drift of this likelihood ratio is fitted.

    Parameters
    ----------
    ratio : float or None
        Likelihood ratio of a drive's drift [1]; None: no drift was tried.

    Returns
    -------
    bool
        Whether it is over 6.63, which holds by chance in 1 % of all drives.

    Examples
    --------
    >>> drift_pays(40.0), drift_pays(2.0), drift_pays(None)
    (True, False, False)

    """
    return ratio is not None and ratio > LEAST_RATIO


def chosen_clocks(problem: Problem, solve: Callable[[Problem], Solved]) -> Tuple[Solved, Ratios]:
    """
    Return the fit in which the clock of each drive drifts if that pays.

    Parameters
    ----------
    problem : Problem
        The fit with an offset for each drive.
    solve : callable
        Solves a problem: returns its state and the steps of the search.

    Returns
    -------
    solved : tuple of FitState and list of Iteration
        Where the fit ends, and the steps of all searches.
    ratios : tuple of float or None
        Likelihood ratio of the drift of each drive; None where its course does not tell one.

    Raises
    ------
    ValueError
        As ``solve``, without any drift.

    Examples
    --------
    A tracker whose clock gains 0.3 s in a minute, as :func:`.fit_trajectory` fits it:

    >>> import numpy as np
    >>> from diffdrive_kinematics.core.calibration import (
    ...     CalibrationParameters, Clock, drive_from_rates, fit_trajectory, NO_FRAME, odometry_at)
    >>> from diffdrive_kinematics.core.kinematics import WheelGeometry
    >>> geometry, stamps = WheelGeometry(0.5, 0.125), np.arange(0.0, 60.0, 0.5)
    >>> rates = 8.0 + 4.0 * np.stack([np.sin(stamps), np.cos(0.7 * stamps)], axis=1)
    >>> bare = drive_from_rates(stamps, rates, stamps, np.zeros((120, 3)))
    >>> truth = odometry_at(geometry, bare, CalibrationParameters(drift=0.005))
    >>> fit = fit_trajectory(
    ...     geometry, [replace(bare, reference=truth)], frame=NO_FRAME, clock=Clock.AUTO)
    >>> fit.names[-1], round(60.0 * fit.drifts[0].value, 3), fit.drift_ratios[0] > 1e3
    ('drift of drive 1', 0.3, True)

    """
    tried = _with_drifts(problem)
    nothing: Ratios = (None,) * len(problem.drives)
    if tried.columns == problem.columns:
        return solve(problem), nothing
    try:
        state, trace = solve(tried)
    except ValueError:  # too much for these drives; offsets may do
        return solve(problem), nothing
    ratios = _ratios(state)
    columns = tuple(each for each in tried.columns
                    if each.drive is None or each.field != 'drift'
                    or drift_pays(ratios[each.drive]))
    if columns == tried.columns:
        return (state, trace), ratios
    state, more = solve(replace(problem, columns=columns))
    return (state, trace + more), ratios


def _with_drifts(problem: Problem) -> Problem:
    """Return the problem with a drift for each drive whose course tells it."""
    columns: List[Column] = []
    for each in problem.columns:
        columns.append(each)
        if each.field == 'offset' and each.drive is not None:
            columns.append(Column(f'drift of drive {each.drive + 1}', 'drift', each.drive))
    windows = sum(len(each.start) for each in problem.windows)
    if windows < fewest_windows(len(columns)):
        return problem
    wide = replace(problem, columns=tuple(columns))
    lost = unidentified(course_state(wide))
    return replace(wide, columns=tuple(
        each for n, each in enumerate(columns) if each.field != 'drift' or n not in lost))


def _ratios(state: FitState) -> Ratios:
    """Return ``(drift / standard error)^2`` of each drive."""
    variances, found = parameter_covariance(state).diagonal(), {}
    for each, value, variance in zip(state.problem.columns, state.values, variances):
        if each.field == 'drift':
            found[each.drive] = float(value**2 / variance)
    return tuple(found.get(drive) for drive in range(len(state.problem.drives)))
