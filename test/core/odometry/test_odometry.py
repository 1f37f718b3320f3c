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

"""Odometry against 50-digit composition, and what no message, timer or restart may change."""

from dataclasses import replace
from itertools import accumulate
import math

from diffdrive_kinematics.core.kinematics import (
    advance, Pose, pose_change_from_travel, travel_from_angles, twist_from_wheel_rates,
    WheelGeometry)
from diffdrive_kinematics.core.noise import NO_COVARIANCE, PoseCovariance
from diffdrive_kinematics.core.odometry import MeasuredWheels, Odometry, Verdict, WheelSample
from hypothesis import given, strategies as st
import mpmath
import pytest

MS = 1_000_000
S = 1000 * MS
T = S // 2
NOW = 1000 * S
GEOMETRY = WheelGeometry(0.4, 0.1, 1.1, 0.9, 1.2)
START = Odometry.starting_at(Pose(1.0, -2.0, 3.0), geometry=GEOMETRY, timeout_ns=T)
UNTIMED = Odometry.starting_at(Pose(1.0, -2.0, 3.0), geometry=GEOMETRY, timeout_ns=None)
UNEXTRAPOLATED = Odometry.starting_at(
    Pose(1.0, -2.0, 3.0), geometry=GEOMETRY, timeout_ns=T,
    unmeasured=MeasuredWheels(extrapolates=False))
A, B, STILL = (5.0, 7.0), (-3.0, 4.0), (0.0, 0.0)
pairs = st.tuples(st.floats(-10.0, 10.0), st.floats(-10.0, 10.0))
schedules = st.lists(
    st.tuples(st.integers(MS, 400 * MS), pairs), min_size=1, max_size=12).map(
        lambda items: [
            WheelSample(stamp, rates) for stamp, (_, rates) in zip(
                accumulate(gap for gap, _ in items), items)])


def fed(odometry, samples):
    """Return the odometry after samples that came at their stamps."""
    for sample in samples:
        odometry, _ = odometry.update(sample, sample.stamp_ns)
    return odometry


def wrapped_difference(theta, other):
    return math.remainder(theta - other, math.tau)


def assert_same_reading(reading, other, tolerance=1e-12):
    assert reading.pose[:2] == pytest.approx(other.pose[:2], abs=tolerance)
    assert abs(wrapped_difference(reading.pose.theta, other.pose.theta)) <= tolerance
    assert reading.angles == pytest.approx(other.angles, abs=tolerance)
    assert reading.rates == pytest.approx(other.rates, abs=1e-9)


def composed(samples, end):
    """Return (x, y, unwrapped theta) of rates held from stamp to stamp, with 50 digits."""
    with mpmath.workdps(50):
        x, y, theta = map(mpmath.mpf, (1.0, -2.0, 3.0))
        for sample, until in zip(samples, [s.stamp_ns for s in samples[1:]] + [end]):
            seconds = mpmath.mpf(until - sample.stamp_ns) / 10**9
            left = mpmath.mpf(GEOMETRY.left_radius) * sample.rates[0] * seconds
            right = mpmath.mpf(GEOMETRY.right_radius) * sample.rates[1] * seconds
            half = (right - left) / GEOMETRY.separation / 2
            chord = (left + right) / 2 * mpmath.sinc(half)
            x += chord * mpmath.cos(theta + half)
            y += chord * mpmath.sin(theta + half)
            theta += 2 * half
        return float(x), float(y), float(theta)


def with_positions(samples, offset=(40.0, -7.0), source='/driver#1'):
    """Return the samples with the positions that a publisher of this package would report."""
    result, left, right = [], *offset
    for before, sample in zip([None, *samples], samples):
        if before:
            seconds = (sample.stamp_ns - before.stamp_ns) / 1e9
            left, right = left + before.rates[0] * seconds, right + before.rates[1] * seconds
        result.append(replace(sample, positions=(left, right), source=source))
    return result


