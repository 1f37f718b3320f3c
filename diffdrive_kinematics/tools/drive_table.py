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

"""A drive as CSV rows: what ``calibrate`` and ``command_sequence`` read, and plots are made of."""

from contextlib import suppress
import os
from typing import Sequence, TextIO

from diffdrive_kinematics.tools.output_files import (
    beside, check_writable, free_path, place, write_beside)
from diffdrive_kinematics.tools.robots import Moment

COLUMNS = (
    'time_sec', 'left_position', 'right_position', 'linear_x', 'angular_z', 'belief_x',
    'belief_y', 'belief_yaw')
TRUTH = 'x', 'y', 'yaw'


class GrowingFile:
    """
    A text that is written bit by bit beside its place, and put there when it is complete.

    Parameters
    ----------
    path : str
        Where it belongs.
    name : str
        Of the parameter that says so.
    overwrite : bool
        Whether a file that is there may be replaced.

    Raises
    ------
    ValueError
        If no file can be written there.

    """

    def __init__(self, path: str, *, name: str, overwrite: bool) -> None:
        check_writable(path, name=name, overwrite=overwrite, regular=True)
        self._path, self._overwrite, self._failed = path, overwrite, ''
        self._part = write_beside(path, b'')
        self._file: TextIO = open(self._part, 'w', encoding='utf-8', newline='')

    def write(self, text: str) -> None:
        """Add to the text; that it cannot be written is said at the end."""
        try:
            if not self._failed:
                self._file.write(text)
        except OSError as error:
            self._failed = str(error)

    def close(self) -> str:
        """Put the complete text in its place or beside it, return where; ``ValueError`` if not."""
        try:
            if self._failed:
                raise OSError(self._failed)
            self._file.flush()
            os.fsync(self._file.fileno())
            path = free_path(self._path, overwrite=self._overwrite)
            place(self._part, path, overwrite=self._overwrite)
            return path
        except OSError as error:
            raise ValueError(f'{self._path} cannot be written: {error}') from error
        finally:
            self.discard()

    def discard(self) -> None:
        """Leave nothing of a text that is not complete."""
        with suppress(OSError):
            self._file.close()
        with suppress(OSError):
            os.unlink(self._part)


class DriveTable(GrowingFile):
    """
    The file of a drive of one robot, with a row for each time.

    The wheels and the twist are those of the belief: of a simulated robot, what was commanded.

    Parameters
    ----------
    path : str
        Of the file.
    start : sequence of Moment
        The robots at the start, which must be one; without a truth its columns are left out.
    overwrite : bool
        Whether a file that is there may be replaced.

    Raises
    ------
    ValueError
        If there is not one robot, or no file can be written there.

    """

    def __init__(self, path: str, start: Sequence[Moment], *, overwrite: bool) -> None:
        if len(start) != 1:
            raise ValueError(
                f'record is {path!r}, and nodes has {len(start)} robots with odometry, expected '
                'one robot; an .mcap file is of any number')
        super().__init__(path, name='record', overwrite=overwrite)
        self._rows = self._first_ns = self._last_ns = 0
        self.write(','.join(COLUMNS + (TRUTH if start[0].truth else ())) + '\n')

    def note(self, moments: Sequence[Moment]) -> None:
        """Add a row."""
        moment, = moments
        time_ns, belief, truth = moment.time_ns, moment.belief, moment.truth
        self._first_ns, self._last_ns = self._first_ns if self._rows else time_ns, time_ns
        seconds, nanoseconds = divmod(time_ns, 10**9)
        self.write(','.join([
            f'{seconds}.{nanoseconds:09d}',
            *(f'{value:.12g}' for value in (
                *belief.angles, *belief.twist, *belief.pose, *(truth or ())))]) + '\n')
        self._rows += 1

    def length_s(self) -> float:
        """Return the time [s] from the first to the last row."""
        return (self._last_ns - self._first_ns) / 1e9

    def close(self) -> str:
        """Complete the file, and return a line that says so; ``ValueError`` if that cannot be."""
        return f'recorded {self._rows} rows in {beside(self._path, super().close())}'
