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

"""Processes under test: started, watched, and ended whatever happens."""

from contextlib import suppress
import os
from pathlib import Path
import signal
import subprocess
import tempfile
import time
from typing import Dict, List, Mapping, Optional, Sequence, Set

from diffdrive_kinematics.testing.at_rest import can_tell, Threads
from rclpy.utilities import get_rmw_implementation_identifier

__all__ = ['environment_of', 'on_this_machine', 'Process', 'ProcessFailed', 'RANGE', 'sleepless']

RANGE = 'ROS_AUTOMATIC_DISCOVERY_RANGE'
PROFILE = str(Path(__file__).with_name('this_machine.xml'))
PROFILES = 'FASTRTPS_DEFAULT_PROFILES_FILE', 'FASTDDS_DEFAULT_PROFILES_FILE'  # Jazzy, Kilted
PATIENCE_S = 3.0
LINES, LENGTH = 40, 500
LOOKS, LOOK_S = 100, 0.02


class ProcessFailed(AssertionError):
    """A process under test ended with an error, or does not answer."""


class Process:
    """
    A process under test.

    Parameters
    ----------
    command : sequence of str
        What to run; ``--ros-args -p use_sim_time:=true`` is added.
    environment : mapping
        Variables to set.
    lockstep : bool
        Whether it acknowledges each step (``diffdrive_kinematics.testing.spin``).
    restless : bool
        Whether one of its threads works all the time, so that nothing is to be learnt from it.

    """

    def __init__(
            self, command: Sequence[str], environment: Mapping[str, str], *, lockstep: bool,
            restless: bool = False) -> None:
        self.name = ' '.join(Path(word).name for word in command)  # in errors
        self.lockstep, self.restless = lockstep, restless
        self.nodes: Set[str] = set()
        self._to_end, self._patience_s = False, PATIENCE_S
        self._file = tempfile.TemporaryFile(mode='w+', encoding='utf-8', errors='replace')
        self._popen = subprocess.Popen(
            [*command, '--ros-args', '-p', 'use_sim_time:=true'], stdin=subprocess.DEVNULL,
            stdout=self._file, stderr=subprocess.STDOUT, start_new_session=True,
            env={**os.environ, **environment})
        self.threads = Threads(self.pid) if can_tell() else None

    @property
    def pid(self) -> int:
        """Return its process id."""
        return self._popen.pid

    @property
    def running(self) -> bool:
        """Return whether it has not ended."""
        return self._popen.poll() is None

    @property
    def status(self) -> Optional[int]:
        """Return its exit status; None: it runs."""
        return self._popen.poll()

    @property
    def output(self) -> str:
        """Return what it has written so far."""
        self._file.seek(0)
        return self._file.read()

    def check(self) -> None:
        """Raise ``ProcessFailed``, once, if it has ended with an error, and was not to end."""
        if self.status and not self._to_end:
            self._to_end = True
            raise ProcessFailed(self.describe(f'ended with status {self.status}'))

    def await_end(self) -> None:
        """Wait a while, once, for its end, as none of its nodes is there any more."""
        patience, self._patience_s = self._patience_s, 0.0  # it may go on without them
        with suppress(subprocess.TimeoutExpired):
            self._popen.wait(patience)

    def describe(self, what: str = '') -> str:
        """Return its name, what is wrong with it or whether it runs, and its last output."""
        what = what or ('runs' if self.running else f'has ended with status {self.status}')
        lines = self.output.splitlines()[-LINES:]
        return '\n'.join([f'{self.name} {what}; its output ends:', *(
            line if len(line) <= LENGTH else f'...{line[-LENGTH:]}' for line in lines)])

    def kill(self) -> None:
        """End it at once, as a crash does."""
        self._end(signal.SIGKILL)

    def stop(self) -> None:
        """End it as Ctrl-C does, and harder where that does not help."""
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGKILL):
            if self._end(number):
                return

    def close(self) -> None:
        """End it and its children, and forget its output."""
        self._to_end = True
        self.stop()
        self._signal(signal.SIGKILL)
        self._file.close()
        if self.threads:
            self.threads.close()

    def _end(self, number: int) -> bool:
        if self.running:
            self._to_end = True
            self._signal(number)
        try:
            self._popen.wait(PATIENCE_S)
        except subprocess.TimeoutExpired:
            return False
        return True

    def _signal(self, number: int) -> None:
        try:
            os.killpg(self._popen.pid, number)
        except ProcessLookupError:
            pass


def environment_of(domain: int) -> Dict[str, str]:
    """Return the variables of a process in a domain that is heard on this machine only."""
    return {'ROS_DOMAIN_ID': str(domain), 'PYTHONUNBUFFERED': '1',
            'RCUTILS_COLORIZED_OUTPUT': '0', **on_this_machine()}


def on_this_machine() -> Dict[str, str]:
    """Return the variables of a process that talks on this machine only; not by shared memory."""
    if get_rmw_implementation_identifier().startswith('rmw_fastrtps'):
        # the profile says it all; the range LOCALHOST would bring shared memory back
        return {RANGE: 'SYSTEM_DEFAULT', **dict.fromkeys(PROFILES, PROFILE)}
    return {RANGE: 'LOCALHOST'}


def sleepless(processes: List[Process]) -> List[Process]:
    """Return those that sleep at no look; one that only has to do at times is none of them."""
    for _ in range(LOOKS):
        if len(processes) < 2:
            break
        processes = [each for each in processes if not each.threads.asleep()]
        time.sleep(LOOK_S)
    return processes