@given(schedules, st.integers(0, 400 * MS))
def test_the_pose_is_the_composition_of_exact_arcs(samples, later):
    end = samples[-1].stamp_ns + later
    pose = fed(START, samples).predict(end).pose
    x, y, theta = composed(samples, end)
    assert (pose.x, pose.y) == pytest.approx((x, y), abs=1e-12)
    assert abs(wrapped_difference(pose.theta, theta)) <= 1e-12
    assert -math.pi < pose.theta <= math.pi


@given(schedules, st.integers(1, 40))
def test_repeats_change_no_bit_of_the_reading(samples, period_ms):
    repeated = []
    for sample, following in zip(samples, [*samples[1:], None]):
        end = following.stamp_ns if following else sample.stamp_ns + 1
        repeated += [WheelSample(stamp, sample.rates)
                     for stamp in range(sample.stamp_ns, end, period_ms * MS)]
    end = samples[-1].stamp_ns + 399 * MS
    assert fed(START, repeated).predict(end) == fed(START, samples).predict(end)


@given(schedules, st.lists(st.integers(0, 6 * S), max_size=9))
def test_looking_changes_nothing(samples, times):
    odometry = fed(START, samples)
    end = samples[-1].stamp_ns + S
    before = odometry.predict(end)
    for time in times:
        odometry.predict(time)
    assert odometry.predict(end) == before


@given(schedules, st.data())
def test_lost_samples_with_positions_keep_angles_and_heading_exact(samples, data):
    full = with_positions(samples)
    kept = full[:1] + [s for s in full[1:-1] if data.draw(st.booleans())] + full[1:][-1:]
    end = samples[-1].stamp_ns + 100 * MS
    reading, exact = fed(START, kept).predict(end), fed(START, samples).predict(end)
    assert reading.angles == pytest.approx(exact.angles, abs=1e-12)
    assert abs(wrapped_difference(reading.pose.theta, exact.pose.theta)) <= 1e-12


@given(schedules)
def test_positions_that_agree_with_the_rates_change_nothing(samples):
    end = samples[-1].stamp_ns + 100 * MS
    assert_same_reading(
        fed(START, with_positions(samples)).predict(end), fed(START, samples).predict(end))


