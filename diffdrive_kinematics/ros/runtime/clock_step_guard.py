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
Wakes an executor that waits on a wall clock which was stepped back.

A wait of the middleware is for a time on the steady clock.  Where its C++ library was built for a
glibc before 2.30, as in wheels for pip, it waits for that time on the wall clock instead: one that
is stepped back by an hour would hold up timers, and the end of a command, for an hour.  Elsewhere
there is nothing to guard.
"""

from functools import lru_cache
import mmap
from pathlib import Path
import re
import threading
import time

from rclpy.executors import Executor

WAITING_LIBRARIES = re.compile(r'/[^/]*(rmw|_rclpy)[^/]*\.so[^/]*$')
ON_WALL_CLOCK, ON_STEADY_CLOCK = b'pthread_cond_timedwait', b'pthread_cond_clockwait'

LOOK_PERIOD_S = 0.2
STEP_NS = 100_000_000  # less than that does not hold up much


class ClockStepGuard:
    """Context in which the timers of an executor go on whatever happens to the wall clock."""

    def __init__(self, executor: Executor) -> None:
        self._executor = executor
        self._over = False
        self._thread = threading.Thread(target=self._look, daemon=True) if _is_needed() else None

    def __enter__(self) -> 'ClockStepGuard':
        if self._thread:
            self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._over = True
        if self._thread:
            self._thread.join()

    def _look(self) -> None:
        """Compare the clocks now and then; a sleep is not held up, unlike a wait."""
        difference = _difference()
        while not self._over:
            time.sleep(LOOK_PERIOD_S)
            before, difference = difference, _difference()
            if difference < before - STEP_NS:
                self._executor.create_task(lambda: None)  # to have it to do ends the wait


def waits_on_wall_clock(library: Path) -> bool:
    """Return whether a library names the old wait and not the one for the steady clock."""
    with library.open('rb') as file, mmap.mmap(file.fileno(), 0, prot=mmap.PROT_READ) as data:
        return data.find(ON_WALL_CLOCK) >= 0 and data.find(ON_STEADY_CLOCK) < 0


@lru_cache(maxsize=None)
def _is_needed() -> bool:
    """Return whether rclpy or the middleware of this process waits on the wall clock."""
    try:
        files = {line.split()[-1] for line in Path('/proc/self/maps').read_text().splitlines()
                 if WAITING_LIBRARIES.search(line)}
        return any(waits_on_wall_clock(Path(file)) for file in files)
    except OSError:  # not to be found out
        return True


def _difference() -> int:
    return time.time_ns() - time.monotonic_ns()
