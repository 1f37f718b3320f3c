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

"""Noise on a stream of wheel motion: statistics, seeds, order of stamps and restarts."""

from dataclasses import replace
from itertools import accumulate
import math

from diffdrive_kinematics.core.kinematics import Pose, WheelGeometry
from diffdrive_kinematics.core.noise import body_variances, BodySlip, WheelSlip
from diffdrive_kinematics.core.odometry import (
    ClockStep, Odometry, SlipStream, Verdict, WheelSample)
from hypothesis import given, settings, strategies as st
import numpy as np
import pytest

LAW = settings(deadline=None, derandomize=True)
MS = 1_000_000
S = 1000 * MS
T = S // 2
Z = 3.2905  # of 99.9 %, two-sided
GEOMETRY = WheelGeometry(0.4, 0.1, 1.0, 0.9, 1.2)
LEFT, RIGHT = WheelSlip(0.05, 2e-3), WheelSlip(-0.02, 1e-3)
A, B, STILL = (5.0, -4.0), (-2.0, 3.0), (0.0, 0.0)
RADII = (GEOMETRY.left_radius, GEOMETRY.right_radius)
NOISY = SlipStream(RADII, LEFT, RIGHT, T)
BODY = BodySlip(1e-3, 0.02, 4e-3)
BODIED = replace(NOISY, separation=GEOMETRY.separation, body=BODY)
CLEAN = SlipStream(RADII, WheelSlip(), WheelSlip(), T)
START = Odometry.starting_at(Pose(1.0, -2.0, 3.0), geometry=GEOMETRY, timeout_ns=T)
pairs = st.tuples(st.floats(-10.0, 10.0), st.floats(-10.0, 10.0))
schedules = st.lists(
    st.tuples(st.integers(MS, 900 * MS), st.one_of(pairs, st.sampled_from([A, STILL]))),
    min_size=1, max_size=12).map(
        lambda items: [
            WheelSample(stamp, rates) for stamp, (_, rates) in zip(
                accumulate(gap for gap, _ in items), items)])


def passed(stream, samples, seed=0):
    """Return the stream after the samples, and what it put out, as its publisher does."""
    generator, out = np.random.default_rng(seed), []
    for sample in samples:
        stream, noisy, _ = stream.apply(sample, generator)
        if noisy is not None:
            out.append(replace(noisy, source='/noise#1'))
    return stream, out


def fed(odometry, samples):
    """Return the odometry after samples that came at their stamps, or when the last one came."""
    for sample, now_ns in zip(samples, accumulate((sample.stamp_ns for sample in samples), max)):
        odometry, _ = odometry.update(sample, now_ns)
    return odometry


def assert_same_reading(reading, other, tolerance=1e-11):
    assert reading.pose[:2] == pytest.approx(other.pose[:2], abs=tolerance)
    assert abs(math.remainder(reading.pose.theta - other.pose.theta, math.tau)) <= tolerance
    assert reading.angles == pytest.approx(other.angles, abs=tolerance)


@LAW
@given(schedules, st.integers(0, 2**32))
def test_the_same_seed_and_the_same_input_give_the_same_bits(samples, seed):
    assert passed(NOISY, samples, seed) == passed(NOISY, samples, seed)


def test_another_seed_gives_another_slip():
    samples = [WheelSample(0, A), WheelSample(100 * MS, A)]
    assert passed(NOISY, samples, 1)[1] != passed(NOISY, samples, 2)[1]


@pytest.mark.parametrize(('rate', 'seconds'), [(20, 1000), (100, 500)])
def test_travel_has_the_mean_and_variance_of_the_law_at_any_message_rate(rate, seconds):
    """Compare the travel of each second, with 99.9 % intervals."""
    period = S // rate
    _, out = passed(NOISY, (
        WheelSample(k * period, A) for k in range(rate * seconds + 1)), seed=rate)
    angles = np.array([STILL] + [sample.positions for sample in out[rate::rate]])
    travel = np.diff(angles, axis=0) * RADII
    nominal = np.array(A) * RADII
    mean = nominal * [1.05, 0.98]
    variance = np.abs(nominal) * [2e-3, 1e-3]
    assert np.all(np.abs(travel.mean(axis=0) - mean) < Z * np.sqrt(variance / seconds))
    ratio = travel.var(axis=0, ddof=1) / variance
    assert np.all(np.abs(ratio - 1.0) < Z * math.sqrt(2.0 / (seconds - 1)))
    assert abs(np.corrcoef(travel.T)[0, 1]) < Z / math.sqrt(seconds), 'wheels slip on their own'


