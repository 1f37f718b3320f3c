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

"""What ``calibrate`` reads: measured runs around a square, recorded drives, live topics."""

import math
from typing import Any, Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple

from builtin_interfaces.msg import Time
from diffdrive_kinematics.core.calibration import (
    drive_from_commands, drive_from_positions, drive_from_rates, drive_from_ticks,
    RecordedDrive, ReturnError)
from diffdrive_kinematics.core.kinematics import WheelGeometry
from diffdrive_kinematics.core.odometry import WheelSample
from diffdrive_kinematics.ros.messages.messages import nanoseconds, pose_in_plane
from diffdrive_kinematics.tools.recordings import COMMAND_COLUMNS, read_columns, read_header
from geometry_msgs.msg import Pose
import numpy as np

__all__ = ['Collection', 'MOTIONS', 'motion_of', 'read_drives', 'read_square_runs']

REFERENCE_COLUMNS = ('time_sec', 'x', 'y', 'yaw')
NEW_RUN_NS = 1_000_000_000
"""Fall of the stamps of wheel motion from which it counts as another run."""
SQUARE_COLUMNS = ('clockwise', 'true_x', 'true_y', 'odom_x', 'odom_y')
MOTIONS: Dict[str, Tuple[str, ...]] = {
    'commands': COMMAND_COLUMNS,
    'wheel_rates': ('time_sec', 'left_rate', 'right_rate'),
    'wheel_positions': ('time_sec', 'left_position', 'right_position'),
    'ticks': ('time_sec', 'left_ticks', 'right_ticks')}
"""Columns of each kind of motion, which its header tells."""


def read_square_runs(path: str) -> Tuple[List[ReturnError], List[ReturnError]]:
    """
    Return the return errors (clockwise, counterclockwise) of a CSV file of runs.

    Raises
    ------
    ValueError
        If the file cannot be read or has no runs, or ``clockwise`` is neither 0 nor 1.

    """
    found: Tuple[List[ReturnError], List[ReturnError]] = ([], [])
    rows = read_columns(path, SQUARE_COLUMNS)
    if not rows:
        raise ValueError(f'{path} has no rows, expected one for each run')
    for number, (clockwise, true_x, true_y, odom_x, odom_y) in enumerate(rows, start=1):
        if clockwise not in (0.0, 1.0):
            raise ValueError(
                f'{path}, row {number}: clockwise is {clockwise!r}, expected 1, or 0 for '
                'counterclockwise')
        found[0 if clockwise else 1].append(ReturnError(true_x - odom_x, true_y - odom_y))
    return found


def read_drives(values: Mapping[str, Any], geometry: WheelGeometry) -> List[RecordedDrive]:
    """
    Return a segment for each recording, with its reference.

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
    return [_read_segment(motion, reference, values, geometry)
            for motion, reference in zip(recordings, references)]


def _read_segment(
        motion: str, reference: str, values: Mapping[str, Any], geometry: WheelGeometry
) -> RecordedDrive:
    kind = motion_of(motion)
    rows = _rows(motion, MOTIONS[kind])
    poses = _rows(reference, REFERENCE_COLUMNS)
    series = rows[:, 0], rows[:, 1:], poses[:, 0], poses[:, 1:]
    try:
        if kind == 'commands':
            return drive_from_commands(*series, geometry=geometry)
        if kind == 'wheel_rates':
            return drive_from_rates(*series)
        if kind == 'wheel_positions':
            return drive_from_positions(*series)
        return _segment_from_ticks(series, values)
    except ValueError as error:
        files = motion if motion == reference else f'{motion} with {reference}'
        raise ValueError(f'{files}: {error}') from error


def motion_of(path: str) -> str:
    """Return which kind of motion a file has; ``ValueError`` where that is not clear."""
    header = read_header(path)
    found = [kind for kind, columns in MOTIONS.items() if set(columns) <= set(header)]
    if len(found) != 1:
        raise ValueError(
            f'{path} has the columns {list(header)!r}, expected those of one kind of motion: '
            + '; '.join(','.join(columns) for columns in MOTIONS.values()))
    return found[0]


def _segment_from_ticks(
        series: Sequence[np.ndarray], values: Mapping[str, Any]) -> RecordedDrive:
    if not values['encoder_resolution']:
        raise ValueError(
            'encoder_resolution is 0.0, expected the ticks of one turn of a joint, as the file '
            'has left_ticks and right_ticks')
    time, ticks, *reference = series
    if not values['tick_increments']:
        ticks = np.diff(ticks, axis=0, prepend=ticks[:1])
    return drive_from_ticks(
        time, ticks, *reference, ticks_per_turn=values['encoder_resolution'] * values['gear_ratio'])


def _rows(path: str, columns: Sequence[str]) -> np.ndarray:
    rows = np.array(read_columns(path, columns), dtype=np.float64)
    if len(rows) < 2:
        raise ValueError(f'{path} has {len(rows)} rows, expected at least 2')
    finite = np.isfinite(rows).all(axis=1)
    if not finite.all():
        number = int(np.argmin(finite))
        raise ValueError(
            f'{path}, row {number + 1}: {rows[number].tolist()}, expected finite numbers in '
            f'{list(columns)!r}')
    return rows


_Seen = Tuple[int, float, float, float]


class _Drive(NamedTuple):
    """One run of the wheels' publisher, and the reference of its time (shared with others)."""

    source: str
    samples: List[WheelSample]
    reference: List[_Seen]


