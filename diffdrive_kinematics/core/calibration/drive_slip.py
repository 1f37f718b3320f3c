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
Slip of calibrated drives: from a calibration and its drives to slip constants with errors.

Windows that the calibration takes for outliers (an encoder that starts anew, a tracker that loses
its body) are left out here as well: a single one would outweigh all slip.

Windows that start often overlap, which makes the best use of the data.  Each counts by the share
of its time that is its own, so that the likelihood is that of windows that do not overlap,
averaged over where they start.  Standard errors come from leaving out a group at a time
(Tukey's jackknife, Efron & Stein 1981, Ann. Stat. 9(3)), a group being a drive, or a part of
one where there are few.  The calibration itself is taken as exact: calibrate other drives than
those whose slip is wanted where the systematic errors are not known far better than the slip.
"""

from dataclasses import replace
from itertools import chain
import math
from typing import Any, Dict, List, Optional, Sequence, Tuple

from diffdrive_kinematics.core.calibration.calibration_parameters import (
    CalibrationParameters, Estimate)
from diffdrive_kinematics.core.calibration.recorded_drive import on_wheel_clock, RecordedDrive
from diffdrive_kinematics.core.calibration.slip_choice import choose_slip
from diffdrive_kinematics.core.calibration.slip_fit import fit_slip
from diffdrive_kinematics.core.calibration.slip_result import SlipFit
from diffdrive_kinematics.core.calibration.slip_window import slip_window, SlipWindow
from diffdrive_kinematics.core.calibration.trajectory_result import TrajectoryFit
from diffdrive_kinematics.core.calibration.trajectory_windows import Windows, windows_between
from diffdrive_kinematics.core.calibration.window_weights import distance, REJECTED, Variances
from diffdrive_kinematics.core.kinematics import Array, Pose, WheelGeometry
import numpy as np

_Counted = Tuple[SlipWindow, float]

FEWEST_GROUPS = 5
EVERY = 1.0  # [s] from the start of a window to that of the next


def slip_windows(
        geometry: WheelGeometry, drive: RecordedDrive, systematic: CalibrationParameters,
        length: float, every: float) -> List[SlipWindow]:
    """
    Return the slip windows of one length of a drive, calibrated, in order.

    Parameters
    ----------
    geometry : WheelGeometry
        Geometry from which the calibration started.
    drive : RecordedDrive
        The drive.
    systematic : CalibrationParameters
        What is systematic about it.
    length, every : float
        As of the windows of a calibration [s]; they do not overlap if ``every`` is above
        ``length``.

    Returns
    -------
    list of SlipWindow
        Those in which a wheel turns.

    Examples
    --------
    >>> from diffdrive_kinematics.core.calibration import drive_from_rates
    >>> stamps = np.arange(0.0, 10.5, 0.5)
    >>> poses = np.stack([stamps, 0.0 * stamps, 0.0 * stamps], axis=1)
    >>> drive = drive_from_rates(stamps, np.full((21, 2), 8.0), stamps, poses)
    >>> len(slip_windows(
    ...     WheelGeometry(0.5, 0.125), drive, CalibrationParameters(), length=2.0, every=2.5))
    4

    """
    chosen = windows_between(drive, (length,), every, Windows.tolerance)
    calibrated = replace(
        geometry,
        wheel_separation_multiplier=geometry.wheel_separation_multiplier * systematic.separation)
    stamps = on_wheel_clock(drive, systematic)
    radii = np.array([geometry.left_radius * systematic.left,
                      geometry.right_radius * systematic.right])
    poses, twists = _centre(drive.reference, systematic), _twists(calibrated, drive, radii, stamps)
    found = []
    for start, end in zip(chosen.start, chosen.end):
        travel = radii * np.diff(_angles(drive, stamps[start], stamps[end]), axis=0)
        if travel.any():
            found.append(slip_window(
                calibrated, travel, Pose(*poses[start]), Pose(*poses[end]),
                twists=twists[[start, end]]))
    return found


def fit_drive_slip(
        geometry: WheelGeometry, drives: Sequence[RecordedDrive], fit: TrajectoryFit, *,
        lengths: Tuple[float, ...] = (2.0, 10.0), equal: bool = True,
        terms: Optional[Sequence[str]] = None) -> SlipFit:
    """
    Return the slip constants of calibrated drives, errors by leaving out groups of windows.

    Parameters
    ----------
    geometry : WheelGeometry
        Geometry that :func:`.fit_trajectory` was given.
    drives : sequence of RecordedDrive
        Drives that it was given.
    fit : TrajectoryFit
        What it returned.
    lengths : tuple of float
        Lengths of the windows [s], of which one starts every second.
    equal : bool
        Fit one k for both wheels instead of one each.
    terms : sequence of str, optional
        What slip is made of, some of ``SLIP_TERMS``; without, those that pay (see
        :mod:`.slip_choice`).

    Returns
    -------
    SlipFit
        Slip constants and noise of the reference, with their errors.

    Raises
    ------
    ValueError
        As :func:`.fit_slip`; if the drives are not those of the fit.

    Examples
    --------
    A drive without slip, by a reference with a noise of 2 mm and 2 mrad:

    >>> from diffdrive_kinematics.core.calibration import drive_from_rates
    >>> from diffdrive_kinematics.core.calibration import Clock, fit_trajectory
    >>> from diffdrive_kinematics.core.calibration import odometry_at
    >>> geometry, stamps = WheelGeometry(0.5, 0.125), np.arange(0.0, 60.0, 0.5)
    >>> rates = 8.0 + 4.0 * np.stack([np.sin(stamps), np.cos(0.7 * stamps)], axis=1)
    >>> bare = drive_from_rates(stamps, rates, stamps, np.zeros((120, 3)))
    >>> noise = np.random.default_rng(1).normal(0.0, 0.002, (120, 3))
    >>> drive = replace(
    ...     bare, reference=odometry_at(geometry, bare, CalibrationParameters()) + noise)
    >>> fit = fit_trajectory(geometry, [drive], frame=Pose(0.0, 0.0, 0.0), clock=Clock.NONE)
    >>> f'{fit_drive_slip(geometry, [drive], fit).sigma_position.value:.3f} m'
    '0.002 m'

    """
    if len(drives) != len(fit.offsets):
        raise ValueError(
            f'there are {len(drives)} drives, expected {len(fit.offsets)} as in the fit')
    groups: List[List[_Counted]] = []
    parts = -(-FEWEST_GROUPS // len(drives))
    for number, drive in enumerate(drives):
        mine: List[List[_Counted]] = [[] for _ in range(parts)]
        for length in lengths:
            windows = [each for each in slip_windows(
                geometry, drive, fit.systematic(number), length, EVERY)
                if _credible(each, fit.variances)]
            for n, window in enumerate(windows):
                mine[n * parts // len(windows)].append((window, min(EVERY / length, 1.0)))
        groups += mine
    whole = _fitted(groups, equal, terms)
    others = [_fitted(groups[:n] + groups[n + 1:], equal, whole.terms) for n in range(len(groups))]

    estimates: Dict[str, Any] = {
        name: _jackknifed([getattr(each, name) for each in (whole, *others)])
        for name, value in vars(whole).items() if isinstance(value, Estimate)}
    return replace(whole, **estimates)


def _fitted(
        groups: Sequence[Sequence[_Counted]], equal: bool, terms: Optional[Sequence[str]]
) -> SlipFit:
    """Return the slip of groups of windows, of the terms that pay where none are given."""
    counted = list(chain.from_iterable(groups))
    windows, weights = [window for window, _ in counted], [weight for _, weight in counted]
    if terms is None:
        return choose_slip(windows, equal=equal, weights=weights)
    return fit_slip(windows, equal=equal, weights=weights, terms=terms)


def _credible(window: SlipWindow, variances: Variances) -> bool:
    """Return whether a window is none of those that count nothing in the calibration."""
    covariance = (variances.slip * (window.left + window.right)
                  + variances.position * window.position + variances.heading * window.heading)
    return bool(distance(window.error[None], covariance[None])[0] < REJECTED)


def _jackknifed(estimates: List[Estimate]) -> Estimate:
    """Return the first estimate with the error that the others, each without a group, tell."""
    without = [each.value for each in estimates[1:]]
    error = math.sqrt(len(without) - 1.0) * float(np.std(without))
    return Estimate(estimates[0].value, error)


def _centre(reference: Array, systematic: CalibrationParameters) -> Array:
    """Return the poses of the robot's centre, shape (m, 3)."""
    theta = reference[:, 2] - systematic.yaw
    cosine, sine = np.cos(theta), np.sin(theta)
    return np.stack([reference[:, 0] - cosine * systematic.x + sine * systematic.y,
                     reference[:, 1] - sine * systematic.x - cosine * systematic.y, theta], axis=1)


def _twists(geometry: WheelGeometry, drive: RecordedDrive, radii: Array, stamps: Array) -> Array:
    """Return speed [m/s] and yaw rate [rad/s] at each stamp, shape (m, 2)."""
    rates = radii * np.diff(drive.angles, axis=0) / np.diff(drive.time)[:, None]
    left, right = rates[
        np.clip(np.searchsorted(drive.time, stamps, 'right') - 1, 0, len(rates) - 1)].T
    return np.stack([0.5 * (left + right), (right - left) / geometry.separation], axis=1)


def _angles(drive: RecordedDrive, start: float, end: float) -> Array:
    """Return the wheel angles at two stamps and all between, interpolated at the two."""
    low, high = np.searchsorted(drive.time, start, 'right'), np.searchsorted(drive.time, end)
    near = slice(max(low - 1, 0), high + 1)  # each window costs its own length only
    first, last = (
        np.array([np.interp(stamp, drive.time[near], wheel) for wheel in drive.angles[near].T])
        for stamp in (start, end))
    return np.vstack([first, drive.angles[low:high], last])
