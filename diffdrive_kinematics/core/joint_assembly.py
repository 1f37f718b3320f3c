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
Messages that carry only some of the joints, put together by joint.

Joints are measured one after the other.  They make a sample once each has been heard since the
sample before, at the time of the one that was measured first; where the others were then is
between the last two things that they said.  So stamps go up, and no motion counts twice.
"""

import math
from typing import Collection, Mapping, NamedTuple, Optional, Tuple

__all__ = ['Assembled', 'Assembly', 'JointReading']

STEP_NS = 1_000_000_000  # back: the clock was stepped


class JointReading(NamedTuple):
    """What a message says of a joint: stamp [ns], position [rad], rate [rad/s]; NaN: nothing."""

    stamp_ns: int
    position: float = math.nan
    rate: float = math.nan


class Assembled(NamedTuple):
    """All joints at one time."""

    stamp_ns: int
    positions: Tuple[float, ...]
    rates: Tuple[float, ...]


class Assembly(NamedTuple):
    """
    The last two readings of each joint, and which joints came since the last sample.

    A value: ``after`` returns a new one.
    """

    newest: Tuple[Optional[JointReading], ...]
    before: Tuple[Optional[JointReading], ...]
    fresh: Tuple[bool, ...]

    @staticmethod
    def of(joints: int) -> 'Assembly':
        """Return the assembly of so many joints that have not been heard."""
        return Assembly((None,) * joints, (None,) * joints, (False,) * joints)

    def without(self, joints: Collection[int]) -> 'Assembly':
        """Return the assembly in which some joints have not been heard."""
        newest, before = (
            tuple(None if joint in joints else reading for joint, reading in enumerate(readings))
            for readings in (self.newest, self.before))
        return Assembly(newest, before, tuple(
            fresh and joint not in joints for joint, fresh in enumerate(self.fresh)))

    def after(
            self, readings: Mapping[int, JointReading]
    ) -> Tuple['Assembly', Optional[Assembled]]:
        """
        Return the assembly after a message, and the sample that it completes, if it does.

        A reading that is not newer than the last one of its joint is dropped.
        """
        newest, before, fresh = list(self.newest), list(self.before), list(self.fresh)
        for joint, reading in readings.items():
            last = newest[joint]
            if last is not None and reading.stamp_ns < last.stamp_ns - STEP_NS:
                return Assembly.of(len(newest)).after(readings)
            if last is None or reading.stamp_ns > last.stamp_ns:
                newest[joint], before[joint], fresh[joint] = reading, last, True
        if not all(fresh):
            return Assembly(tuple(newest), tuple(before), tuple(fresh)), None
        stamp_ns = min(reading.stamp_ns for reading in newest if reading)
        return Assembly(tuple(newest), tuple(before), (False,) * len(fresh)), Assembled(
            stamp_ns, tuple(_position_at(stamp_ns, a, b) for a, b in zip(before, newest)),
            tuple(reading.rate for reading in newest if reading))


def _position_at(
        stamp_ns: int, before: Optional[JointReading], newest: Optional[JointReading]) -> float:
    """Return the position [rad] at a time at or before the newest reading."""
    if newest is None:
        return math.nan
    if before is None or math.isnan(before.position) or stamp_ns >= newest.stamp_ns:
        return newest.position
    share = (stamp_ns - before.stamp_ns) / (newest.stamp_ns - before.stamp_ns)
    return before.position + max(0.0, share) * (newest.position - before.position)
