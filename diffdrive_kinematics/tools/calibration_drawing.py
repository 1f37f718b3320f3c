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

"""The picture of a calibration: return errors, ways and their errors, or a response."""

from typing import Any, List, Sequence, Tuple

from diffdrive_kinematics.core.calibration import (
    CalibrationParameters, commands_of, linearised, odometry_at, RecordedDrive, ResponseFit,
    ReturnError, TrajectoryFit, Umbmark, windows_between)
from diffdrive_kinematics.core.kinematics import Pose, WheelGeometry
from diffdrive_kinematics.tools.calibration import Calibration
from diffdrive_kinematics.tools.drawing import file_of, in_plan, new_figure
import numpy as np

BEFORE, AFTER = '#cc3311', '#4477aa'  # also: measured, and the map of a response
WINDOW_S, EVERY_S, TOLERANCE_S = 10.0, 1.0, 0.1
SECONDS, LEAST_SPEED = 1.0, 0.2  # of a point, and of the largest speed, from which one is drawn


def picture_of(calibration: Calibration, suffix: str) -> bytes:
    """
    Return the picture as the bytes of a ``png`` or ``svg`` file.

    Raises
    ------
    ImportError
        If matplotlib is missing.

    """
    if isinstance(calibration.source[0], Umbmark):
        figure = new_figure(figsize=(9.0, 6.0))
        _draw_returns(figure, *calibration.source)
    elif isinstance(calibration.source[0], ResponseFit):
        figure = new_figure(figsize=(9.0, 5.0))
        _draw_response(figure, *calibration.source)
    else:
        figure = new_figure(figsize=(13.0, 6.0))
        plan, errors = figure.subfigures(1, 2)
        _draw_plan(plan, *calibration.source)
        _draw_windows(errors, *calibration.source)
    return file_of(figure, suffix)


def _draw_returns(
        figure: Any, result: Umbmark, clockwise: Sequence[ReturnError],
        counterclockwise: Sequence[ReturnError]) -> None:
    """Draw the return errors of both directions, and where the correction puts them."""
    axes = figure.add_subplot()
    for errors, centre, left, marker, way in (
            (clockwise, result.clockwise, result.clockwise_after, 'o', 'clockwise'),
            (counterclockwise, result.counterclockwise, result.counterclockwise_after, 's',
             'counterclockwise')):
        points = 1e3 * np.array(errors)
        moved = points + 1e3 * (np.array(left) - np.array(centre))
        for where, at, colour, when in (
                (points, centre, BEFORE, 'measured'), (moved, left, AFTER, 'corrected')):
            axes.plot(*where.T, marker, color=colour, mfc='none', label=f'{way}, {when}')
            axes.plot(*(1e3 * np.array(at)), 'x', color=colour, ms=10, mew=2)
    axes.axhline(0.0, color='black', lw=0.6)
    axes.axvline(0.0, color='black', lw=0.6)
    axes.set_aspect('equal', adjustable='datalim')
    axes.set_xlabel('x [mm]')
    axes.set_ylabel('y [mm]')
    axes.set_title(
        f'Return errors of a square of {result.side:g} m; crosses: centres of gravity',
        fontsize='medium')
    axes.grid(alpha=0.25)
    axes.legend(fontsize='small')


def way_by_odometry(
        geometry: WheelGeometry, drive: RecordedDrive, systematic: CalibrationParameters,
        frame: Pose) -> 'np.ndarray':
    """
    Return where odometry has the frame of the reference, from where the reference begins.

    Parameters
    ----------
    geometry : WheelGeometry
        Of the wheels as given.
    drive : RecordedDrive
        With m samples of the reference.
    systematic : CalibrationParameters
        Factors on the geometry, and the clocks.
    frame : Pose
        That of the reference on the robot.

    Returns
    -------
    numpy.ndarray, shape (m, 2)
        Positions (x, y) in the fixed frame of the reference [m].

    """
    x, y, heading = odometry_at(geometry, drive, systematic).T
    way = x + 1j * y + complex(frame.x, frame.y) * np.exp(1j * heading)
    start_x, start_y, start_heading = drive.reference[0]
    turned = np.exp(1j * (start_heading - heading[0] - frame.theta)) * (way - way[0])
    return np.stack([start_x + turned.real, start_y + turned.imag], axis=1)


def _draw_plan(
        figure: Any, fit: TrajectoryFit, geometry: WheelGeometry,
        drives: Sequence[RecordedDrive]) -> None:
    """Draw the drive that odometry missed most before: the reference, before and after."""
    axes = figure.add_subplot()
    ways = [[(colour, when, way_by_odometry(geometry, drive, systematic, fit.frame))
             for colour, when, systematic in _before_and_after(fit, number)]
            for number, drive in enumerate(drives)]
    ends = [way[0][2][-1] - drive.reference[-1, :2] for way, drive in zip(ways, drives)]
    worst = int(np.argmax(np.hypot(*np.array(ends).T)))
    reference = drives[worst].reference
    axes.plot(*reference[:, :2].T, color='black', lw=1.6, label='reference')
    for colour, when, way in ways[worst]:
        axes.plot(*way.T, color=colour, lw=1.2, label=f'odometry, {when}')
        axes.plot(*way[-1], 'o', color=colour, ms=5)
    axes.plot(*reference[0, :2], 's', color='black', ms=6, mfc='none', label='start')
    axes.plot(*reference[-1, :2], 'o', color='black', ms=5)
    in_plan(axes)
    axes.set_title('The way that was driven' if len(drives) == 1 else
                   f'Drive {worst + 1} of {len(drives)}, whose end odometry missed most',
                   fontsize='medium')
    figure.legend(loc='outside lower center', ncols=2, fontsize='small', frameon=False)