@given(schedules, st.lists(st.integers(1, 99), max_size=4), pairs)
def test_a_superseding_sample_undoes_what_followed_its_stamp(samples, percents, rates):
    last = samples[-1]
    stamps = sorted(last.stamp_ns + percent * MS for percent in percents)
    late = WheelSample(last.stamp_ns + MS // 2, rates)
    heard = fed(START, [*samples, *(WheelSample(stamp, last.rates) for stamp in stamps), late])
    end = late.stamp_ns + 200 * MS
    assert_same_reading(heard.predict(end), fed(START, [*samples, late]).predict(end))


def test_a_sample_at_or_before_the_anchor_changes_nothing():
    odometry = fed(START, [WheelSample(S, A), WheelSample(2 * S, B)])
    for stamp in (2 * S, 2 * S - 1, S):
        after, verdict = odometry.update(WheelSample(stamp, A), 2 * S)
        assert verdict is Verdict.OUT_OF_ORDER
        wheels = after.wheels._replace(clock=odometry.clock)
        assert after._replace(wheels=wheels) == odometry


@pytest.mark.parametrize('stamp', [-9 * S, NOW + 9 * S])
def test_a_step_of_the_clock_keeps_the_pose_of_the_last_sample(stamp):
    odometry = fed(START, [WheelSample(0, A), WheelSample(100 * MS, A)])
    after, verdict = odometry.update(
        WheelSample(stamp, B, (900.0, 900.0), '/driver#1'), NOW)
    assert verdict is Verdict.CLOCK_STEP
    assert after.predict(NOW).pose == odometry.predict(100 * MS).pose
    assert after.predict(NOW).angles == odometry.predict(100 * MS).angles
    later = after.predict(NOW + 100 * MS)
    assert later.angles == pytest.approx((0.5 - 0.3, 0.7 + 0.4))


def test_the_base_stops_exactly_at_the_last_stamp_and_the_timeout():
    odometry = fed(START, [WheelSample(0, A), WheelSample(100 * MS, A)])
    end = 100 * MS + T
    assert odometry.predict(end - 1).rates == A
    stopped = odometry.predict(end)
    assert (stopped.rates, stopped.twist) == (STILL, STILL)
    assert stopped.angles == pytest.approx((0.6 * 5.0, 0.6 * 7.0))
    assert odometry.predict(end + NOW) == stopped
    assert odometry.predict(end - 1).pose != stopped.pose


def test_the_same_rates_after_silence_go_on_from_where_the_base_stopped():
    odometry = fed(START, [WheelSample(0, A)])
    after = fed(odometry, [WheelSample(20 * S, A)])
    assert_same_reading(
        after.predict(20 * S)._replace(rates=STILL), odometry.predict(20 * S), tolerance=1e-14)
    assert after.predict(20 * S + 100 * MS).angles == pytest.approx((3.0, 4.2))


@given(schedules, st.integers(0, 399 * MS), st.booleans(), pairs)
def test_a_restarted_publisher_causes_no_jump(samples, later, standing, rates):
    last = samples[-1]
    rates = last.rates if standing else rates
    odometry = fed(START, with_positions(samples))
    stamp = last.stamp_ns + 1 + later
    restarted = fed(odometry, [WheelSample(stamp, rates, source='/driver#2')])
    assert_same_reading(
        restarted.predict(stamp)._replace(rates=STILL),
        odometry.predict(stamp)._replace(rates=STILL))
    moved = (0.1 * rates[0], 0.1 * rates[1])
    end = stamp + 100 * MS
    going_on = fed(restarted, [WheelSample(end, rates, moved, '/driver#2')])
    assert_same_reading(going_on.predict(end), restarted.predict(end))


@pytest.mark.parametrize('rates', [STILL, A])
def test_a_restart_with_the_same_rates_is_noticed_also_at_a_stand(rates):
    """Guard a repeat of the same rates that was not taken for a new baseline."""
    publisher = [WheelSample(0, rates, (80.0, 90.0), '/driver#1'), WheelSample(
        100 * MS, rates, (80.0 + 0.1 * rates[0], 90.0 + 0.1 * rates[1]), '/driver#1')]
    again = [WheelSample(200 * MS, rates, source='/driver#2'), WheelSample(
        300 * MS, rates, (0.1 * rates[0], 0.1 * rates[1]), '/driver#2')]
    assert fed(START, publisher + again).predict(300 * MS).angles == pytest.approx(
        (0.3 * rates[0], 0.3 * rates[1]), abs=1e-13)


def test_the_first_sample_moves_nothing_whatever_its_positions():
    odometry, verdict = START.update(WheelSample(S, None, (500.0, -3.0)), NOW)
    assert verdict is Verdict.FIRST
    assert odometry.predict(5 * S).pose == Pose(1.0, -2.0, 3.0)
    assert odometry.predict(5 * S).angles == STILL


@given(schedules, st.sets(st.integers(0, 11)), st.tuples(
    st.floats(-1e4, 1e4), st.floats(-1e4, 1e4)))
def test_an_unknown_driver_that_lacks_its_positions_now_and_then_causes_no_jump(
        samples, lacking, offset):
    """Compare with the rates alone, which are what its encoders say: they count from anywhere."""
    full = [replace(sample, positions=(
        sample.positions[0] + offset[0], sample.positions[1] + offset[1]))
        for sample in with_positions(samples, source='')]
    told = [replace(sample, positions=None) if number in lacking else sample
            for number, sample in enumerate(full)]
    end = samples[-1].stamp_ns
    reading, exact = fed(UNEXTRAPOLATED, told).predict(end), fed(START, samples).predict(end)
    assert_same_reading(reading._replace(rates=STILL), exact._replace(rates=STILL), 1e-7)


def test_what_a_known_publisher_rolled_since_its_first_message_counts():
    first = WheelSample(0, STILL, source='/driver#1')
    second = WheelSample(20 * MS, STILL, (0.3, 0.4), source='/driver#1')
    assert fed(START, [first, second]).predict(20 * MS).angles == (0.3, 0.4)


def test_before_the_first_sample_the_base_stands_at_its_start():
    reading = START.predict(7 * S)
    assert reading == (Pose(1.0, -2.0, 3.0), STILL, STILL, STILL)


def test_before_the_anchor_the_base_is_where_it_is_at_the_anchor():
    odometry = fed(START, [WheelSample(0, A), WheelSample(S // 10, B)])
    assert odometry.predict(0) == odometry.predict(S // 10)


@given(schedules)
def test_positions_alone_give_the_same_angles_and_heading_but_nothing_beyond(samples):
    full = with_positions(samples)
    alone = fed(START, [replace(sample, rates=None) for sample in full])
    end = samples[-1].stamp_ns
    reading, exact = alone.predict(end), fed(START, samples).predict(end)
    assert reading.angles == pytest.approx(exact.angles, abs=1e-12)
    assert abs(wrapped_difference(reading.pose.theta, exact.pose.theta)) <= 1e-12
    assert alone.predict(end + T // 2).pose == reading.pose


def test_the_twist_is_that_of_the_rates():
    twist = fed(START, [WheelSample(0, A)]).predict(1).twist
    v_left, v_right = GEOMETRY.left_radius * 5.0, GEOMETRY.right_radius * 7.0
    assert twist == pytest.approx(
        ((v_left + v_right) / 2, (v_right - v_left) / GEOMETRY.separation))


OTHER = WheelGeometry(0.8, 0.2)


@given(schedules, st.integers(-100 * MS, S), st.booleans())
def test_a_change_of_geometry_keeps_pose_and_angles(samples, later, positions):
    odometry = fed(START, with_positions(samples) if positions else samples)
    now = samples[-1].stamp_ns + later
    changed = odometry.configured(OTHER, T, now)
    assert_same_reading(changed.predict(now), odometry.predict(now))
    assert changed.geometry == OTHER


@given(schedules, st.integers(1, 90 * MS), pairs)
def test_after_a_change_of_geometry_the_same_wheels_count_under_the_new_one(
        samples, later, rates):
    full = with_positions([*samples, WheelSample(samples[-1].stamp_ns + 100 * MS, rates)])
    now = samples[-1].stamp_ns + later
    changed = fed(START, full[:-1]).configured(OTHER, T, now)
    fresh = Odometry.starting_at(changed.predict(now).pose, geometry=OTHER, timeout_ns=T)
    fresh = fed(fresh, [WheelSample(now, samples[-1].rates)])
    end = full[-1].stamp_ns + 50 * MS
    without = replace(full[-1], positions=None)
    reading = fed(changed, full[-1:]).predict(end)
    assert reading.pose == pytest.approx(fed(fresh, [without]).predict(end).pose, abs=1e-11)
    assert reading.angles == pytest.approx(fed(START, [*samples, without]).predict(end).angles)


def test_a_base_that_timed_out_is_not_set_in_motion_by_a_longer_timeout():
    odometry = fed(START, [WheelSample(0, A)])
    changed = odometry.configured(GEOMETRY, None, 2 * S)
    assert changed.predict(9 * S).pose == pytest.approx(odometry.predict(2 * S).pose)
    assert changed.predict(9 * S).rates == STILL


def test_a_change_of_geometry_before_the_first_sample_keeps_the_start():
    changed = START.configured(OTHER, None, S)
    assert changed.predict(S) == START.predict(S)
    assert (changed.geometry, changed.timeout_ns) == (OTHER, None)


def test_a_change_of_geometry_between_positions_alone_does_not_make_a_speed_up():
    """Guard 10 km/s: an increment since the last sample over the time since the change."""
    odometry = fed(START, [WheelSample(k * 100 * MS, None, (0.1 * k, 0.1 * k)) for k in (0, 1)])
    changed = odometry.configured(GEOMETRY, T, 200 * MS - 1000)
    after = fed(changed, [WheelSample(200 * MS, None, (0.2, 0.2))])
    assert after.predict(200 * MS).rates == pytest.approx((1.0, 1.0))


@given(schedules, st.integers(-1000 * S, 1000 * S), st.integers(0, 2 * S), pairs)
def test_after_the_clock_was_stepped_everything_goes_on_as_before(samples, step, later, rates):
    odometry = fed(START, samples)
    stepped, time = odometry.clock_stepped(step), samples[-1].stamp_ns + 1 + later
    assert stepped.predict(time + step) == odometry.predict(time)
    following, _ = stepped.update(WheelSample(time + step, rates), time + step)
    assert following.predict(time + step + T) == fed(
        odometry, [WheelSample(time, rates)]).predict(time + T)


def test_the_clock_may_step_before_the_first_sample():
    assert START.clock_stepped(S) == START


@pytest.mark.parametrize('samples', [
    [WheelSample(0, (9e11, 9e11))],
    [WheelSample(0, STILL, (-9e11, 0.0)), WheelSample(1, STILL, (9e11, 0.0))]])
def test_motion_that_is_absurd_for_this_geometry_is_refused(samples):
    big = Odometry.starting_at(
        Pose(0.0, 0.0, 0.0), geometry=WheelGeometry(0.1, 10.0), timeout_ns=T)
    odometry = fed(big, samples[:-1])
    with pytest.raises(ValueError, match='(velocity|position) .left, right. is'):
        odometry.update(samples[-1], NOW)


@pytest.mark.parametrize(('pose', 'name'), [
    (Pose(math.nan, 0.0, 0.0), 'x'), (Pose(0.0, math.inf, 0.0), 'y'),
    (Pose(0.0, 0.0, -math.inf), 'yaw')])
def test_a_start_that_is_not_finite_is_refused_by_name(pose, name):
    with pytest.raises(ValueError, match=f'^{name} of the pose is'):
        Odometry.starting_at(pose, geometry=GEOMETRY, timeout_ns=None)


def test_many_turns_lose_no_digit_of_the_heading():
    """Drive 20000 arcs: the wrapped heading is that of the unwrapped angles."""
    odometry = START
    for k in range(20_000):
        odometry, _ = odometry.update(
            WheelSample(k * 100 * MS, (5.0, 7.0 + k % 2)), NOW + k * S)
    reading = odometry.predict(19_999 * 100 * MS)
    with mpmath.workdps(50):
        left = mpmath.mpf(GEOMETRY.left_radius) * reading.angles[0]
        right = mpmath.mpf(GEOMETRY.right_radius) * reading.angles[1]
        theta = 3 + (right - left) / GEOMETRY.separation
        assert abs(mpmath.fmod(theta - reading.pose.theta + 1, 2 * mpmath.pi) - 1) < 1e-11


def test_a_stop_that_is_under_way_while_settings_change_is_obeyed():
    """Guard a base that drives on, for good where the publisher does not repeat itself."""
    odometry = fed(START, [WheelSample(100 * MS, (5.0, 5.0))])
    changed = odometry.configured(GEOMETRY, None, 205 * MS)
    stopped = fed(changed, [WheelSample(200 * MS, (0.0, 0.0))])
    assert stopped.predict(9 * S).rates == (0.0, 0.0)
    assert stopped.predict(9 * S).pose == stopped.predict(206 * MS).pose


@given(schedules, st.integers(0, 400 * MS), st.booleans())
def test_a_base_that_is_put_elsewhere_stands_there_and_then_moves_on_by_what_wheels_roll(
        schedule, after, with_rates):
    samples = with_positions(schedule)
    if not with_rates:
        samples = [replace(sample, rates=None) for sample in samples]
    when = samples[-1].stamp_ns + after
    before = fed(UNTIMED, samples)
    placed = before.set_pose(Pose(-3.0, 4.0, 0.5), NO_COVARIANCE, when)
    reading = placed.predict(when + 10 * S)
    assert (reading.pose, reading.twist, reading.rates) == (
        Pose(-3.0, 4.0, 0.5), (0.0, 0.0), (0.0, 0.0))
    assert reading.angles == before.predict(when).angles
    angle = [rate * after / 1e9 for rate in samples[-1].rates or STILL]
    last = samples[-1].positions
    following = WheelSample(
        when + 20 * MS, A if with_rates else None,
        (last[0] + angle[0] + 0.3, last[1] + angle[1] + 0.3), '/driver#1')
    moved, verdict = placed.update(following, NOW)
    assert verdict is Verdict.MOVED
    expected = advance(Pose(-3.0, 4.0, 0.5), *twist_from_wheel_rates(GEOMETRY, 0.3, 0.3))
    got = moved.predict(following.stamp_ns)
    assert got.pose == pytest.approx(expected, abs=1e-9)
    assert got.twist == twist_from_wheel_rates(GEOMETRY, *got.rates)


def test_a_base_that_is_put_elsewhere_has_the_covariance_and_the_angles_that_are_asked_for():
    given_covariance = PoseCovariance(0.1, 0.0, 0.0, 0.2, 0.0, 0.3)
    odometry = fed(START._replace(slip_variances=(0.01, 0.01)), with_positions(
        [WheelSample(number * 20 * MS, A) for number in range(9)]))
    placed = odometry.set_pose(Pose(0.0, 0.0, 0.0), given_covariance, S, keep_angles=False)
    assert placed.covariance_at(2 * S) == given_covariance
    assert placed.predict(2 * S).angles == STILL
    assert odometry.covariance_at(S) != given_covariance


def test_a_base_that_has_heard_nothing_can_be_put_elsewhere():
    pose = Pose(1.0, 2.0, 3.0)
    assert START.set_pose(pose, NO_COVARIANCE, S).predict(S).pose == pose


def test_a_message_that_was_on_its_way_while_the_base_was_put_elsewhere_is_no_jump():
    steady = with_positions([WheelSample(number * 10 * MS, A) for number in range(17)])
    placed = fed(START, steady[:11]).set_pose(Pose(0.0, 0.0, 0.0), NO_COVARIANCE, 120 * MS)
    moved = fed(placed, [steady[11], steady[16]])
    expected = 0.04 * (GEOMETRY.right_radius * A[1] - GEOMETRY.left_radius * A[0])
    assert moved.predict(160 * MS).pose.theta == pytest.approx(
        expected / GEOMETRY.separation, abs=1e-12)


def test_a_base_that_is_put_elsewhere_by_a_clock_a_little_behind_forgets_no_stamp():
    """Guard an old message, heard a second time, that was taken for motion backward."""
    samples = with_positions([WheelSample(number * 100 * MS, (number, number)) for number in (
        1, 2, 3)])
    odometry = fed(START, samples).set_pose(Pose(0.0, 0.0, 0.0), NO_COVARIANCE, 150 * MS)
    again, verdict = odometry.update(samples[1], 160 * MS)
    assert verdict is Verdict.OUT_OF_ORDER and again.predict(S).pose == Pose(0.0, 0.0, 0.0)


@pytest.mark.parametrize('pose', [
    Pose(math.nan, 0.0, 0.0), Pose(0.0, math.inf, 0.0), Pose(0.0, 0.0, -math.inf)])
def test_a_base_is_put_nowhere_that_is_not_finite(pose):
    with pytest.raises(ValueError, match='of the pose'):
        START.set_pose(pose, NO_COVARIANCE, S)


@pytest.mark.parametrize('step_s', [-3600, 3600])
def test_a_publisher_whose_clock_steps_for_good_goes_on_moving_the_base(step_s):
    odometry = START
    way = []
    for number in range(200):
        now_ns = NOW + number * 20 * MS
        stamp = now_ns + (step_s * S if number > 99 else 0)
        odometry, _ = odometry.update(WheelSample(
            stamp, (3.0, 3.0), (0.06 * number, 0.06 * number)), now_ns)
        way.append(odometry.predict(now_ns).angles[0])
    assert way[-1] - way[100] == pytest.approx(99 * 0.06, abs=1e-9)
    assert max(b - a for a, b in zip(way, way[1:])) < 0.5 * 3.0 + 0.061


def ahead(seconds):
    """Return a base whose publisher's clock is ahead, having driven at one speed, and the time."""
    odometry, now_ns = START, NOW
    for number in range(100):
        now_ns = NOW + number * 20 * MS
        odometry, _ = odometry.update(WheelSample(
            now_ns + seconds * S, (3.0, 3.0), (0.06 * number, 0.06 * number)), now_ns)
    return odometry, now_ns


@pytest.mark.parametrize('seconds', [0, 2, 3600])
def test_a_base_is_put_elsewhere_without_a_jump_however_far_ahead_the_publishers_clock_is(seconds):
    odometry, now_ns = ahead(seconds)
    placed = odometry.set_pose(Pose(0.0, 0.0, 0.0), NO_COVARIANCE, now_ns)
    assert placed.predict(now_ns).angles == odometry.predict(now_ns).angles
    moved, _ = placed.update(WheelSample(
        now_ns + seconds * S + 20 * MS, (3.0, 3.0), (6.0, 6.0)), now_ns + 20 * MS)
    assert moved.predict(now_ns + 20 * MS).angles == pytest.approx((6.0, 6.0), abs=1e-12)
    distance, _ = twist_from_wheel_rates(GEOMETRY, 0.06, 0.06)
    pose = moved.predict(now_ns + 20 * MS).pose
    assert math.hypot(pose.x, pose.y) == pytest.approx(distance, rel=1e-3)


@pytest.mark.parametrize('seconds', [0, 2, 3600])
def test_what_was_driven_stays_driven_however_far_ahead_the_publishers_clock_is(seconds):
    odometry, now_ns = ahead(seconds)
    changed = odometry.configured(OTHER, T, now_ns)
    assert_same_reading(changed.predict(now_ns), odometry.predict(now_ns))


@given(st.integers(1, 50), pairs, pairs, st.integers(1, 19))
def test_a_lost_change_of_the_rates_costs_the_arc_of_one_message_however_long_they_were_held(
        repeats, before, after, change_ms):
    """Rates were held for repeats * 20 ms, changed within the next 20 ms, and that was lost."""
    start = UNTIMED
    change = repeats * 20 * MS + change_ms * MS
    times = [number * 20 * MS for number in range(repeats + 1)]
    samples = [WheelSample(S + time, before, scaled(before, time), '/driver#1') for time in times]
    at_change = scaled(before, change)
    rest = scaled(after, (20 - change_ms) * MS)
    end = WheelSample(S + times[-1] + 20 * MS, after,
                      (at_change[0] + rest[0], at_change[1] + rest[1]), '/driver#1')
    whole = fed(start, [*samples, WheelSample(S + change, after, at_change, '/driver#1'), end])
    lossy = fed(start, [*samples, end])
    got, expected = lossy.predict(end.stamp_ns), whole.predict(end.stamp_ns)
    distance = turn = 0.0
    for rates, seconds in ((before, change_ms / 1e3), (after, 0.02 - change_ms / 1e3)):
        v, w = twist_from_wheel_rates(GEOMETRY, *rates)
        distance, turn = distance + abs(v) * seconds, turn + abs(w) * seconds
    assert math.dist(got.pose[:2], expected.pose[:2]) <= 1.5 * distance * turn + 1e-12
    assert wrapped_difference(got.pose.theta, expected.pose.theta) < 1e-12
    assert got.angles == pytest.approx(expected.angles, abs=1e-12)


def scaled(rates, time_ns):
    return rates[0] * time_ns / 1e9, rates[1] * time_ns / 1e9


@given(heading=st.floats(-1e6, 1e6), left=st.floats(-1e6, 1e6), right=st.floats(-1e6, 1e6))
def test_its_arc_is_that_of_advance_to_the_last_bit(heading, left, right):
    odometry = Odometry.starting_at(
        Pose(0.0, 0.0, heading), geometry=GEOMETRY, timeout_ns=None)
    distance, turn = pose_change_from_travel(
        GEOMETRY, *travel_from_angles(GEOMETRY, left, right))
    arc = advance(Pose(0.0, 0.0, odometry.anchor.heading), distance, turn)
    odometry = fed(odometry, [
        WheelSample(S, STILL, STILL, '/driver#1'),
        WheelSample(2 * S, A, (left, right), '/driver#1')])
    assert (odometry.anchor.x.value, odometry.anchor.y.value) == (arc.x, arc.y)
