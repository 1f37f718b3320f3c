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

"""A robot that follows late and otherwise than told: by stamps alone, whenever messages come."""

from diffdrive_kinematics.core.noise import WheelSlip
from diffdrive_kinematics.core.odometry import (
    AnsweredMotion, ClockStep, SlipStream, Verdict, WheelSample)
from hypothesis import given, strategies as st
import numpy as np
import pytest

DELAY_NS, MS = 250_000_000, 1_000_000


def doubled(rates):
    """Return rates twice as large."""
    return 2.0 * rates[0], 2.0 * rates[1]


def angle_at(samples, time_ns):
    """Return the left angle of held rates up to a time."""
    ends = [each.stamp_ns for each in samples[1:]] + [time_ns]
    return sum(each.rates[0] * max(0, min(end, time_ns) - each.stamp_ns) / 1e9
               for each, end in zip(samples, ends) if each.stamp_ns < time_ns)


def heard(period_ms, end_ms=3000, delay_ns=DELAY_NS):
    """Return what is done of a command of 1 rad/s from 0.5 to 1.5 s, repeated at a period."""
    told, done = AnsweredMotion(doubled, delay_ns), []
    stamps = sorted({*range(0, end_ms + 1, period_ms), 500, 1500})
    for stamp in stamps:
        rate = 1.0 if 500 <= stamp < 1500 else 0.0
        told, due = told.update(WheelSample(stamp * MS, (rate, rate)))
        done += due
    return done


@pytest.mark.parametrize('period_ms', [10, 37, 100, 499])
def test_what_is_done_does_not_depend_on_how_often_it_is_told(period_ms):
    done = heard(period_ms)
    assert [each.stamp_ns for each in done] == sorted({each.stamp_ns for each in done})
    for time_ms in range(0, 2500, 50):
        expected = 2.0 * min(max(time_ms / 1e3 - 0.75, 0.0), 1.0)
        assert angle_at(done, time_ms * MS) == pytest.approx(expected, abs=1e-12)


def test_without_a_delay_it_is_done_at_once():
    assert [each.stamp_ns for each in heard(500, delay_ns=0)] == [
        each * MS for each in range(0, 3001, 500)]


def test_a_robot_rests_until_something_is_due():
    told, due = AnsweredMotion(doubled, DELAY_NS).update(WheelSample(0, (1.0, 1.0)))
    assert [each.rates for each in due] == [(0.0, 0.0)]
    _, due = told.update(WheelSample(DELAY_NS - 1, (1.0, 1.0)))
    assert due == []


def test_of_positions_alone_the_rates_between_them_are_done():
    told = AnsweredMotion(doubled, DELAY_NS)
    done = []
    for number in range(8):
        told, due = told.update(WheelSample(number * 500 * MS, None, (0.5 * number, 0.0)))
        done += due
    assert done[1].stamp_ns == DELAY_NS and done[1].rates == (2.0, 0.0)


def test_where_time_goes_back_what_waited_is_dropped():
    told, _ = AnsweredMotion(doubled, DELAY_NS).update(WheelSample(10**12, (1.0, 1.0)))
    told, due = told.update(WheelSample(5, (3.0, 3.0)))
    assert [(each.stamp_ns, each.rates) for each in due] == [(5, (0.0, 0.0))]
    assert [each.rates for each in told.waiting] == [(6.0, 6.0)]


def rolled_by(samples):
    """Return the left angle that comes of samples, in the order in which they came."""
    stream = SlipStream((0.1, 0.1), WheelSlip(), WheelSlip(), None)
    generator = np.random.default_rng(1)
    for sample in samples:
        stream, _, verdict = stream.apply(sample, generator)
        assert verdict is not Verdict.CLOCK_STEP
    return stream.left.value


@given(st.lists(
    st.tuples(st.integers(-90, 60), st.sampled_from([0.0, 1.0, 1.0, 1.0, 2.0])), max_size=30))
def test_a_command_that_was_overtaken_takes_no_other_one_with_it(steps):
    """One stamped among repeats takes the place of those after it, one before them comes late."""
    told, newest_ms = [WheelSample(0, (0.0, 0.0))], 0
    for step, rate in steps:
        stamp_ms = max(told[-1].stamp_ns // MS + 10 * step, newest_ms - 900, 1)
        newest_ms = max(newest_ms, stamp_ms)
        told.append(WheelSample(stamp_ms * MS, (rate, 0.0)))
    told += [WheelSample((newest_ms + 1000 * number) * MS, (0.0, 0.0)) for number in (1, 2)]
    motion, done = AnsweredMotion(doubled, DELAY_NS), []
    for sample in told:
        motion, due = motion.update(sample)
        done += due
    assert rolled_by(done) == pytest.approx(2.0 * rolled_by(told), abs=1e-9)


def test_positions_that_were_overtaken_change_nothing():
    done = {}
    for stamps in ([0, 500, 1000, 1500, 2000], [0, 500, 1000, 900, 1500, 2000]):
        told, done[len(stamps)] = AnsweredMotion(doubled, DELAY_NS), []
        for stamp in stamps:
            told, due = told.update(WheelSample(stamp * MS, None, (1e-3 * stamp, 0.0)))
            done[len(stamps)] += due
    assert done[5] == done[6]


@pytest.mark.parametrize('other_ns', [0, 40 * MS, 150 * MS, 600 * MS])
@pytest.mark.parametrize('at_ms', range(100, 1900, 170))
def test_another_delay_on_the_way_keeps_the_order_of_what_is_done(at_ms, other_ns):
    told, done = AnsweredMotion(doubled, DELAY_NS), []
    for stamp in range(0, 4000, 20):
        if at_ms <= stamp < at_ms + 20:
            told = told.configured(AnsweredMotion(doubled, other_ns))
        rate = 1.0 if 500 <= stamp < 1500 else 0.0
        told, due = told.update(WheelSample(stamp * MS, (rate, rate)))
        done += due
    stamps = [each.stamp_ns for each in done]
    assert stamps == sorted(set(stamps))
    rates = [each.rates[0] for each in done]
    assert sum(one != other for one, other in zip(rates, rates[1:])) == 2
    assert done[-1].rates == (0.0, 0.0)


@pytest.mark.parametrize('step_ms', [-3_600_000, -500, -50, 5000])
@pytest.mark.parametrize('cut', [1, 9, 40])
def test_a_step_of_the_clock_that_is_known_changes_nothing_but_the_stamps(step_ms, cut):
    told, done = AnsweredMotion(doubled, DELAY_NS), []
    for number in range(61):
        if number == cut:
            told = told.clock_stepped(ClockStep(step_ms * MS, ((number - 1) * 50 + step_ms) * MS))
        rate = 1.0 if 10 <= number < 30 else 0.0
        passed_ms = 0 if number < cut else step_ms
        told, due = told.update(WheelSample((number * 50 + passed_ms) * MS, (rate, rate)))
        done += [(each.stamp_ns - passed_ms * MS, each.rates) for each in due]
    assert done == [(each.stamp_ns, each.rates) for each in heard(50)]
