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

"""Timers that the loop of a process fires by itself."""

from types import SimpleNamespace

from diffdrive_kinematics.ros.runtime import clocks
from diffdrive_kinematics.ros.runtime.clocks import (
    SetBack, SteadyTimers, SteppedClock, StepWatch, Timer)
from hypothesis import given, strategies as st
import pytest

MS = 10**6
S = 1000 * MS


@pytest.fixture
def steady(monkeypatch):
    """Yield a list of one time [ns], which the steady clock shows."""
    now = [1234567 * MS + 89]
    monkeypatch.setattr(clocks.time, 'monotonic_ns', lambda: now[0])
    return now


def test_timers_of_one_rate_fire_in_step_in_the_order_in_which_they_were_made(steady):
    timers, fired = SteadyTimers(), []
    start = steady[0]
    for name in 'abc':
        timers.create_timer(10 * MS, lambda name=name: fired.append((name, steady[0])))
        steady[0] += 3 * MS  # made at different times
    steady[0] = start + 10 * MS - 1
    timers.fire_due()
    assert fired == []
    steady[0] += 1
    timers.fire_due()
    assert fired == [(name, steady[0]) for name in 'abc']


def test_a_timer_fires_a_period_apart_and_skips_what_it_has_missed(steady):
    timers, fired = SteadyTimers(), []
    timer = timers.create_timer(10 * MS, lambda: fired.append(steady[0]))
    first = timer.next_ns
    assert steady[0] < first <= steady[0] + 10 * MS
    for late in (0, 1, 10 * MS + 5, 35 * MS):
        steady[0] = first + late
        timers.fire_due()
    assert fired == [first, first + 10 * MS + 5, first + 35 * MS]
    assert timer.next_ns == first + 40 * MS


@pytest.mark.parametrize('change', [Timer.cancel, Timer.reset])
def test_a_timer_that_another_one_of_its_step_cancels_or_resets_does_not_fire(change):
    clock, fired = SteppedClock(), []
    clock.create_timer(10 * MS, lambda: change(second))
    second = clock.create_timer(5 * MS, lambda: fired.append(clock.now_ns()))
    clock.advance_to(10 * MS)
    for timer in clock.due():
        clock.fire(timer)
    assert fired == []
    clock.advance_to(15 * MS)
    for timer in clock.due():
        clock.fire(timer)
    assert fired == ([15 * MS] if change is Timer.reset else [])


@given(st.lists(st.integers(1, 100 * MS), min_size=1, max_size=6))
def test_the_time_left_is_that_to_the_first_that_is_due(periods):
    """Whatever was fired before; where nothing is due it is the bound."""
    with pytest.MonkeyPatch.context() as patch:
        now = [77 * MS + 3]
        patch.setattr(clocks.time, 'monotonic_ns', lambda: now[0])
        timers = SteadyTimers()
        timers.fire_due()
        assert timers.seconds_left(0.1) == 0.1
        made = [timers.create_timer(period, lambda: None) for period in periods]
        for _ in range(5):
            due = min(timer.next_ns for timer in made)
            assert timers.seconds_left(1.0) == pytest.approx((due - now[0]) / 1e9, abs=1e-9)
            now[0] = due
            assert timers.seconds_left(1.0) == 0.0
            timers.fire_due()
            assert min(timer.next_ns for timer in made) > now[0]


def test_a_timer_that_is_reset_fires_a_period_after_that(steady):
    timers, fired = SteadyTimers(), []
    timer = timers.create_timer(10 * MS, lambda: fired.append(steady[0]))
    timer.reset()
    end = steady[0] + 10 * MS
    steady[0] = end - 1
    timers.fire_due()
    assert fired == [] and timers.seconds_left(1.0) == 1e-9
    steady[0] = end
    timers.fire_due()
    assert fired == [end]
    timer.timer_period_ns = 2 * MS
    timer.reset()
    steady[0] += 2 * MS
    timers.fire_due()
    assert fired == [end, steady[0]]


