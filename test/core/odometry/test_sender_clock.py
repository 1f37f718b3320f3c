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

"""The clock of a sender: what latencies say of it, and what a stall must not."""

from diffdrive_kinematics.core.odometry import SenderClock
from diffdrive_kinematics.core.odometry.sender_clock import HYSTERESIS
from hypothesis import example, given, strategies as st
import pytest

MS = 1_000_000
S = 1000 * MS
TOLERANCE = S // 4
PERIOD = 20 * MS
NOW = 1_700_000_000 * S
FRESH = SenderClock(TOLERANCE)
offsets = st.integers(-10**10 * S, 10**10 * S)


def heard(latencies, clock=FRESH, start_ns=NOW, period_ns=PERIOD):
    """Return the clock after messages with latencies, one a period, and when the last came."""
    arrival_ns = start_ns
    for number, latency in enumerate(latencies):
        arrival_ns = start_ns + number * period_ns
        clock = clock.observed(arrival_ns - latency, arrival_ns)
    return clock, arrival_ns


@given(st.lists(st.integers(-TOLERANCE, TOLERANCE), min_size=1, max_size=200))
def test_the_stamps_of_a_clock_within_the_tolerance_are_taken_as_they_are(latencies):
    clock, now_ns = heard(latencies)
    assert not clock.apart and not clock.differs
    assert clock.own_ns(now_ns) == clock.theirs_ns(now_ns) == now_ns


@given(offsets.filter(lambda offset: abs(offset) > TOLERANCE + S), st.lists(
    st.integers(0, 50 * MS), min_size=60, max_size=200))
def test_another_clock_is_known_at_once_and_steady_after_a_while_and_its_offset_is_found(
        offset, ways):
    assert heard([offset])[0].apart and not heard([offset])[0].differs
    clock, _ = heard([offset + way for way in ways])
    assert clock.apart and clock.differs
    found = clock.offset_ns - offset
    assert min(ways) <= found <= min(ways) + len(ways) * PERIOD // 100
    assert clock.own_ns(clock.theirs_ns(NOW)) == NOW


@pytest.mark.parametrize('offset', [-5 * S, 3 * S // 5, 1_700_000_000 * S])
def test_what_came_later_than_the_fastest_is_a_delay_whatever_the_clock(offset):
    clock, now_ns = heard([offset] * 100)
    for delay in 0, 7 * MS, 900 * MS:
        assert clock.delay_ns(now_ns - offset - delay, now_ns) == delay
    assert FRESH.delay_ns(NOW - 3, NOW) == 3


@pytest.mark.parametrize('stall', [S // 2, 3 * S, 60 * S])
@pytest.mark.parametrize('offset', [0, 5 * S])
def test_a_stall_and_the_burst_at_its_end_change_no_clock(stall, offset):
    clock, now_ns = heard([offset] * 100)
    end_ns = now_ns + stall
    for stamp in range(now_ns + PERIOD, end_ns + 1, PERIOD):
        clock = clock.observed(stamp - offset, end_ns)
    assert abs(clock.offset_ns - offset) <= stall // 1000
    assert clock.apart == bool(offset)


@pytest.mark.parametrize('offset', [0, 5 * S, -5 * S])
def test_a_latency_that_has_grown_for_good_is_found_after_a_while(offset):
    clock, now_ns = heard([offset] * 100)
    grown, end_ns = heard([offset + 600 * MS] * 40, clock, now_ns + PERIOD)
    assert abs(grown.offset_ns - offset) <= end_ns - now_ns, 'not yet'
    grown, _ = heard([offset + 600 * MS] * 20, grown, end_ns + PERIOD)
    assert grown.offset_ns == pytest.approx(offset + 600 * MS, abs=MS)


@pytest.mark.parametrize('offset', [0, 5 * S, -5 * S])
def test_a_latency_that_has_fallen_is_found_at_once(offset):
    clock, now_ns = heard([offset] * 100)
    fallen = clock.observed(now_ns + PERIOD - offset + 2 * S, now_ns + PERIOD)
    assert fallen.offset_ns == offset - 2 * S


@pytest.mark.parametrize('back', [0, 5 * S, -5 * S])
def test_a_clock_that_was_set_back_is_found_at_once_where_it_was_another(back):
    clock, now_ns = heard([-3600 * S] * 3)
    clock = clock.observed(now_ns - back, now_ns)
    assert clock.offset_ns == back
    assert not clock.differs


@given(st.integers(-5000, 5000), st.sampled_from([-7 * S, 7 * S]))
def test_a_drift_of_the_clocks_is_followed_and_mapped_time_goes_on(drift_ppm, offset):
    clock, before = FRESH, None
    for number in range(3000):
        arrival = NOW + number * PERIOD
        latency = offset + number * PERIOD * drift_ppm // 10**6
        clock = clock.observed(arrival - latency - number % 5 * MS, arrival)
        assert before is None or clock.theirs_ns(arrival) > before
        before = clock.theirs_ns(arrival)
        assert abs(clock.offset_ns - latency) <= 5 * MS


@given(st.lists(st.integers(0, 400 * MS), min_size=1, max_size=80), offsets,
       st.integers(-3600 * S, 3600 * S))
@example([225 * MS + 1], 25 * MS, 1)  # that nanosecond keeps them apart
def test_a_step_of_the_own_clock_is_none_of_the_senders(ways, offset, step):
    latencies = [offset + way for way in ways]
    clock, now_ns = heard(latencies)
    stepped = clock.clock_stepped(step)
    assert (stepped.apart, stepped.differs) == (clock.apart, clock.differs)
    shift = step if clock.apart else 0
    assert stepped.offset_ns == clock.offset_ns + shift
    later = now_ns + PERIOD
    going_on = clock.observed(later - offset, later)
    after = stepped.observed(later - offset + step - shift, later + step)
    assert after.least_ns == going_on.least_ns + shift
    if clock.apart:  # a step may part them further, or bring them close
        assert after.apart == (abs(after.least_ns) > TOLERANCE // HYSTERESIS)
    if after.apart == going_on.apart:
        assert after.differs == going_on.differs
    else:
        assert clock.apart


def test_clocks_agree_again_only_where_they_come_close():
    clock, now_ns = heard([S] * 100)
    near, now_ns = heard([TOLERANCE // 2] * 10, clock, now_ns + PERIOD)
    assert near.apart and near.offset_ns == pytest.approx(TOLERANCE // 2, abs=MS)
    assert not heard([0], near, now_ns + PERIOD)[0].apart


def test_a_message_that_teaches_nothing_costs_no_new_value():
    clock, now_ns = heard([MS] * 3)
    assert clock.observed(now_ns - 2 * MS, now_ns) is clock
