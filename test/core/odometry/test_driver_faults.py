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

"""Odometry that holds with drivers whose messages pause, drift, spike, alternate or come late."""

from diffdrive_kinematics.core.kinematics import Pose, WheelGeometry
from diffdrive_kinematics.core.noise import NO_COVARIANCE
from diffdrive_kinematics.core.odometry import MeasuredWheels, Verdict, WheelSample
import pytest
from support.driver import (
    base, driven, Driver, GEOMETRY, MS, RADIUS, S, seconds_of, START_NS, steady)

RATE = 5.0  # [rad/s]


@pytest.mark.parametrize('pause_s', [1, 3, 10, 60])
@pytest.mark.parametrize('velocity', [None, lambda rate: rate])
def test_a_pause_after_the_first_message_is_no_usual_interval(pause_s, velocity):
    """Guard 0.4 rad/s for 5 a second later: a driver that waits for its motors to start."""
    driver = Driver(lambda at: RATE * max(0.0, at - pause_s), velocity=velocity)
    messages = driver.messages(pause_s + 1.0)
    messages = messages[:1] + tuple(
        each for each in messages if seconds_of(each[0]) > pause_s)
    _, odometry = driven(base(), messages)
    assert odometry.predict(messages[-1][0]).rates[0] == pytest.approx(RATE)
    assert odometry.measured.window.usual_ns < 40 * MS


@pytest.mark.parametrize('extrapolates', [True, False])
@pytest.mark.parametrize('resolution', [0.0, 90.0])
def test_wheels_that_turn_are_not_at_rest_whatever_is_held_until_the_next_message(
        extrapolates, resolution):
    for rate, rests in (0.5, False), (0.0, True):
        _, odometry = driven(
            base(unmeasured=MeasuredWheels(extrapolates=extrapolates)),
            Driver(steady(rate), resolution=resolution).messages(5.0))
        assert odometry.at_rest is rests


def test_a_base_that_has_heard_nothing_is_not_known_to_be_at_rest():
    assert not base().at_rest


@pytest.mark.parametrize('kind', ['rates', 'both', 'positions'])
@pytest.mark.parametrize('slow_ppm', [200, 5000])
def test_a_clock_that_is_slow_never_takes_the_base_back(kind, slow_ppm):
    """Guard 1.2 rad backward once a minute."""
    odometry, angles = base(), []
    for number in range(5000):
        arrival = START_NS + number * 20 * MS
        stamp = arrival - 5 * S - number * 20 * MS * slow_ppm // 10**6
        angle = RATE * number * 0.02
        odometry, _ = odometry.update(WheelSample(
            stamp, None if kind == 'positions' else (RATE, RATE),
            None if kind == 'rates' else (angle, angle)), arrival + MS)
        angles += [odometry.predict(arrival + wait * MS).angles[0] for wait in (1, 6, 11, 16)]
        assert angles[-1] <= RATE * (0.02 * number + 0.3)
    assert min(b - a for a, b in zip(angles, angles[1:])) >= -1e-9


@pytest.mark.parametrize('period_ms', [20, 100])
def test_a_clock_that_drifts_from_the_own_one_until_it_is_another_takes_no_base_back(period_ms):
    """Guard 1.2 rad backward when the clocks part."""
    odometry, angles, twists = base(), [], set()
    for number in range(60_000 // period_ms):
        arrival, seconds = START_NS + number * period_ms * MS, number * period_ms / 1e3
        odometry, verdict = odometry.update(WheelSample(
            arrival - round(seconds * 5e-3 * S), (RATE, RATE)), arrival)
        assert verdict is not Verdict.OUT_OF_ORDER and verdict is not Verdict.CLOCK_STEP
        for wait in 0, period_ms // 2:
            reading = odometry.predict(arrival + wait * MS)
            angles.append(reading.angles[0])
            twists.add(reading.rates)
    assert odometry.clock.differs
    assert twists == {(RATE, RATE)}
    assert min(b - a for a, b in zip(angles, angles[1:])) >= -1e-9


def test_a_clock_that_starts_behind_and_drifts_on_stops_no_wheel():
    odometry = base()
    for number in range(3000):
        arrival = START_NS + number * 100 * MS
        odometry, _ = odometry.update(WheelSample(
            arrival - 200 * MS - number * MS // 10, (RATE, RATE)), arrival)
        for wait in 0, 50, 99:
            assert odometry.predict(arrival + wait * MS).rates == (RATE, RATE), number


@pytest.mark.parametrize('period_ms', [20, 100])
@pytest.mark.parametrize('spike', [50.0, 500.0, -500.0])
def test_one_velocity_that_is_wrong_does_the_harm_of_one_message(period_ms, spike):
    """Guard a pose that was 10 rad ahead for 2 s."""
    odometry, at = base(), 5000 // period_ms
    for number in range(at + 20):
        arrival = START_NS + number * period_ms * MS
        angle, rate = RATE * number * period_ms / 1e3, spike if number == at else RATE
        odometry, _ = odometry.update(WheelSample(
            arrival, (rate, rate), (angle, angle)), arrival)
        if number < at - 5:
            continue
        message = RATE * period_ms / 1e3
        for wait in 0, period_ms - 1:
            error = odometry.predict(arrival + wait * MS).angles[0] - RATE * (
                number * period_ms + wait) / 1e3
            assert abs(error) <= (3.0 if number == at else 1.0 if number == at + 1 else
                                  1e-6) * message + 1e-9, number


def test_positions_that_come_now_and_then_do_not_stop_the_twist():
    odometry = base()
    for number in range(50):
        arrival, angle = START_NS + number * 10 * MS, RATE * number * 0.01
        odometry, _ = odometry.update(WheelSample(
            arrival, (RATE, RATE), (angle, angle) if number % 10 == 9 else None), arrival)
        assert odometry.predict(arrival).rates == pytest.approx((RATE, RATE))


def test_a_shorter_timeout_makes_a_clock_that_is_behind_another_one():
    """Guard wheels that time out between two messages."""
    odometry = base()
    for number in range(300):
        arrival = START_NS + number * 20 * MS
        if number == 100:
            odometry = odometry.configured(GEOMETRY, 100 * MS, arrival - MS)
        odometry, _ = odometry.update(WheelSample(arrival - 200 * MS, (RATE, RATE)), arrival)
        assert odometry.predict(arrival + 5 * MS).rates == (RATE, RATE), number


@pytest.mark.parametrize('period_ms, latency_ms', [(20, 45), (20, 200), (1, 5), (100, 150)])
@pytest.mark.parametrize('kind', ['rates', 'positions'])
@pytest.mark.parametrize('what', ['placed', 'configured'])
def test_messages_under_way_while_the_base_is_put_elsewhere_or_set_anew_are_in_order(
        period_ms, latency_ms, kind, what):
    odometry, verdicts = base(), []
    for number in range(100):
        arrival = START_NS + (number * period_ms + latency_ms) * MS
        if number == 50:
            odometry = odometry.set_pose(
                Pose(0.0, 0.0, 0.0), NO_COVARIANCE, arrival - MS // 2) if what == 'placed' \
                else odometry.configured(WheelGeometry(0.17, RADIUS), S // 2, arrival - MS // 2)
        angle = RATE * number * period_ms / 1e3
        odometry, verdict = odometry.update(WheelSample(
            arrival - latency_ms * MS, (RATE, RATE) if kind == 'rates' else None,
            (angle, angle) if kind == 'positions' else None), arrival)
        verdicts.append(verdict)
    assert Verdict.OUT_OF_ORDER not in verdicts
    assert odometry.motion.last_ns == arrival - latency_ms * MS
