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

"""Odometry that holds with drivers as they are: their clocks, positions and velocities."""

from diffdrive_kinematics.core.odometry import MeasuredWheels, RateWindow, Verdict, WheelSample
import pytest
from support.driver import base, driven, Driver, MS, RADIUS, ramp, S, seconds_of, START_NS, steady

RATE = 5.0  # [rad/s]
ZERO = (0.0, 0.0)


def backward(readings):
    """Return the largest step [rad] back of a wheel that turns forward."""
    return max(a.angles[0] - b.angles[0] for (_, a), (_, b) in zip(readings, readings[1:]))


def settled(readings, seconds=1.0):
    return [(time, reading) for time, reading in readings if seconds_of(time) > seconds]


CLOCKS = {
    'own': {}, 'since boot': {'offset_ns': 1_699_999_000 * S}, 'far ahead': {'offset_ns': -7 * S},
    'a little ahead': {'offset_ns': -S // 2}, 'late': {'latency_ns': 600 * MS},
    'behind': {'offset_ns': 5 * S}}


@pytest.mark.parametrize('clock', CLOCKS)
@pytest.mark.parametrize('kind', ['rates', 'both', 'positions'])
def test_whatever_the_clock_of_the_driver_the_twist_is_right_and_the_stop_takes_nothing_back(
        clock, kind):
    stop = 4.0
    driver = Driver(
        lambda at: RATE * min(at, stop), positions=kind != 'rates',
        velocity=None if kind == 'positions' else lambda rate: rate, **CLOCKS[clock])
    readings, _ = driven(base(), driver.messages(6.0))
    moving = [reading for time, reading in settled(readings) if seconds_of(time) < stop]
    assert all(r.rates == pytest.approx((RATE, RATE), rel=1e-6) for r in moving)
    extrapolated = RATE * (0.02 + (driver.latency_ns / S if clock == 'own' else 0.0))
    assert backward(readings) <= extrapolated + 1e-9, 'from one message to the next'
    assert backward([item for item in readings if seconds_of(item[0]) < stop]) <= 1e-9
    error = RATE * 0.02 if kind == 'rates' else 1e-9
    assert readings[-1][1].angles[0] == pytest.approx(RATE * stop, abs=error)
    assert readings[-1][1].rates == ZERO


@pytest.mark.parametrize('clock', ['own', 'since boot', 'far ahead'])
def test_wheels_stop_a_timeout_after_the_last_message_arrived_whatever_its_clock(clock):
    driver = Driver(steady(RATE), positions=False, velocity=lambda rate: rate, **CLOCKS[clock])
    messages = driver.messages(3.0)
    last = messages[-1][0]
    readings, odometry = driven(base(), messages, until_ns=last + 2 * S)
    lag = 0 if clock == 'own' else driver.latency_ns
    stop_ns = last - driver.latency_ns + lag + S // 2
    tolerance = 4 * MS  # what the least latency has risen by
    assert odometry.predict(stop_ns - tolerance).rates == pytest.approx((RATE, RATE))
    assert odometry.predict(stop_ns + tolerance).rates == ZERO
    assert readings[-1][1].angles[0] == odometry.predict(stop_ns + tolerance).angles[0]
    assert backward(readings) <= 0.0


def test_a_latency_that_grows_for_good_in_mid_drive_is_followed():
    angle = steady(RATE)
    early = Driver(angle, velocity=lambda rate: rate).messages(3.0)
    late = Driver(angle, velocity=lambda rate: rate, latency_ns=900 * MS).messages(9.0)
    messages = early + tuple(each for each in late if each[1].stamp_ns > early[-1][1].stamp_ns)
    readings, odometry = driven(base(), messages)
    assert odometry.clock.differs
    assert odometry.clock.offset_ns == pytest.approx(900 * MS, abs=20 * MS)
    assert all(r.rates[0] == pytest.approx(RATE) for _, r in settled(readings, 6.0))


@pytest.mark.parametrize('pace', [0.3, 1.0])
def test_a_driver_on_wall_time_moves_a_base_on_simulated_time_at_the_pace_of_its_positions(pace):
    driver = Driver(steady(RATE), velocity=lambda rate: rate)
    sim = [(S + round((arrival - START_NS) * pace), sample)
           for arrival, sample in driver.messages(6.0)]
    odometry, angles = base(), []
    for arrival, sample in sim:
        odometry, _ = odometry.update(sample, arrival)
        angles += [odometry.predict(arrival + wait).angles[0] for wait in (0, 5 * MS)]
        assert angles[-2] == pytest.approx(RATE * seconds_of(sample.stamp_ns), abs=1e-6)
    assert all(a <= b for a, b in zip(angles, angles[1:]))
    assert odometry.clock.differs and odometry.predict(arrival).rates[0] == pytest.approx(RATE)


def test_a_clock_that_agrees_is_not_mapped_by_a_bit():
    driver = Driver(steady(RATE), positions=False, velocity=lambda rate: rate)
    _, odometry = driven(base(), driver.messages(3.0))
    assert not odometry.clock.apart
    time = odometry.motion.anchor_ns + 3 * S + 7
    unmapped = odometry._replace(wheels=odometry.wheels._replace(clock=base().clock))
    assert odometry.predict(time) == unmapped.predict(time)


def pairs_of(rate, gap_ns, stamped=True):
    """Return messages of which two, 20 ms apart, come as a pair."""
    out = []
    for number in range(200):
        arrival = START_NS + (number // 2) * 40 * MS + number % 2 * gap_ns
        angle = rate * number * 0.02
        out.append((arrival, WheelSample(arrival, None, (angle, angle))))
    return out


@pytest.mark.parametrize('gap_ns', [500_000, 13_000, 1])
def test_messages_in_pairs_publish_the_speed_that_they_amount_to(gap_ns):
    """Guard 6.6 m/s for 0.165, and 252 where stamps are those of arrival."""
    rate = 0.165 / RADIUS
    odometry, speeds = base(), []
    for arrival, sample in pairs_of(rate, gap_ns):
        odometry, _ = odometry.update(sample, arrival)
        speeds.append(odometry.predict(arrival).twist[0])
    assert max(speeds) <= 0.165 * 1.001
    assert min(speeds[20:]) >= 0.165 * 0.9


@pytest.mark.parametrize('period_ms', [10, 20, 50])
@pytest.mark.parametrize('stamped', [True, False])
def test_a_wheel_that_flickers_between_two_ticks_hardly_turns(period_ms, stamped):
    """Guard -1.4 to 8.5 rad/s for 0: 90 ticks a turn, and 4 ms of jitter."""
    tick = 4.0 * 3.141592653589793 / 180.0
    number = [0]

    def flicker(_):
        number[0] += 1
        return tick * (number[0] * 7 % 3 // 2)

    driver = Driver(flicker, period_ms * MS, jitter_ns=4 * MS, stamped=stamped, resolution=0.0)
    readings, _ = driven(base(), driver.messages(8.0))
    bound = tick / (8 * period_ms / 1e3)
    assert max(abs(r.rates[0]) for _, r in settled(readings, 2.0)) <= bound


@pytest.mark.parametrize('rate', [0.3, 3.0, 12.0])
def test_the_rate_of_coarse_encoders_with_jitter_is_right_to_a_tick_in_the_window(rate):
    driver = Driver(steady(rate), 20 * MS, jitter_ns=4 * MS, stamped=False, resolution=90)
    readings, _ = driven(base(), driver.messages(8.0))
    error = 6.283185307179586 / 90 / 0.2 + rate * 0.01 / 0.2
    rates = [reading.rates[0] for _, reading in settled(readings, 2.0)]
    assert max(abs(each - rate) for each in rates) <= error
    assert min(rates) >= 0.0


def test_a_burst_after_a_stall_with_stamps_of_arrival_is_no_high_speed():
    odometry, speeds = base(max_rate=1000.0), []
    for number in range(300):
        arrival = START_NS + number * 20 * MS
        if 100 <= number < 150:
            arrival = START_NS + 150 * 20 * MS - (150 - number) * 10_000
        angle = RATE * number * 0.02
        odometry, verdict = odometry.update(WheelSample(
            arrival, None, (angle, angle)), arrival)
        assert verdict is not Verdict.JUMPED
        speeds.append(odometry.predict(arrival).rates[0])
    assert max(speeds) <= RATE * 1.3
    assert speeds[-1] == pytest.approx(RATE)


def test_the_window_is_as_long_as_it_is_set():
    for size in 1, 4, 10:
        odometry = base(unmeasured=MeasuredWheels(window=RateWindow(size)))
        for arrival, sample in Driver(ramp(10.0, 0.0, 10.0)).messages(3.0):
            odometry, _ = odometry.update(sample, arrival)
        assert odometry.predict(arrival).rates[0] == pytest.approx(3.0 - size * 0.01, abs=1e-6)


WRONG = {
    'in rpm': (lambda rate: rate * 9.549, 9.549), 'in deg/s': (lambda rate: rate * 57.3, 57.3),
    'always zero': (lambda rate: 0.0, 0.0), 'of the other sign': (lambda rate: -rate, -1.0),
    'half': (lambda rate: 0.5 * rate, 0.5), 'half as much again': (lambda rate: 1.5 * rate, 1.5)}


@pytest.mark.parametrize('wrong', WRONG)
@pytest.mark.parametrize('period_ms', [20, 100])
def test_velocities_that_contradict_the_positions_move_nothing_and_are_told(wrong, period_ms):
    tell, factor = WRONG[wrong]
    driver = Driver(steady(RATE), period_ms * MS, velocity=tell)
    readings, odometry = driven(base(), driver.messages(12.0))
    assert backward(readings) <= 1e-9
    assert all(r.rates[0] == pytest.approx(RATE) for _, r in settled(readings))
    told = odometry.measured.check.disagreement
    assert told.side == 'both' and told.reported / told.rolled == pytest.approx(factor, abs=1e-6)
    late = [(time, r) for time, r in settled(readings, 2.0)]
    assert max(abs(r.angles[0] - RATE * seconds_of(time)) for time, r in late) <= 1e-6


def test_the_configured_maximum_that_is_told_while_standing_moves_nothing():
    driver = Driver(steady(0.0), velocity=lambda rate: 20.0)
    readings, odometry = driven(base(), driver.messages(5.0))
    assert all(r.angles == r.rates == ZERO for _, r in readings)
    told = odometry.measured.check.disagreement
    assert told.rolled == 0.0 < told.reported


def test_velocities_that_agree_again_are_used_again():
    def tell(rate):
        return (9.549 if tell.wrong else 1.0) * rate

    tell.wrong = True
    driver = Driver(steady(RATE), velocity=tell)
    _, odometry = driven(base(), driver.messages(5.0))
    check = odometry.measured.check
    assert check.disagreement and not check.believed
    tell.wrong = False
    for arrival, sample in driver.messages(9.0):
        if sample.stamp_ns > odometry.motion.last_ns:
            odometry, _ = odometry.update(sample, arrival)
    check = odometry.measured.check
    assert check.believed and check.disagreement is None
    assert odometry.motion.rates == pytest.approx((RATE, RATE))


def test_one_wheel_that_is_wrong_is_named():
    odometry = base()
    for arrival, sample in Driver(steady(RATE), velocity=lambda rate: rate).messages(5.0):
        odometry, _ = odometry.update(WheelSample(
            sample.stamp_ns, (RATE, -RATE), sample.positions), arrival)
    assert odometry.measured.check.disagreement.side == 'right'


@pytest.mark.parametrize('period_ms', [33, 100, 250])
@pytest.mark.parametrize('jitter_ms', [0, 8])
def test_positions_alone_are_extrapolated_so_that_the_pose_is_that_of_its_stamp(
        period_ms, jitter_ms):
    driver = Driver(steady(RATE), period_ms * MS, jitter_ns=jitter_ms * MS)
    messages = driver.messages(8.0)
    readings, _ = driven(base(), messages)
    assert backward(readings) <= 1e-9
    first = messages[0][1].positions[0]
    for time, reading in settled(readings, 6 * period_ms / 1e3):
        assert reading.angles[0] == pytest.approx(RATE * seconds_of(time) - first, abs=1e-6)
        assert reading.pose.x == pytest.approx(RADIUS * reading.angles[0], abs=1e-9)


def test_without_extrapolation_the_pose_is_that_of_the_last_positions():
    driver = Driver(steady(RATE), 100 * MS)
    odometry = base(unmeasured=MeasuredWheels(extrapolates=False))
    readings, _ = driven(odometry, driver.messages(3.0))
    told = [RATE * 0.1 * number for number in range(31)]
    assert all(min(abs(r.angles[0] - each) for each in told) < 1e-9 for _, r in readings)


def test_extrapolation_ends_after_a_few_intervals_of_silence_and_rates_after_the_timeout():
    messages = Driver(steady(RATE), 50 * MS).messages(4.0)
    last = messages[-1][1].stamp_ns
    _, odometry = driven(base(), messages)
    known = 4.0 * RATE
    assert odometry.predict(last + 150 * MS).angles[0] == pytest.approx(known + 0.15 * RATE)
    assert odometry.predict(last + 60 * S).angles == odometry.predict(last + 150 * MS).angles
    assert odometry.predict(last + 499 * MS).rates[0] == pytest.approx(RATE)
    assert odometry.predict(last + 500 * MS).rates == ZERO


def test_standing_wheels_do_not_creep_and_are_where_their_positions_say():
    driver = Driver(lambda at: RATE * min(at, 3.0), 100 * MS)
    readings, odometry = driven(base(), driver.messages(6.0))
    assert backward(readings) <= RATE * 0.1 + 0.01, 'what was extrapolated from one message'
    standing = [reading.angles[0] for _, reading in settled(readings, 3.3)]
    assert set(standing) == {standing[0]}
    assert standing[0] == pytest.approx(RATE * 3.0, abs=1e-9)
    assert readings[-1][1].rates == ZERO


KINDS = {
    'jitter': {'jitter_ns': 8 * MS, 'stamped': False}, 'late': {'latency_ns': 700 * MS},
    'since boot': {'offset_ns': 1_699_999_000 * S}, 'ticks': {'resolution': 90.0},
    'rpm': {'velocity': lambda rate: 9.549 * rate}, 'zero': {'velocity': lambda rate: 0.0},
    'right': {'velocity': lambda rate: rate}, 'fast': {'velocity': lambda rate: 1.1 * rate},
    'all': {'jitter_ns': 8 * MS, 'latency_ns': 700 * MS, 'resolution': 90.0,
            'offset_ns': 1_699_999_000 * S, 'velocity': lambda rate: 9.549 * rate}}


@pytest.mark.parametrize('kind', KINDS)
@pytest.mark.parametrize('period_ms', [20, 100])
@pytest.mark.parametrize('rate', [1.0, 5.0, 17.3])
def test_a_robot_that_drives_steadily_is_never_published_backward(kind, period_ms, rate):
    driver = Driver(steady(rate), period_ms * MS, **KINDS[kind])
    readings, _ = driven(base(max_rate=1000.0), driver.messages(8.0))
    assert backward(readings) <= 1e-9


def test_a_counter_of_16_bits_that_wraps_is_a_jump_without_a_bound_that_somebody_set():
    """Guard 151 m in one message: 2048 ticks a turn."""
    odometry, tick, verdicts = base(max_rate=1000.0), 6.283185307179586 / 2048, []
    for number in range(400):
        count = (number * 100 + 32768) % 65536 - 32768
        arrival = START_NS + number * 20 * MS
        odometry, verdict = odometry.update(WheelSample(
            arrival, None, (count * tick, count * tick)), arrival)
        verdicts.append(verdict)
    assert verdicts.count(Verdict.JUMPED) == 1
    assert odometry.predict(arrival).angles[0] == pytest.approx(399 * 100 * tick, abs=1e-6)


@pytest.mark.parametrize('gap_ns', [1, 1000, 500_000])
def test_positions_that_come_at_almost_one_time_are_no_jump(gap_ns):
    odometry, verdicts = base(max_rate=1000.0), set()
    for arrival, sample in pairs_of(50.0, gap_ns):
        odometry, verdict = odometry.update(sample, arrival)
        verdicts.add(verdict)
    assert verdicts == {Verdict.FIRST, Verdict.MOVED}


def test_a_frame_in_the_header_does_not_make_a_driver_one_of_this_package():
    """Guard a leap by all that encoders count: a first message without positions is no zero."""
    odometry = base()
    for number, positions in enumerate([None, (500.0, 500.0), (500.1, 500.1)]):
        odometry, _ = odometry.update(WheelSample(
            START_NS + number * 20 * MS, ZERO, positions, 'base_link'),
            START_NS + number * 20 * MS)
    assert odometry.predict(START_NS + 40 * MS).angles == pytest.approx((0.1, 0.1))


@pytest.mark.parametrize('frame', ['', 'base_link', '/base_link'])
def test_what_a_driver_tells_is_the_same_whatever_its_frame(frame):
    messages = Driver(steady(RATE), 20 * MS, velocity=lambda rate: 9.549 * rate).messages(2.0)
    odometry, other = base(), base()
    for arrival, sample in messages:
        odometry, _ = odometry.update(sample, arrival)
        other, _ = other.update(WheelSample(
            sample.stamp_ns, sample.rates, sample.positions, frame), arrival)
    assert odometry.predict(arrival) == other.predict(arrival)


def test_the_publishers_of_this_package_are_taken_at_their_word():
    messages = Driver(ramp(RATE, 0.0, 2.0), 20 * MS, velocity=lambda rate: rate).messages(3.0)
    odometry = base()
    for arrival, sample in messages:
        odometry, _ = odometry.update(WheelSample(
            sample.stamp_ns, sample.rates, sample.positions, '/noise#1'), arrival)
        assert odometry.predict(arrival).rates == sample.rates
