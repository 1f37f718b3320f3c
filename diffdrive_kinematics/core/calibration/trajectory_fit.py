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
of several lengths (:mod:`.trajectory_windows`) are weighed by the covariance that slip and the
reference's noise give them; these variances are estimated along with the rest, and windows that
are not credible under them lose their weight (:mod:`.window_weights`; there also for the standard
errors).  The iteration is that of Gauss and Newton with steps of bounded length.

What the data do not identify is refused: a straight drive says nothing about the separation, a
drive without turns nothing about where the reference's frame sits.
"""

from dataclasses import dataclass, replace
import enum
import math
from typing import List, NamedTuple, Optional, Sequence, Tuple

from diffdrive_kinematics.core.calibration.calibration_problem import (
    Column, distances_of, FRAME, newton_step, Problem, refuse_unidentified, SAME_DRIVE, sandwich,
    taken_by_fit, WHEELS)
from diffdrive_kinematics.core.calibration.recording import RecordedDrive
from diffdrive_kinematics.core.calibration.slip_fit import Estimate
from diffdrive_kinematics.core.calibration.trajectory_windows import (
    CalibrationParameters, WindowResiduals, windows_between)
from diffdrive_kinematics.core.calibration.window_weights import (
    MEDIAN, START_VARIANCES, updated_variances, Variances, window_weights)
from diffdrive_kinematics.core.kinematics import check_finite, check_positive, Pose, WheelGeometry
import numpy as np
from numpy.typing import NDArray

__all__ = [
    'COMMANDED', 'NO_FRAME', 'Clock', 'Residual', 'TrajectoryFit', 'Windows', 'fit_trajectory']

Array = NDArray[np.float64]

NO_FRAME = Pose(0.0, 0.0, 0.0)
ROUNDS, SETTLED = 100, 1e-2
COARSE, ALTERNATING = 5, 40
"""Rounds up to which the variances are only scaled, and from which they and weights are held."""
NEGLIGIBLE = 1e-3
"""Change of the sum of squared distances that no estimate feels."""


class Clock(enum.Enum):
    """
    What is fitted of the time between wheels and reference.

    Examples
    --------
    >>> Clock.DELAY.value
    'one delay for all drives'

    """

    NONE = 'none'
    DELAY = 'one delay for all drives'
    OFFSETS = 'an offset for each drive'
    DRIFTS = 'an offset and a drift for each drive'


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


class Residual(NamedTuple):
    """
    Root mean square of the errors of windows.

    Parameters
    ----------
    position : float
        Of the distance [m].
    heading : float
        Of the heading [rad].

    Examples
    --------
    >>> Residual(position=0.012, heading=0.003).position
    0.012

    """

    position: float
    heading: float


@dataclass(frozen=True)
class TrajectoryFit:
    """
    Systematic errors of one robot, and how well they are known.

    Parameters
    ----------
    left_wheel_radius_multiplier : Estimate
        Factor on that of the geometry that the fit started from [1].
    right_wheel_radius_multiplier : Estimate
        Factor on that of the geometry [1].
    wheel_separation_multiplier : Estimate
        Factor on that of the geometry [1].
    frame_x, frame_y, frame_yaw : Estimate
        Pose of the reference's frame on the robot [m], [m], [rad].
    offsets, drifts : tuple of Estimate
        Those of each drive: ``reference stamp = wheel stamp + offset + drift (stamp - middle
        of the drive)`` [s], [s/s]; all offsets are the same for a delay.
    names : tuple of str
        Names of the p parameters that were fitted.
    covariance : numpy.ndarray, shape (p, p)
        Their covariance.
    variances : Variances
        Slip constant [m] and variances of the reference [m^2], [rad^2] that the errors of the
        windows amount to, systematic errors that are left included.
    before, after : Residual
        Residual of the windows, outliers aside: with the wheels as given but frame and clocks
        fitted, and with all fitted.
    windows, in_gaps, outliers : int
        How many windows were fitted, had an end in a gap, or (of those fitted) count nothing.

    Examples
    --------
    See :func:`fit_trajectory`.

    """

    left_wheel_radius_multiplier: Estimate
    right_wheel_radius_multiplier: Estimate
    wheel_separation_multiplier: Estimate
    frame_x: Estimate
    frame_y: Estimate
    frame_yaw: Estimate
    offsets: Tuple[Estimate, ...]
    drifts: Tuple[Estimate, ...]
    names: Tuple[str, ...]
    covariance: Array
    variances: Variances
    before: Residual
    after: Residual
    windows: int
    in_gaps: int
    outliers: int

    @property
    def frame(self) -> Pose:
        """Pose of the reference's frame on the robot."""
        return Pose(self.frame_x.value, self.frame_y.value, self.frame_yaw.value)

    def corrected(self, geometry: WheelGeometry) -> WheelGeometry:
        """
        Return the geometry with the fitted factors on its multipliers.

        Parameters
        ----------
        geometry : WheelGeometry
            Geometry that the fit started from.

        Returns
        -------
        WheelGeometry
            The same nominal lengths with other multipliers.

        Raises
        ------
        ValueError
            If a corrected length is out of range.

        Examples
        --------
        See :func:`fit_trajectory`.

        """
        return replace(
            geometry,
            **{name: getattr(geometry, name) * getattr(self, name).value for name in WHEELS})

    def systematic(self, drive: int) -> CalibrationParameters:
        """
        Return what is systematic about a drive, relative to the geometry of the fit.

        Parameters
        ----------
        drive : int
            Index of the drive, from 0.

        Returns
        -------
        CalibrationParameters
            Factors, frame and clock, without errors.

        Examples
        --------
        See :func:`fit_trajectory`.

        """
        fields = (*WHEELS, *FRAME)
        values = dict(zip(
            CalibrationParameters._fields, (getattr(self, name).value for name in fields)))
        return CalibrationParameters(
            **values, offset=self.offsets[drive].value, drift=self.drifts[drive].value)


