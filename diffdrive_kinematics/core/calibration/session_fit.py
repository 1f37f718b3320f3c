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
What differs between sessions: the spread of the wheels that each of them alone tells.

Each session, of one drive or several, is fitted by itself, with the reference's frame of all of
them.  Its estimates of scale, separation and curvature scatter by their standard errors within the
session, and by what lasts one.  The variance between sessions is what their scatter has beyond the
standard errors: that for which the squared deviations, each over the sum of both variances, add up
to one less than the sessions (Paule & Mandel 1982, J. Res. NBS 87(5)); 0 where the standard errors
explain it all.
"""

import math
from typing import List, NamedTuple, Optional, Sequence, Tuple

from diffdrive_kinematics.core.calibration.calibration_parameters import Estimate, NAMES, WHEELS
from diffdrive_kinematics.core.calibration.fit_setup import Clock
from diffdrive_kinematics.core.calibration.recorded_drive import RecordedDrive
from diffdrive_kinematics.core.calibration.trajectory_fit import fit_trajectory
from diffdrive_kinematics.core.calibration.trajectory_result import TrajectoryFit
from diffdrive_kinematics.core.calibration.trajectory_windows import Windows
from diffdrive_kinematics.core.kinematics import Array, WheelGeometry
import numpy as np
from numpy.typing import ArrayLike

FEWEST = 3
HALVINGS = 100


class SessionFit(NamedTuple):
    """
    Standard deviations, between sessions, of what lasts one.

    Parameters
    ----------
    scale : Estimate or None
        Of the scale of all travel [1]; None where the mean radius is not fitted.
    separation : Estimate
        Of the fraction of the separation [1].
    curvature : Estimate
        Of the heading gained per metre [rad/m].
    sessions : int
        From how many.

    Examples
    --------
    >>> SessionFit(None, Estimate(0.003, 0.001), Estimate(0.0, 0.001), sessions=5).separation.value
    0.003

    """

    scale: Optional[Estimate]
    separation: Estimate
    curvature: Estimate
    sessions: int


def spread_between(values: ArrayLike, errors: ArrayLike) -> Estimate:
    """
    Return the standard deviation of what estimates scatter beyond their standard errors.

    Parameters
    ----------
    values : array_like, shape (n,)
        Estimates, n >= 2.
    errors : array_like, shape (n,)
        Their standard errors.

    Returns
    -------
    Estimate
        In the same unit, 0 or above.  Its standard error is that of large samples; where the
        spread is not seen, it is the spread that would be.

    Examples
    --------
    They scatter by 0.1 in all, 0.06 of which are the errors of each:

    >>> round(spread_between([0.9, 1.0, 1.1], [0.06, 0.06, 0.06]).value, 6)
    0.08
    >>> spread_between([0.9, 1.0, 1.1], [0.2, 0.2, 0.2]).value
    0.0

    """
    each = np.asarray(values, dtype=np.float64)
    within: Array = np.asarray(errors, dtype=np.float64)**2
    degrees = len(each) - 1

    def scatter(variance: float) -> float:
        weights = 1.0 / (variance + within)
        mean = float(weights @ each / weights.sum())
        return float(weights @ (each - mean)**2)

    low, high = 0.0, float(each.var(ddof=1))
    if high > 0.0 and scatter(1e-12 * high) > degrees:
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if scatter(middle) > degrees else (low, middle)
        variance = high
    else:
        variance = 0.0
    if not (variance + within).all():
        return Estimate(0.0, 0.0)
    error = math.sqrt(2.0 * len(each) / degrees / float((1.0 / (variance + within)**2).sum()))
    spread = math.sqrt(variance)
    return Estimate(spread, error / max(2.0 * spread, math.sqrt(error)))


def fit_sessions(
        geometry: WheelGeometry, sessions: Sequence[Sequence[RecordedDrive]],
        fit: TrajectoryFit, *, clock: Clock, mean_radius: bool = True, windows: Windows = Windows()
) -> Optional[SessionFit]:
    """
    Return by how much the wheels differ between sessions.

    Parameters
    ----------
    geometry : WheelGeometry
        Geometry that the fit started from.
    sessions : sequence of sequence of RecordedDrive
        The drives of each.
    fit : TrajectoryFit
        Fit of all of them: its frame of the reference is kept, its wheels are where to start.
    clock, mean_radius, windows : as there
        As :func:`.fit_trajectory` had them.

    Returns
    -------
    SessionFit or None
        None where fewer than three tell the wheels by themselves.

    Examples
    --------
    One session says nothing about others:

    >>> from dataclasses import replace
    >>> from diffdrive_kinematics.core.calibration import (
    ...     CalibrationParameters, drive_from_rates, NO_FRAME, odometry_at)
    >>> geometry, stamps = WheelGeometry(0.5, 0.125), np.arange(0.0, 60.0, 0.5)
    >>> rates = 8.0 + 4.0 * np.stack([np.sin(stamps), np.cos(0.7 * stamps)], axis=1)
    >>> bare = drive_from_rates(stamps, rates, stamps, np.zeros((120, 3)))
    >>> truth = odometry_at(geometry, bare, CalibrationParameters())
    >>> drives = [replace(bare, reference=truth)]
    >>> fit = fit_trajectory(geometry, drives, frame=NO_FRAME, clock=Clock.NONE)
    >>> fit_sessions(geometry, [drives], fit, clock=Clock.NONE) is None
    True

    """
    if len(sessions) < FEWEST:
        return None
    after, found = fit.corrected(geometry), []
    for drives in sessions:
        try:
            alone = fit_trajectory(
                after, drives, clock=clock, mean_radius=mean_radius, frame=fit.frame,
                windows=windows)
        except ValueError:  # they do not tell the wheels by themselves
            continue
        found.append(_deviation(after, alone))
    if len(found) < FEWEST:
        return None
    scale, separation, curvature = (
        spread_between(values, errors) for values, errors in np.swapaxes(found, 0, 2))
    return SessionFit(scale if mean_radius else None, separation, curvature, len(found))


def _deviation(geometry: WheelGeometry, fit: TrajectoryFit) -> Tuple[List[float], List[float]]:
    """Return scale, separation and curvature of a session, and their standard errors."""
    left, right, separation = (getattr(fit, NAMES[field]).value for field in WHEELS)
    scale, by_turn = 0.5 * (left + right), 1.0 / geometry.separation
    values = [scale - 1.0, separation - 1.0, by_turn * (right - left) / (scale * separation)]
    change = np.array([[0.5, 0.5, 0.0], [0.0, 0.0, 1.0], [-by_turn, by_turn, 0.0]])
    at = [fit.names.index(NAMES[field]) for field in WHEELS]
    covariance = change @ fit.covariance[np.ix_(at, at)] @ change.T
    return values, [math.sqrt(max(each, 0.0)) for each in covariance.diagonal().tolist()]