@pytest.mark.slow
@pytest.mark.parametrize(('rate', 'seconds'), [(100, 500), (20, 1000)])
@pytest.mark.parametrize('rates', [(5.0, 4.0), (-3.0, 3.5), (4.0, 0.0)])
def test_slip_of_the_body_moves_both_wheels_as_its_law_says(rate, seconds, rates):
    """Compare distance and turn of each second, beside slip of the wheels."""
    period, (left, right) = S // rate, np.array(rates) * RADII * [1.05, 0.98]
    _, out = passed(BODIED, (
        WheelSample(k * period, rates) for k in range(rate * seconds + 1)), seed=rate)
    angles = np.array([STILL] + [sample.positions for sample in out[rate::rate]])
    travel = np.diff(angles, axis=0) * RADII
    change = np.stack([0.5 * (travel[:, 0] + travel[:, 1]),
                       (travel[:, 1] - travel[:, 0]) / GEOMETRY.separation])
    mean = np.array([0.5 * (left + right), (right - left) / GEOMETRY.separation])
    wheels = np.abs(rates) * RADII * [2e-3, 1e-3]
    expected = np.array(body_variances(BODY, *mean)) + (
        0.25 * wheels.sum(), wheels.sum() / GEOMETRY.separation**2)
    assert np.all(np.abs(change.mean(axis=1) - mean) < Z * np.sqrt(expected / seconds))
    assert np.all(np.abs(change.var(axis=1, ddof=1) / expected - 1.0)
                  < Z * math.sqrt(2.0 / (seconds - 1)))
    correlation = 0.5 * (wheels[1] - wheels[0]) / GEOMETRY.separation / math.sqrt(
        np.prod(expected))
    assert abs(np.corrcoef(change)[0, 1] - correlation) < Z / math.sqrt(seconds)


def test_a_belief_that_counts_the_slip_of_the_body_is_as_far_off_as_it_says():
    """NEES of the belief against the truth behind the stream, over 300 runs, at 99.9 %."""
    slip = {'slip_variances': (2e-3, 1e-3), 'body_slip': BODY}
    stream = replace(
        BODIED, left_slip=WheelSlip(variance=2e-3), right_slip=WheelSlip(variance=1e-3))
    legs = [A] * 10 + [(6.0, 4.0)] * 15 + [(-3.0, 3.0)] * 5 + [(6.0, 6.0)] * 10 + [STILL] * 2
    samples = [WheelSample(k * 50 * MS, rates) for k, rates in enumerate(legs)]
    end = samples[-1].stamp_ns
    belief = fed(START._replace(**slip), samples)
    believed, matrix = belief.predict(end).pose, belief.covariance_at(end).matrix()
    nees = []
    for seed in range(300):
        truth = fed(START, passed(stream, samples, seed)[1]).predict(end).pose
        error = np.subtract(truth, believed)
        error[2] = math.remainder(error[2], math.tau)
        nees.append(error @ np.linalg.solve(matrix, error))
    assert abs(np.mean(nees) - 3.0) < Z * np.std(nees) / math.sqrt(len(nees))


def test_slip_of_the_body_in_a_straight_needs_no_separation():
    stream = replace(CLEAN, body=BodySlip(linear_variance=1e-3))
    _, out = passed(stream, [WheelSample(0, A), WheelSample(100 * MS, A)])
    travel = np.array(out[1].positions) * RADII - 0.1 * np.array(A) * RADII
    assert travel[0] == pytest.approx(travel[1]) and travel[0] != 0.0


@pytest.mark.parametrize('stream', ['NOISY', 'BODIED'])
def test_a_rest_of_any_length_draws_nothing_and_moves_nothing(stream):
    _, out = passed(globals()[stream], [WheelSample(k * 100 * MS, STILL) for k in range(9)])
    assert {sample.positions for sample in out[1:]} == {STILL}


