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

"""Work beside the loop: the newest only, whatever goes wrong with it, and an end at any time."""

import os
import signal
import threading
import time

from diffdrive_kinematics.ros.runtime import worker as module
from diffdrive_kinematics.ros.runtime.worker import InPlace, Worker
import pytest

DEADLINE_S = 60.0


class Desk:
    """A worker, and what it delivers."""

    def __init__(self, make=Worker):
        self.delivered, self._news = [], threading.Condition()
        self.worker = make(self._take)

    def _take(self, *what):
        with self._news:
            self.delivered.append((*what, threading.current_thread()))
            self._news.notify_all()

    def results(self, number):
        """Wait until so many answers have come; return them as (tag, result, error)."""
        with self._news:
            assert self._news.wait_for(lambda: len(self.delivered) >= number, DEADLINE_S)
            return [each[:3] for each in self.delivered]

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.worker.close()


def ended(pid):
    """Return whether a process is gone: one that was waited for is no zombie either."""
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return True
    return False


def wait_until(condition):
    deadline = time.monotonic() + DEADLINE_S
    while not condition():
        assert time.monotonic() < deadline
        os.sched_yield()


@pytest.mark.parametrize('make', [Worker, InPlace])
def test_what_a_function_returns_is_delivered_with_the_tag_of_its_request(make):
    with Desk(make) as desk:
        desk.worker.ask('a', divmod, 7, 2)
        assert desk.results(1) == [('a', (3, 1), '')]


def test_the_work_is_done_in_another_process_that_knows_no_ros():
    with Desk() as desk:
        desk.worker.ask('pid', os.getpid)
        assert desk.results(1)[0][1] != os.getpid()
        desk.worker.ask('ros', eval, "'rclpy' in __import__('sys').modules")
        assert desk.results(2)[1] == ('ros', False, '')


def test_of_what_waits_only_the_newest_is_done():
    with Desk() as desk:
        desk.worker.ask('slow', time.sleep, 0.5)
        wait_until(lambda: not desk.worker._waiting)
        for number in range(5):
            desk.worker.ask(number, int, number)
        assert [tag for tag, _, _ in desk.results(2)] == ['slow', 4]
        assert desk.worker.skipped == 4


@pytest.mark.parametrize('make', [Worker, InPlace])
@pytest.mark.parametrize(('request_', 'words'), [
    ((int, 'x'), 'invalid literal'), ((divmod, 1, 0), 'ZeroDivisionError: ')])
def test_an_exception_of_the_work_is_delivered_in_words_and_the_next_request_is_done(
        make, request_, words):
    with Desk(make) as desk:
        desk.worker.ask('bad', *request_)
        assert words in desk.results(1)[0][2]
        desk.worker.ask('good', int, '5')
        assert desk.results(2)[1] == ('good', 5, '')


@pytest.mark.slow
def test_a_process_that_is_killed_is_reported_and_another_one_takes_its_place():
    with Desk() as desk:
        desk.worker.ask('pid', os.getpid)
        pid = desk.results(1)[0][1]
        os.kill(pid, signal.SIGKILL)
        desk.worker.ask('killed', int)
        assert 'status -9' in desk.results(2)[1][2]
        desk.worker.ask('again', os.getpid)
        assert desk.results(3)[2][1] not in (None, pid)


@pytest.mark.slow
def test_a_request_that_cannot_be_sent_is_reported_and_the_next_one_is_done():
    with Desk() as desk:
        desk.worker.ask('bad', lambda: 1)
        assert desk.results(1)[0][2]
        desk.worker.ask('good', int)
        assert desk.results(2)[1] == ('good', 0, '')


@pytest.mark.parametrize('asked', [False, True])
def test_a_worker_closes_while_it_works_and_leaves_neither_thread_nor_process(asked):
    with Desk() as desk:
        if asked:
            desk.worker.ask('pid', os.getpid)
            pid = desk.results(1)[0][1]
            desk.worker.ask('long', time.sleep, 1000.0)
            wait_until(lambda: not desk.worker._waiting)
        began = time.monotonic()
    assert time.monotonic() - began < 100.0
    assert not [each for each in threading.enumerate() if each.name == 'worker']
    assert not asked or ended(pid)
    assert len(desk.delivered) == asked


def test_a_worker_that_is_closed_at_once_has_not_begun_and_does_not():
    with Desk() as desk:
        desk.worker.ask('a', int)
    assert not [each for each in threading.enumerate() if each.name == 'worker']


def test_a_worker_that_nobody_asks_ends_its_process_and_starts_another_when_asked(monkeypatch):
    monkeypatch.setattr(module, 'IDLE_S', 0.01)
    with Desk() as desk:
        desk.worker.ask('pid', os.getpid)
        pid = desk.results(1)[0][1]
        wait_until(lambda: ended(pid))
        desk.worker.ask('again', os.getpid)
        assert desk.results(2)[1][1] not in (None, pid)
