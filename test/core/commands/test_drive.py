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

"""The drive: closed form, watchdog, ramps on their grid, and independence of who looks when."""

from dataclasses import replace
from itertools import accumulate
import math

from diffdrive_kinematics.core.commands import (
    AxisLimits, CommandResponse, Drive, DriveSettings, Twist)
from diffdrive_kinematics.core.kinematics import (
    twist_from_wheel_rates, wheel_rates_from_twist, WheelGeometry)
from hypothesis import given, strategies as st
import pytest

MS = 1_000_000
S = 1000 * MS
PERIOD = 20 * MS  # of an update_rate of 50
GEOMETRY = WheelGeometry(0.5, 0.1)
UNIT = WheelGeometry(1.0, 1.0)  # straight ahead, wheel rate = speed
PLAIN = DriveSettings(GEOMETRY)
ENDLESS = DriveSettings(GEOMETRY, cmd_vel_timeout=0.0)
RAMPS = DriveSettings(
    GEOMETRY, AxisLimits(max_velocity=2.0, max_acceleration=1.0, max_deceleration=-2.0),
    AxisLimits(max_acceleration=3.0, max_jerk=100.0), update_rate=50.0)
BOUNDED = replace(PLAIN, max_wheel_rate=8.0)
EVERYTHING = replace(RAMPS, max_wheel_rate=8.0)
SETTINGS = st.sampled_from([PLAIN, ENDLESS, RAMPS, BOUNDED, EVERYTHING])
KNOWN = replace(PLAIN, response=CommandResponse(0.5, 2.0, turn_loss=0.18))
STILL = Twist(0.0, 0.0)
AHEAD = Twist(1.0, 0.5)
twists = st.builds(Twist, st.floats(-3.0, 3.0), st.floats(-4.0, 4.0))
courses = st.lists(st.tuples(st.integers(1, 800 * MS), twists), min_size=1, max_size=8).map(
    lambda items: list(zip(accumulate(gap for gap, _ in items), (twist for _, twist in items))))


def driven(settings, course, end=None, polls=()):
    """Return the drive at the end and all its changes; ``polls`` are looks in between."""
    drive, changes = Drive(settings, since_ns=0), []
    events = [(stamp, twist) for stamp, twist in course] + [(poll, None) for poll in polls]
    for stamp, twist in sorted(events, key=lambda event: (event[0], event[1] is not None)):
        drive, new = drive.advanced(stamp) if twist is None else drive.commanded(twist, stamp)
        changes += new
    if end is not None:
        drive, new = drive.advanced(end)
        changes += new
    return drive, changes


@given(courses, st.integers(0, 5 * S))
def test_the_angles_are_the_closed_form_of_the_commands(course, later):
    end = course[-1][0] + later
    told = driven(ENDLESS, course)[0].command_at(end)
    for side in (0, 1):
        exact = math.fsum(
            wheel_rates_from_twist(GEOMETRY, *twist)[side] * (until - stamp) / 1e9
            for (stamp, twist), until in zip(course, [s for s, _ in course[1:]] + [end]))
        assert told.angles[side] == pytest.approx(exact, rel=1e-15, abs=1e-12)
    assert told.stamp_ns == end
    assert told.rates == wheel_rates_from_twist(GEOMETRY, *course[-1][1])
    assert told.twist == course[-1][1]


@given(SETTINGS, courses)
def test_the_angles_told_are_the_integral_of_the_rates_told(settings, course):
    drive, changes = driven(settings, course, end=course[-1][0] + 5 * S)
    stamps = [change.stamp_ns for change in changes]
    assert stamps == sorted(set(stamps)), 'changes are in order, each at its own time'
    for side in (0, 1):
        angle, before = 0.0, None
        for change in [*changes, drive.command_at(course[-1][0] + 5 * S)]:
            if before:
                angle += before.rates[side] * (change.stamp_ns - before.stamp_ns) / 1e9
            assert change.angles[side] == pytest.approx(angle, abs=1e-11)
            before = change