def _draw_windows(
        figure: Any, fit: TrajectoryFit, geometry: WheelGeometry,
        drives: Sequence[RecordedDrive]) -> None:
    """Draw the errors of windows over time, drives one after the other."""
    position, heading = figure.subplots(2, 1, sharex=True)
    start, ends = 0.0, []
    for number, drive in enumerate(drives):
        length = min(WINDOW_S, 0.5 * float(drive.time[-1] - drive.time[0]))
        windows = windows_between(drive, (length,), EVERY_S, TOLERANCE_S)
        times = start + (drive.reference_time[windows.end] - drive.reference_time[0])
        for colour, when, systematic in _before_and_after(fit, number):
            values = linearised(geometry, drive, windows, systematic).error
            label = None if number else when
            position.plot(
                times, 1e3 * np.hypot(*values[:, :2].T), '.', ms=4, color=colour, label=label)
            heading.plot(times, 1e3 * values[:, 2], '.', ms=4, color=colour, label=label)
        start += float(drive.time[-1] - drive.time[0])
        ends.append(start)
    for axes, label in ((position, 'distance [mm]'), (heading, 'heading [mrad]')):
        axes.set_ylabel(label)
        axes.grid(alpha=0.25)
        for end in ends[:-1]:
            axes.axvline(end, color='black', lw=0.6, ls=':')
    heading.axhline(0.0, color='black', lw=0.6)
    heading.set_xlabel('time [s], drives one after the other')
    position.legend(fontsize='small')
    position.set_title(f'Errors of odometry over windows of {WINDOW_S:g} s', fontsize='medium')


def _before_and_after(
        fit: TrajectoryFit, number: int) -> List[Tuple[str, str, CalibrationParameters]]:
    """Return colour, label and errors of a drive before and after."""
    after = fit.systematic(number)
    return [(BEFORE, 'wheels as given', after._replace(left=1.0, right=1.0, separation=1.0)),
            (AFTER, 'corrected', after)]


def _draw_response(
        figure: Any, fit: ResponseFit, geometry: WheelGeometry,
        drives: Sequence[RecordedDrive]) -> None:
    """Draw speeds over curvature, and yaw rates over those asked for: measured, and the map."""
    response = fit.response
    asked, moved = (np.concatenate(parts) for parts in zip(*(
        _steady(geometry, drive, response.delay) for drive in drives)))
    fast = np.abs(asked[:, 0]) > LEAST_SPEED * response.max_speed
    v, w = asked[fast].T
    speed, turn = figure.subplots(1, 2)
    speed.plot(w / v, moved[fast, 0] / v, '.', ms=3, color=BEFORE, label='measured, 1 s')
    edge = float(np.percentile(np.abs(w / v), 99.0)) if len(v) else 1.0
    k = np.linspace(-edge, edge, 401)
    speed.plot(k, response.speed_gain * response.share(k), color=AFTER, label=f'map: {fit.form}')
    speed.set_xlim(-1.1 * edge, 1.1 * edge)
    speed.set_ylim(0.0, 1.5)
    speed.set_xlabel('curvature asked for [1/m]')
    speed.set_ylabel('speed driven over speed asked for')
    turn.plot(asked[:, 1], moved[:, 1], '.', ms=3, color=BEFORE)
    rate = np.array([-response.max_yaw_rate, response.max_yaw_rate])
    turn.plot(rate, response.yaw_rate_gain * rate, color=AFTER)
    turn.set_xlabel('yaw rate asked for [rad/s]')
    turn.set_ylabel('yaw rate turned with [rad/s]')
    for axes in (speed, turn):
        axes.grid(alpha=0.25)
    speed.legend(fontsize='small')


def _steady(geometry: WheelGeometry, drive: RecordedDrive, delay: float) -> Any:
    """Return twists asked for, and driven, of windows in which the command hardly changed."""
    commands = commands_of(geometry, drive)
    start, end, _ = windows_between(drive, (SECONDS,), SECONDS, 0.1)
    times = drive.reference_time - delay
    first, last = (np.clip(np.searchsorted(drive.time, times[rows], side='right') - 1, 0,
                           len(commands) - 1) for rows in (start, end))
    same = np.abs(commands[last] - commands[first]).max(axis=1) < 0.02
    start, end, first = start[same], end[same], first[same]
    seconds = drive.reference_time[end] - drive.reference_time[start]
    apart = drive.reference[end] - drive.reference[start]
    way = drive.reference[start, 2] + 0.5 * apart[:, 2]
    chord = np.cos(way) * apart[:, 0] + np.sin(way) * apart[:, 1]
    moved = np.stack([chord / np.sinc(apart[:, 2] / (2.0 * np.pi)), apart[:, 2]], axis=1)
    return commands[first], moved / seconds[:, None]
