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

"""How far it is, on a terminal, in one line that is written over and over."""

import os
import shutil
import sys
import time
from typing import Callable, Optional, TextIO

PERIOD_S = 0.2


class Progress:
    """
    A line on stderr that says what is being done and for how long; none where that is no terminal.

    Parameters
    ----------
    stream : text file, optional
        Where to write instead of stderr.

    """

    def __init__(self, stream: Optional[TextIO] = None) -> None:
        self._stream = sys.stderr if stream is None else stream
        self._shown = self._stream is not None and self._stream.isatty()
        self._began = time.monotonic()
        self._next = 0.0

    def __call__(self, text: str, *, begins: bool = False) -> None:
        """Say how far it is; more than five times a second is shown only where work begins."""
        if self._due(begins=begins):
            since = f', {time.monotonic() - self._began:.0f} s'
            self._write(f'\r{text[:self._width() - len(since)]}{since}\x1b[K')

    def _due(self, *, begins: bool = False) -> bool:
        if not self._shown or (now := time.monotonic()) < self._next and not begins:
            return False
        self._next = now + PERIOD_S
        return True

    def _width(self) -> int:
        """Return how many characters a line may have: with more it would become two."""
        try:
            columns = os.get_terminal_size(self._stream.fileno()).columns
        except (OSError, ValueError):
            columns = 0
        return (columns or shutil.get_terminal_size().columns) - 1

    def __enter__(self) -> 'Progress':
        """Begin."""
        return self

    def __exit__(self, *_: object) -> None:
        """Clear the line."""
        if self._shown:
            self._write('\r\x1b[K')

    def _write(self, text: str) -> None:
        try:
            self._stream.write(text)
            self._stream.flush()
        except OSError:  # nobody looks
            self._shown = False


class LiveLine(Progress):
    """
    A line on stdout that is of the moment; none where that is no terminal.

    The cursor stays at its begin, so that the next line of a log is written over it.

    Parameters
    ----------
    stream : text file, optional
        Where to write instead of stdout.

    """

    def __init__(self, stream: Optional[TextIO] = None) -> None:
        super().__init__(sys.stdout if stream is None else stream)

    def __call__(self, text: Callable[[], str]) -> None:
        """Show what ``text`` returns, which is called up to five times a second."""
        if self._due():
            self._write(f'{text()[:self._width()]}\x1b[K\r')

    def clear(self) -> None:
        """Clear the line, for one that stays."""
        if self._shown:
            self._write('\x1b[K')
