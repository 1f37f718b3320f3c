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


"""
Every limit holds in every step of a drive: ten thousand random drives against laws.

A drive is random commands and random changes of its settings (limits, also one-sided and NaN, the
bound and geometry of the wheels, the rate of the ramp, the timeout), and then nothing, until the
watchdog has it at rest.  Each step is held against ``limit_laws``.  New settings of the wheels
hold at once, and cut.  A drive is at rest when its limits allow it to be.
"""

from dataclasses import replace
import math
import random

from diffdrive_kinematics.core.commands import AxisLimits, Drive, DriveSettings, Twist
from diffdrive_kinematics.core.kinematics import WheelGeometry
import pytest
from support.limit_laws import check_state, check_step, DIGITS, goal_of, Law, share_within

NAN = math.nan
STILL = Twist(0.0, 0.0)
AXES = (0, 1)
BLOCKS, CASES = 20, 500


class Driver:
    """Drives step by step, and holds each step against the laws."""

    def __init__(self, settings):
        self.drive = Drive(settings, 0)
        self.goal, self.settings, self.steps = STILL, settings, 0

    def to(self, time_ns):
        while True:
            due = [time for time in (self.drive.step_ns, self.drive.deadline_ns)
                   if time is not None and time <= time_ns]
            if not due:
                return
            before, ends = self.drive, self.drive.deadline_ns == min(due)
            self.drive = self.drive.advanced(min(due))[0]
            if before.step_ns in (None, min(due)):
                self._check(before._replace(target=STILL) if ends else before)
            else:
                assert self.drive.twist == before.twist

    def command(self, twist, time_ns):
        self.to(time_ns)
        before = self.drive
        self.drive = before.commanded(twist, time_ns)[0]
        if before.step_ns is None:
            self._check(before._replace(target=twist))
        else:
            assert self.drive.twist == before.twist

    def configure(self, settings, time_ns):
        self.to(time_ns)
        before, rate_before = (
            self.drive._replace(settings=settings), self.drive.settings.update_rate)
        self.drive = self.drive.configured(settings, time_ns)[0]
        self._check_end(before, time_ns)
        factor = share_within(settings, before.twist) if settings.ramps else 1.0
        if factor < 1.0 - DIGITS:
            assert self.drive.twist == pytest.approx(
                [factor * value for value in before.twist], abs=DIGITS)
            assert self.drive.before == self.drive.twist, 'the cut is not taken for acceleration'
            check_state(self.drive)
        elif before.step_ns is None or not settings.ramps:
            self._check(before)
        else:
            assert self.drive.twist == before.twist
            for axis in AXES:
                was, is_now = (
                    (drive.twist[axis] - drive.before[axis]) * rate for drive, rate in (
                        (before, rate_before), (self.drive, settings.update_rate)))
                assert is_now == pytest.approx(was, rel=1e-5, abs=DIGITS * settings.update_rate)
            check_state(self.drive)

    def _check_end(self, before, time_ns):
        end, timeout = self.drive.deadline_ns, self.drive.settings.cmd_vel_timeout
        assert end is None or before.deadline_ns is None or end <= before.deadline_ns
        if timeout and before.target != STILL:
            assert end is not None and end <= max(time_ns, self.drive.since_ns) + timeout * 1e9 + 1
        elif not timeout:
            assert end is None

    def _check(self, before):
        goal = goal_of(before)
        check_step(before, self.drive, goal,
                   goal != self.goal or before.settings is not self.settings)
        check_state(self.drive)
        self.goal, self.settings, self.steps = goal, before.settings, self.steps + 1


