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

"""How old a message is, by clocks of senders that are known only by what they send."""

from diffdrive_kinematics.core.odometry import REMEMBERED_NS, SenderClocks
from hypothesis import given, strategies as st
import pytest

MS = 10**6
S = 10**9
TIMEOUT = S // 2
CLOCKS = SenderClocks(TIMEOUT)
offsets = st.integers(-10**9 * S, 10**9 * S)


def sent(clocks, offset, begin, end, period=50 * MS, latency=MS):
    """Return the clocks and ages after messages that are sent steadily and come at once."""
    ages = []
    for time in range(begin, end, period):
        clocks, age = clocks.update(offset + latency, time)
        ages.append(age)
    return clocks, ages


@given(st.integers(0, 10**6 * S))
def test_a_message_of_a_sender_on_the_own_clock_is_as_old_as_its_latency(latency):
    assert CLOCKS.update(latency, 0)[1] == latency


@given(offsets)
def test_what_is_sent_steadily_by_another_clock_is_alive_after_a_while(offset):
    ages = sent(CLOCKS, offset, 0, 2 * S)[1]
    assert all(age <= TIMEOUT for age in ages[7:])
    if offset < 0:
        assert all(age <= TIMEOUT for age in ages)


@given(offsets | st.integers(-20 * S, 20 * S), st.integers(1, 10), st.integers(0, 60 * MS))
def test_a_burst_of_a_queue_is_old_whatever_the_clock_of_its_sender(offset, count, gap):
    clocks = sent(CLOCKS, offset, 0, 12 * S + REMEMBERED_NS)[0]
    arrival, stopped = 30 * S, 5 * S
    for number in range(count):
        latency = offset + stopped - number * gap
        clocks, age = clocks.update(latency, arrival + number * MS)
        assert age == pytest.approx(stopped - number * gap, abs=TIMEOUT // 2 + 2 * MS)


def test_a_burst_that_comes_first_is_old_where_its_sender_is_on_the_own_clock():
    clocks = CLOCKS
    for number in range(10):
        clocks, age = clocks.update(3 * S - number * 50 * MS, number)
        assert age > TIMEOUT


@given(st.lists(offsets, min_size=2, max_size=3))
def test_senders_whose_clocks_differ_are_alive_side_by_side(many):
    clocks = CLOCKS
    for time in range(0, 4 * S, 50 * MS):
        for offset in many:
            clocks, age = clocks.update(offset + MS, time)
            assert age <= TIMEOUT or time < 3 * S


@pytest.mark.slow
@pytest.mark.parametrize('parts_per_million', [-100, -20, 20, 100])
def test_clocks_that_drift_apart_for_a_day_cost_no_message(parts_per_million):
    clocks, worst = CLOCKS, 0
    for time in range(0, 86_400 * S, 200 * MS):
        clocks, age = clocks.update(MS + time * parts_per_million // 10**6, time)
        worst = max(worst, age)
    assert worst <= TIMEOUT


@pytest.mark.parametrize('step', [-3600 * S, 3600 * S])
@pytest.mark.parametrize('follows', [False, True])
def test_a_step_of_the_own_clock_makes_no_message_old_whether_senders_step_with_it_or_not(
        step, follows):
    for offset in (0, 7 * S):
        clocks = sent(CLOCKS, offset, 0, 2 * S)[0].clock_stepped(step)
        assert max(sent(clocks, offset if follows else offset + step, 2 * S, 4 * S)[1]) <= TIMEOUT


def test_old_messages_that_come_rarely_teach_no_clock():
    clocks = CLOCKS
    for time in range(0, 100 * S, 10 * S):
        clocks, age = clocks.update(3 * S, time)
        assert age == 3 * S


@given(st.lists(st.tuples(offsets, st.integers(0, 10**10)), max_size=40))
def test_whatever_comes_a_few_clocks_are_kept_and_one_of_them_is_known(messages):
    clocks, time = CLOCKS, 0
    for latency, gap in messages:
        time += gap
        clocks, age = clocks.update(latency, time)
        for each in clocks, clocks.clock_stepped(latency):
            assert any(clock.known for clock in each.clocks) and len(each.clocks) <= 8
        assert age >= 0