@given(SETTINGS, courses, st.lists(st.integers(0, 8 * S), max_size=12))
def test_how_often_and_when_somebody_looks_changes_nothing(settings, course, polls):
    end = course[-1][0] + 8 * S
    drive, changes = driven(settings, course, end)
    assert driven(settings, course, end, polls) == (drive, changes)


@pytest.mark.parametrize('timeout', [0.5, 0.001, 2.0])
def test_the_watchdog_stops_exactly_at_the_stamp_and_the_timeout(timeout):
    settings, end = replace(PLAIN, cmd_vel_timeout=timeout), 7 + round(timeout * 1e9)
    drive, _ = driven(settings, [(7, AHEAD)])
    assert drive.advanced(end - 1) == (drive, [])
    stopped, (change,) = drive.advanced(end + 99 * S)
    assert change.stamp_ns == end
    assert (change.rates, change.twist) == ((0.0, 0.0), STILL)
    assert change.angles == pytest.approx(tuple(
        rate * timeout for rate in wheel_rates_from_twist(GEOMETRY, *AHEAD)))
    assert stopped.advanced(1000 * S)[1] == []


def test_a_repeat_tells_nothing_and_renews_the_deadline():
    drive, changes = driven(PLAIN, [(0, AHEAD), (300 * MS, AHEAD)])
    assert len(changes) == 1
    _, (stop,) = drive.advanced(9 * S)
    assert stop.stamp_ns == 800 * MS


def test_a_command_at_the_very_deadline_comes_after_the_stop():
    _, changes = driven(PLAIN, [(0, AHEAD), (500 * MS, AHEAD)])
    assert [(change.stamp_ns, change.twist) for change in changes] == [
        (1, AHEAD), (500 * MS, STILL), (500 * MS + 1, AHEAD)]


def test_a_timeout_of_zero_is_never():
    drive, _ = driven(ENDLESS, [(0, AHEAD)], end=10**6 * S)
    assert drive.command_at(10**6 * S).twist == AHEAD
    assert drive.deadline_ns is None


@pytest.mark.parametrize('late', [400 * MS, 400 * MS - 1, 0, -S])
def test_a_late_command_holds_from_one_nanosecond_after_the_last_change(late):
    drive, _ = driven(PLAIN, [(400 * MS, AHEAD)])
    drive, (change,) = drive.commanded(Twist(-1.0, 0.0), late)
    assert change.stamp_ns == 400 * MS + 1
    assert drive.deadline_ns == late + 500 * MS


def test_without_ramps_a_command_is_answered_at_its_stamp():
    _, changes = driven(PLAIN, [(3 * MS, AHEAD), (4 * MS, STILL)])
    assert [change.stamp_ns for change in changes] == [3 * MS, 4 * MS]


LINE = DriveSettings(
    UNIT, AxisLimits(max_acceleration=1.0, max_deceleration=-2.0), cmd_vel_timeout=10.0,
    update_rate=4.0)  # steps of 1/4 s: up by 0.25, down by 0.5