class Collection:
    """
    Wheel motion and reference poses as they come in.

    Wheel motion of another run of its publisher begins another segment.  Where its stamps begin
    anew as well (a simulation is started again, a bag plays in a loop), so does the reference:
    the poses of one run must not be laid beside the wheels of the other.  What else is older
    than what came before is left out.
    """

    def __init__(self) -> None:
        self._drives: List[_Drive] = []
        self._reference: List[_Seen] = []
        self.left_out = 0

    def add_wheels(self, sample: WheelSample) -> None:
        """Add wheel motion."""
        last = self._drives[-1] if self._drives else None
        fallen_ns = last.samples[-1].stamp_ns - sample.stamp_ns if last else 0
        if last is None or last.source != sample.source or fallen_ns > NEW_RUN_NS:
            if fallen_ns > 0:
                self._reference = []
            self._drives.append(_Drive(sample.source, [], self._reference))
        samples = self._drives[-1].samples
        if samples and sample.stamp_ns < samples[-1].stamp_ns:
            self.left_out += 1
            return
        samples.append(sample)

    def add_reference(self, stamp: Time, pose: Pose) -> None:
        """Add a reference pose; ``ValueError`` if it is none or has no stamp."""
        stamp_ns, at = nanoseconds(stamp), pose_in_plane(pose)
        if not stamp_ns:
            raise ValueError('stamp is 0, expected the time at which the pose was measured')
        if self._reference and stamp_ns < self._reference[-1][0]:
            self.left_out += 1
            return
        self._reference.append((stamp_ns, *at))

    def summary(self, geometry: WheelGeometry) -> str:
        """Return how much there is, in a line."""
        wheels = sum(len(drive.samples) for drive in self._drives)
        seen = {id(drive.reference): len(drive.reference) for drive in self._drives}
        poses = sum(seen.values()) if seen else len(self._reference)
        text = f'{wheels} samples of the wheels, {poses} of the reference'
        try:
            segments = self.drives()
        except ValueError:
            return text
        seconds = sum(segment.time[-1] - segment.time[0] for segment in segments)
        steps = [np.diff(segment.angles, axis=0) for segment in segments]
        rolled = np.concatenate(steps) * [geometry.left_radius, geometry.right_radius]
        distance = float(np.abs(rolled.mean(axis=1)).sum())
        turned = float(np.abs(np.diff(rolled, axis=1)).sum()) / geometry.separation
        late = f', {self.left_out} left out as out of order' if self.left_out else ''
        return (f'{text}: {seconds:.1f} s, {distance:.2f} m, {math.degrees(turned):.0f} deg '
                f'turned{late}')

    def drives(self) -> List[RecordedDrive]:
        """
        Return a segment for each run of the wheels' publisher.

        Raises
        ------
        ValueError
            If there is no wheel motion or no reference, or too little of them.

        """
        drives = [drive for drive in self._drives if drive.reference]
        if not drives:
            what = 'reference' if self._drives else 'wheel motion'
            raise ValueError(f'no {what} has come so far, expected some')
        found = [_segment(drive) for drive in drives]
        segments = [segment for segment in found if segment is not None]
        if not segments:
            wheels, poses = drives[-1].samples, drives[-1].reference
            raise ValueError(
                f'wheel motion is stamped {wheels[0].stamp_ns / 1e9:.3f} to '
                f'{wheels[-1].stamp_ns / 1e9:.3f} s and the reference {poses[0][0] / 1e9:.3f} to '
                f'{poses[-1][0] / 1e9:.3f} s, expected two or more of each at the same time')
        return segments


def _segment(drive: _Drive) -> Optional[RecordedDrive]:
    """Return the segment of one run, with the reference at its time; None if it is too short."""
    first_ns = min(drive.samples[0].stamp_ns, drive.reference[0][0])
    reference = np.array([
        ((stamp_ns - first_ns) / 1e9, *pose) for stamp_ns, *pose in drive.reference])
    with_positions = [sample for sample in drive.samples if sample.positions is not None]
    chosen = with_positions or drive.samples
    time = np.array([(sample.stamp_ns - first_ns) / 1e9 for sample in chosen])
    seen = (reference[:, 0] >= time[0] - 1.0) & (reference[:, 0] <= time[-1] + 1.0)
    series = time, reference[seen, 0], reference[seen, 1:]
    if len(np.unique(series[0])) < 2 or len(np.unique(series[1])) < 2:
        return None
    if with_positions:
        return drive_from_positions(
            time, [sample.positions for sample in chosen], *series[1:])
    return drive_from_rates(time, [sample.rates for sample in chosen], *series[1:])
