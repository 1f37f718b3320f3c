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
Whether processes have handled all that has reached them: then all of their threads sleep.

Linux tells of every thread whether it runs, waits for a processor, or sleeps, and for how long a
process has run.  A message for a thread that sleeps makes it one that runs before its sender goes
on.  If a process does not run while it is found that all of its threads sleep, they slept all
along: a thread that is to run does not fall asleep before it has run.  But a thread that falls
asleep is told to sleep some microseconds before its time counts, and may have woken another one
that was looked at before: so all are looked at twice.
"""

import os
import sys
import threading
import time
from typing import Callable, Dict, List, Sequence, Tuple

from rclpy.executors import Executor, SingleThreadedExecutor

__all__ = ['Rest', 'Threads', 'can_tell']

STATE = '/proc/{0}/task/{1}/stat'
CHILDREN = '/proc/{0}/task/{1}/children'
NEWEST = '/proc/loadavg'  # its last number changes with each new thread of the machine
ASLEEP = b') S '
BUSY = b'RDTt'  # runs, or waits for a processor; waits for a disk; is stopped, or by a debugger
LENGTH = 512
CPU_TIME, CPU_TIME_OF_THREAD = 2, 6  # kinds of clocks of the kernel, <linux/posix-timers.h>


def can_tell() -> bool:
    """Return whether this system tells what threads do."""
    own = os.getpid()
    return sys.platform == 'linux' and all(
        os.access(path.format(own, own), os.R_OK) for path in (NEWEST, STATE))


class Threads:
    """
    All threads of a process and its children; of this process those of the middleware.

    Parameters
    ----------
    pid : int
        Process id.

    """

    def __init__(self, pid: int) -> None:
        self._pid, self._own = pid, pid == os.getpid()
        self._files: Dict[Tuple[int, int], Tuple[int, int]] = {}  # its state, its children
        self._clocks: List[int] = []
        self.newest = b''  # thread of the machine when they were found

    def cpu_time(self) -> Tuple[int, ...]:
        """Return for how long [ns] they have run."""
        try:
            return tuple(map(time.clock_gettime_ns, self._clocks))
        except OSError:  # one has ended
            self.find()
            return ()

    def asleep(self) -> bool:
        """Return whether each slept when it was looked at."""
        for state, _ in self._files.values():
            try:
                text = os.pread(state, LENGTH, 0)
            except ProcessLookupError:  # it has ended
                continue
            if ASLEEP not in text and text[text.rindex(b')') + 2] in BUSY:
                return False
        return True

    def find(self) -> None:
        """Note which threads there are now."""
        found, processes = set(), [self._pid]
        while processes:
            pid = processes.pop()
            for thread in self._middleware() if self._own else _threads(pid):
                if (pid, thread) not in self._files:
                    self._open(pid, thread)
                if (pid, thread) in self._files:
                    found.add((pid, thread))
                    processes += [] if self._own else _read(self._files[pid, thread][1])
        for ended in {*self._files} - found:
            self._close(self._files.pop(ended))
        if self._own:
            self._clocks = [~thread << 3 | CPU_TIME_OF_THREAD for _, thread in found]
        else:
            self._clocks = [~pid << 3 | CPU_TIME for pid in {pid for pid, _ in found}]

    def _open(self, pid: int, thread: int) -> None:
        """Open the files of a thread that has not ended."""
        try:
            state = os.open(STATE.format(pid, thread), os.O_RDONLY)
        except OSError:
            return
        try:
            children = os.open(CHILDREN.format(pid, thread), os.O_RDONLY)
        except OSError:  # this kernel does not tell
            children = -1
        self._files[pid, thread] = state, children

    def _middleware(self) -> List[int]:
        """Return the threads of Fast DDS, or of another middleware: all that are not Python's."""
        python = {each.native_id for each in threading.enumerate()}
        others = [each for each in _threads(self._pid) if each not in python]
        return [each for each in others if _name(self._pid, each).startswith('dds.')] or others

    def close(self) -> None:
        """Look no more."""
        for files in self._files.values():
            self._close(files)
        self._files.clear()

    @staticmethod
    def _close(files: Tuple[int, int]) -> None:
        for file in files:
            if file >= 0:
                os.close(file)


def _read(children: int) -> List[int]:
    """Return the process ids in a file of children."""
    try:
        return [int(each) for each in os.pread(children, LENGTH, 0).split()]
    except OSError:  # it has ended, or this kernel does not tell
        return []


def _name(pid: int, thread: int) -> str:
    try:
        with open(f'/proc/{pid}/task/{thread}/comm', encoding='utf-8') as file:
            return file.read()
    except OSError:  # it has ended
        return ''


def _threads(pid: int) -> List[int]:
    try:
        return sorted(map(int, os.listdir(f'/proc/{pid}/task')))
    except OSError:  # it has ended
        return []


class Rest:
    """
    Tells that processes have handled all they heard, and this one all that they said.

    Parameters
    ----------
    executor : Executor
        Of the nodes of this process.

    """

    def __init__(self, executor: Executor) -> None:
        self._executor = executor
        # an EventsExecutor handles callbacks and tasks in the order in which they came
        self.can_tell = can_tell() and not isinstance(executor, SingleThreadedExecutor)
        self._own = Threads(os.getpid()) if self.can_tell else None
        self._newest = os.open(NEWEST, os.O_RDONLY) if self.can_tell else -1

    def reached(self, others: Sequence[Threads], deliver: Callable[[], None]) -> bool:
        """
        Return whether nothing was left to do; what there was in this process is done now.

        What that makes the nodes of this process say to each other is for ``deliver``.
        """
        while self.asleep([*others, self._own]):
            if not self._work_off():
                return True
            deliver()
        return False

    def asleep(self, groups: Sequence[Threads]) -> bool:
        """Return whether there was a moment at which all of these threads slept."""
        before = [each.cpu_time() for each in groups]
        if not all(each.asleep() for each in groups):
            return False
        newest = os.pread(self._newest, LENGTH, 0).rpartition(b' ')[2]
        outdated = [each for each in groups if each.newest != newest]
        for each in outdated:  # there may be more threads
            each.find()
            each.newest = newest
        if outdated or not all(each.asleep() for each in groups):
            return False
        return [each.cpu_time() for each in groups] == before

    def _work_off(self) -> bool:
        """Handle what waits to be handled in this process; return whether something did."""
        mark = self._executor.create_task(lambda: None)
        self._executor.spin_once(timeout_sec=0)
        if mark.done():
            return False
        while not mark.done():
            self._executor.spin_once(timeout_sec=0)
        return True

    def close(self) -> None:
        """Look no more."""
        if self._own:
            self._own.close()
            os.close(self._newest)
            self._own, self.can_tell = None, False
