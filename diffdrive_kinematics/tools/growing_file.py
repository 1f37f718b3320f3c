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

"""A text file that is written bit by bit, and is in its place when it is complete."""

from contextlib import suppress
import os
from typing import TextIO

from diffdrive_kinematics.tools.output_files import check_writable, free_path, place, write_beside


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
