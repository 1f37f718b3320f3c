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

"""Recordings of any kind: drives for ``calibrate``, commands for ``command_sequence``."""

from typing import Any, Dict, List, Mapping, NamedTuple, Sequence, Tuple

from diffdrive_kinematics.core.calibration import (
    drive_from_commands, drive_from_positions, drive_from_rates, drive_from_ticks,
    RecordedDrive)
from diffdrive_kinematics.core.kinematics import Array, LARGEST, Pose, WheelGeometry
from diffdrive_kinematics.tools.bag_drives import (
    add_bag, COMMANDS, Read, read_topics, Times, topic_of, twist_of, TWISTS)
from diffdrive_kinematics.tools.bags import BagMessage, is_bag, open_bag
from diffdrive_kinematics.tools.collection import Collection
from diffdrive_kinematics.tools.plausible import check_commands, check_stamps, check_units
from diffdrive_kinematics.tools.recordings import (
    check_columns, COMMAND_COLUMNS, Header, nobody, Progress, read_chosen, read_columns)
import numpy as np

REFERENCE_COLUMNS = ('time_sec', 'x', 'y', 'yaw')
MOTIONS: Dict[str, Tuple[str, ...]] = {
    COMMANDS: COMMAND_COLUMNS,
    'wheel_rates': ('time_sec', 'left_rate', 'right_rate'),
    'wheel_positions': ('time_sec', 'left_position', 'right_position'),
    'ticks': ('time_sec', 'left_ticks', 'right_ticks')}
"""Columns of each kind of motion, which its header tells."""


class Drives(NamedTuple):
    """What was read: the drives, whether their motion is commands, and what is to be said."""

    drives: List[RecordedDrive]
    commands: bool
    remarks: Tuple[str, ...]


class _Motion(NamedTuple):
    """Motion of a CSV file, and the reference where the file has it too (else no rows)."""

    kind: str
    rows: Array
    reference: Array


def read_drives(
        values: Mapping[str, Any], geometry: WheelGeometry, progress: Progress = nobody
) -> Drives:
    """
    Return the drives of recordings with their references, of CSV files and bags.

    Raises
    ------
    ValueError
        If there are not as many references as recordings, or a file is not what it should be;
        the message names it.

    """
    recordings, references = values['recordings'], values['references'] or values['recordings']
    if len(references) != len(recordings):
        raise ValueError(
            f'references is {list(references)!r}, expected {len(recordings)} files, one for each '
            'of recordings, or none where these have the columns x, y, yaw themselves')
    parts = [_read(pair, values, geometry, progress) for pair in zip(recordings, references)]
    return Drives(
        [drive for part in parts for drive in part.drives], any(part.commands for part in parts),
        tuple(remark for part in parts for remark in part.remarks))


def _read(
        paths: Tuple[str, str], values: Mapping[str, Any], geometry: WheelGeometry,
        progress: Progress) -> Drives:
    if is_bag(paths[0]):
        return _read_bag(paths, values, geometry, progress)
    motion, remarks = _read_motion(*paths, progress), []
    reference = motion.reference
    if paths[0] != paths[1]:
        if is_bag(paths[1]):
            collection = Collection()
            remarks += add_bag(collection, paths[1], values, geometry, progress,
                               motion=False).remarks
            reference = collection.reference()
        else:
            reference = _read_reference(paths[1], progress)
    try:
        drive = _drive(motion, reference, values, geometry)
    except ValueError as error:
        raise ValueError(f'{_both(paths)}: {error}') from error
    check_units(paths, motion.kind, drive, reference, geometry)
    return Drives([drive], motion.kind == COMMANDS, tuple(remarks))


def _read_bag(
        paths: Tuple[str, str], values: Mapping[str, Any], geometry: WheelGeometry,
        progress: Progress) -> Drives:
    """Return the drives of a bag, with the reference in it or in another file."""
    collection, alone = Collection(), paths[0] == paths[1]
    read: Read = add_bag(collection, paths[0], values, geometry, progress, reference=alone)
    remarks = list(read.remarks)
    if not alone and is_bag(paths[1]):
        remarks += add_bag(collection, paths[1], values, geometry, progress, motion=False).remarks
    elif not alone:
        for time, *pose in _read_reference(paths[1], progress).tolist():
            collection.add_pose(round(1e9 * time), Pose(*pose))
    try:
        drives = collection.drives()
    except ValueError as error:
        raise ValueError(f'{_both(paths)}: {error}') from error
    for drive in drives:
        check_units(paths, read.kind, drive,
                    np.column_stack([drive.reference_time, drive.reference]), geometry)
    if collection.left_out:
        remarks.append(f'{paths[0]}: {collection.left_out} messages left out as out of order')
    return Drives(drives, read.kind == COMMANDS, tuple(remarks))


