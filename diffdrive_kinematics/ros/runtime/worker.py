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
Work that takes longer than a tick, done beside the loop of a process, the newest only.

It is done in a process of its own: in a thread, Python code takes turns with that of the loop,
which delayed a controller by up to 40 ms.  That process starts with the first request and ends
when none has come for a while; it imports what the requests name, and no ROS.
"""

from collections import deque
import os
import pickle
import signal
import subprocess
import sys
import threading
from typing import Any, BinaryIO, Callable, Deque, Optional, Tuple

IDLE_S = 30.0
RESTART_S = 1.0
NICENESS = 10
CHILD = 'from diffdrive_kinematics.ros.runtime.worker import answer_all; answer_all()'

Request = Tuple[Callable[..., Any], Tuple[Any, ...]]
Answer = Tuple[Any, str]
Deliver = Callable[[Any, Any, str], None]


class InPlace:
    """Does the work at once, where time waits for it."""

    skipped = 0

    def __init__(self, deliver: Deliver) -> None:
        self._deliver = deliver

    def ask(self, tag: Any, function: Callable[..., Any], *arguments: Any) -> None:
        """Call ``function``, and deliver what it returns; see :class:`Worker`."""
        self._deliver(tag, *_answer_to((function, arguments)))

    def close(self) -> None:
        """Do nothing: nothing is going on."""


class Worker:
    """
    Does the work in a process of its own, one request at a time.

    A request that waits gives way to a newer one.  Whatever goes wrong ends in an error that is
    delivered, be it that the process is killed: the next request finds another one.

    Parameters
    ----------
    deliver :
        Is called in a thread with the tag of a request, the result, and an error in words, which
        is empty where all went well.

    """

    def __init__(self, deliver: Deliver) -> None:
        self._deliver = deliver
        self._waiting: Deque[Tuple[Any, Request]] = deque(maxlen=1)
        self._wake = threading.Event()
        self._closing = threading.Event()
        self._starting = threading.Lock()
        self._thread: Optional[threading.Thread] = None
        self._process: Optional['subprocess.Popen[bytes]'] = None
        self.skipped = 0

    def ask(self, tag: Any, function: Callable[..., Any], *arguments: Any) -> None:
        """
        Have ``function`` called with arguments; returns at once.

        The function is one of a module, and can be pickled as its arguments and its result can.
        """
        self.skipped += len(self._waiting)
        self._waiting.append((tag, (function, arguments)))
        self._wake.set()
        if self._thread is None:
            self._thread = threading.Thread(target=self._work, name='worker', daemon=True)
            self._thread.start()

    def close(self) -> None:
        """End what is going on; nothing is delivered after this."""
        self._closing.set()
        self._wake.set()
        with self._starting:
            if self._process:
                self._process.kill()
        if self._thread:
            self._thread.join()

    def _work(self) -> None:
        """Hand on requests and answers until closed."""
        while not self._closing.is_set():
            if not self._wake.wait(IDLE_S):
                self._end()
                continue
            self._wake.clear()
            if not self._waiting:
                continue
            tag, request = self._waiting.pop()
            result, error = self._answer(request)
            if not self._closing.is_set():
                self._deliver(tag, result, error)
            if self._process is None:
                self._closing.wait(RESTART_S)
        self._end()

    def _answer(self, request: Request) -> Answer:
        try:
            process = self._started()
            assert process.stdin and process.stdout
            pickle.dump(request, process.stdin)
            process.stdin.flush()
            answer: Answer = pickle.load(process.stdout)
            return answer
        except Exception as error:  # whatever it is, the thread goes on
            status = self._end()
            return None, f'the worker process ended with status {status} ({error!r})'

    def _started(self) -> 'subprocess.Popen[bytes]':
        """Return the process; it finds modules where this one does."""
        with self._starting:
            if self._closing.is_set():
                raise EOFError('it is to end')
            if self._process is None:
                self._process = subprocess.Popen(
                    [sys.executable, '-c', CHILD], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                    env={**os.environ, 'PYTHONPATH': os.pathsep.join(filter(None, sys.path)),
                         'PYTHONSAFEPATH': '1', 'OPENBLAS_NUM_THREADS': '1'},
                    start_new_session=True)  # Ctrl-C is for this process, which ends that one
            return self._process

    def _end(self) -> Optional[int]:
        """End the process; return its exit status."""
        with self._starting:
            process, self._process = self._process, None
        if process is None:
            return None
        process.kill()
        with process:
            try:
                process.stdin.close()  # type: ignore[union-attr]
            except OSError:  # what was not written yet stays unwritten
                pass
        return process.returncode


def answer_all() -> None:
    """Answer the requests that come in, until no more can; what a worker's process does."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    os.nice(NICENESS)
    requests: BinaryIO = sys.stdin.buffer
    answers: BinaryIO = sys.stdout.buffer
    sys.stdout = sys.stderr
    try:
        while True:
            pickle.dump(_answer_to(pickle.load(requests)), answers, pickle.HIGHEST_PROTOCOL)
            answers.flush()
    except (EOFError, BrokenPipeError):
        os._exit(0)  # the other end is gone: there is nobody to tell


def _answer_to(request: Request) -> Answer:
    function, arguments = request
    try:
        return function(*arguments), ''
    except ValueError as error:
        return None, str(error)
    except Exception as error:  # whatever it is, it ends neither process
        return None, f'{type(error).__name__}: {error}'
