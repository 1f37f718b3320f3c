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

"""Wheel motion over time: the anchor, the last stamp, the timeout and the baseline."""

from dataclasses import replace
from itertools import accumulate
import math

from diffdrive_kinematics.core.kinematics import LARGEST
from diffdrive_kinematics.core.odometry import (
    baseline, rates_at, rolled, shifted, step_tolerance, timeout_from_seconds, update_motion,
    Verdict, WheelSample)
from diffdrive_kinematics.core.odometry.wheel_track import WheelTrack
from hypothesis import given, strategies as st
import pytest

MS = 1_000_000
S = 1000 * MS
T = S // 2
NOW = 100 * S
A, B, STILL = (1.0, 2.0), (3.0, -4.0), (0.0, 0.0)
pairs = st.tuples(st.floats(-10.0, 10.0), st.floats(-10.0, 10.0))
gaps = st.integers(1, 400 * MS)
schedules = st.lists(st.tuples(gaps, pairs), min_size=1, max_size=12)


def stamped(schedule):
    """Return samples of rates at the sums of the gaps."""
    stamps = accumulate(gap for gap, _ in schedule)
    return [WheelSample(stamp, rates) for stamp, (_, rates) in zip(stamps, schedule)]


def play(samples, timeout_ns=T, now_ns=NOW):
    """Return the motion after the samples, the angle rolled up to its anchor, the verdicts."""
    motion, verdicts = baseline(samples[0]), []
    left = right = 0.0
    for sample in samples[1:]:
        result = update_motion(motion, sample, now_ns=now_ns, timeout_ns=timeout_ns)
        motion = result.motion
        left, right = left + result.rolled[0], right + result.rolled[1]
        verdicts.append(result.verdict)
    return motion, (left, right), verdicts


def angle_at(samples, time_ns, timeout_ns=T):
    motion, angle, _ = play(samples, timeout_ns)
    held = rolled(motion, time_ns, timeout_ns)
    return angle[0] + held[0], angle[1] + held[1]


@given(schedules, st.lists(st.floats(0.0, 1.0), max_size=5))
def test_repeats_change_nothing_but_the_last_stamp(schedule, fractions):
    samples = stamped(schedule)
    with_repeats = []
    for sample, following in zip(samples, [*samples[1:], None]):
        end = following.stamp_ns if following else sample.stamp_ns + 400 * MS
        between = sorted({sample.stamp_ns + int(f * (end - sample.stamp_ns)) for f in fractions})
        with_repeats += [sample] + [
            WheelSample(stamp, sample.rates) for stamp in between
            if sample.stamp_ns < stamp < end]
    bare, repeated = play(samples), play(with_repeats)
    assert repeated[1] == bare[1], 'to the last bit'
    assert repeated[0].anchor_ns == bare[0].anchor_ns
    assert repeated[0].rates == bare[0].rates
    assert repeated[0].last_ns == with_repeats[-1].stamp_ns


@given(schedules)
def test_the_angle_is_the_sum_of_the_rates_times_the_time_they_were_held(schedule):
    samples = stamped(schedule)
    end = samples[-1].stamp_ns + 7 * MS
    for side in (0, 1):
        exact = math.fsum(
            a.rates[side] * (b - a.stamp_ns) / 1e9
            for a, b in zip(samples, [s.stamp_ns for s in samples[1:]] + [end]))
        assert angle_at(samples, end)[side] == pytest.approx(exact, abs=1e-12)


def test_a_repeat_is_a_repeat_and_a_change_moves_the_anchor():
    motion, angle, verdicts = play(
        [WheelSample(0, A), WheelSample(100 * MS, A), WheelSample(200 * MS, B)])
    assert verdicts == [Verdict.REPEATED, Verdict.MOVED]
    assert (motion.anchor_ns, motion.last_ns, motion.rates) == (200 * MS, 200 * MS, B)
    assert angle == pytest.approx((0.2, 0.4))


def test_a_sample_between_the_anchor_and_the_last_supersedes_what_followed():
    samples = [WheelSample(0, A), WheelSample(200 * MS, A), WheelSample(50 * MS, B)]
    motion, angle, verdicts = play(samples)
    assert verdicts == [Verdict.REPEATED, Verdict.MOVED]
    assert (motion.anchor_ns, motion.last_ns) == (50 * MS, 50 * MS)
    assert angle == pytest.approx((0.05, 0.1))
    assert angle_at(samples, 250 * MS) == pytest.approx((0.05 + 0.6, 0.1 - 0.8))