def test_a_ramp_steps_on_the_grid_that_its_command_began():
    _, changes = driven(LINE, [(7, Twist(0.875, 0.0))], end=5 * S)
    assert [change.stamp_ns for change in changes] == [7 + k * S // 4 for k in range(4)]
    assert [change.twist.v for change in changes] == [0.25, 0.5, 0.75, 0.875]


def test_with_a_jerk_limit_the_steps_of_a_ramp_grow_and_fall_by_the_jerk():
    """A jerk of 4 m/s^3 in steps of 1/4 s: each step differs from the one before by 0.25 m/s."""
    settings = replace(LINE, linear=AxisLimits(max_jerk=4.0))
    _, changes = driven(settings, [(7, Twist(2.25, 0.0))], end=5 * S)
    assert [change.twist.v for change in changes] == [0.25, 0.75, 1.5, 2.0, 2.25]


def test_during_a_ramp_a_command_only_moves_the_target():
    _, changes = driven(LINE, [(7, Twist(9.0, 0.0)), (S // 3, Twist(0.5, 0.0))], end=2 * S)
    assert [(change.stamp_ns, change.twist.v) for change in changes] == [
        (7, 0.25), (7 + S // 4, 0.5)]
    _, changes = driven(LINE, [(7, Twist(9.0, 0.0)), (S // 3, STILL)], end=2 * S)
    assert [(change.stamp_ns, change.twist.v) for change in changes] == [
        (7, 0.25), (7 + S // 4, 0.5), (7 + S // 2, 0.0)]


def test_the_watchdog_brakes_from_the_deadline_with_the_deceleration_limit():
    _, changes = driven(LINE, [(7, Twist(1.0, 0.0))], end=60 * S)
    assert [(change.stamp_ns, change.twist.v) for change in changes[-2:]] == [
        (7 + 10 * S, 0.5), (7 + 10 * S + S // 4, 0.0)]


def test_a_deadline_within_a_ramp_moves_the_target_of_its_next_step():
    settings = replace(LINE, cmd_vel_timeout=0.3)
    _, changes = driven(settings, [(0, Twist(9.0, 0.0))], end=9 * S)
    assert [(change.stamp_ns, change.twist.v) for change in changes] == [
        (1, 0.25), (1 + S // 4, 0.5), (1 + S // 2, 0.0)]


@given(courses)
def test_a_ramp_keeps_the_limits_of_acceleration_and_velocity(course):
    _, changes = driven(RAMPS, course, end=course[-1][0] + 9 * S)
    for before, after in zip([None, *changes], changes):
        v, w = (before.twist if before else STILL)
        steps = 1 if before is None else max(1, (after.stamp_ns - before.stamp_ns) // PERIOD)
        assert abs(after.twist.v) - abs(v) <= 0.02 * 1.0 * steps + 1e-12
        assert abs(after.twist.v - v) <= 0.02 * 2.0 * steps + 1e-12
        assert abs(after.twist.w - w) <= 0.02 * 3.0 * steps + 1e-12
        assert abs(after.twist.v) <= 2.0


@given(twists)
def test_a_ramp_arrives_and_settles(target):
    settings = replace(RAMPS, cmd_vel_timeout=0.0)
    drive, _ = driven(settings, [(0, target)], end=60 * S)
    assert drive.twist == Twist(max(-2.0, min(target.v, 2.0)), target.w)
    assert drive.step_ns is None
    assert drive.advanced(10**9 * S) == (drive, [])


@given(st.sampled_from([BOUNDED, EVERYTHING]), courses)
def test_no_wheel_exceeds_the_bound_and_the_twist_is_that_of_the_rates(settings, course):
    _, changes = driven(settings, course, end=course[-1][0] + S)
    for change in changes:
        assert max(map(abs, change.rates)) <= 8.0
        assert twist_from_wheel_rates(GEOMETRY, *change.rates) == pytest.approx(
            change.twist, abs=1e-14)


@given(twists)
def test_a_saturated_command_keeps_its_curvature(target):
    drive, _ = driven(BOUNDED, [(0, target)])
    assert drive.twist.v * target.w == pytest.approx(drive.twist.w * target.v, abs=1e-13)
    assert drive.saturated == (max(map(abs, wheel_rates_from_twist(GEOMETRY, *target))) > 8.0)


SATURATED_RAMP = DriveSettings(
    GEOMETRY, AxisLimits(max_acceleration=1.0), AxisLimits(max_acceleration=1.0),
    max_wheel_rate=10.0, cmd_vel_timeout=0.0)


@pytest.mark.parametrize('target', [Twist(10.0, 2.0), Twist(-3.0, 9.0), Twist(0.25, 9.5)])
def test_a_saturated_ramp_settles_on_the_curvature_asked_for(target):
    drive, _ = driven(SATURATED_RAMP, [(0, target)], end=100 * S)
    assert drive.twist.w / drive.twist.v == pytest.approx(target.w / target.v, rel=1e-12)


def test_a_saturated_ramp_settles():
    drive, _ = driven(
        SATURATED_RAMP, [(0, Twist(0.23037844265266116, 9.469027534050454))], end=100 * S)
    assert drive.step_ns is None


def test_the_axis_that_grows_takes_the_room_that_the_other_makes():
    """Right wheel: v + w, bound 1; v brakes by 0.1 a step, w is free."""
    settings = DriveSettings(
        WheelGeometry(2.0, 1.0), AxisLimits(max_deceleration=-0.1), AxisLimits(),
        max_wheel_rate=1.0, cmd_vel_timeout=0.0, update_rate=1.0)
    _, changes = driven(settings, [(1, Twist(1.0, 0.0)), (5 * S, Twist(0.0, 1.0))], end=6 * S)
    assert [change.twist for change in changes] == [
        pytest.approx(twist, abs=1e-14) for twist in ((1.0, 0.0), (0.9, 0.1), (0.8, 0.2))]
    assert [change.rates[1] for change in changes] == [1.0, 1.0, 1.0]


def test_cuts_are_counted():
    drive, _ = driven(BOUNDED, [(0, Twist(3.0, 0.0)), (1, Twist(0.1, 0.0))])
    assert (drive.saturated, drive.limited) == (1, 0)
    clamped = replace(PLAIN, linear=AxisLimits(max_velocity=1.0))
    drive, _ = driven(clamped, [(0, Twist(3.0, 0.0)), (1, Twist(0.1, 0.0))])
    assert (drive.saturated, drive.limited) == (0, 1)


def test_new_settings_hold_from_now_on_with_the_same_target_and_deadline():
    drive, _ = driven(PLAIN, [(0, AHEAD)])
    other = replace(PLAIN, geometry=WheelGeometry(0.5, 0.2))
    changed, (change,) = drive.configured(other, 100 * MS)
    assert (change.stamp_ns, change.twist) == (100 * MS, AHEAD)
    assert change.rates == wheel_rates_from_twist(other.geometry, *AHEAD)
    assert change.angles == drive.command_at(100 * MS).angles
    _, (stop,) = changed.advanced(9 * S)
    assert stop.stamp_ns == 500 * MS


@pytest.mark.parametrize(('before', 'after', 'end'), [
    (0.0, 0.5, 1600 * MS), (20.0, 0.5, 1600 * MS), (0.5, 20.0, 1500 * MS), (2.0, 1.95, 3 * S),
    (0.5, 0.0, None), (0.0, 0.0, None)])
@pytest.mark.parametrize('linear', [AxisLimits(), AxisLimits(max_acceleration=1.0)])
def test_a_new_timeout_ends_the_live_command_a_timeout_from_then_on_and_never_later_than_before(
        before, after, end, linear):
    settings = replace(PLAIN, linear=linear, cmd_vel_timeout=before)
    drive, _ = driven(settings, [(S, AHEAD)])
    drive, _ = drive.configured(replace(settings, cmd_vel_timeout=after), 1100 * MS)
    assert drive.deadline_ns == end
    drive, _ = drive.advanced(99 * S)
    assert drive.rates == (0.0, 0.0) if end else drive.twist == AHEAD


def test_a_new_timeout_ends_no_command_where_there_is_none():
    drive, _ = driven(PLAIN, [(0, AHEAD)], S)
    changed, changes = drive.configured(replace(PLAIN, cmd_vel_timeout=9.0), 2 * S)
    assert (changed.deadline_ns, changed.timeouts, changes) == (None, 1, [])


@pytest.mark.parametrize('settings', [PLAIN, ENDLESS, RAMPS])
def test_a_command_that_is_ended_ends_then_or_earlier_and_no_stop_is_of_the_future(settings):
    drive, _ = driven(settings, [(S, AHEAD)])
    end = drive.deadline_ns
    assert drive.ended_by(9 * S) == drive
    drive = drive.ended_by(1100 * MS)
    assert drive.deadline_ns == (None if end is None else 1100 * MS)
    _, changes = drive.advanced(1100 * MS)
    assert all(change.stamp_ns <= 1100 * MS for change in changes)


def test_a_lifted_limit_lets_the_old_target_through():
    clamped = replace(ENDLESS, linear=AxisLimits(max_velocity=0.25))
    drive, _ = driven(clamped, [(0, Twist(1.0, 0.0))])
    drive, (change,) = drive.configured(ENDLESS, S)
    assert (drive.twist.v, change.stamp_ns) == (1.0, S)


def test_settings_that_change_nothing_tell_nothing():
    drive, _ = driven(PLAIN, [(0, AHEAD)])
    changed, changes = drive.configured(PLAIN, 100 * MS)
    assert changes == []
    assert changed.command_at(S) == drive.command_at(S)


def test_new_settings_come_after_what_was_due_before_them():
    drive, _ = driven(PLAIN, [(0, AHEAD)])
    _, changes = drive.configured(replace(PLAIN, geometry=UNIT), S)
    assert [change.stamp_ns for change in changes] == [500 * MS]


def test_settings_written_during_a_ramp_do_not_make_it_steeper():
    drive, _ = driven(LINE, [(S, Twist(9.0, 0.0))])
    for k in range(10):
        drive, _ = drive.configured(LINE, S + k)
    assert drive.twist.v == 0.25


@given(SETTINGS, courses, st.integers(-1000 * S, 1000 * S), twists, st.integers(1, S))
def test_after_the_clock_was_stepped_everything_goes_on_as_before(
        settings, course, step, twist, later):
    drive, _ = driven(settings, course)
    time = course[-1][0] + later
    stepped, changes = drive.clock_stepped(step).commanded(twist, time + step)
    expected, others = drive.commanded(twist, time)
    assert stepped == expected.clock_stepped(step)
    assert changes == [
        change._replace(stamp_ns=change.stamp_ns + step) for change in others]


@pytest.mark.parametrize('target', [
    Twist(math.nan, 0.0), Twist(0.0, math.nan), Twist(math.inf, 0.0), Twist(0.0, -math.inf),
    Twist(math.inf, math.inf), Twist(1e300, 0.0), Twist(0.0, 1e308), Twist(2e12, 0.0),
    Twist(5e11, 0.0)])  # the last one is 5e12 rad/s at a radius of 0.1 m
def test_a_command_that_is_not_finite_or_absurd_is_refused(target):
    drive, _ = driven(PLAIN, [(0, AHEAD)])
    with pytest.raises(ValueError, match=r'the command \(linear.x, angular.z\) is'):
        drive.commanded(target, S)


@pytest.mark.parametrize(('name', 'value'), [
    ('cmd_vel_timeout', -1.0), ('cmd_vel_timeout', math.nan), ('cmd_vel_timeout', math.inf),
    ('update_rate', 0.0), ('update_rate', -1.0), ('update_rate', math.nan),
    ('max_wheel_rate', 0.0), ('max_wheel_rate', -1.0)])
def test_a_bad_setting_is_refused_by_name(name, value):
    with pytest.raises(ValueError, match=f'^{name} is {value!r}'):
        replace(PLAIN, **{name: value})


@pytest.mark.parametrize('extreme', [
    {'cmd_vel_timeout': 1e300}, {'linear': LINE.linear, 'update_rate': 1e-300}])
def test_an_extreme_setting_is_refused_or_works(extreme):
    try:
        settings = replace(PLAIN, **extreme)
    except ValueError:
        return
    driven(settings, [(0, AHEAD)])


def test_a_ramp_whose_limits_are_lifted_arrives_at_once():
    drive, _ = driven(LINE, [(S, Twist(9.0, 0.0))])
    drive, (change,) = drive.configured(replace(LINE, linear=AxisLimits()), S + 5)
    assert (change.stamp_ns, change.twist.v) == (S + 5, 9.0)
    assert drive.step_ns is None


def test_a_drive_that_was_never_commanded_stands_and_tells_so():
    drive, changes = driven(RAMPS, [], end=99 * S)
    assert changes == []
    assert drive.command_at(99 * S) == (99 * S, (0.0, 0.0), (0.0, 0.0), STILL)


def test_what_is_told_is_never_before_the_last_change():
    drive, (change,) = driven(PLAIN, [(S, AHEAD)])
    assert drive.command_at(0) == change


@pytest.mark.parametrize('settings', [PLAIN, EVERYTHING])
def test_a_drive_that_is_halted_stands_from_then_on_however_often_and_whatever_was_under_way(
        settings):
    drive, (*_, last) = driven(settings, [(S, AHEAD)], end=S + 100 * MS)
    moving, halted = drive.command_at(S + 115 * MS), drive.halted(S + 115 * MS)
    for drive_at_rest in (halted, halted.halted(S + 135 * MS)):
        assert drive_at_rest.command_at(9 * S) == (9 * S, (0.0, 0.0), moving.angles, STILL)
    assert halted.advanced(9 * S) == (halted, [])
    assert drive.halted(last.stamp_ns).command_at(last.stamp_ns).stamp_ns == last.stamp_ns + 1


@pytest.mark.parametrize('rate', [1.0, 10.0, 500.0])
def test_a_change_of_the_rate_during_a_ramp_does_not_make_it_steeper(rate):
    """Guard 50 m/s^2 where 1 m/s^2 is allowed."""
    limits = AxisLimits(max_acceleration=1.0)
    drive = Drive(DriveSettings(LINE.geometry, limits, update_rate=50.0, cmd_vel_timeout=0.0), 0)
    drive, told = drive.commanded(Twist(3.0, 0.0), S)
    drive, more = drive.advanced(S + 105 * MS)
    told += more
    drive, more = drive.configured(replace(drive.settings, update_rate=rate), S + 105 * MS)
    told += more + drive.advanced(9 * S)[1]
    for before, after in zip(told, told[1:]):
        seconds = (after.stamp_ns - before.stamp_ns) / 1e9
        assert after.twist.v - before.twist.v <= seconds * (1.0 + 1e-9)
    assert told[-1].twist.v == 3.0


def test_a_rate_that_is_changed_again_and_again_does_not_hold_a_ramp_up():
    limits = AxisLimits(max_acceleration=0.5)
    settings = DriveSettings(UNIT, limits, update_rate=50.0, cmd_vel_timeout=0.0)
    drive, _ = Drive(settings, 0).commanded(Twist(0.5, 0.0), S)
    for k in range(1, 201):
        now = S + k * 15 * MS
        drive, _ = drive.configured(replace(settings, update_rate=[50.0, 40.0][k % 2]), now)
        allowed = min(0.5, 0.5 * (now - S) / 1e9)
        assert 0.5 * allowed - 0.02 <= drive.twist.v <= allowed + 0.02
    assert drive.twist.v == 0.5


def test_a_timeout_counts_where_it_ended_a_command_to_move():
    course = [(0, AHEAD), (2 * S, STILL), (4 * S, AHEAD), (4 * S + 400 * MS, AHEAD)]
    assert [driven(PLAIN, course[:n], 8 * S)[0].timeouts for n in (1, 2, 3, 4)] == [1, 1, 2, 2]
    assert driven(ENDLESS, course, 8 * S)[0].timeouts == 0


def test_a_response_that_comes_or_goes_holds_for_the_command_that_lives():
    wanted = Twist(0.1, 0.4)
    known, _ = Drive(KNOWN, since_ns=0).commanded(wanted, S)
    assert known.target == wanted and known.twist.v > 0.12
    plain, _ = known.configured(PLAIN, S + 100 * MS)
    assert plain.twist == wanted
    assert plain.configured(KNOWN, S + 200 * MS)[0].twist == known.twist


def test_the_motion_wanted_is_within_the_limits_before_the_response_makes_up_for_anything():
    settings = replace(KNOWN, linear=AxisLimits(max_velocity=0.2))
    far, _ = Drive(settings, since_ns=0).commanded(Twist(1e4, 0.4), S)
    edge, _ = Drive(settings, since_ns=0).commanded(Twist(0.2, 0.4), S)
    assert far.twist == edge.twist and far.limited == 1


def test_a_small_speed_in_a_curve_is_made_up_for_by_a_bounded_factor():
    drive, _ = Drive(KNOWN, since_ns=0).commanded(Twist(0.01, 1.9), S)
    assert drive.twist == pytest.approx((0.03, 1.9)) and drive.limited == 1
