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

"""Velocities against positions: no false alarm, none that is missed, and what is told of it."""

import math

from diffdrive_kinematics.core.odometry import VelocityCheck
from hypothesis import given, strategies as st
import pytest
from support.driver import Driver, MS, ramp, S, sway
from support.recorded import load, RUNS, wheel_positions


def checked(messages):
    """Return the checks after each of the messages."""
    check, checks, last = VelocityCheck(), [], None
    for _, sample in messages:
        if last is not None:
            check = check.followed(
                sample.rates, tuple(
                    b - a for a, b in zip(last.positions, sample.positions)),
                (sample.stamp_ns - last.stamp_ns) / S)
            checks.append(check)
        last = sample
    return checks


def filtered(rows, seconds):
    """Return (increments, time, velocities) of a recording whose driver filters velocities."""
    positions, rates, out = wheel_positions(rows), (0.0, 0.0), []
    for before, after, start, end in zip(rows, rows[1:], positions, positions[1:]):
        interval = after['time_sec'] - before['time_sec']
        share = interval / (interval + seconds)
        increments = tuple(b - a for a, b in zip(start, end))
        rates = tuple(
            rate + share * (angle / interval - rate) for rate, angle in zip(rates, increments))
        out.append((rates, increments, interval))
    return out


@pytest.mark.parametrize('seconds', [0.0, 0.05, 0.2])
@pytest.mark.parametrize('run', RUNS, ids=lambda run: run.stem)
def test_the_velocities_of_a_real_robot_are_believed_whatever_filter_they_went_through(
        run, seconds):
    check, believed = VelocityCheck(), []
    for rates, increments, interval in filtered(load(run), seconds):
        check = check.followed(rates, increments, interval)
        assert check.disagreement is None
        believed.append(check.believed)
    assert sum(believed) > 0.8 * len(believed)


@pytest.mark.parametrize('factor', [9.549, 57.3, 0.0, -1.0, 0.5, 1.5])
@pytest.mark.parametrize('run', RUNS[:2], ids=lambda run: run.stem)
def test_the_velocities_of_a_real_robot_in_other_units_are_not(run, factor):
    check, told, believed = VelocityCheck(), [], 0
    for rates, increments, interval in filtered(load(run), 0.05):
        check = check.followed(tuple(factor * rate for rate in rates), increments, interval)
        told += [check.disagreement] if check.disagreement else []
        believed += check.believed
    assert told[-1].reported / told[-1].rolled == pytest.approx(factor, rel=0.15, abs=1e-9)
    assert not believed or 0.4 < factor < 1.6


DRIVES = {'slow ramp': ramp(10.0, 1.0, 8.0), 'quick ramp': ramp(20.0, 1.0, 0.3),
          'to and fro': sway(8.0, 4.0), 'quickly to and fro': sway(5.0, 0.7)}


@pytest.mark.parametrize('drive', DRIVES)
@pytest.mark.parametrize('period_ms', [5, 20, 100])
@pytest.mark.parametrize('resolution', [0, 16, 90, 4096])
@pytest.mark.parametrize('filtered_s', [0.0, 0.1, 0.25])
def test_ramps_ticks_and_filters_are_no_disagreement(drive, period_ms, resolution, filtered_s):
    driver = Driver(DRIVES[drive], period_ms * MS, resolution=resolution, filtered_s=filtered_s,
                    jitter_ns=period_ms * MS // 5, velocity=lambda rate: rate)
    assert not any(check.disagreement for check in checked(driver.messages(20.0)))


@given(st.floats(1.0, 30.0), st.floats(-60.0, 60.0).filter(
    lambda factor: not 0.6 <= factor <= 1.6), st.sampled_from([5, 20, 50]))
def test_a_factor_is_found_within_seconds_and_told_as_it_is(rate, factor, period_ms):
    driver = Driver(lambda at: rate * at, period_ms * MS, velocity=lambda rate: factor * rate)
    checks = checked(driver.messages(5.0))
    told = checks[-1].disagreement
    assert told.reported / told.rolled == pytest.approx(factor, rel=1e-6, abs=1e-6)
    assert not any(check.believed for check in checks)


def test_what_was_believed_and_becomes_grossly_wrong_is_not_believed_after_a_block():
    def tell(rate):
        return rate * (1.0 if tell.right else 9.549)

    tell.right = True
    driver = Driver(lambda at: 5.0 * at, 20 * MS, velocity=tell)
    first = driver.messages(3.0)
    tell.right = False
    checks = checked(first + driver.messages(9.0)[len(first):])
    assert checks[len(first) - 2].believed
    wrong = [number for number, check in enumerate(checks[len(first):]) if not check.believed]
    assert wrong[0] <= 2 * 25


def test_wheels_that_stand_prove_nothing():
    driver = Driver(lambda at: 0.0, 20 * MS, velocity=lambda rate: 0.01)
    checks = checked(driver.messages(30.0))
    assert not any(check.believed or check.disagreement for check in checks)


def test_velocities_that_are_absent_now_and_then_are_judged_by_the_others():
    check = VelocityCheck()
    for number in range(400):
        check = check.followed(
            None if number % 7 == 0 else (5.0, 5.0), (0.1, 0.1), 0.02)
    assert check.believed and math.isfinite(sum(check.reported))
