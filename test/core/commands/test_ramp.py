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


"""Drives on which a limit once broke another: of jerk, and of the wheels."""

from dataclasses import replace
from pathlib import Path
import random

from diffdrive_kinematics.core.commands import (
    AxisLimits, Drive, DriveSettings, ramp_step, Twist, wheel_bound, WheelBound)
from diffdrive_kinematics.core.kinematics import wheel_rates_from_twist, WheelGeometry
import pytest
import yaml

S = 10**9
ROBOT = Path(__file__).parents[3] / 'config' / 'robot.yaml'
GEOMETRY = WheelGeometry(0.5, 0.1)
STILL = Twist(0.0, 0.0)
FREE = AxisLimits()


def robot():
    """Return the drive of the configuration that comes with the package, never timing out."""
    values = yaml.safe_load(ROBOT.read_text())
    shared, own = (values[key]['ros__parameters'] for key in ('/**', '/**/diff_drive_controller'))
    linear, angular = (
        AxisLimits(**{name[len(axis):]: own[name] for name in own if name.startswith(axis)})
        for axis in ('linear.x.', 'angular.z.'))
    return DriveSettings(
        WheelGeometry(shared['wheel_separation'], shared['wheel_radius']), linear, angular,
        own['max_wheel_rate'], 0.0, own['update_rate'])


def steered(settings, *targets, seconds=4):
    """Return the twists of a drive that heads for each target for some seconds."""
    drive, twists = Drive(settings, 0), [STILL]
    for k, target in enumerate(targets):
        drive, changes = drive.commanded(Twist(*target), k * seconds * S + 1)
        changes += drive.advanced((k + 1) * seconds * S)[1]
        drive = drive.advanced((k + 1) * seconds * S)[0]
        twists += [change.twist for change in changes]
    return twists


def steepest(settings, twists, axis):
    """Return the largest acceleration between two steps."""
    return settings.update_rate * max(
        (abs(after[axis] - before[axis]) for before, after in zip(twists, twists[1:])),
        default=0.0)


