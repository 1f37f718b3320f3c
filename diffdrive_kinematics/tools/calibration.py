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

"""What ``calibrate`` finds, from runs around a square or from recorded drives, as a table."""

from dataclasses import dataclass, field
from itertools import count
import math
from typing import Any, List, Mapping, NamedTuple, Optional, Sequence, Tuple

from diffdrive_kinematics.core.calibration import (
    Clock, COMMANDED, fit_drive_slip, fit_sessions, fit_squares, fit_trajectory, RecordedDrive,
    ReturnError, slip_from_squares, SlipFit, TrajectoryFit, Windows, without_frozen_poses)
from diffdrive_kinematics.core.kinematics import WheelGeometry
from diffdrive_kinematics.core.noise import BodySlip, NO_BODY_SLIP
from diffdrive_kinematics.tools.calibration_remarks import (
    clock_remark, course_remarks, frame_remark, frozen_remark, KNOWN_BY_DRIVES, KNOWN_BY_RATIO,
    session_parameters, session_remark, session_rows, slip_remark, square_remarks,
    THIS_SESSION_ONLY)
from diffdrive_kinematics.tools.recordings import nobody, Progress

MULTIPLIERS = (
    'left_wheel_radius_multiplier', 'right_wheel_radius_multiplier', 'wheel_separation_multiplier')


class Row(NamedTuple):
    """A line of the table: a value and its standard error (None: unknown)."""

    name: str
    value: float
    error: Optional[float]


class Gain(NamedTuple):
    """An error before the correction and after it."""

    name: str
    before: float
    after: float


@dataclass(frozen=True)
class Calibration:
    """
    What was found.

    ``geometry`` has the corrected multipliers; ``slips`` are k (left, right) [m], ``body`` is
    the slip of the body. ``source`` is
    the result it comes from, and what that was given, for the picture. ``columns`` says what
    the two numbers of each gain are. ``sessions`` are the parameters of what differs between
    runs, where it is known, and ``response`` those of how the robot follows its commands.
    """

    method: str
    geometry: WheelGeometry
    slips: Tuple[float, float]
    rows: Tuple[Row, ...]
    gains: Tuple[Gain, ...]
    remarks: Tuple[str, ...]
    source: Any
    columns: Tuple[str, str] = ('before', 'after')
    body: BodySlip = NO_BODY_SLIP
    sessions: Mapping[str, float] = field(default_factory=dict)
    response: Mapping[str, Any] = field(default_factory=dict)


def of_squares(
        values: Mapping[str, Any], geometry: WheelGeometry, clockwise: Sequence[ReturnError],
        counterclockwise: Sequence[ReturnError]) -> Calibration:
    """Return the calibration by UMBmark; ``ValueError`` where the runs do not allow one."""
    square = values['square_side'], clockwise, counterclockwise
    radius = values['square_corner_radius']
    fit = fit_squares(geometry, *square, corner_radius=radius)
    result, after = fit.umbmark, fit.geometry
    slip = slip_from_squares(after, *square, corner_radius=radius)
    ratio, separation = result.diameter_ratio, result.separation_ratio
    left, right = after.left_wheel_radius_multiplier, after.right_wheel_radius_multiplier
    wheel_error = left * right / (left + right) * ratio.error / ratio.value  # about their mean
    rows = (
        Row('E_d (right over left wheel)', *ratio),
        Row('E_b (true over nominal separation)', *separation),
        Row('alpha [rad]', *result.alpha), Row('beta [rad]', *result.beta),
        *_multipliers(after, [wheel_error, wheel_error, separation.error
                              * geometry.wheel_separation_multiplier]),
        Row('slip variance k [m]', *slip))
    remark = (f'{len(clockwise)} runs clockwise, {len(counterclockwise)} counterclockwise, side '
              f"{values['square_side']:g} m")
    return Calibration(
        'UMBmark', after, (slip.value, slip.value), rows,
        (Gain('return error E_max,syst [mm]', 1e3 * result.error_before,
              1e3 * fit.predicted_error),),
        (remark, *square_remarks(fit, slip.value), THIS_SESSION_ONLY),
        (result, clockwise, counterclockwise),
        ('measured', 'predicted'))


