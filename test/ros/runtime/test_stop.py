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

"""How a process that is busy is asked to stop."""

import os
import signal

from diffdrive_kinematics.ros.runtime.running import Interrupted, Stop
from diffdrive_kinematics.ros.runtime.signals import SIGNALS
import pytest


@pytest.fixture
def stop():
    """Yield a Stop, and give the signals back to who had them."""
    before = [(number, signal.getsignal(number)) for number in SIGNALS]
    try:
        yield Stop()
    finally:
        for number, handler in before:
            signal.signal(number, handler)


@pytest.mark.parametrize('number', SIGNALS)
def test_work_is_interrupted_wherever_it_is_and_only_while_it_may_be(stop, number):
    with pytest.raises(Interrupted) as interrupted:
        with stop.interrupting():
            os.kill(os.getpid(), number)
            sum(range(10**8))
    assert interrupted.value.status == 128 + number and stop
    os.kill(os.getpid(), number)  # nothing is raised from here on
    with pytest.raises(Interrupted):
        with stop.interrupting():
            raise AssertionError('what was asked for before counts too')


def test_work_after_a_signal_is_interrupted_by_the_next_one(stop):
    os.kill(os.getpid(), signal.SIGINT)
    with pytest.raises(Interrupted):
        with stop.interrupting(after=signal.SIGINT):
            assert stop.number == signal.SIGINT
            os.kill(os.getpid(), signal.SIGINT)
            sum(range(10**8))


@pytest.mark.parametrize('ignored', [False, True])
def test_a_terminal_that_is_closed_ends_it_unless_it_is_to_outlive_that(ignored):
    """As with nohup."""
    before = [(number, signal.getsignal(number)) for number in SIGNALS]
    try:
        signal.signal(signal.SIGHUP, signal.SIG_IGN if ignored else signal.SIG_DFL)
        stop = Stop()
        os.kill(os.getpid(), signal.SIGHUP)
        assert bool(stop) is not ignored
    finally:
        for number, handler in before:
            signal.signal(number, handler)