def test_a_late_repeat_does_not_take_the_last_stamp_back():
    motion, _, verdicts = play(
        [WheelSample(0, A), WheelSample(200 * MS, A), WheelSample(50 * MS, A)])
    assert verdicts[-1] is Verdict.REPEATED
    assert motion.last_ns == 200 * MS


@pytest.mark.parametrize('rates, positions', [(B, None), (None, (1.0, 2.0)), (B, (1.0, 2.0))])
def test_a_message_that_comes_twice_is_a_repeat_and_one_that_contradicts_it_is_not(
        rates, positions):
    start = WheelSample(0, rates and A, positions and (0.0, 0.0), 'one')
    sample = WheelSample(100 * MS, rates, positions, 'one')
    motion = play([start, sample])[0]
    assert update_motion(motion, sample, now_ns=NOW, timeout_ns=T) == (
        motion, (0.0, 0.0), Verdict.REPEATED, (0.0, 0.0))
    others = [replace(sample, source='other')]
    others += [replace(sample, rates=A)] if rates else []
    others += [replace(sample, positions=(1.0, 2.1))] if positions else []
    for other in others:
        result = update_motion(motion, other, now_ns=NOW, timeout_ns=T)
        assert result.verdict is Verdict.OUT_OF_ORDER and result.motion == motion


def test_wheels_may_begin_to_turn_at_the_time_of_the_first_message_and_no_double_stops_them():
    first, begin = WheelSample(S, STILL, None, 'one'), WheelSample(S, A, STILL, 'one')
    motion, angle, verdicts = play([first, begin, first, begin])
    assert verdicts == [Verdict.MOVED, Verdict.OUT_OF_ORDER, Verdict.REPEATED]
    assert (motion.rates, motion.anchor_ns, angle) == (A, S, STILL)
    for other in (replace(begin, source='other'), replace(begin, positions=(1.0, 2.0)),
                  replace(begin, stamp_ns=S - 1)):
        assert play([first, other])[2] == [Verdict.OUT_OF_ORDER]
    assert play([first, replace(first, stamp_ns=S + 1), begin])[2][-1] is Verdict.OUT_OF_ORDER


@pytest.mark.parametrize('stamp', [100 * MS, 99 * MS, 0, 100 * MS - S])
def test_a_sample_at_or_before_the_anchor_is_dropped(stamp):
    motion, _, _ = play([WheelSample(0, A), WheelSample(100 * MS, B)])
    result = update_motion(motion, WheelSample(stamp, A), now_ns=NOW, timeout_ns=T)
    assert result.verdict is Verdict.OUT_OF_ORDER
    assert (result.motion, result.rolled) == (motion, STILL)


@pytest.mark.parametrize(('timeout_ns', 'tolerance'), [
    (None, S), (0, S), (T, S), (S, S), (3 * S, 3 * S)])
def test_a_step_of_the_clock_is_more_than_the_timeout_and_more_than_a_second(
        timeout_ns, tolerance):
    assert step_tolerance(timeout_ns) == tolerance
    motion = baseline(WheelSample(10 * S, A))
    for stamp, verdict in [
            (10 * S - tolerance, Verdict.OUT_OF_ORDER),
            (10 * S - tolerance - 1, Verdict.CLOCK_STEP),
            (NOW + tolerance, Verdict.MOVED), (NOW + tolerance + 1, Verdict.CLOCK_STEP)]:
        result = update_motion(motion, WheelSample(stamp, B), now_ns=NOW, timeout_ns=timeout_ns)
        assert result.verdict is verdict, stamp - 10 * S


@pytest.mark.parametrize('stamp', [-5 * S, NOW + 5 * S])
@pytest.mark.parametrize('positions', [None, (50.0, 60.0)])
def test_a_step_of_the_clock_is_anchored_anew_and_never_integrated(stamp, positions):
    samples = [WheelSample(0, A), WheelSample(100 * MS, A), WheelSample(stamp, B, positions)]
    motion, angle, verdicts = play(samples)
    assert verdicts[-1] is Verdict.CLOCK_STEP
    assert angle == pytest.approx((0.1, 0.2)), 'what was known up to the last sample'
    assert motion == baseline(samples[-1])