def of_drives(
        values: Mapping[str, Any], geometry: WheelGeometry, drives: Sequence[RecordedDrive], *,
        clock: str, commands: bool = False, progress: Progress = nobody) -> Calibration:
    """Return the calibration by trajectory fit; ``ValueError`` where the drives allow none."""
    whole = drives
    drives = [without_frozen_poses(drive, wheel_radius=geometry.wheel_radius) for drive in whole]
    rounds = count(1)
    keep = values['mean_radius'] == 'keep' or commands and not values['mean_radius']
    windows = COMMANDED if commands else Windows()
    fit = fit_trajectory(
        geometry, drives, clock=Clock[clock.upper()], mean_radius=not keep, windows=windows,
        watch=lambda _: progress(f'fitting, iteration {next(rounds)}'))
    progress('fitting each drive')
    sessions = fit_sessions(
        geometry, [[drive] for drive in drives], fit, clock=Clock[clock.upper()],
        mean_radius=not keep, windows=windows)
    progress('fitting the slip')
    after = fit.corrected(geometry)
    slip = fit_drive_slip(geometry, drives, fit, equal=values['equal_slip'])
    errors = [getattr(geometry, name) * getattr(fit, name).error for name in MULTIPLIERS]
    rows = [
        *_multipliers(after, errors), Row('reference x on the robot [m]', *fit.frame_x),
        Row('reference y on the robot [m]', *fit.frame_y),
        Row('reference yaw on the robot [rad]', *fit.frame_yaw)]
    if clock == 'delay':
        rows.append(Row('delay [s]', *fit.offsets[0]))
    elif clock != 'none':
        rows += _clock_rows(fit)
    rows += [*slip_rows(slip), *(Row(*row) for row in session_rows(sessions))]
    gains = (
        Gain('position error of windows, RMS [mm]', 1e3 * fit.before.position,
             1e3 * fit.after.position),
        Gain('heading error of windows, RMS [mrad]', 1e3 * fit.before.heading,
             1e3 * fit.after.heading))
    return Calibration(
        'trajectory fit', after, (slip.k_left.value, slip.k_right.value), tuple(rows), gains,
        (*_remarks(fit, drives), KNOWN_BY_RATIO if keep else KNOWN_BY_DRIVES,
         *frozen_remark(whole, drives), *clock_remark(fit), *frame_remark(fit),
         *course_remarks(geometry, drives), slip_remark(slip), session_remark(sessions)),
        (fit, geometry, drives), body=slip.body, sessions=session_parameters(sessions))


def slip_rows(slip: SlipFit) -> List[Row]:
    """Return the slip of the wheels and that of the body, where that is, and the stamps' noise."""
    rows = [Row('slip variance k left [m]', *slip.k_left),
            Row('slip variance k right [m]', *slip.k_right)]
    rows += [Row(f'{name} slip variance {symbol}', *getattr(slip, name))
             for name, symbol in (('linear', 'k_d [m]'), ('turn', 'k_t [rad]'),
                                  ('heading', 'k_x [rad^2/m]')) if name in slip.terms]
    return [*rows, Row('noise of the reference: position [m]', *slip.sigma_position),
            Row('noise of the reference: heading [rad]', *slip.sigma_heading),
            Row('noise of the reference: stamps [s]', *slip.sigma_time)]


def _clock_rows(fit: TrajectoryFit) -> List[Row]:
    """Return offset and drift of each drive; a drift that was not fitted is 0."""
    rows = []
    for number, (offset, drift) in enumerate(zip(fit.offsets, fit.drifts), start=1):
        rows += [Row(f'clock offset of drive {number} [s]', *offset),
                 Row(f'clock drift of drive {number} [s/min]', 60.0 * drift.value,
                     60.0 * drift.error if f'drift of drive {number}' in fit.names else None)]
    return rows


def _remarks(fit: TrajectoryFit, drives: Sequence[RecordedDrive]) -> List[str]:
    seconds = sum(float(drive.time[-1] - drive.time[0]) for drive in drives)
    remarks = [
        f'{len(drives)} drives, {seconds:.1f} s, {fit.windows} windows, {fit.in_gaps} left out '
        f'for gaps of the reference, {fit.outliers} outliers']
    duplicates = sum(drive.duplicates for drive in drives)
    if duplicates:
        remarks.append(f'{duplicates} rows were replaced by a later row with the same stamp')
    return remarks


def _multipliers(after: WheelGeometry, errors: Sequence[Optional[float]]) -> List[Row]:
    return [Row(name, getattr(after, name), error) for name, error in zip(MULTIPLIERS, errors)]


def table(calibration: Calibration) -> str:
    """Return the table for people: values with standard errors, and errors before and after."""
    width = max(len(line.name) for line in (*calibration.rows, *calibration.gains)) + 2
    lines = [f'{calibration.method}: {calibration.remarks[0]}', *calibration.remarks[1:],
             f"{'':{width}}{'value':>14}{'std. error':>14}"]
    lines += [
        f'{row.name:{width}}{_shown(row.value, row.error):>14}'
        f"{'-' if row.error is None else f'{row.error:.2g}':>14}" for row in calibration.rows]
    before, after = calibration.columns
    lines.append(f"{'':{width}}{before:>14}{after:>14}")
    lines += [f'{gain.name:{width}}{gain.before:>14.3f}{gain.after:>14.3f}'
              for gain in calibration.gains]
    return '\n'.join(lines)


def _shown(value: float, error: Optional[float]) -> str:
    """Return the value with two digits of its error; without one, with six decimals."""
    if 0.0 < abs(value) < 1e-3:
        return f'{value:.3g}'
    if not error or not math.isfinite(error):
        return f'{value:.6f}'
    digits = 1 - math.floor(math.log10(error))
    return f'{value:.{digits}f}' if 0 <= digits <= 7 else f'{value:.3g}'
