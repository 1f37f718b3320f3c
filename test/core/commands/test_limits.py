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

"""The limiter, against a table derived by hand and against laws."""

import math

from diffdrive_kinematics.core.commands import AxisLimits, largest_change
from hypothesis import given, strategies as st
import pytest

DT = 0.5
NAN = math.nan
# Four different rates: up 2, reverse up 1, down 4, reverse down 3; in DT that is 1, 0.5, 2, 1.5.
FOUR = AxisLimits(
    max_acceleration=2.0, max_acceleration_reverse=-1.0, max_deceleration=-4.0,
    max_deceleration_reverse=3.0)
ONE = AxisLimits(max_acceleration=2.0)  # 2 everywhere: 1 in DT
UP = AxisLimits(max_acceleration=2.0, max_acceleration_reverse=-1.0)  # braking as reverse up: 1
BRAKE = AxisLimits(max_deceleration=-4.0)  # brakes 4 both ways, speeds up at once
BRAKE_REVERSE = AxisLimits(max_deceleration_reverse=3.0)
FAST = AxisLimits(max_velocity=3.0)
SKEW = AxisLimits(max_velocity=3.0, min_velocity=-1.0)
BACK = AxisLimits(min_velocity=-1.0)
JERK = AxisLimits(max_jerk=8.0)  # the step grows by 8 DT^2 = 2, either way
JERKS = AxisLimits(max_jerk=8.0, min_jerk=-4.0)  # grows by 2 upwards, by 1 downwards
JERK_DOWN = AxisLimits(min_jerk=-4.0)  # grows by 1 downwards, freely upwards
TURN = AxisLimits(max_acceleration=1.0, max_deceleration=-4.0, max_jerk=2.0)
BOTH = AxisLimits(max_acceleration=2.0, max_jerk=8.0)
SOFT = AxisLimits(max_acceleration=2.0, max_jerk=2.0)  # grows by 0.5, at most 1
ALL = AxisLimits(max_velocity=1.25, max_acceleration=2.0, max_jerk=8.0)

