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
bound and geometry of the wheels, the rate of the ramp), and then nothing, until the watchdog has
it at rest.  The laws are stated here anew, from the table in ``limits.py``:

* A step stays between where the axis is and its goal, what was asked for within the velocity
  range and scaled by one factor to the bound of the wheels.
* To brake and speed up by a step takes no longer than the step does.
* Acceleration towards the goal grows and falls within the jerk; what points away ends at once.
  Where a command or new settings just came it may fall faster if it could not end in time.
* No wheel ever exceeds its bound.  New settings of the wheels hold at once, and cut.
* A drive is at rest when its limits allow it to be.
"""

from dataclasses import replace
import math
import random
from typing import NamedTuple

from diffdrive_kinematics.core.drive import Drive, DriveSettings, Twist
from diffdrive_kinematics.core.geometry import twist_from_wheel_rates, WheelGeometry
from diffdrive_kinematics.core.limits import AxisLimits
import pytest

NAN, INF = math.nan, math.inf
STILL = Twist(0.0, 0.0)
BLOCKS, CASES = 20, 500
DIGITS = 1e-12  # of speeds of about 1
AXES = (0, 1)


class Law(NamedTuple):
    """Limits of one axis as the table of ``limits.py`` has them, all but velocities positive."""

    low: float
    high: float
    up: float
    reverse_up: float
    down: float
    reverse_down: float
    rise: float
    fall: float

    @classmethod
    def of(cls, limits):
        def first(*values):
            return next((value for value in values if not math.isnan(value)), INF)
        high = first(limits.max_velocity)
        up = first(limits.max_acceleration)
        reverse_up = first(-limits.max_acceleration_reverse, up)
        down = first(-limits.max_deceleration, reverse_up)
        rise = first(limits.max_jerk)
        return cls(
            first(limits.min_velocity, -high), high, up, reverse_up, down,
            first(limits.max_deceleration_reverse, down), rise, first(-limits.min_jerk, rise))

    def seconds(self, start, end):
        """Return the least time from one velocity to another, jerk aside."""
        if start < 0.0 or start == 0.0 > end:
            mirrored = self._replace(up=self.reverse_up, down=self.reverse_down)
            return mirrored._seconds(-start, -end, self.up)
        return self._seconds(start, end, self.reverse_up)

    def _seconds(self, start, end, beyond):
        if end > start:
            return (end - start) / self.up
        return (start - max(end, 0.0)) / self.down + max(0.0, -end) / beyond

    def jerks(self, direction):
        """Return how fast an acceleration in a direction may grow, and fall."""
        return (self.rise, self.fall) if direction > 0.0 else (self.fall, self.rise)

    def to_stand(self, velocity):
        """Return the least time in which a velocity that is steady comes to rest."""
        speed, rate = abs(velocity), self.down if velocity > 0.0 else self.reverse_down
        soft = 1.0 / self.rise + 1.0 / self.fall
        if 0.5 * rate * rate * soft <= speed:
            return speed / rate + 0.5 * rate * soft
        return math.sqrt(2.0 * speed * soft)


def wheel_rates(geometry, twist):
    half = 0.5 * geometry.separation * twist[1]
    return (twist[0] - half) / geometry.left_radius, (twist[0] + half) / geometry.right_radius


def share_within(settings, twist):
    """Return the factor that brings a twist to the bound of the wheels, at most 1."""
    peak = max(map(abs, wheel_rates(settings.geometry, twist)))
    return settings.max_wheel_rate / peak if peak > settings.max_wheel_rate else 1.0


def goal_of(drive):
    laws = Law.of(drive.settings.linear), Law.of(drive.settings.angular)
    allowed = [min(max(asked, law.low), law.high) for asked, law in zip(drive.target, laws)]
    factor = share_within(drive.settings, allowed)
    return Twist(factor * allowed[0], factor * allowed[1])


def furthest(settings, axis, start, end, other):
    """Return how far towards ``end`` the wheels allow an axis, beside a value of the other."""
    def within(value):
        twist = (value, other) if axis == 0 else (other, value)
        return share_within(settings, twist) == 1.0
    if within(end):
        return end
    good, bad = start, end
    for _ in range(60):
        good, bad = ((good + bad) / 2, bad) if within((good + bad) / 2) else (
            good, (good + bad) / 2)
    return good


def could_end(law, start, change, fall, end, dt):
    """Return whether changes that fall keep to the end and to what accelerations there may be."""
    towards = math.copysign(1.0, change)
    while change * towards > 0.0:
        after = start + change
        if (after - end) * towards > 0.0 or law.seconds(start, after) > dt:
            return False
        start, change = after, change - towards * fall
    return True


def check_step(old, new, goal, came_anew):
    """Hold a step of a drive, from one state to the next, against the laws."""
    settings, dt = old.settings, 1.0 / old.settings.publish_rate
    for axis, limits in zip(AXES, (settings.linear, settings.angular)):
        law, start, end, aim = Law.of(limits), old.twist[axis], new.twist[axis], goal[axis]
        low, high = min(start, aim), max(start, aim)
        assert low - DIGITS <= end <= high + DIGITS, 'outside current and goal'
        assert (end - start) * (aim - start) >= 0.0 or high - low < DIGITS, 'away from the goal'
        assert min(law.low, start) - DIGITS <= end <= max(law.high, start) + DIGITS
        assert law.seconds(start, end) <= dt * (1.0 + 1e-9) + law.seconds(0.0, DIGITS), (
            'acceleration')
        change, before = end - start, start - old.before[axis]
        towards = math.copysign(1.0, aim - start if aim != start else before)
        change, before = change * towards, max(0.0, before * towards)
        rise, fall = (jerk * dt * dt for jerk in law.jerks(towards))
        assert change - before <= rise * (1.0 + 1e-9) + 4.0 * DIGITS, 'jerk: grows'
        if before - change > fall * (1.0 + 1e-9) + 4.0 * DIGITS:
            assert came_anew, 'jerk: falls'
            room = min((furthest(settings, axis, start, aim, drive.twist[1 - axis])
                        for drive in (old, new)), key=lambda value: abs(value - start))
            least = towards * max(0.0, before - fall)
            assert not could_end(law, start, least, fall, room, dt), 'jerk: for no reason'
    laws = Law.of(settings.linear), Law.of(settings.angular)
    if all(math.isinf(law.rise) and math.isinf(law.fall) for law in laws):
        check_haste(old, new, goal, dt)


def check_haste(old, new, goal, dt):
    """Hold an axis that limits of acceleration would let go on to a wheel being at its bound."""
    settings = old.settings
    limits = settings.linear, settings.angular
    held_back = any(
        abs(new.twist[axis] - goal[axis]) > DIGITS
        and Law.of(limits[axis]).seconds(old.twist[axis], new.twist[axis]) < 0.999 * dt
        for axis in AXES)
    turned_round = any(old.twist[axis] * goal[axis] < 0.0 for axis in AXES)
    unequal = settings.geometry.left_radius != settings.geometry.right_radius
    if held_back and not (turned_round or unequal):
        assert max(map(abs, new.rates)) == pytest.approx(settings.max_wheel_rate, rel=1e-9)


def check_state(drive):
    assert drive.step_ns is not None or drive.before == drive.twist, 'at rest, yet accelerating'
    bound = drive.settings.max_wheel_rate
    assert math.isnan(bound) or max(map(abs, drive.rates)) <= bound
    assert twist_from_wheel_rates(drive.settings.geometry, *drive.rates) == pytest.approx(
        drive.twist, abs=DIGITS)


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
            self.drive._replace(settings=settings), self.drive.settings.publish_rate)
        self.drive = self.drive.configured(settings, time_ns)[0]
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
                        (before, rate_before), (self.drive, settings.publish_rate)))
                assert is_now == pytest.approx(was, rel=1e-5, abs=DIGITS * settings.publish_rate)
            check_state(self.drive)

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
            ('geometry', 'max_wheel_rate', 'linear'), ('publish_rate',), ()])
        if 'publish_rate' in names:
            self.rate *= 3.0 ** self.random.uniform(-1.0, 1.0)
            return replace(settings, publish_rate=self.rate)
        return replace(settings, **{name: getattr(other, name) for name in names})

    def command(self):
        return Twist(*(self.random.choice([0.0, self.random.uniform(-1.5, 1.5)]) for _ in AXES))


def time_to_rest(drive, equal):
    """Return the time [s] in which a drive that is told to stand does, with a few of its steps."""
    axes = [Law.of(limits).to_stand(velocity) for velocity, limits in zip(
        drive.twist, (drive.settings.linear, drive.settings.angular))]
    together = equal or math.isnan(drive.settings.max_wheel_rate)
    return (max if together else sum)(axes) + 4.0 / drive.settings.publish_rate


@pytest.mark.parametrize('block', range(BLOCKS))
def test_every_step_of_a_random_drive_keeps_every_limit_and_it_ends_at_rest(block):
    steps = 0
    for seed in range(block * CASES, (block + 1) * CASES):
        world = World(seed)
        driver, time_ns = Driver(world.settings()), 0
        try:
            for _ in range(world.random.randrange(1, 7)):
                time_ns += round(world.random.uniform(0.0, 9.0) * 1e9 / world.rate)
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