def _both(paths: Tuple[str, str]) -> str:
    return paths[0] if paths[0] == paths[1] else f'{paths[0]} with {paths[1]}'


def _read_motion(path: str, reference: str, progress: Progress) -> _Motion:
    """Return the motion of a CSV file, and the reference where that is in the same file."""
    more = REFERENCE_COLUMNS[1:] if path == reference else ()

    def chosen(header: Header) -> Sequence[str]:
        return *MOTIONS[_kind_of(path, header)], *check_columns(path, header, more)

    header, rows = read_chosen(path, chosen, progress)
    kind = _kind_of(path, header)
    rows = _rows(path, rows, (*MOTIONS[kind], *more), commands=kind == COMMANDS)
    return _Motion(kind, rows[:, :3], rows[:, [0, 3, 4, 5]] if more else np.empty((0, 4)))


def _kind_of(path: str, header: Header) -> str:
    """Return which kind of motion a file has; ``ValueError`` where that is not clear."""
    found = [kind for kind, columns in MOTIONS.items() if set(columns) <= set(header)]
    found = [kind for kind in found if kind != COMMANDS] or found  # wheels tell more
    if len(found) != 1:
        raise ValueError(
            f'{path} has the columns {list(header)!r}, expected those of one kind of motion: '
            + '; '.join(','.join(columns) for columns in MOTIONS.values()))
    return found[0]


def _read_reference(path: str, progress: Progress) -> Array:
    """Return the reference of a CSV file: time, x, y, yaw."""
    return _rows(path, read_columns(path, REFERENCE_COLUMNS, progress), REFERENCE_COLUMNS)


def _drive(
        motion: _Motion, reference: Array, values: Mapping[str, Any], geometry: WheelGeometry
) -> RecordedDrive:
    series = motion.rows[:, 0], motion.rows[:, 1:], reference[:, 0], reference[:, 1:]
    if motion.kind == COMMANDS:
        return drive_from_commands(*series, geometry=geometry)
    if motion.kind == 'wheel_rates':
        return drive_from_rates(*series)
    if motion.kind == 'wheel_positions':
        return drive_from_positions(*series)
    if not values['encoder_resolution']:
        raise ValueError(
            'encoder_resolution is 0.0, expected the ticks of one turn of a joint, as the file '
            'has left_ticks and right_ticks')
    time, ticks, *poses = series
    if not values['tick_increments']:
        ticks = np.diff(ticks, axis=0, prepend=ticks[:1])
    return drive_from_ticks(
        time, ticks, *poses, ticks_per_turn=values['encoder_resolution'] * values['gear_ratio'])


def _rows(path: str, rows: Array, columns: Sequence[str], *, commands: bool = False) -> Array:
    """Return the rows if they are enough, with stamps in seconds and numbers that can be."""
    if len(rows) < 2:
        raise ValueError(f'{path} has {len(rows)} rows, expected at least 2')
    bad = ~(np.abs(rows) <= LARGEST)
    bad[:, 0] = ~np.isfinite(rows[:, 0])  # what stamps can be is said below
    if bad.any():
        row, column = np.argwhere(bad)[0]
        raise ValueError(
            f'{path}, row {row + 1}: {columns[column]} is {rows[row, column]:.15g}, expected a '
            f'finite number within +-{LARGEST:g}')
    check_stamps(path, rows[:, 0], commands=commands)
    return rows


def read_commands(path: str, topic: str) -> List[Tuple[float, float, float]]:
    """
    Return (time [s], v [m/s], w [rad/s]) of recorded commands.

    Raises
    ------
    ValueError
        If the file cannot be read or has no such columns (a bag: no such topic), or is in other
        units.

    """
    rows = (_commands_of_bag(path, topic) if is_bag(path)
            else [(time, v, w) for time, v, w in read_columns(path, COMMAND_COLUMNS).tolist()])
    if rows:
        numbers = np.array(rows)
        check_stamps(path, numbers[:, 0], commands=True)
        check_commands(path, numbers)
    return rows


def _commands_of_bag(path: str, topic: str) -> List[Tuple[float, float, float]]:
    found: List[Tuple[int, float, float]] = []
    times = Times()

    def add(message: BagMessage) -> None:
        stamp_ns, v, w = twist_of(message)
        found.append((times.of(stamp_ns, message.received_ns), v, w))

    with open_bag(path) as bag:
        chosen = topic_of(bag, 'cmd_vel_topic', {'cmd_vel_topic': topic}, TWISTS)
        read_topics(bag, {chosen.name: add})
    return [((time_ns - found[0][0]) / 1e9, v, w) for time_ns, v, w in found]
