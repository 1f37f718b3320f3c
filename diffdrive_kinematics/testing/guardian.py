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
import fcntl
import os
from pathlib import Path
import re
import signal
import subprocess
import sys
import time
from typing import Set

__all__ = ['delete_shared_memory', 'Guardian', 'shared_memory_of']

LOCK = re.compile(r'(/dev/shm/fast(?:dds|rtps)_\w+)_el')  # locked by the one who has the memory
PATIENCE_S = 5.0  # until processes that were killed are gone


def shared_memory_of(pid: int) -> Set[str]:
    """Return the names of what a process has of Fast DDS in shared memory, not that of others."""
    found: Set[str] = set()
    with suppress(OSError):  # it may end meanwhile
        for each in Path(f'/proc/{pid}/fd').iterdir():
            with suppress(OSError):
                lock = LOCK.fullmatch(os.readlink(each))
                found.update(lock.groups() if lock else ())
    return found


def delete_shared_memory(name: str) -> None:
    """
    Delete what an ended process had in shared memory.

    The number of a port is given out again, on all of the machine, and who loses the file of a
    port is deaf from then on.  So what is locked stays: it is another process's by now.
    """
    with suppress(OSError), open(f'{name}_el', 'rb') as lock:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        for file in (name, name.replace('/shm/', '/shm/sem.') + '_mutex', f'{name}_el'):
            with suppress(FileNotFoundError):
                os.unlink(file)


class Guardian:
    """A process that outlives this one by a moment, however this one ends."""

    def __init__(self) -> None:
        self._popen = subprocess.Popen(
            [sys.executable, '-I', '-S', __file__], stdin=subprocess.PIPE, text=True,
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)
        for name in shared_memory_of(os.getpid()):  # to be deleted where this process is killed
            self._tell(f'o{name}')

    def guard(self, group: int) -> None:
        """End a process group in the end."""
        self._tell(f'+{group}')

    def release(self, group: int) -> None:
        """Leave a process group that has ended alone."""
        self._tell(f'-{group}')

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
    """Read what to end and to delete, and do so at the end of the input."""
    groups: Set[int] = set()
    own: Set[str] = set()
    for line in sys.stdin:
        kind, what = line[0], line[1:].strip()
        if kind == '+':
            groups.add(int(what))
        elif kind == '-':
            groups.discard(int(what))
        elif kind == 'o':
            own.add(what)
        else:
            own.clear()
    for group in groups:
        _signal(group, signal.SIGKILL)
    deadline = time.monotonic() + PATIENCE_S
    while any(_signal(group, 0) for group in groups) and time.monotonic() < deadline:
        time.sleep(0.01)
    for name in own:
        delete_shared_memory(name)


def _signal(group: int, number: int) -> bool:
    """Send a signal to a process group; return whether there is one."""
    try:
        os.killpg(group, number)
    except OSError:
        return False
    return True


if __name__ == '__main__':
    main()