def test_a_timer_can_be_cancelled_and_another_made_while_timers_fire(steady):
    timers, fired = SteadyTimers(), []

    def replace():
        fired.append('first')
        second.cancel()
        first.cancel()
        timers.create_timer(10 * MS, lambda: fired.append('third'))

    first = timers.create_timer(10 * MS, replace)
    second = timers.create_timer(10 * MS, lambda: fired.append('second'))
    for _ in range(2):
        steady[0] += 10 * MS
        timers.fire_due()
    assert fired == ['first', 'third']
    assert 0.0 < timers.seconds_left(1.0) <= 0.01


def test_what_a_timer_raises_is_not_lost_and_does_not_stop_the_others(steady):
    timers, fired = SteadyTimers(), []

    def fail():
        raise RuntimeError('as it happens')

    timers.create_timer(10 * MS, fail)
    timers.create_timer(10 * MS, lambda: fired.append(steady[0]))
    steady[0] += 10 * MS
    with pytest.raises(RuntimeError):
        timers.fire_due()
    timers.fire_due()
    assert fired == [steady[0]]


class Clocks:
    """A wall clock and a steady one; between two looks at them the process may be held up."""

    def __init__(self, patch):
        self.wall, self.steady, self.held_up = 10**6 * S, 5 * S, 0
        patch.setattr(clocks.time, 'time_ns', self._look)
        patch.setattr(clocks.time, 'monotonic_ns', lambda: self.steady)
        handle = SimpleNamespace(get_ros_time_override_is_enabled=lambda: False)
        self.watch = StepWatch(SimpleNamespace(handle=handle), SetBack())
        self.watch.now_and_step()

    def _look(self):
        wall = self.wall
        self.pass_by(self.held_up)
        self.held_up = 0
        return wall

    def pass_by(self, time_ns):
        self.wall += time_ns
        self.steady += time_ns


@given(st.integers(-3600 * S, -10 * MS), st.integers(0, 40 * MS))
def test_a_wall_clock_that_is_set_back_by_however_little_is_a_step(step, passed):
    with pytest.MonkeyPatch.context() as patch:
        both = Clocks(patch)
        both.pass_by(passed)
        both.wall += step
        assert both.watch.now_and_step() == (both.wall, step)
        both.pass_by(passed)
        assert both.watch.now_and_step() == (both.wall, 0)


@given(st.integers(0, S // 4), st.integers(0, 3600 * S), st.floats(-0.1, 0.1))
def test_a_process_that_is_held_up_and_a_clock_that_is_slewed_are_no_step(
        held_up, passed, slewed):
    """Nor is time that the steady clock does not count, up to a second."""
    with pytest.MonkeyPatch.context() as patch:
        both = Clocks(patch)
        for _ in range(3):
            both.pass_by(passed)
            both.wall += round(slewed * min(passed, S))
            both.held_up = held_up
            assert both.watch.now_and_step()[1] == 0
        both.wall += S // 2
        assert both.watch.now_and_step()[1] == 0


@given(st.integers(1, 10**4), st.integers(1, 10**4))
def test_between_two_simulated_clocks_the_step_is_that_from_the_wall_clock(first, second):
    """What the first one had shown is of no account."""
    simulated, shown, told = [True], [first * S], SetBack()
    handle = SimpleNamespace(
        get_ros_time_override_is_enabled=lambda: simulated[0],
        get_now=lambda: SimpleNamespace(nanoseconds=shown[0]))
    told.note(first * S)
    watch = StepWatch(SimpleNamespace(handle=handle), told)
    watch.now_and_step()
    simulated[0] = False
    wall_ns, _ = watch.now_and_step()
    simulated[0], shown[0] = True, second * S
    told.note(second * S)
    assert watch.now_and_step() == (second * S, second * S - wall_ns)
    told.note(second * S - MS)
    shown[0] -= MS
    assert watch.now_and_step()[1] == -MS