@pytest.mark.parametrize('timeout_ns', [1, T, 3 * S])
def test_the_wheels_stop_exactly_at_the_last_stamp_and_the_timeout(timeout_ns):
    motion, _, _ = play([WheelSample(0, A), WheelSample(1, A)], timeout_ns)
    end = 1 + timeout_ns
    assert rates_at(motion, end - 1, timeout_ns) == A
    assert rates_at(motion, end, timeout_ns) == STILL
    stop = rolled(motion, end, timeout_ns)
    assert stop == pytest.approx((end / 1e9, 2.0 * end / 1e9))
    assert rolled(motion, end - 1, timeout_ns) != stop
    assert rolled(motion, end + 1, timeout_ns) == rolled(motion, 10 * NOW, timeout_ns) == stop


def test_without_a_timeout_the_wheels_never_stop():
    motion = baseline(WheelSample(0, A))
    assert rates_at(motion, 1000 * S, None) == A
    assert rolled(motion, 1000 * S, None) == (1000.0, 2000.0)


@pytest.mark.parametrize('time_ns', [S, S - 1, -S])
def test_nothing_is_rolled_at_or_before_the_anchor(time_ns):
    assert rolled(baseline(WheelSample(S, A)), time_ns, T) == STILL


def test_wheels_at_rest_may_be_silent_and_a_late_sample_still_finds_them():
    late = WheelSample(7 * S - 100 * MS, A)
    motion, angle, verdicts = play(
        [WheelSample(0, STILL), WheelSample(7 * S, STILL), late], now_ns=7 * S)
    assert verdicts == [Verdict.REPEATED, Verdict.MOVED]
    assert (motion.anchor_ns, motion.rates, angle) == (late.stamp_ns, A, (0.0, 0.0))


def test_the_same_rates_after_silence_only_rolled_until_the_timeout():
    samples = [WheelSample(0, A), WheelSample(2 * S, A)]
    motion, angle, verdicts = play(samples)
    assert verdicts == [Verdict.MOVED]
    assert angle == pytest.approx((0.5, 1.0))
    assert motion.anchor_ns == 2 * S
    at_the_timeout = play([WheelSample(0, A), WheelSample(T, A)])
    assert at_the_timeout[2] == [Verdict.REPEATED], 'a sample just in time is no silence'


@given(schedules, st.data())
def test_lost_samples_with_positions_cost_nothing(schedule, data):
    bare = stamped(schedule)
    ends = [angle_at(bare[:k], sample.stamp_ns) for k, sample in enumerate(bare, start=1)]
    full = [WheelSample(s.stamp_ns, s.rates, end) for s, end in zip(bare, ends)]
    kept = [full[0]] + [s for s in full[1:-1] if data.draw(st.booleans())] + full[1:][-1:]
    end = full[-1].stamp_ns + 3 * MS
    assert angle_at(kept, end) == pytest.approx(angle_at(bare, end), abs=1e-12)