def test_the_velocity_is_that_of_the_way_with_slip_of_the_body_where_it_is_known():
    stream = replace(CLEAN, separation=GEOMETRY.separation, body=BodySlip(1e-6, 1e-4, 1e-5))
    _, out = passed(stream, [WheelSample(0, A), WheelSample(100 * MS, B)])
    left, right = out[1].positions
    assert out[1].rates == pytest.approx((-2.0 * left / 0.5, 3.0 * right / -0.4))
    wild = replace(stream, body=BodySlip(turn_variance=10.0))
    _, out = passed(wild, [WheelSample(0, A), WheelSample(100 * MS, B)])
    assert out[1].rates == B, 'a single error would make many times the rate asked for'


def test_the_velocity_is_the_rate_asked_for_times_what_the_interval_made_of_its_travel():
    _, out = passed(NOISY, [WheelSample(0, A), WheelSample(100 * MS, B)])
    left, right = out[1].positions
    assert out[1].rates == pytest.approx((-2.0 * left / 0.5, 3.0 * right / -0.4))


def test_the_first_velocity_is_biased_and_has_no_positions():
    _, (first,) = passed(NOISY, [WheelSample(7, A, (50.0, 60.0))])
    assert first == WheelSample(7, (5.0 * 1.05, -4.0 * 0.98), None, first.source)


def test_after_a_rest_the_velocity_is_biased_as_nothing_else_is_known():
    _, out = passed(NOISY, [WheelSample(0, STILL), WheelSample(100 * MS, A)])
    assert out[-1].rates == pytest.approx((5.0 * 1.05, -4.0 * 0.98))


@LAW
@given(st.lists(st.integers(1, 2 * S), min_size=1, max_size=9), st.integers(0, 2**32))
def test_wheels_at_rest_feel_no_noise(gaps, seed):
    stamps = accumulate([0, *gaps])
    _, out = passed(NOISY, [WheelSample(stamp, STILL) for stamp in stamps], seed)
    assert all(sample.rates == STILL for sample in out)
    assert all(sample.positions == STILL for sample in out[1:])


@pytest.mark.parametrize('rests', [1, 2, 7])
def test_how_often_a_rest_is_repeated_has_no_influence_on_the_travel_after_it(rests):
    start = [WheelSample(0, A), WheelSample(100 * MS, STILL)]
    pause = [WheelSample((110 + k) * MS, STILL) for k in range(rests)]
    end = [WheelSample(200 * MS, A), WheelSample(300 * MS, A)]
    assert passed(NOISY, start + pause + end)[1][-1] == passed(NOISY, start + end)[1][-1]


@LAW
@given(schedules, st.integers(0, 2**32))
def test_a_velocity_of_zero_stays_zero(samples, seed):
    stop = WheelSample(samples[-1].stamp_ns + MS, (0.0, 1.0))
    _, out = passed(NOISY, [*samples, stop], seed)
    assert out[-1].rates[0] == 0.0


@LAW
@given(schedules, st.data())
def test_the_stamps_put_out_only_grow_whatever_the_order_of_the_input(samples, data):
    _, out = passed(NOISY, data.draw(st.permutations(samples[:4])) + samples[4:])
    grown = [
        after.stamp_ns - before.stamp_ns for before, after in zip(out, out[1:])]
    assert all(gap > 0 or gap < -S for gap in grown), 'but for a step of the clock'


@LAW
@given(schedules)
def test_without_noise_the_positions_are_the_nominal_angles(samples):
    _, out = passed(CLEAN, samples)
    reference = START
    for sample, noisy in zip(samples, out):
        reference = fed(reference, [sample])
        assert noisy.stamp_ns == sample.stamp_ns
        assert noisy.rates == pytest.approx(sample.rates, rel=1e-11)
        assert (noisy.positions or STILL) == pytest.approx(
            reference.predict(sample.stamp_ns).angles, abs=1e-13)


@LAW
@given(schedules, st.integers(0, 2 * S))
def test_without_noise_odometry_through_the_stream_is_odometry(samples, later):
    end = samples[-1].stamp_ns + later
    assert_same_reading(
        fed(START, passed(CLEAN, samples)[1]).predict(end), fed(START, samples).predict(end))


