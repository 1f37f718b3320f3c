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

from typing import Any, Callable, Iterable, List, Mapping, Optional, Sequence, Tuple

from diffdrive_kinematics.tools.bag_recorder import BagRecorder
from diffdrive_kinematics.tools.drive_drawing import DrivePicture
from diffdrive_kinematics.tools.drive_table import DriveTable
from diffdrive_kinematics.tools.output_files import check_writable
from diffdrive_kinematics.tools.robots import Moment
from diffdrive_kinematics.tools.square_notes import SquareNotes, Squares
from rclpy.publisher import Publisher

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

    def __init__(self, moments: Callable[[], List[Moment]], now_ns: Callable[[], int]) -> None:
        self._moments, self._now_ns = moments, now_ns
        self._table: Optional[DriveTable] = None
        self._picture: Optional[DrivePicture] = None
        self._bag: Optional[BagRecorder] = None
        self._squares: Optional[SquareNotes] = None
        self._next_ns = 0
        self._calibration = ''
        self._failed: List[str] = []

    def begin(self, values: Mapping[str, Any], publishers: Iterable[Publisher]) -> None:
        """Keep the drive in ``record`` and ``picture``; ``ValueError`` where that cannot be."""
        record, picture, overwrite = (values[name] for name in ('record', 'picture', 'overwrite'))
        self._calibration = values['calibration']
        if values['calibration']:
            check_writable(values['calibration'], name='calibration', overwrite=overwrite)
        if picture:
            self._picture = DrivePicture(picture, overwrite=overwrite)
        if record.endswith('.csv'):
            self._table = DriveTable(record, self._moments(), overwrite=overwrite)
        elif record:
            self._bag = BagRecorder(record, overwrite=overwrite)
            self._bag.watch(publishers, self._now_ns)

    def note_squares(self, path: str, squares: Sequence[Squares]) -> None:
        """Note the runs around squares in a file; ``ValueError`` where that cannot be."""
        self._squares = SquareNotes(
            path, squares, self._moments(), calibrates=bool(self._calibration))

    @property
    def notes(self) -> bool:
        """Return whether there is something to note on the way."""
        return bool(self._table or self._picture or self._squares)

    def note(self) -> str:
        """
        Note where the robots are, where a period has passed or the clock was set back.

        Returns
        -------
        str
            A line on the run around a square that has ended, if one has.

        """
        now_ns = self._now_ns()
        noting = [each for each in (self._table, self._picture) if each]
        if noting and not self._next_ns - PERIOD_NS <= now_ns < self._next_ns:
            self._next_ns = now_ns + PERIOD_NS
            moments = self._moments()
            for each in noting:
                each.note(moments)
        due = self._squares and self._squares.due()
        return self._squares.note(self._moments()) if due else ''

    def close(
            self, *, finished: bool, interrupted: bool,
            calibrated: Callable[[], List[str]] = list) -> List[str]:
        """
        Complete the files, and return a line on each; what cannot be is for ``check``.

        Parameters
        ----------
        finished : bool
            Whether there was a course, and it is done.
        interrupted : bool
            Whether there was one, and it is not.
        calibrated : callable
            Calibrates by the runs that are noted, and returns its report.

        """
        lines: List[str] = []
        squares = self._squares
        last = [lambda: squares.note(self._moments())] if squares and finished else []
        for complete in (*last, *(each.close for each in self._kept()), calibrated):
            try:
                done = complete()
                lines += [done] if isinstance(done, str) else done
            except ValueError as error:
                self._failed.append(str(error))
        if interrupted and (recording := self._table or self._bag):
            lines.append(f'the recording ends at {recording.length_s():.2f} s because the course '
                         'was interrupted')
        if interrupted and squares:
            lines.extend(squares.left(self._calibration))
        return lines

    def check(self) -> None:
        """Raise ``ValueError`` if something could not be completed."""
        if self._failed:
            raise ValueError('; '.join(self._failed))

    def discard(self) -> None:
        """Leave nothing of files that are not complete."""
        for each in self._kept():
            each.discard()

    def _kept(self) -> Tuple[Any, ...]:
        return tuple(filter(None, (self._table, self._bag, self._picture)))
