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
Recordings that are not in the units they should be: seconds, metres, radians.

What a recording is in is told by its values, by the steps of its stamps, and by what the wheels
say about the same second.
"""

import math
from typing import Mapping, NamedTuple, Optional, Sequence, Tuple

from diffdrive_kinematics.core.calibration import RecordedDrive
from diffdrive_kinematics.core.kinematics import Array, WheelGeometry
import numpy as np
from numpy.typing import NDArray

STAMPS = (('nanoseconds', 1e9), ('microseconds', 1e6), ('milliseconds', 1e3))
NO_STAMP_S = 1e11
"""No time [s] since an epoch of anybody, and in milliseconds since 1970 one of 1973."""
JUMP_S = 1e8
"""Step [s] of the stamps that no drive has: three years."""
SLOWEST_S = 2.0
"""Median step [s] from which stamps of measurements are of another unit."""
SLOWEST_COMMANDS_S, MANY_COMMANDS = 5.0, 20
FASTEST, FASTEST_TURN = 20.0, 40.0
"""Commands [m/s], [rad/s] that no robot with two wheels is given."""
SPAN_S, FEW = 1.0, 5
LIKE = 1.7
"""Factor within which a ratio is taken for one of units."""
DEGREES = 180.0 / math.pi
LENGTHS = ((1e3, 'millimetres', 1000), (1e2, 'centimetres', 100))


def check_stamps(path: str, time: Array, *, commands: bool = False) -> None:
    """
    Raise ``ValueError`` where stamps are no seconds, or not all of one clock.

    Parameters
    ----------
    path : str
        Of the file, for the message.
    time : numpy.ndarray, shape (n,)
        Its column ``time_sec``.
    commands : bool
        Whether they are those of commands, of which each may hold for seconds.

    """
    if len(time) < 2:
        return
    steps = np.diff(time)
    rising = steps[steps > 0.0]
    median = float(np.median(rising)) if len(rising) else 0.0
    row, unit = _stamp_unit(time, median, commands)
    if unit:
        name, scale = unit
        raise ValueError(
            f'{path}, row {row}: time_sec is {time[row - 1]:.15g}, with steps of {median:.6g}: '
            f'that looks like {name}, expected seconds (divide time_sec by {scale:.0e})')
    at = int(np.argmax(steps))
    if steps[at] > JUMP_S:
        row = 1 if at == 0 else at + 2
        raise ValueError(
            f'{path}, row {row}: time_sec is {time[row - 1]:.15g} and jumps by {steps[at]:.6g} s '
            f'{"after it" if row == 1 else "to it"}, expected stamps of one clock (delete the '
            'rows of the other one)')


def _stamp_unit(
        time: Array, median: float, commands: bool
) -> Tuple[int, Optional[Tuple[str, float]]]:
    """Return a row, counted from 1, that shows the unit, and the unit if it is no second."""
    size = np.abs(time)
    if float(size.max()) > NO_STAMP_S:
        row = int(np.argmax(size > NO_STAMP_S)) + 1
        return row, next((unit for unit in STAMPS if size[row - 1] > 1e-3 * NO_STAMP_S * unit[1]),
                         STAMPS[-1])
    if commands:
        slow = median >= SLOWEST_COMMANDS_S and len(time) >= MANY_COMMANDS
    else:
        slow = median >= SLOWEST_S
    return 2, next((unit for unit in STAMPS if median > 0.7e-3 * unit[1] or unit is STAMPS[-1]),
                   None) if slow else None


def check_commands(path: str, rows: Array) -> None:
    """
    Raise ``ValueError`` where commands are in other units than m/s and rad/s.

    Parameters
    ----------
    path : str
        Of the file, for the message.
    rows : numpy.ndarray, shape (n, 3)
        Its columns ``time_sec``, ``linear_x``, ``angular_z``.

    """
    for column, (name, most, unit, other) in enumerate((
            ('linear_x', FASTEST, 'm/s', 'mm/s'),
            ('angular_z', FASTEST_TURN, 'rad/s', 'deg/s')), start=1):
        fast = np.abs(rows[:, column]) > most
        if fast.any():
            row = int(np.argmax(fast))
            raise ValueError(
                f'{path}, row {row + 1}: {name} is {rows[row, column]:.6g}, expected at most '
                f'{most:g} {unit} either way (is it in {other}?)')


class _Span(NamedTuple):
    """A ratio of the way, or turn, of the reference to that of the wheels, and where."""

    ratio: float
    row: int
    seen: float
    rolled: float


def check_units(
        paths: Tuple[str, str], kind: str, drive: RecordedDrive, reference: Array,
        geometry: WheelGeometry) -> None:
    """
    Raise ``ValueError`` where wheels and reference differ by a factor between units.

    Parameters
    ----------
    paths : tuple of str
        Of the files of the motion and of the reference, for the message.
    kind : str
        Of motion: ``commands``, ``wheel_rates``, ``wheel_positions`` or ``ticks``.
    drive : RecordedDrive
        Made of them.
    reference : numpy.ndarray, shape (m, 4)
        Time [s] and pose of the reference as they were recorded.
    geometry : WheelGeometry
        Nominal wheels.

    """
    way, turn = _spans(drive, reference, geometry)
    for factor, name, divisor in LENGTHS:
        if way and _like(way.ratio, factor):
            raise ValueError(
                f'{paths[1]}, row {way.row}: x and y change by {way.seen:.4g} while the wheels '
                f'roll {way.rolled:.4g} m: that looks like {name}, expected metres (divide x and '
                f'y by {divisor})')
    if turn and _like(turn.ratio, DEGREES):
        raise ValueError(
            f'{paths[1]}, row {turn.row}: yaw changes by {turn.seen:.4g} while the wheels turn '
            f'the robot by {turn.rolled:.4g} rad: that looks like degrees, expected radians '
            '(multiply yaw by pi / 180)')
    for name, span, factor, words in _of_motion(kind, way, turn):
        if span and _like(span.ratio, factor):
            raise ValueError(
                f'{paths[0]}: {name} say {span.rolled:.4g} for the {span.seen:.4g} of the '
                f'reference up to its row {span.row}: {words}')


def _of_motion(
        kind: str, way: Optional[_Span], turn: Optional[_Span]
) -> Sequence[Tuple[str, Optional[_Span], float, str]]:
    degrees = 'that looks like degrees, expected radians (multiply by pi / 180)'
    metres = 'that looks like millimetres, expected metres (divide by 1000)'
    of_wheels = ('wheels of wheel_radius', way, 1e-3, metres)
    found: Mapping[str, Sequence[Tuple[str, Optional[_Span], float, str]]] = {
        'commands': (('values of linear_x', way, 1e-3, metres),
                     ('values of angular_z', turn, 1.0 / DEGREES, degrees)),
        'wheel_positions': (
            ('left_position and right_position', way, 1.0 / DEGREES, degrees), of_wheels),
        'wheel_rates': (
            ('left_rate and right_rate', way, 1.0 / DEGREES, degrees), of_wheels,
            ('left_rate and right_rate', way, math.pi / 30.0,
             'that looks like rpm, expected rad/s (multiply by pi / 30)')),
        'ticks': (of_wheels,)}
    return found[kind]


def _like(ratio: float, factor: float) -> bool:
    return factor / LIKE < ratio < factor * LIKE


def _spans(
        drive: RecordedDrive, reference: Array, geometry: WheelGeometry
) -> Tuple[Optional[_Span], Optional[_Span]]:
    """Return the median ratio of ways, and that of turns, of spans of a second."""
    seen = reference[:, 0]
    first = np.flatnonzero(
        (seen >= drive.time[0]) & (seen + SPAN_S <= min(drive.time[-1], seen[-1])))
    last = np.minimum(np.searchsorted(seen, seen[first] + SPAN_S), len(seen) - 1)
    whole = seen[last] - seen[first] < 1.5 * SPAN_S
    first, last = first[whole], last[whole]
    rolled = np.stack([
        radius * (np.interp(seen[last], drive.time, angle)
                  - np.interp(seen[first], drive.time, angle))
        for radius, angle in zip((geometry.left_radius, geometry.right_radius), drive.angles.T)])
    way = np.abs(rolled.mean(axis=0))
    turn = np.abs(rolled[1] - rolled[0]) / geometry.separation
    change = reference[last] - reference[first]
    return (_median(np.hypot(change[:, 1], change[:, 2]), way, last),
            _median(np.abs(change[:, 3]), turn, last))


def _median(seen: Array, rolled: Array, row: 'NDArray[np.int64]') -> Optional[_Span]:
    """Return the median of the ratios, of the spans with the most motion."""
    if len(rolled) < FEW or not float(rolled.max()) > 0.0:
        return None
    much = np.flatnonzero(rolled > 0.5 * np.quantile(rolled, 0.9))
    ratio = seen[much] / rolled[much]
    at = much[np.argsort(ratio)[len(much) // 2]]
    return _Span(float(seen[at] / rolled[at]), int(row[at]) + 1, float(seen[at]),
                 float(rolled[at]))