def test_the_positions_of_the_first_sample_are_only_a_baseline():
    samples = [WheelSample(0, A, (70.0, -9.0)), WheelSample(S // 10, B, (70.5, -9.25))]
    assert angle_at(samples[:1], 0) == STILL
    assert angle_at(samples, S // 10) == (0.5, -0.25)


def test_positions_that_agree_with_the_rates_are_a_repeat_and_others_are_the_truth():
    start = WheelSample(0, A, (70.0, -9.0))
    agree = WheelSample(100 * MS, A, (70.0 + 0.1, -9.0 + 0.2))
    other = WheelSample(100 * MS, A, (70.0 + 0.1, -9.0 + 0.2 + 1e-9))
    assert play([start, agree])[2] == [Verdict.REPEATED]
    motion, angle, verdicts = play([start, other])
    assert verdicts == [Verdict.MOVED]
    assert angle == pytest.approx((0.1, 0.2 + 1e-9), abs=1e-13)
    assert motion.reference == other.positions


@pytest.mark.parametrize('rates', [A, STILL])
def test_a_sample_without_positions_is_the_baseline_of_a_restarted_publisher(rates):
    moved = (rates[0] * 0.1, rates[1] * 0.1)
    samples = [
        WheelSample(0, rates), WheelSample(100 * MS, rates, moved),
        WheelSample(200 * MS, rates), WheelSample(300 * MS, rates, moved)]
    assert angle_at(samples, 300 * MS) == pytest.approx((3 * moved[0], 3 * moved[1]), abs=1e-14)


@pytest.mark.parametrize('repeats', [1, 3])
def test_a_repeat_without_positions_is_a_baseline_too(repeats):
    """Guard a jump back by all that was rolled since the anchor, before the publisher began."""
    samples = [WheelSample(k * 100 * MS, A) for k in range(repeats + 1)]
    counting = WheelSample((repeats + 1) * 100 * MS, A, (0.1, 0.2))
    total = 0.1 * (repeats + 1)
    assert angle_at([*samples, counting], counting.stamp_ns) == pytest.approx(
        (total, 2.0 * total), abs=1e-14)


def test_positions_alone_are_never_extrapolated():
    samples = [WheelSample(0, None, (5.0, 5.0)), WheelSample(200 * MS, None, (5.1, 4.8))]
    motion, angle, verdicts = play(samples)
    assert verdicts == [Verdict.MOVED]
    assert angle == pytest.approx((0.1, -0.2))
    assert rolled(motion, 300 * MS, T) == rolled(motion, 9 * S, None) == STILL
    assert rates_at(motion, 300 * MS, T) == pytest.approx((0.5, -1.0)), 'what the last made'
    assert rates_at(motion, 200 * MS + T, T) == STILL


def test_positions_alone_that_stay_say_that_the_wheels_stand():
    motion, angle, _ = play(
        [WheelSample(k * 100 * MS, None, (5.0, 5.0)) for k in range(4)])
    assert (motion.rates, angle) == (STILL, STILL)


@given(schedules, st.integers(-1000 * S, 1000 * S), st.integers(0, 2 * S))
def test_after_a_step_of_the_clock_everything_reads_as_before(schedule, step, later):
    motion, _, _ = play(stamped(schedule))
    moved, time = shifted(motion, step), motion.anchor_ns + later
    assert rolled(moved, time + step, T) == rolled(motion, time, T)
    assert rates_at(moved, time + step, T) == rates_at(motion, time, T)


@pytest.mark.parametrize('bad', [
    math.nan, math.inf, -math.inf, math.nextafter(LARGEST, math.inf), -2.0 * LARGEST])
@pytest.mark.parametrize('side', [0, 1])
def test_values_that_are_not_finite_or_absurd_are_refused_by_name(bad, side):
    pair = (bad, 0.0) if side == 0 else (0.0, bad)
    with pytest.raises(ValueError, match='^velocity'):
        WheelSample(0, pair, STILL)
    with pytest.raises(ValueError, match='^position'):
        WheelSample(0, STILL, pair)
    with pytest.raises(ValueError, match='^position'):
        WheelSample(0, None, pair)


def test_a_sample_of_nothing_is_refused():
    with pytest.raises(ValueError, match='velocity and position are absent'):
        WheelSample(0, None, None)


def test_the_largest_values_are_accepted():
    assert WheelSample(0, (LARGEST, -LARGEST), (-LARGEST, LARGEST)).stamp_ns == 0


@pytest.mark.parametrize(('seconds', 'timeout_ns'), [(0.0, None), (0.5, T), (1e-9, 1), (3, 3 * S)])
def test_a_timeout_of_zero_seconds_is_none(seconds, timeout_ns):
    assert timeout_from_seconds(seconds) == timeout_ns


@given(pairs, pairs, st.sampled_from([A, None]))
def test_the_first_positions_of_another_source_are_a_baseline(old, new, rates):
    """Guard a jump by all that was driven when a publisher is restarted, or a second one comes."""
    samples = [
        WheelSample(0, A, old, source='one'),
        WheelSample(100 * MS, A, (old[0] + 0.1, old[1] + 0.2), source='one'),
        WheelSample(200 * MS, rates, new, source='two'),
        WheelSample(300 * MS, rates, (new[0] + 0.5, new[1] - 0.5), source='two')]
    assert angle_at(samples, 300 * MS) == pytest.approx((0.2 + 0.5, 0.4 - 0.5), abs=1e-12)


def test_two_sources_that_take_turns_hold_the_rates_of_the_one_before():
    samples = [WheelSample(0, A, (50.0, 50.0), source='one')]
    for k in range(1, 9):
        positions = (0.0, 0.0) if k % 2 else (50.0 + 0.1 * k, 50.0 + 0.2 * k)
        rates = STILL if k % 2 else A
        samples.append(
            WheelSample(k * 100 * MS, rates, positions, source=('one', 'two')[k % 2]))
    assert angle_at(samples, 800 * MS) == pytest.approx((0.4, 0.8), abs=1e-12)


def test_a_clock_that_is_ahead_for_good_makes_one_step_and_counts_from_then_on():
    ahead = NOW + 3 * S
    samples = [WheelSample(ahead + k * 20 * MS, None, (0.1 * k, 0.1 * k)) for k in range(5)]
    motion, angle, verdicts = play([WheelSample(NOW - S, None, (0.0, 0.0)), *samples])
    assert verdicts == [Verdict.CLOCK_STEP, *[Verdict.MOVED] * 4]
    assert angle == pytest.approx((0.4, 0.4), abs=1e-12)


def test_a_repeat_from_long_before_the_last_one_is_a_step_of_the_clock():
    samples = [WheelSample(0, A), WheelSample(10 * S, A), WheelSample(5 * S, A)]
    motion, _, verdicts = play(samples, timeout_ns=None)
    assert verdicts == [Verdict.REPEATED, Verdict.CLOCK_STEP]
    assert motion.anchor_ns == motion.last_ns == 5 * S


def jumped(samples, max_rate=50.0):
    """Return the angle rolled and the verdicts of samples where wheels reach ``max_rate``."""
    motion, verdicts = baseline(samples[0]), []
    left = right = 0.0
    for sample in samples[1:]:
        result = update_motion(motion, sample, now_ns=NOW, timeout_ns=None, max_rate=max_rate)
        motion = result.motion
        left, right = left + result.rolled[0], right + result.rolled[1]
        verdicts.append(result.verdict)
    held = rolled(motion, motion.last_ns, None)
    return (left + held[0], right + held[1]), verdicts


@pytest.mark.parametrize('rates', [None, A], ids=['positions only', 'with rates'])
def test_positions_that_jump_are_a_new_baseline_from_which_they_count_on(rates):
    positions = [(0.0, 0.0), (0.02, 0.04), (700.0, 0.08), (700.02, 0.12), (-9.0, 0.16),
                 (-8.98, 0.2)]
    angle, verdicts = jumped([
        WheelSample(number * 20 * MS, rates, position)
        for number, position in enumerate(positions)])
    assert verdicts.count(Verdict.JUMPED) == 2
    held = 0 if rates is None else 2  # over a jump rates are held, where there are any
    assert angle == pytest.approx((0.06 + held * 0.02, 0.12 + held * 0.04), abs=1e-12)


def test_a_jump_after_a_long_time_of_steady_rates_is_one_of_the_last_message():
    steady = [WheelSample(number * 20 * MS, A, (0.02 * number, 0.04 * number))
              for number in range(500)]
    angle, verdicts = jumped([*steady, WheelSample(10 * S, A, (10.0 + 30.0, 20.0))])
    assert verdicts[-1] is Verdict.JUMPED
    assert verdicts.count(Verdict.JUMPED) == 1
    assert angle == pytest.approx((10.0, 20.0), rel=1e-12)


def test_a_wheel_at_the_bound_does_not_jump_and_one_above_does():
    at, above = (WheelSample(20 * MS, None, (rate * 0.02, -rate * 0.02)) for rate in (50.0, 50.1))
    start = WheelSample(0, None, STILL)
    assert jumped([start, at])[1] == [Verdict.MOVED]
    assert jumped([start, above])[1] == [Verdict.JUMPED]


def test_without_a_bound_nothing_jumps():
    samples = [WheelSample(0, None, STILL), WheelSample(1, None, (1e9, -1e9))]
    assert play(samples)[2] == [Verdict.MOVED]


@pytest.mark.parametrize('rates', [A, B], ids=['a repeat', 'a change'])
def test_an_update_of_a_track_keeps_every_field_that_is_not_its_own_to_change(rates):
    """The fast path writes the fields out: one that is added could be forgotten there."""
    track, _, _ = WheelTrack(timeout_ns=T).update(WheelSample(0, A), now_ns=0)
    read = {'timeout_ns', 'max_rate', 'measured'}
    others = {*WheelTrack._fields} - read - {'left', 'right', 'motion', 'clock'}
    track = track._replace(**{name: object() for name in others})
    after, _, verdict = track.update(WheelSample(MS, rates), now_ns=MS)
    assert verdict is (Verdict.REPEATED if rates == A else Verdict.MOVED)
    assert [getattr(after, name) for name in (*read, *others)] == [
        getattr(track, name) for name in (*read, *others)]
