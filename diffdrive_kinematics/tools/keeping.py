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

"""What is kept of a drive: a table of it, a bag of its messages, a picture of its way."""

from typing import Any, Callable, Iterable, List, Mapping, Optional, Tuple

from diffdrive_kinematics.tools.bag_recorder import BagRecorder
from diffdrive_kinematics.tools.drive_drawing import DrivePicture
from diffdrive_kinematics.tools.drive_table import DriveTable
from diffdrive_kinematics.tools.robots import Moment
from rclpy.publisher import Publisher

__all__ = ['Keeping']

PERIOD_NS = 20_000_000


class Keeping:
    """
    Nothing is kept before it is begun.

    Parameters
    ----------
    moments : callable
        Returns where the robots are now.
    now_ns : callable
        Returns the time [ns].

    """

    def __init__(
            self, moments: Callable[[], List[Moment]], now_ns: Callable[[], int]) -> None:
        self._moments, self._now_ns = moments, now_ns
        self._table: Optional[DriveTable] = None
        self._picture: Optional[DrivePicture] = None
        self._bag: Optional[BagRecorder] = None
        self._next_ns = 0

    def begin(self, values: Mapping[str, Any], publishers: Iterable[Publisher]) -> None:
        """Keep the drive in ``record`` and ``picture``; ``ValueError`` where that cannot be."""
        record, picture, overwrite = (
            values[name] for name in ('record', 'picture', 'overwrite'))
        if picture:
            self._picture = DrivePicture(picture, overwrite=overwrite)
        if record.endswith('.csv'):
            self._table = DriveTable(record, self._moments(), overwrite=overwrite)
        elif record:
            self._bag = BagRecorder(record, overwrite=overwrite)
            self._bag.watch(publishers, self._now_ns)

    def note(self) -> None:
        """Note where the robots are, where a period has passed or the clock was set back."""
        now_ns = self._now_ns()
        noting = [each for each in (self._table, self._picture) if each]
        if noting and not self._next_ns - PERIOD_NS <= now_ns < self._next_ns:
            self._next_ns = now_ns + PERIOD_NS
            moments = self._moments()
            for each in noting:
                each.note(moments)

    def close(self) -> List[str]:
        """Complete the files, and return a line on each; ``ValueError`` if one cannot be."""
        return [each.close() for each in self._kept()]

    def discard(self) -> None:
        """Leave nothing of files that are not complete."""
        for each in self._kept():
            each.discard()

    def _kept(self) -> Tuple[Any, ...]:
        return tuple(filter(None, (self._table, self._bag, self._picture)))