TABLE = [
    # limits, before, current, target, expected, derivation
    # acceleration, forward
    (FOUR, 1.0, 1.0, 10.0, 2.0, 'forward, speeds up: 1 + 2 DT'),
    (FOUR, 1.0, 1.0, 1.5, 1.5, 'forward, the target is within reach'),
    (FOUR, 1.0, 1.0, 1.0, 1.0, 'forward, already there'),
    (FOUR, 5.0, 5.0, 0.0, 3.0, 'forward, slows down: 5 - 4 DT'),
    (FOUR, 5.0, 5.0, 4.0, 4.0, 'forward, slower within reach'),
    (FOUR, 0.0, 0.0, 10.0, 1.0, 'from a stand forward: 0 + 2 DT'),
    # acceleration, reverse
    (FOUR, -1.0, -1.0, -10.0, -1.5, 'reverse, speeds up: -1 - 1 DT'),
    (FOUR, -1.0, -1.0, -1.2, -1.2, 'reverse, faster within reach'),
    (FOUR, -5.0, -5.0, 0.0, -3.5, 'reverse, slows down: -5 + 3 DT'),
    (FOUR, -5.0, -5.0, -4.0, -4.0, 'reverse, slower within reach'),
    (FOUR, 0.0, 0.0, -10.0, -0.5, 'from a stand backwards: 0 - 1 DT'),
    # acceleration, through zero
    (FOUR, 1.0, 1.0, -10.0, -0.25, 'down: stands after 1/4 s, then -1 for the other 1/4 s'),
    (FOUR, 2.0, 2.0, -10.0, 0.0, 'down: stands after 2/4 s = DT, nothing remains'),
    (FOUR, 3.0, 3.0, -10.0, 1.0, 'down: 3 - 4 DT, does not get there'),
    (FOUR, 1.0, 1.0, -0.125, -0.125, 'down: the target beyond zero is within reach'),
    (FOUR, -0.75, -0.75, 10.0, 0.5, 'up: stands after 0.75/3 = 1/4 s, then 2 for 1/4 s'),
    (FOUR, -1.5, -1.5, 10.0, 0.0, 'up: stands after 1.5/3 s = DT, nothing remains'),
    (FOUR, -3.0, -3.0, 10.0, -1.5, 'up: -3 + 3 DT, does not get there'),
    (FOUR, -0.75, -0.75, 0.25, 0.25, 'up: the target beyond zero is within reach'),
    # defaults
    (ONE, 1.0, 1.0, 10.0, 2.0, 'up 2: 1 + 1'),
    (ONE, 5.0, 5.0, 0.0, 4.0, 'braking defaults to reverse up, that to up: 5 - 1'),
    (ONE, -1.0, -1.0, -10.0, -2.0, 'reverse up defaults to up: -1 - 1'),
    (ONE, -5.0, -5.0, 0.0, -4.0, 'reverse braking defaults to braking: -5 + 1'),
    (ONE, 0.5, 0.5, -10.0, -0.5, 'through zero at one rate: 0.5 - 1'),
    (ONE, -0.5, -0.5, 10.0, 0.5, 'through zero upwards at one rate: -0.5 + 1'),
    (UP, 5.0, 5.0, 0.0, 4.5, 'braking defaults to reverse up 1: 5 - 1 DT'),
    (UP, -5.0, -5.0, 0.0, -4.5, 'reverse braking defaults to braking 1: -5 + 1 DT'),
    (BRAKE, 0.0, 0.0, 10.0, 10.0, 'speeding up is not limited'),
    (BRAKE, 0.0, 0.0, -10.0, -10.0, 'nor in reverse'),
    (BRAKE, 5.0, 5.0, 0.0, 3.0, 'braking: 5 - 4 DT'),
    (BRAKE, -5.0, -5.0, 0.0, -3.0, 'reverse braking defaults to braking: -5 + 4 DT'),
    (BRAKE, 1.0, 1.0, -10.0, -10.0, 'stands after 1/4 s, then not limited'),
    (BRAKE_REVERSE, 5.0, 5.0, 0.0, 0.0, 'forward braking has no default from reverse braking'),
    (BRAKE_REVERSE, -5.0, -5.0, 0.0, -3.5, 'reverse braking: -5 + 3 DT'),
    # velocity
    (FAST, 0.0, 0.0, 5.0, 3.0, 'clamped to max'),
    (FAST, 0.0, 0.0, -5.0, -3.0, 'min defaults to -max'),
    (FAST, 0.0, 0.0, -2.0, -2.0, 'within the range'),
    (SKEW, 0.0, 0.0, -5.0, -1.0, 'its own min'),
    (SKEW, 0.0, 0.0, 5.0, 3.0, 'and max'),
    (BACK, 0.0, 0.0, 5.0, 5.0, 'max NaN: no limit, also with a min'),
    (BACK, 0.0, 0.0, -5.0, -1.0, 'min without a max'),
    (AxisLimits(max_velocity=0.0), 0.0, 0.0, 5.0, 0.0, 'a maximum of 0 is a stand'),
    (AxisLimits(max_velocity=0.0), 0.0, 0.0, -5.0, 0.0, 'both ways'),
    # jerk, from constant velocity
    (JERK, 0.0, 0.0, 10.0, 2.0, 'forward from a stand: the step grows from 0 to 2'),
    (JERK, 0.0, 0.0, -10.0, -2.0, 'reverse from a stand: min jerk defaults to -max'),
    (JERK, 4.0, 4.0, 0.0, 2.0, 'forward, slows down: 4 - 2'),
    (JERK, -4.0, -4.0, 0.0, -2.0, 'reverse, slows down: -4 + 2'),
    (JERK, 1.0, 1.0, -10.0, -1.0, 'through zero down: 1 - 2'),
    (JERK, -1.0, -1.0, 10.0, 1.0, 'through zero up: -1 + 2'),
    (JERK, 0.0, 0.0, 1.5, 1.5, 'growth of 1.5 is within 2'),
    # jerk, while accelerating
    (JERK, 1.0, 2.0, 10.0, 5.0, 'the step was 1 and grows to 3: 2 + 3'),
    (JERK, 1.0, 2.0, 4.5, 4.25, '2.25 + 0.25 is the way that can end in steps of 2 less'),
    (JERK, 1.0, 2.0, 8.0, 5.0, 'of 6 left, 4 + 2 could still end, but the step grows to 3'),
    (JERK, 2.0, 5.0, 8.0, 7.5, 'of 3 left: 2.5 + 0.5'),
    (JERK, 1.0, 2.0, 3.0, 3.0, 'the same step again is no growth'),
    (JERK, 0.0, 4.0, 5.0, 5.0, 'the target came too near: the step falls from 4 to 1 at once'),
    (JERK, 0.0, 4.0, 4.0, 4.0, 'and to 0'),
    (JERK, 1.0, 2.0, -10.0, 0.0, 'turned round: the step of 1 ends at once and grows to -2'),
    (JERK, -1.0, -2.0, -10.0, -5.0, 'reverse: the step was -1 and grows to -3'),
    (JERK, 0.0, -4.0, -5.0, -5.0, 'reverse arrival at once'),
    (JERK, -1.0, -2.0, 10.0, 0.0, 'reverse turned round: the step of -1 ends, and grows to 2'),
    (JERKS, 0.0, 0.0, 10.0, 2.0, 'upwards 8 DT^2'),
    (JERKS, 4.0, 4.0, 0.0, 3.0, 'downwards -4 DT^2'),
    (JERKS, 0.0, 0.0, -10.0, -1.0, 'reverse from a stand is downwards'),
    (JERKS, 0.0, 0.0, 1.5, 1.25, 'rises by 2, falls by 1: 1.25 + 0.25'),
    (JERK_DOWN, 0.0, 0.0, 10.0, 4.0, 'max jerk NaN: no limit upwards, but ends as 4 + 3 + 2 + 1'),
    (JERK_DOWN, 4.0, 4.0, 0.0, 3.0, 'min jerk alone'),
    (JERK_DOWN, 4.0, 3.0, 0.0, 1.0, 'the step of -1 grows to -2'),
    (JERK_DOWN, 3.0, 1.0, 0.0, 0.0, 'and may end at once, which is upwards'),
    # jerk through zero: the deceleration falls to what speeds up, in time
    (TURN, -2.0, -1.0, 10.0, 0.0, 'a step of 1, as it may then be 0.5 only and falls by 0.5'),
    (TURN, -3.0, -2.0, 10.0, -2.0 + 2.5 / 1.75,
     'c, then c - 0.5 from x = 2 - c: 1/4 x to a stand and 1 for the rest, 0.5 + 3/4 x'),
    # together: jerk, then acceleration, then velocity
    (BOTH, 0.0, 0.0, 10.0, 1.0, 'jerk allows 2, acceleration 1'),
    (BOTH, 0.0, 1.0, 10.0, 2.0, 'jerk allows 1 + 3, acceleration 1 + 1'),
    (BOTH, 0.5, 0.5, -10.0, -0.5, 'through zero: jerk allows -1.5, acceleration 0.5 - 1'),
    (SOFT, 0.0, 0.0, 10.0, 0.5, 'jerk 0.5 binds before acceleration 1'),
    (SOFT, 0.0, 0.5, 10.0, 1.5, 'step 0.5 grows to 1, which acceleration allows'),
    (SOFT, 0.5, 1.5, 10.0, 2.5, 'step would grow to 1.5, acceleration allows 1'),
    (SOFT, 2.0, 2.0, 0.0, 1.5, 'slowing down starts softly'),
    (ALL, 0.5, 1.0, 10.0, 1.25, 'jerk 1 + 2.5, acceleration 1 + 1, velocity 1.25'),
    (ALL, 0.0, 0.0, -10.0, -1.0, 'acceleration -1 is within -1.25'),
]


