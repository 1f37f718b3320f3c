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

"""Runs around a square, noted as a user of UMBmark notes them, and calibrated."""

from pathlib import Path
from typing import Any, Callable, List, Mapping, NamedTuple, Optional, Sequence, Tuple

from diffdrive_kinematics.core.calibration import FEWEST_RUNS
from diffdrive_kinematics.core.commands import SquareRun
from diffdrive_kinematics.core.kinematics import compose, inverse, Pose, WheelGeometry
from diffdrive_kinematics.tools.calibration import Calibration, of_squares, table
from diffdrive_kinematics.tools.calibration_file import rendered
from diffdrive_kinematics.tools.output_files import check_writable, write_files
from diffdrive_kinematics.tools.robots import Moment
from diffdrive_kinematics.tools.square_rows import (
    read_square_runs, SETTING_COLUMNS, settings_of, SQUARE_COLUMNS)

HEADER = ','.join([*SQUARE_COLUMNS, *SETTING_COLUMNS])


class Squares(NamedTuple):
    """The runs of a course, what tells the time [s] since it began, and its parameters."""

    runs: Tuple[SquareRun, ...]
    elapsed_s: Callable[[], float]
    values: Mapping[str, Any]


class SquareNotes:
    """
    The file of the runs, to which each is added as soon as it is done.

    Parameters
    ----------
    path : str
        Of the file, a new one or one of runs.
    squares : sequence of Squares
        Courses of the composition, which must be one, around a square.
    start : sequence of Moment
        The robots at the start, which must be one with a truth.
    calibrates : bool
        Whether the runs of the file are to be calibrated by, once these are in it.

    Raises
    ------
    ValueError
        If it cannot be noted, or not in this file, or the runs will not be enough.

    """

    def __init__(
            self, path: str, squares: Sequence[Squares], start: Sequence[Moment], *,
            calibrates: bool = False) -> None:
        if len(squares) != 1 or not squares[0].runs:
            raise ValueError(
                f'square_runs is {path!r}, expected one command_sequence with a square_side, '
                'without loop')
        if len(start) != 1 or start[0].truth is None:
            raise ValueError(
                f'square_runs is {path!r}, expected one robot with a belief and a ground truth')
        check_writable(path, name='square_runs', overwrite=True, regular=True)
        self._path, (self._squares,), self._done = path, squares, 0
        self._settings = settings_of(self._squares.values, start[0].geometry)
        self._check_runs(calibrates)
        self._began: Optional[Tuple[Pose, Pose]] = None

    def _check_runs(self, calibrates: bool) -> None:
        """Raise ``ValueError`` for runs that are there and of no use, or too few with the new."""
        there: Sequence[Sequence[Any]] = ((), ())
        if _content(self._path).count('\n') > 1:
            there = read_square_runs(self._path, self._settings['square_side'], self._settings)
        ways = [run.clockwise for run in self._squares.runs]
        numbers = [len(runs) + ways.count(way) for runs, way in zip(there, (True, False))]
        if calibrates and min(numbers) < FEWEST_RUNS:
            raise ValueError(
                f'square_runs is {self._path!r}, which will have {numbers[0]} clockwise and '
                f'{numbers[1]} counterclockwise runs, expected at least {FEWEST_RUNS} each way '
                'for a calibration: set square_rounds')

    def due(self) -> bool:
        """Return whether a run begins or has ended; the last one ends with the course."""
        runs = self._squares.runs
        last = self._done == len(runs) - 1
        return (self._began is None
                or not last and self._squares.elapsed_s() >= runs[self._done].end)

    def note(self, moments: Sequence[Moment]) -> str:
        """Note where a run begins, or add the one that ends there; return a line on the latter."""
        (moment,) = moments
        poses = moment.truth or moment.belief.pose, moment.belief.pose
        began, self._began = self._began, poses
        if began is None:
            return ''
        ends = [round(value, 9) + 0.0 for start, pose in zip(began, poses)
                for value in compose(inverse(start), pose)[:2]]
        clockwise = self._squares.runs[self._done].clockwise
        row = ','.join([str(int(clockwise)), *(f'{value:.9f}' for value in ends),
                        *map(repr, self._settings.values())])
        write_files({self._path: f'{_content(self._path)}{row}\n'.encode()}, overwrite=True)
        self._done += 1
        x, y, odom_x, odom_y = (round(value, 4) + 0.0 for value in ends)
        return (f"run {self._done} of {len(self._squares.runs)}, {'' if clockwise else 'counter'}"
                f'clockwise: ended at ({x:.4f}, {y:.4f}), by odometry at ({odom_x:.4f}, '
                f'{odom_y:.4f}) [m], added to {self._path}')

    def left(self, calibration: str) -> List[str]:
        """Return a line on runs that were to be calibrated by, if the course is interrupted."""
        if not calibration:
            return []
        return [
            f'interrupted after {self._done} of {len(self._squares.runs)} runs: no calibration; '
            f'run it again to add runs to {self._path}, or, with two or more each way there: ros2 '
            'run diffdrive_kinematics calibrate --ros-args --params-file ROBOT.yaml -p '
            f'square_runs:={self._path} -p square_side:=SIDE -p output:={calibration}']


def _content(path: str) -> str:
    """Return what a file of runs has, up to the last end of a line; ``ValueError`` if not one."""
    try:
        text = Path(path).read_text(encoding='utf-8-sig')
    except FileNotFoundError:
        text = ''
    except (OSError, UnicodeDecodeError) as error:
        raise ValueError(f'square_runs is {path!r}, which cannot be read: {error}') from error
    lines = text.splitlines() or [HEADER]
    if [name.strip() for name in lines[0].split(',')] != HEADER.split(','):
        raise ValueError(
            f'square_runs is {path!r}, which begins with {lines[0]!r}, expected a new file, or '
            f'one with {HEADER}')
    return '\n'.join(lines) + '\n'


def calibration_of_runs(values: Mapping[str, Any], geometry: WheelGeometry) -> Calibration:
    """
    Return the calibration by all rows of ``square_runs``.

    Parameters
    ----------
    values : mapping
        Parameters, those of the square among them.
    geometry : WheelGeometry
        That the odometry of the runs used.

    Returns
    -------
    Calibration
        What was found.

    Raises
    ------
    ValueError
        If the runs cannot be read, are of another square or geometry, or allow no calibration;
        the message names the file.

    """
    path = values['square_runs']
    runs = read_square_runs(path, values['square_side'], settings_of(values, geometry))
    try:
        return of_squares(values, geometry, *runs)
    except ValueError as error:
        raise ValueError(f'{path}: {error}') from error


def square_calibration(values: Mapping[str, Any], geometry: WheelGeometry) -> List[str]:
    """
    Calibrate by all rows of ``square_runs``, write it to ``calibration``, and return the report.

    Parameters
    ----------
    values : mapping
        Parameters of the simulation and its square.
    geometry : WheelGeometry
        That the odometry used.

    Returns
    -------
    list of str
        The table, and which file was written.

    Raises
    ------
    ValueError
        If the runs do not allow a calibration, or it cannot be written.

    """
    calibration = calibration_of_runs(values, geometry)
    files = rendered(calibration, {'output': values['calibration'], 'picture': ''})
    written = write_files(files, overwrite=values['overwrite'])
    return [table(calibration), f"wrote {', '.join(written)}"]
