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

"""Wheel motion and reference poses as they come in, of a topic or a bag, made into drives."""

import math
from typing import List, NamedTuple, Optional, Tuple

from builtin_interfaces.msg import Time
from diffdrive_kinematics.core.calibration import (
    drive_from_positions, drive_from_rates, RecordedDrive)
from diffdrive_kinematics.core.kinematics import Array, Pose, WheelGeometry
from diffdrive_kinematics.core.odometry import WheelSample
from diffdrive_kinematics.ros.messages.messages import nanoseconds, pose_in_plane
from geometry_msgs.msg import Pose as PoseMessage
import numpy as np

NEW_RUN_NS = 1_000_000_000
"""Fall of the stamps of wheel motion from which it counts as another run."""

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

    def add_reference(self, stamp: Time, pose: PoseMessage) -> None:
        """Add a reference pose; ``ValueError`` if it is none or has no stamp."""
        stamp_ns, at = nanoseconds(stamp), pose_in_plane(pose)
        if not stamp_ns:
            raise ValueError('stamp is 0, expected the time at which the pose was measured')
        self.add_pose(stamp_ns, at)

    def add_pose(self, stamp_ns: int, at: Pose) -> None:
        """Add the pose of the reference at a time [ns]."""
        if self._reference and stamp_ns < self._reference[-1][0]:
            self.left_out += 1
            return
        self._reference.append((stamp_ns, *at))

    def reference(self) -> Array:
        """Return the reference so far: time [s], x [m], y [m], yaw [rad], shape (m, 4)."""
        return np.array([(stamp_ns / 1e9, *pose) for stamp_ns, *pose in self._reference],
                        dtype=np.float64).reshape(-1, 4)

    def counts(self) -> Tuple[int, int]:
        """Return how many samples of the wheels and of the reference there are."""
        seen = {id(drive.reference): len(drive.reference) for drive in self._drives}
        return (sum(len(drive.samples) for drive in self._drives),
                sum(seen.values()) if seen else len(self._reference))

    def summary(self, geometry: WheelGeometry) -> str:
        """Return how much there is, in a line."""
        wheels, poses = self.counts()
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
        return drive_from_positions(time, [sample.positions for sample in chosen], *series[1:])
    return drive_from_rates(time, [sample.rates for sample in chosen], *series[1:])
