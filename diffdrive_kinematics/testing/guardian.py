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

"""Ends what a test has started, also where the test itself is killed and cannot."""

from contextlib import suppress
import os
from pathlib import Path
import re
import signal
import subprocess
import sys
import time
from typing import Set

__all__ = ['Guardian', 'shared_memory_in_use', 'shared_memory_of']

SHARED_MEMORY = re.compile(r'/dev/shm/\S*fast(?:dds|rtps)_\S+')
PORT = re.compile(r'/dev/shm/(fast\w+_port\d+)')
PATIENCE_S = 5.0  # until processes that were killed are gone


def shared_memory_of(pid: int) -> Set[str]:
    """Return the files of Fast DDS in shared memory that a process uses, as far as it is alive."""
    try:
        maps = Path(f'/proc/{pid}/maps').read_text(encoding='utf-8')
    except OSError:
        return set()
    found = set(SHARED_MEMORY.findall(maps))
    return found | {f'{each}_el' for each in found if '/fast' in each} | {
        f'/dev/shm/sem.{port}_mutex' for port in PORT.findall(maps)}


def shared_memory_in_use() -> Set[str]:
    """Return the files of Fast DDS in shared memory that any process uses."""
    return set().union(*map(shared_memory_of, map(int, filter(str.isdigit, os.listdir('/proc')))))


class Guardian:
    """A process that outlives this one by a moment, however this one ends."""

    def __init__(self) -> None:
        self._popen = subprocess.Popen(
            [sys.executable, '-I', '-S', __file__], stdin=subprocess.PIPE, text=True,
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)
        self.note_own()

    def guard(self, group: int) -> None:
        """End a process group in the end."""
        self._tell(f'+{group}')

    def note_own(self) -> None:
        """Delete what this process has in shared memory where it is killed."""
        for file in sorted(shared_memory_of(os.getpid())):
            self._tell(f'o{file}')

    def release(self, group: int, files: Set[str]) -> None:
        """Leave a process group that has ended alone, and delete its files in the end."""
        self._tell(f'-{group}')
        self.sweep(files)

    def sweep(self, files: Set[str]) -> None:
        """Delete files in the end."""
        for file in sorted(files):
            self._tell(f'f{file}')

    def close(self) -> None:
        """Have the rest ended and deleted now; what this process has it deletes itself."""
        self._tell('done')
        self._popen.stdin.close()
        self._popen.wait()

    def _tell(self, line: str) -> None:
        try:
            self._popen.stdin.write(f'{line}\n')
            self._popen.stdin.flush()
        except (BrokenPipeError, ValueError):  # it was killed, or has done its work
            pass


def main() -> None:
    """
    Read what to end and to delete, and do so at the end of the input.

    The number of a port is given out again once its process has ended, to whatever domain, and
    who loses the file of a port is deaf from then on.  So what somebody uses by now stays.
    """
    groups: Set[int] = set()
    files: Set[str] = set()
    own: Set[str] = set()
    for line in sys.stdin:
        kind, what = line[0], line[1:].strip()
        if kind == '+':
            groups.add(int(what))
        elif kind == '-':
            groups.discard(int(what))
        elif kind == 'f':
            files.add(what)
        elif kind == 'o':
            own.add(what)
        else:
            own.clear()
    for group in groups:
        _signal(group, signal.SIGKILL)
    deadline = time.monotonic() + PATIENCE_S
    while any(_signal(group, 0) for group in groups) and time.monotonic() < deadline:
        time.sleep(0.01)
    for file in (files | own) - shared_memory_in_use():
        with suppress(OSError):
            os.unlink(file)


def _signal(group: int, number: int) -> bool:
    """Send a signal to a process group; return whether there is one."""
    try:
        os.killpg(group, number)
    except OSError:
        return False
    return True


if __name__ == '__main__':
    main()