def fit_trajectory(
        geometry: WheelGeometry, drives: Sequence[RecordedDrive], *, wheels: bool = True,
        mean_radius: bool = True, clock: Clock = Clock.OFFSETS, frame: Optional[Pose] = None,
        windows: Windows = Windows()) -> TrajectoryFit:
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
        What is fitted of the time.
    frame : Pose, optional
        Pose of the reference's frame on the robot, where it is known; fitted where it is not.
    windows : Windows
        Which windows are fitted.

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
    A robot whose wheels are 0.51 m apart instead of 0.5 m, with a reference at its centre:

    >>> from diffdrive_kinematics.core.calibration import drive_from_rates
    >>> from diffdrive_kinematics.core.calibration import odometry_at
    >>> geometry, stamps = WheelGeometry(0.5, 0.125), np.arange(0.0, 60.0, 0.5)
    >>> rates = 8.0 + 4.0 * np.stack([np.sin(stamps), np.cos(0.7 * stamps)], axis=1)
    >>> bare = drive_from_rates(stamps, rates, stamps, np.zeros((120, 3)))
    >>> truth = odometry_at(WheelGeometry(0.51, 0.125), bare, CalibrationParameters())
    >>> fit = fit_trajectory(
    ...     geometry, [replace(bare, reference=truth)], frame=NO_FRAME, clock=Clock.NONE)
    >>> f'{fit.systematic(0).separation:.3f}, {fit.corrected(geometry).separation:.3f} m'
    '1.020, 0.510 m'

    """
    problem = _problem(geometry, drives, wheels, clock, frame, windows)
    try:
        with np.errstate(all='ignore'):  # what comes of it is judged
            return _fitted(problem, wheels=wheels, mean_radius=mean_radius)
    except np.linalg.LinAlgError as error:
        raise ValueError(
            f'wheels and reference do not agree well enough to be fitted ({error}): '
            f'{SAME_DRIVE}') from error


def _fitted(problem: Problem, *, wheels: bool, mean_radius: bool) -> TrajectoryFit:
    """Return the fit; ``LinAlgError`` where the numbers leave all bounds."""
    state = _solved(problem)
    covariance = sandwich(problem, state.parts, state.weights, state.variances)
    if wheels and not mean_radius:
        state, change = _with_mean_radius_kept(problem, state)
        covariance = change @ covariance @ change.T
    inner = _residual(state.parts, state.weights)
    before = inner
    if wheels:
        bare = replace(problem, columns=tuple(
            each for each in problem.columns if each.field >= len(WHEELS)))
        values = bare.initial()
        begin = _State(values, bare.parts(values), state.weights, state.variances)
        before = _residual(_steps(bare, begin).parts, state.weights)
    return _result(problem, state, covariance, before, inner)


class _State(NamedTuple):
    """Where the iteration stands."""

    values: Array
    parts: List[WindowResiduals]
    weights: Array
    variances: Variances


def _problem(
        geometry: WheelGeometry, drives: Sequence[RecordedDrive], wheels: bool, clock: Clock,
        frame: Optional[Pose], windows: Windows) -> Problem:
    if not drives:
        raise ValueError('drives is empty, expected at least one drive')
    columns = [Column(name, n, None) for n, name in enumerate(WHEELS) if wheels]
    if frame is None:
        columns += [Column(name, 3 + n, None) for n, name in enumerate(FRAME)]
    if clock is Clock.DELAY:
        columns.append(Column('delay', 6, None))
    elif clock is not Clock.NONE:
        for n in range(len(drives)):
            columns.append(Column(f'offset of drive {n + 1}', 6, n))
            if clock is Clock.DRIFTS:
                columns.append(Column(f'drift of drive {n + 1}', 7, n))
    if not columns:
        raise ValueError('wheels, frame and clock are all given, expected something to fit')
    held = [check_finite('frame', float(value)) for value in frame or NO_FRAME]
    for n, drive in enumerate(drives):
        wheel, seen = drive.time, drive.reference_time
        if seen[-1] <= wheel[0] or wheel[-1] <= seen[0]:
            raise ValueError(
                f'drive {n + 1} has wheels from {wheel[0]:.3f} to {wheel[-1]:.3f} s and a '
                f'reference from {seen[0]:.3f} to {seen[-1]:.3f} s, expected stamps of the same '
                'time')
    chosen = tuple(windows_between(drive, windows.lengths, windows.every, windows.tolerance)
                   for drive in drives)
    number = sum(len(each.start) for each in chosen)
    if 3 * number < 2 * len(columns) + 6:
        raise ValueError(
            f'there are {number} windows with motion and a reference at both ends for '
            f'{len(columns)} parameters ({sum(each.in_gaps for each in chosen)} in gaps), '
            f'expected at least {math.ceil(2 * len(columns) / 3) + 2}')
    start = CalibrationParameters(x=held[0], y=held[1], yaw=held[2])
    return Problem(geometry, tuple(drives), chosen, tuple(columns), start, windows.trust)


def _solved(problem: Problem) -> _State:
    """Alternate between parameters, variances and weights until nothing changes."""
    values, variances = problem.initial(), START_VARIANCES
    parts = problem.parts(values)
    course = problem.as_the_wheels_tell()
    refuse_unidentified(course, course.parts(values), variances)
    for number in range(ALTERNATING):
        distances = distances_of(parts, variances)
        weights = window_weights(distances, problem.trust)
        if number < COARSE:
            scale = max(float(np.median(distances)) / MEDIAN, 1e-6)
            weights = window_weights(distances / scale, problem.trust)
            variances = Variances(*(scale**2 * each for each in variances))
        else:
            spread = sandwich(problem, parts, weights, variances)
            variances = updated_variances(
                parts, distances, taken_by_fit(problem, parts, spread), variances, 6)
        step, covariance = newton_step(problem, parts, weights, variances)
        values = values + step
        parts = problem.parts(values)
        if number > COARSE + 3 and _small(step, covariance):
            break
    state = _steps(problem, _State(values, parts, weights, variances))
    refuse_unidentified(problem, state.parts, variances, weights)
    return state


def _small(step: Array, covariance: Array) -> bool:
    return bool((np.abs(step) <= SETTLED * np.sqrt(np.diag(covariance))).all())


def _steps(problem: Problem, state: _State) -> _State:
    """
    Fit with the weights and variances given, by steps that lower the cost.

    Held wheel rates make the cost bend at each stamp, where full steps may go to and fro.
    """
    values, parts, weights, variances = state
    cost = _cost(parts, weights, variances)
    for _ in range(ROUNDS if problem.columns else 0):
        step, covariance = newton_step(problem, parts, weights, variances)
        if _small(step, covariance):
            return _State(values, parts, weights, variances)
        for part in (1.0, 0.5, 0.25, 0.1, 0.02):
            trial = problem.parts(values + part * step)
            reached = _cost(trial, weights, variances)
            if reached < cost:
                break
        if reached > cost - NEGLIGIBLE:
            return _State(values, parts, weights, variances)
        values, parts, cost = values + part * step, trial, reached
    if not problem.columns:
        return state
    raise ValueError(
        f'the fit did not settle in {ROUNDS} steps, expected a geometry and clocks that are '
        f'nearer to the truth')


def _cost(parts: Sequence[WindowResiduals], weights: Array, variances: Variances) -> float:
    """Return the weighted sum of squared distances."""
    return float(weights @ distances_of(parts, variances)**2)


def _residual(parts: Sequence[WindowResiduals], weights: Array) -> Residual:
    squares = weights[:, None] * np.concatenate([part.error for part in parts])**2
    mean = squares.sum(axis=0) / weights.sum()
    return Residual(math.sqrt(mean[0] + mean[1]), math.sqrt(mean[2]))


def _with_mean_radius_kept(problem: Problem, state: _State) -> Tuple[_State, Array]:
    """Return the state with the wheels divided by their mean radius, and its derivative."""
    wheels = state.values[:3]
    mean = 0.5 * (wheels[0] + wheels[1])
    change = np.eye(len(state.values))
    change[:3, :3] = np.eye(3) / mean - np.outer(wheels, [0.5, 0.5, 0.0]) / mean**2
    values = np.concatenate([wheels / mean, state.values[3:]])
    return state._replace(values=values, parts=problem.parts(values)), change


def _result(
        problem: Problem, state: _State, covariance: Array, before: Residual, after: Residual
) -> TrajectoryFit:
    errors = np.sqrt(np.diag(covariance))
    systematics = problem.systematics(state.values)

    def estimate(field: int, drive: int = 0) -> Estimate:
        columns, fields = problem.mine(drive)
        error = float(errors[columns[fields.index(field)]]) if field in fields else 0.0
        return Estimate(float(systematics[drive][field]), error)

    numbers = range(len(problem.drives))
    left, right, separation, x, y, yaw = (estimate(field) for field in range(6))
    return TrajectoryFit(
        left, right, separation, x, y, yaw,
        tuple(estimate(6, number) for number in numbers),
        tuple(estimate(7, number) for number in numbers),
        tuple(each.name for each in problem.columns), covariance, state.variances, before, after,
        len(state.weights), sum(each.in_gaps for each in problem.windows),
        int(np.count_nonzero(state.weights == 0.0)))