@LAW
@given(schedules, st.lists(st.integers(1, 400), min_size=1, max_size=4), pairs, pairs)
def test_a_superseding_sample_leaves_the_nominal_positions_right(samples, times, rates, then):
    """A change, stamped before the repeats that were heard already: their travel is undone."""
    last = samples[-1]
    repeats = [WheelSample(last.stamp_ns + ms * MS, last.rates) for ms in sorted(times)]
    late = WheelSample(last.stamp_ns + MS // 2, rates)
    following = WheelSample(repeats[-1].stamp_ns + 50 * MS, then)
    heard = [*samples, *repeats, late, following]
    _, out = passed(CLEAN, heard)
    angles = fed(START, heard).predict(following.stamp_ns).angles
    assert out[-1].positions == pytest.approx(angles, abs=1e-12)
    assert fed(START, out).predict(following.stamp_ns).angles == pytest.approx(angles, abs=1e-12)


def test_a_superseding_stop_takes_back_the_travel_beyond_its_stamp():
    _, out = passed(CLEAN, [
        WheelSample(0, A), WheelSample(200 * MS, A), WheelSample(50 * MS, STILL)])
    assert out[-1].stamp_ns == 200 * MS + 1
    assert out[-1].positions == pytest.approx((0.25, -0.2), abs=1e-15)
    assert out[-1].rates == STILL


def test_a_late_repeat_takes_nothing_back():
    """Guard a base 50 ms behind after a repeat that was overtaken."""
    samples = [WheelSample(stamp * MS, A) for stamp in (0, 100, 200, 150)]
    _, out = passed(CLEAN, samples)
    assert len(out) == 3
    end = 2 * S
    assert fed(START, out).predict(end).angles == pytest.approx(
        fed(START, samples).predict(end).angles, abs=1e-7)


def test_a_superseding_sample_is_right_at_once_downstream():
    samples = [WheelSample(0, A), WheelSample(200 * MS, A), WheelSample(50 * MS, B)]
    _, out = passed(CLEAN, samples)
    assert fed(START, out).predict(300 * MS).angles == pytest.approx(
        fed(START, samples).predict(300 * MS).angles, abs=1e-7)


def test_a_sample_at_or_before_the_anchor_is_dropped():
    stream, _ = passed(NOISY, [WheelSample(0, A), WheelSample(S // 10, B)])
    generator = np.random.default_rng(0)
    for stamp in (S // 10, 0):
        assert stream.apply(WheelSample(stamp, A), generator) == (
            stream, None, Verdict.OUT_OF_ORDER)
    assert generator.bit_generator.state == np.random.default_rng(0).bit_generator.state


def test_a_step_of_the_clock_moves_nothing_and_the_positions_go_on():
    samples = [WheelSample(10 * S, A), WheelSample(10 * S + 100 * MS, A), WheelSample(S, B),
               WheelSample(S + 100 * MS, B)]
    _, out = passed(CLEAN, samples)
    assert [sample.stamp_ns for sample in out] == [sample.stamp_ns for sample in samples]
    assert out[2].positions == out[1].positions
    assert out[3].positions == pytest.approx((0.5 - 0.2, -0.4 + 0.3))
    reading = fed(START, out).predict(S + 100 * MS)
    assert_same_reading(reading, fed(START, samples).predict(S + 100 * MS))


@LAW
@given(schedules, st.integers(0, 11), st.integers(-3600 * S, 3600 * S), st.integers(0, 2**32))
def test_a_step_of_the_clock_that_is_known_changes_nothing_but_the_stamps(
        samples, cut, step_ns, seed):
    generator, out = np.random.default_rng(seed), []
    stream, before = NOISY, samples[:cut]
    for sample in before:
        stream, noisy, _ = stream.apply(sample, generator)
        out.append(noisy)
    stream = stream.clock_stepped(ClockStep(step_ns, stream.last_out_ns + step_ns))
    for sample in samples[cut:]:
        stream, noisy, _ = stream.apply(
            replace(sample, stamp_ns=sample.stamp_ns + step_ns), generator)
        out.append(noisy and replace(noisy, stamp_ns=noisy.stamp_ns - step_ns))
    assert [replace(each, source='/noise#1') for each in out if each] == passed(
        NOISY, samples, seed)[1]


@pytest.mark.parametrize('step_ns', [-3600 * S, -5 * S, -S // 2, S // 2, 5 * S])
@pytest.mark.parametrize('apart_ns', [100 * S, 10**17])
def test_a_step_of_the_own_clock_changes_nothing_where_the_stamps_are_of_another(
        step_ns, apart_ns):
    stream, _ = passed(NOISY, [WheelSample(10**18, A), WheelSample(10**18 + 20 * MS, A)], seed=1)
    own_ns = stream.last_out_ns - apart_ns + step_ns
    assert stream.clock_stepped(ClockStep(step_ns, own_ns)) == stream


@LAW
@given(schedules, st.integers(1, 11), st.integers(0, 2**32))
def test_a_restart_of_the_noise_causes_no_jump_downstream(samples, cut, seed):
    before, after = samples[:cut], samples[cut:]
    odometry = fed(START, passed(NOISY, before, seed)[1])
    if after:
        first, *rest = passed(NOISY, after, seed + 1)[1]
        restarted = fed(odometry, [first])
        assert_same_reading(restarted.predict(first.stamp_ns), odometry.predict(first.stamp_ns))
        travelled = np.abs(fed(restarted, rest).predict(samples[-1].stamp_ns).angles) < 200.0
        assert travelled.all()


@LAW
@given(schedules, st.integers(1, 11), st.integers(0, 400 * MS))
def test_without_noise_a_restart_changes_nothing_downstream(samples, cut, later):
    out = passed(CLEAN, samples[:cut])[1] + passed(CLEAN, samples[cut:])[1]
    end = samples[-1].stamp_ns + later
    assert_same_reading(fed(START, out).predict(end), fed(START, samples).predict(end))


@LAW
@given(schedules)
def test_a_restart_of_the_source_causes_no_jump(samples):
    """Give the source positions, then restart it: a sample without them, and a new count."""
    last = samples[-1]
    moved = (0.1 * last.rates[0], 0.1 * last.rates[1])
    heard = [
        *samples[:-1],
        WheelSample(last.stamp_ns, last.rates),
        WheelSample(last.stamp_ns + 100 * MS, last.rates, moved),
        WheelSample(last.stamp_ns + 200 * MS, last.rates),
        WheelSample(last.stamp_ns + 300 * MS, last.rates, moved)]
    _, out = passed(CLEAN, heard)
    end = heard[-1].stamp_ns
    assert_same_reading(fed(START, out).predict(end), fed(START, heard).predict(end))
    assert_same_reading(fed(START, out).predict(end), fed(START, samples).predict(end))


def test_positions_alone_pass_as_positions_alone():
    _, out = passed(CLEAN, [
        WheelSample(k * 100 * MS, None, (50.0 + k, 60.0 - k)) for k in range(4)])
    assert out[0] == WheelSample(0, STILL, source=out[0].source)
    assert [sample.rates for sample in out[1:]] == [None] * 3
    assert [sample.positions for sample in out[1:]] == [
        pytest.approx((k, -k)) for k in (1.0, 2.0, 3.0)]


def test_silence_counts_only_until_the_timeout():
    _, out = passed(CLEAN, [WheelSample(0, A), WheelSample(9 * S, A)])
    assert out[1].positions == pytest.approx((2.5, -2.0))
    _, out = passed(SlipStream(RADII, WheelSlip(), WheelSlip(), None), [
        WheelSample(0, A), WheelSample(9 * S, A)])
    assert out[1].positions == pytest.approx((45.0, -36.0))


def test_motion_goes_on_after_the_clock_of_a_robot_at_rest_was_stepped_back():
    """Guard a truth that stays where it is for as long as the step was long."""
    rest = [WheelSample(k * 20 * MS, STILL, (0.0, 0.0)) for k in range(1, 500)]
    back = 5 * S
    after = [WheelSample(back + k * 20 * MS, STILL, (0.0, 0.0)) for k in range(3)]
    drive = [WheelSample(back + k * 20 * MS, A, (0.02 * (k - 3) * A[0], 0.02 * (k - 3) * A[1]))
             for k in range(3, 103)]
    samples = [*rest, *after, *drive]
    _, out = passed(CLEAN, samples)
    now_ns = rest[-1].stamp_ns  # when the last one came, for this test
    assert fed(START, out).predict(now_ns).angles == pytest.approx(
        (1.98 * A[0], 1.98 * A[1]), abs=1e-9)