def test_one_command_never_leads_to_more_than_it_asked_for_whatever_the_jerk():
    """Guard 1.40 m/s, 2.5 s after a command of 0.5 m/s and 2 s after the watchdog."""
    limits = AxisLimits(max_acceleration=1.0, max_jerk=5.0, min_jerk=-0.5)
    drive, changes = Drive(DriveSettings(GEOMETRY, limits), 0).commanded(Twist(0.5, 0.0), 0)
    drive, later = drive.advanced(S // 2 - 1)
    reached = drive.twist.v
    drive, braking = drive.advanced(60 * S)
    assert max(change.twist.v for change in changes + later) <= 0.5
    speeds = [reached, *(change.twist.v for change in braking)]
    assert speeds == sorted(speeds, reverse=True), 'it brakes from the deadline on'
    assert drive.twist == STILL


@pytest.mark.parametrize('limits', [
    AxisLimits(max_jerk=1.0), AxisLimits(min_jerk=-1.0), AxisLimits(max_jerk=1.0, min_jerk=-0.1),
    AxisLimits(max_acceleration=1.0, max_jerk=5.0, min_jerk=-0.5)])
@pytest.mark.parametrize('rate', [100, 10, 1])
def test_commands_within_a_speed_never_lead_beyond_it_whatever_the_jerk(limits, rate):
    """Guard 2.89 m/s with max_jerk alone, and 744 m/s with min_jerk alone."""
    settings = DriveSettings(GEOMETRY, limits)
    for seed in range(5):
        generator, drive, fastest = random.Random(seed), Drive(settings, 0), 0.0
        for k in range(200):
            command = Twist(generator.uniform(-1.0, 1.0), 0.0)
            drive, changes = drive.commanded(command, k * S // rate)
            fastest = max([fastest, *(abs(change.twist.v) for change in changes)])
        assert fastest <= 1.0


@pytest.mark.parametrize('stop', [STILL, Twist(-1.0, 0.0)])
def test_a_stop_does_not_wait_for_the_jerk_to_turn_the_acceleration_round(stop):
    settings = DriveSettings(
        GEOMETRY, AxisLimits(max_jerk=1.0), cmd_vel_timeout=0.0, update_rate=50.0)
    drive, _ = Drive(settings, 0).commanded(Twist(2.0, 0.0), 0)
    drive, _ = drive.advanced(S)
    speed, gain = drive.twist.v, drive.twist.v - drive.before.v
    assert gain > 0.01, 'it speeds up by much more than jerk changes in a step'
    drive, _ = drive.commanded(stop, S)
    drive, changes = drive.advanced(S + S // 5)
    assert changes[0].twist.v < speed
    falls = [speed, *(change.twist.v for change in changes)]
    assert [before - after for before, after in zip(falls, falls[1:])] == pytest.approx(
        [0.02**2 * k for k in range(1, len(falls))])


EXTREMES = [(v, w) for v in (-0.22, 0.0, 0.22) for w in (-2.84, 0.0, 2.84)]


@pytest.mark.parametrize('first', EXTREMES)
@pytest.mark.parametrize('second', EXTREMES)
def test_the_shipped_robot_keeps_its_accelerations_within_its_wheels(first, second):
    """Guard 11.9 rad/s^2 at a limit of 6."""
    settings = robot()
    twists = steered(settings, first, second)
    assert steepest(settings, twists, 0) <= 2.5 * (1.0 + 1e-9)
    assert steepest(settings, twists, 1) <= 6.0 * (1.0 + 1e-9)
    factor = min(1.0, 6.7 / max(map(abs, (*wheel_rates_from_twist(settings.geometry, *second),
                                          1e-9))))
    assert twists[-1] == pytest.approx((factor * second[0], factor * second[1]), abs=1e-12)


SLOW = DriveSettings(
    GEOMETRY, AxisLimits(max_acceleration=0.5), AxisLimits(max_acceleration=12.0),
    max_wheel_rate=10.0, update_rate=100.0, cmd_vel_timeout=0.0)


@pytest.mark.parametrize('target', [(0.0, 4.0), (1.0, 4.0), (-1.0, 4.0)])
def test_the_axis_that_shrinks_ramps_by_its_limit_and_the_other_takes_the_room(target):
    """Guard 2.9 m/s^2 at a limit of 0.5, from full speed."""
    twists = steered(SLOW, (1.0, 0.0), target)
    assert steepest(SLOW, twists, 0) <= 0.5 * (1.0 + 1e-9)
    assert steepest(SLOW, twists, 1) <= 12.0 * (1.0 + 1e-9)
    turning = [twist for twist in twists
               if 0.0 < twist.w < twists[-1].w and twist.v > max(0.0, twists[-1].v)]
    assert len(turning) > 90
    for before, after in zip(turning, turning[1:]):
        assert before.v - after.v == pytest.approx(0.005), 'the axis that shrinks'
        assert after.v + 0.25 * after.w == pytest.approx(1.0), 'the faster wheel at its bound'
    assert twists[-1].v * target[1] == pytest.approx(twists[-1].w * target[0]), 'the curvature'


def test_jerk_holds_as_well_while_the_axis_that_grows_is_held_back():
    settings = replace(SLOW, angular=AxisLimits(max_acceleration=12.0, max_jerk=60.0))
    rates = [twist.w for twist in steered(settings, (1.0, 0.0), (0.0, 4.0), seconds=9)]
    steps = [after - before for before, after in zip([0.0, *rates], rates)]
    assert max(steps) == pytest.approx(0.02), 'it follows its room, which grows by 2 rad/s^2'
    for before, after in zip(steps, [*steps[1:], 0.0]):
        assert abs(after - before) <= 60.0 * 0.01**2 + 1e-12
    assert rates[-1] == 4.0


@pytest.mark.parametrize('timing', ['amid a ramp', 'settled'])
def test_a_new_bound_of_the_wheels_cuts_at_once_along_the_path_and_ramps_on_from_there(timing):
    now = {'amid a ramp': S // 2 + 5, 'settled': 20 * S}[timing]
    drive, _ = Drive(SLOW, 0).commanded(Twist(0.4, 2.0), 1)
    drive, _ = drive.advanced(now)
    wide = drive.twist
    bounded = replace(SLOW, max_wheel_rate=3.0)
    drive, (change,) = drive.configured(bounded, now)
    assert change.stamp_ns == now
    assert max(change.rates) == 3.0
    assert change.twist.w * wide.v == pytest.approx(change.twist.v * wide.w)
    assert drive.saturated == 1
    drive, after = drive.advanced(now + 20 * S)
    assert steepest(bounded, [change.twist, *(later.twist for later in after)], 0) <= 0.5 + 1e-9
    assert drive.twist == pytest.approx((0.4 / 3.0, 2.0 / 3.0)), 'scaled from 9 rad/s to 3'


def test_new_geometry_amid_a_ramp_turns_the_wheels_otherwise_at_once_and_keeps_the_twist():
    drive, _ = Drive(SLOW, 0).commanded(Twist(0.4, 2.0), 1)
    drive, _ = drive.advanced(S // 2 + 5)
    other = replace(SLOW, geometry=WheelGeometry(0.5, 0.2))
    changed, (change,) = drive.configured(other, S // 2 + 5)
    assert change.twist == drive.twist
    assert change.rates == wheel_rates_from_twist(other.geometry, *drive.twist)
    assert changed.step_ns == drive.step_ns


def test_a_new_limit_of_velocity_is_ramped_to_and_not_jumped_to():
    drive, _ = Drive(SLOW, 0).commanded(Twist(0.4, 0.0), 1)
    drive, _ = drive.advanced(9 * S)
    slower = replace(SLOW, linear=AxisLimits(max_velocity=0.1, max_acceleration=0.5))
    drive, changes = drive.configured(slower, 9 * S)
    changes += drive.advanced(20 * S)[1]
    twists = [Twist(0.4, 0.0), *(change.twist for change in changes)]
    assert steepest(slower, twists, 0) <= 0.5 * (1.0 + 1e-9)
    assert twists[-1].v == 0.1


def test_a_drive_whose_ramps_begin_after_a_command_does_not_start_with_an_acceleration():
    """Guard a step of a drive without ramps that is taken for acceleration by a jerk limit."""
    plain = replace(SLOW, linear=AxisLimits(max_velocity=0.5), angular=FREE)
    drive, _ = Drive(plain, 0).commanded(Twist(0.9, 0.0), 1)
    _, (change,) = drive.configured(replace(plain, linear=AxisLimits(max_jerk=1.0)), S)
    assert change.twist.v - 0.5 == pytest.approx(1.0 * 0.01**2)


def test_steps_are_cut_counted_and_saturated_ones_only_where_a_wheel_is_at_its_bound():
    drive, _ = Drive(SLOW, 0).commanded(Twist(0.5, 0.0), 1)
    drive, _ = drive.advanced(9 * S)
    assert (drive.saturated, drive.limited) == (0, 99), '0.5 m/s by 0.005 a step'
    drive, _ = Drive(SLOW, 0).commanded(Twist(1.0, 0.0), 1)
    drive, _ = drive.advanced(9 * S)
    limited = drive.limited
    drive, _ = drive.commanded(Twist(0.0, 4.0), 9 * S)
    drive, _ = drive.advanced(20 * S)
    assert drive.limited == limited + 199
    assert drive.saturated == 199, 'each step of the way, the last arrives'


@pytest.mark.parametrize('beyond', [0.0, 1e-15, 1e-12])
def test_digits_beyond_the_bound_are_not_a_way_back(beyond):
    """An axis whose present value has lost its room by a digit waits until there is some."""
    crawl = AxisLimits(max_acceleration=1e-15)
    step = ramp_step(
        (0.0, 1.0), current=(0.5, 0.5 + beyond), before=(0.5, 0.5 + beyond), dt=1.0,
        linear=crawl, angular=FREE, bound=WheelBound(1.0, 1.0, 1.0))
    assert step.w >= 0.5 + beyond


def test_the_room_of_an_axis_ends_where_a_wheel_is_at_its_bound():
    geometry = WheelGeometry(0.5, 0.1, 1.0, 0.8, 1.2)
    bound = wheel_bound(geometry, 10.0)
    for other in (-0.6, 0.0, 0.3):
        for speed in bound.speeds(other):
            rates = wheel_rates_from_twist(geometry, speed, other)
            assert max(map(abs, rates)) == pytest.approx(10.0)
        for yaw_rate in bound.yaw_rates(other):
            rates = wheel_rates_from_twist(geometry, other, yaw_rate)
            assert max(map(abs, rates)) == pytest.approx(10.0)