class World:
    """Draws settings and drives whose ramps take some steps at any rate."""

    def __init__(self, seed):
        self.random = random.Random(seed)
        self.rate = 10.0 ** self.random.uniform(0.0, 3.0)
        self.equal = self.random.random() < 0.5
        self.bounded = self.random.random() < 0.6

    def about(self, scale, spread, sometimes=0.5):
        if self.random.random() >= sometimes:
            return NAN
        return scale * spread ** self.random.uniform(-1.0, 1.0)

    def limits(self, scale):
        often = self.random.choice([0.0, 0.4, 0.8])
        steps = 10.0 ** self.random.uniform(-0.5, 1.2)
        rate = scale * self.rate / steps
        jerk = rate * self.rate / 10.0 ** self.random.uniform(-0.5, 0.8)
        soft = self.random.choice([0.0, 0.5, 1.0])
        return AxisLimits(
            self.about(scale, 2.0, 0.4), -self.about(scale, 2.0, 0.3),
            self.about(rate, 3.0, often), -self.about(rate, 3.0, often),
            -self.about(rate, 3.0, often), self.about(rate, 3.0, often),
            self.about(jerk, 3.0, soft), -self.about(jerk, 3.0, soft))

    def geometry(self):
        multipliers = (1.0, 1.0) if self.equal else (
            self.random.uniform(0.7, 1.4), self.random.uniform(0.7, 1.4))
        return WheelGeometry(2.0, self.random.uniform(0.05, 1.0), 1.0, *multipliers)

    def settings(self):
        geometry = self.geometry()
        bound = self.about(0.6 / geometry.wheel_radius, 3.0) if self.bounded else NAN
        timeout = self.random.choice([0.0, self.random.uniform(1.0, 20.0) / self.rate])
        return DriveSettings(
            geometry, self.limits(1.0), self.limits(1.0), bound, timeout, self.rate)

    def changed(self, settings):
        other = self.settings()
        names = self.random.choice([
            ('linear',), ('angular',), ('linear', 'angular'), ('max_wheel_rate',), ('geometry',),
            ('geometry', 'max_wheel_rate', 'linear'), ('update_rate',), ('cmd_vel_timeout',), ()])
        if 'update_rate' in names:
            self.rate *= 3.0 ** self.random.uniform(-1.0, 1.0)
            return replace(settings, update_rate=self.rate)
        return replace(settings, **{name: getattr(other, name) for name in names})

    def command(self):
        return Twist(*(self.random.choice([0.0, self.random.uniform(-1.5, 1.5)]) for _ in AXES))


def time_to_rest(drive, equal):
    """Return the time [s] in which a drive that is told to stand does, with a few of its steps."""
    axes = [Law.of(limits).to_stand(velocity) for velocity, limits in zip(
        drive.twist, (drive.settings.linear, drive.settings.angular))]
    together = equal or math.isnan(drive.settings.max_wheel_rate)
    return (max if together else sum)(axes) + 4.0 / drive.settings.update_rate


@pytest.mark.parametrize('block', range(BLOCKS))
def test_every_step_of_a_random_drive_keeps_every_limit_and_it_ends_at_rest(block):
    steps = 0
    for seed in range(block * CASES, (block + 1) * CASES):
        world = World(seed)
        driver, time_ns = Driver(world.settings()), 0
        try:
            for _ in range(world.random.randrange(1, 7)):
                steps_on = world.random.choice([9.0, 9.0, 9.0, 99.0]) * world.random.random()
                time_ns += round(steps_on * 1e9 / world.rate)
                if world.random.random() < 0.25:
                    driver.configure(world.changed(driver.drive.settings), time_ns)
                else:
                    driver.command(world.command(), time_ns)
            if driver.drive.deadline_ns is None:
                driver.command(STILL, time_ns + 1)
            else:
                time_ns = driver.drive.deadline_ns
                driver.to(time_ns - 1)
            rest = time_to_rest(driver.drive, world.equal)
            driver.to(time_ns + 1 + round(rest * 1e9))
            assert driver.drive.rates == (0.0, 0.0) == driver.drive.twist, 'not at rest'
        except AssertionError as error:
            raise AssertionError(f'drive {seed}, step {driver.steps}: {error}') from error
        steps += driver.steps
    assert steps > 10 * CASES
