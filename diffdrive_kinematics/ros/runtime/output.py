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
What executables print, where stdout and stderr may be full or closed.

Nothing that was worked out is lost with it: a drive goes on, files are written, and results are
said on stderr instead.  The exit status tells.
"""

import os
import sys

LOST = 1  # exit status
STDERR = 2

_failed = ''  # why stdout could not be written


def show(text: str) -> bool:
    """Print a text that is of the moment, and return whether it could be printed."""
    global _failed
    if _failed:
        return False
    try:
        if sys.stdout is None:  # so Python has it where it was closed before the start
            raise OSError('it is closed')
        print(text, flush=True)
    except OSError as error:
        _failed = error.strerror or str(error)
        if sys.stdout is not None:  # what is left in the buffer would fail again at the end
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        complain(f'diffdrive_kinematics: stdout cannot be written ({_failed}): results are '
                 'printed here')
    return not _failed


def report(text: str) -> None:
    """Print a result, on stderr where stdout does not take it."""
    if not show(text):
        complain(text)


def exit_status() -> int:
    """Return 0, or 1 where stdout has not taken all."""
    return LOST if _failed else 0


def complain(text: str) -> None:
    """Print a text on stderr, where that can be done."""
    try:
        if sys.stderr is not None:
            print(text, file=sys.stderr, flush=True)
    except OSError:  # nobody is left to tell; the exit status is
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stderr.fileno())


def open_stderr() -> None:
    """
    Have a stderr that takes what is written, where it was closed before the start.

    Some libraries expect one; and what is opened next would have its number, and get their words.
    """
    if sys.stderr is not None:
        return
    sink = os.open(os.devnull, os.O_WRONLY)
    try:
        os.fstat(STDERR)
    except OSError:
        os.dup2(sink, STDERR)
    os.set_inheritable(STDERR, True)
    sys.stderr = os.fdopen(sink, 'w')