@pytest.mark.parametrize(
    ('limits', 'before', 'current', 'target', 'expected'),
    [row[:5] for row in TABLE], ids=[f'{k}: {row[5]}' for k, row in enumerate(TABLE)])
def test_the_limited_velocity_is_that_derived_by_hand(limits, before, current, target, expected):
    assert limits.limit(target, current=current, before=before, dt=DT) == pytest.approx(
        expected, abs=1e-15)


rates = st.one_of(st.just(NAN), st.floats(0.1, 10.0))
velocities = st.floats(-20.0, 20.0)
steps = st.floats(1e-3, 1.0)
accelerations = st.builds(
    lambda up, reverse, down, down_reverse: AxisLimits(
        max_acceleration=up, max_acceleration_reverse=-reverse, max_deceleration=-down,
        max_deceleration_reverse=down_reverse), rates, rates, rates, rates)


def mirrored(limits):
    """Return the limits of the robot that looks the other way; no value left to a default."""
    (up, down), (reverse_up, reverse_down) = limits.forward_rates, limits.reverse_rates
    return AxisLimits(
        max_acceleration=reverse_up, max_deceleration=-reverse_down,
        max_acceleration_reverse=-up, max_deceleration_reverse=down)


@given(velocities, velocities, velocities, steps)
def test_without_limits_every_target_is_reached_at_once(target, current, before, dt):
    assert AxisLimits().limit(target, current=current, before=before, dt=dt) == target


@given(accelerations, velocities, velocities, steps)
def test_acceleration_never_leads_past_the_target_or_away_from_it(limits, target, current, dt):
    velocity = limits.limit_acceleration(target, current=current, dt=dt)
    assert min(current, target) <= velocity <= max(current, target)


@given(accelerations, velocities, velocities, steps)
def test_two_half_steps_of_acceleration_are_one_step_also_through_zero(
        limits, target, current, dt):
    half = limits.limit_acceleration(target, current=current, dt=0.5 * dt)
    whole = limits.limit_acceleration(target, current=current, dt=dt)
    assert limits.limit_acceleration(target, current=half, dt=0.5 * dt) == pytest.approx(
        whole, abs=1e-12)


@given(accelerations, velocities, velocities, steps)
def test_the_mirrored_robot_does_the_mirrored_thing(limits, target, current, dt):
    assert mirrored(limits).limit_acceleration(-target, current=-current, dt=dt) == (
        -limits.limit_acceleration(target, current=current, dt=dt))


