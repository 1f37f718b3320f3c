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
What every step of a drive has to keep, stated anew from the table in ``limits.py``.

* A step stays between where the axis is and its goal, what was asked for within the velocity
  range and scaled by one factor to the bound of the wheels.
* To brake and speed up by a step takes no longer than the step does.
* Acceleration towards the goal grows and falls within the jerk; what points away ends at once.
  Where a command or new settings just came it may fall faster if it could not end in time.
* An axis goes as far as its acceleration allows, or to where a wheel is at its bound.
* No wheel ever exceeds its bound, and a drive settles at its goal only.
"""

import math
from typing import NamedTuple

from diffdrive_kinematics.core.commands import Twist
from diffdrive_kinematics.core.kinematics import twist_from_wheel_rates
import pytest

__all__ = ['DIGITS', 'Law', 'check_state', 'check_step', 'goal_of', 'share_within']

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
            return next((value for value in values if not math.isnan(value)), math.inf)
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
    settings, dt = old.settings, 1.0 / old.settings.update_rate
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
    if drive.step_ns is None:
        assert drive.before == drive.twist, 'settled, yet accelerating'
        assert drive.twist == pytest.approx(goal_of(drive), abs=DIGITS), 'settled elsewhere'
    bound = drive.settings.max_wheel_rate
    assert math.isnan(bound) or max(map(abs, drive.rates)) <= bound
    assert twist_from_wheel_rates(drive.settings.geometry, *drive.rates) == pytest.approx(
        drive.twist, abs=DIGITS)