@given(rates, velocities, velocities, st.floats(-2.0, 2.0), steps)
def test_jerk_never_lets_the_step_grow_by_more_than_its_limit(jerk, target, current, step, dt):
    limits = AxisLimits(max_jerk=jerk)
    velocity = limits.limit_jerk(target, current=current, before=current - step, dt=dt)
    towards = math.copysign(1.0, target - current)
    growth = (velocity - current) * towards - max(0.0, step * towards)
    if not math.isnan(jerk):
        assert growth <= jerk * dt * dt + 1e-12
    assert min(current, target) <= velocity <= max(current, target)


def can_end(change, distance, fall, braking=math.inf, rate=0.0, dt=1.0):
    """Return whether changes that fall keep to what a robot that stands after distance may do."""
    while True:
        to_stand = min(dt, max(0.0, distance) / braking)
        if change > max(0.0, distance if math.isinf(braking) else braking * to_stand) + rate * (
                dt - to_stand) + 1e-12:
            return False
        if change <= rate * dt:
            return True
        change, distance = change - fall, distance - change


@given(st.floats(0.0, 10.0), st.floats(0.01, 3.0), st.floats(0.0, 2.0),
       st.one_of(st.just(math.inf), st.floats(2.1, 9.0)), st.floats(0.1, 1.0))
def test_the_largest_change_can_end_in_time_and_a_larger_one_cannot(
        distance, fall, rate, braking, dt):
    last, share = rate * dt, 1.0 - rate / braking
    change = min(largest_change(distance, fall, last, share), braking * dt)
    assert can_end(change, distance, fall, braking, rate, dt)
    if change < braking * dt:
        assert not can_end(change + 1e-9, distance, fall, braking, rate, dt)


@given(st.floats(0.2, 5.0), st.floats(0.2, 5.0), st.floats(0.2, 5.0), st.floats(0.2, 5.0),
       st.floats(-3.0, 3.0), st.floats(-3.0, 3.0))
def test_a_ramp_keeps_to_every_limit_from_a_rest_to_the_end(
        up, down, rise, fall, start, target):
    limits = AxisLimits(
        max_acceleration=up, max_deceleration=-down, max_acceleration_reverse=-up,
        max_jerk=rise, min_jerk=-fall)
    before = current = start
    dt, change_before = 0.05, 0.0
    for _ in range(4000):
        velocity = limits.limit(target, current=current, before=before, dt=dt)
        change = velocity - current
        assert -fall * dt * dt - 1e-12 <= change - change_before <= rise * dt * dt + 1e-12
        assert abs(change) <= max(up, down) * dt + 1e-12
        assert min(start, target) <= velocity <= max(start, target)
        before, current, change_before = current, velocity, change
        if before == current == target:
            return
    pytest.fail(f'the ramp ended at {current}, not at {target}')


@given(st.floats(0.2, 5.0), st.floats(0.2, 5.0), st.floats(-3.0, 3.0), st.floats(-3.0, 3.0))
def test_a_ramp_arrives_exactly_and_neither_overshoots_nor_swings(
        acceleration, jerk, start, target):
    limits = AxisLimits(max_acceleration=acceleration, max_jerk=jerk)
    before = current = start
    for _ in range(2000):
        velocity = limits.limit(target, current=current, before=before, dt=0.05)
        assert (velocity - current) * (target - start) >= 0.0
        assert abs(velocity - current) <= acceleration * 0.05 + 1e-12
        before, current = current, velocity
        if before == current == target:
            return
    pytest.fail(f'the ramp ended at {current}, not at {target}')


@pytest.mark.parametrize('limits', [
    AxisLimits(), FAST, SKEW, BACK, AxisLimits(max_acceleration=math.inf)])
def test_velocity_limits_alone_need_no_ramp(limits):
    assert not limits.ramps


@pytest.mark.parametrize('name', [
    'max_acceleration', 'max_deceleration_reverse', 'max_jerk', '-max_acceleration_reverse',
    '-max_deceleration', '-min_jerk'])
def test_any_acceleration_or_jerk_limit_needs_a_ramp(name):
    sign = -1.0 if name.startswith('-') else 1.0
    assert AxisLimits(**{name.lstrip('-'): sign}).ramps


@pytest.mark.parametrize(('name', 'value'), [
    ('max_velocity', -0.1), ('min_velocity', 0.1),
    *((name, value) for name in ('max_acceleration', 'max_deceleration_reverse', 'max_jerk')
      for value in (0.0, -1.0, -math.inf)),
    *((name, value) for name in ('max_acceleration_reverse', 'max_deceleration', 'min_jerk')
      for value in (0.0, 1.0, math.inf))])
def test_a_limit_of_the_wrong_sign_is_refused_by_name(name, value):
    with pytest.raises(ValueError, match=f'^{name} is {value!r}, expected'):
        AxisLimits(**{name: value})
