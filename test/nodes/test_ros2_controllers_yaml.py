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
YAML of ros2_controllers' ``diff_drive_controller`` gives the velocities that it gives there.

``rate_limited`` says what control_toolbox's ``RateLimiter`` does, which ros2_controllers'
``SpeedLimiter`` wraps.  The package differs on purpose in five things, and is tested for them:

* A step through zero: there the rate at which the robot brakes also speeds it up in the new
  direction; here that has its own rate for what remains of the step.
* Acceleration that points away from the target: there the jerk limit has to turn it round first,
  so that the velocity grows after a command to stop; here it ends at once.
* Acceleration towards the target: there it ends on arrival, however large it is; here its end is
  planned, within the jerk limit, which may be by a step smaller before.
* A limit whose partner is NaN: there ``min_velocity`` without ``max_velocity``, a braking rate
  without ``max_acceleration`` and ``min_jerk`` without ``max_jerk`` do not count; here they do.
* The step: there it is the period of the controller manager; here it is 1 / ``update_rate``.
"""

import math
from pathlib import Path
import random

from diffdrive_kinematics.core.commands import AxisLimits
from diffdrive_kinematics.nodes.diff_drive_controller import DiffDriveController
import pytest
from support.graph import KHEPERA, stamp_ns, twist
from support.inside import inside, START_NS
import yaml

DATA = Path(__file__).parents[1] / 'data' / 'ros2_controllers'
DT_NS = 10_000_000  # of the default update_rate
DT = DT_NS / 1e9
STEPS = 2000
NAN = math.nan
KEYS = (
    'min_velocity', 'max_velocity', 'max_acceleration_reverse', 'max_acceleration',
    'max_deceleration', 'max_deceleration_reverse', 'min_jerk', 'max_jerk')


def clamp(value, low, high):
    return low if value < low else high if high < value else value


def or_else(value, default):
    return default if math.isnan(value) else value


def rate_limited(limits, v, v0, v1, dt=DT):
    """Return the velocity after v0, which came after v1, on the way to v: control_toolbox."""
    v_min, v_max, up_reverse, up, down, down_reverse, j_min, j_max = (
        limits.get(key, NAN) for key in KEYS)
    if not math.isnan(j_max):
        change, change_before = v - v0, v0 - v1
        if (change - change_before) * change > 0.0:
            growth = clamp(
                change - change_before, or_else(j_min, -j_max) * dt * dt, j_max * dt * dt)
            v = v0 + change_before + growth
    if not math.isnan(up):
        up_reverse = or_else(up_reverse, -up)
        down = or_else(down, up_reverse)
        down_reverse = or_else(down_reverse, -down)
        lowest = down if v0 > 0.0 else up_reverse
        highest = down_reverse if v0 < 0.0 else up
        v = v0 + clamp(v - v0, lowest * dt, highest * dt)
    return v if math.isnan(v_max) else clamp(v, or_else(v_min, -v_max), v_max)


def through_zero(limits, v, v0, v1, dt=DT):
    """Return what the package does instead where that passes through zero."""
    if not math.isnan(j_max := limits.get('max_jerk', NAN)):
        v = rate_limited(
            {'max_jerk': j_max, 'min_jerk': limits.get('min_jerk', NAN)}, v, v0, v1, dt)
    up = limits['max_acceleration']
    up_reverse = or_else(limits.get('max_acceleration_reverse', NAN), -up)
    down = or_else(limits.get('max_deceleration', NAN), up_reverse)
    down_reverse = or_else(limits.get('max_deceleration_reverse', NAN), -down)
    if v0 > 0.0:
        v = max(v, up_reverse * (dt - v0 / -down))
    else:
        v = min(v, up * (dt - -v0 / down_reverse))
    v_max = limits.get('max_velocity', NAN)
    return v if math.isnan(v_max) else clamp(v, or_else(limits.get('min_velocity', NAN), -v_max),
                                             v_max)


def allowed(limits, v):
    high = or_else(limits.get('max_velocity', NAN), math.inf)
    return clamp(v, or_else(limits.get('min_velocity', NAN), -high), high)


def ends_in_time(limits, change, v0, goal, dt=DT):
    """Return whether an acceleration can fall within its jerk so as to end at the goal."""
    towards = math.copysign(1.0, change)
    high = limits['max_jerk']
    fall = (-or_else(limits.get('min_jerk', NAN), -high) if change > 0.0 else high) * dt * dt
    free = {**limits, 'max_jerk': NAN, 'min_jerk': NAN}
    while change * towards > 0.0:
        v = v0 + change
        most = rate_limited(free, goal, v0, v0, dt)
        if v0 * v < 0.0 and not math.isnan(limits['max_acceleration']):
            most = through_zero(free, goal, v0, v0, dt)
        if (v - goal) * towards > 1e-12 or (v - most) * towards > 1e-12:
            return False
        v0, change = v, change - towards * fall
    return True


def planned(limits, v, v0, goal, dt=DT):
    """Return what is nearest to v and still lets the acceleration end at the goal."""
    good, bad = 0.0, v - v0
    for _ in range(60):
        middle = (good + bad) / 2
        good, bad = (middle, bad) if ends_in_time(limits, middle, v0, goal, dt) else (good, middle)
    return v0 + good


def limits_of(path, axis):
    """Return the limits that a YAML file sets, as ros2_controllers reads them."""
    values = yaml.safe_load(path.read_text())['diff_drive_controller']['ros__parameters']
    limits = {key: float(values.get(f'{axis}.{key}', NAN)) for key in KEYS}
    for switch, kind in (('velocity', 'velocity'), ('acceleration', 'celeration'),
                         ('jerk', 'jerk')):
        if not values.get(f'{axis}.has_{switch}_limits', True):
            limits.update({key: NAN for key in limits if kind in key})
    return limits


def targets(seed, scale):
    """Return commands of every kind: steps, ramps, full reverse, rests and noise."""
    generator = random.Random(seed)
    asked = []
    while len(asked) < STEPS:
        kind, length = generator.randrange(5), generator.randrange(1, 60)
        a, b = generator.uniform(-scale, scale), generator.uniform(-scale, scale)
        asked += {
            0: [a] * length, 1: [a + (b - a) * k / length for k in range(length)],
            2: [scale, -scale] * (length // 2), 3: [0.0] * length,
            4: [generator.uniform(-scale, scale) for _ in range(length)]}[kind]
    return asked[:STEPS]


def driven(path, seed):
    """Return (asked, limited) velocities of the node step by step, under a params file."""
    args = ['--ros-args', '--params-file', str(path), '-p', 'cmd_vel_timeout:=0.0']
    with inside(DiffDriveController, args=args, name='diff_drive_controller') as held:
        asked = list(zip(targets(seed, 3.0), targets(seed + 1, 4.0)))
        out, limited, now = held.said['/cmd_vel_out'], [(0.0, 0.0)], held.clock.now_ns()
        for command in asked:
            now += DT_NS
            settled = held.node._drive.step_ns is None
            if not settled:  # the ramp's next step heads for it
                held.clock.advance_to(now - 1)
                held.hear('/cmd_vel', twist(*command))
            held.advance_to(now)
            if settled:  # a ramp begins with it
                held.hear('/cmd_vel', twist(*command))
            limited.append((out[-1].twist.linear.x, out[-1].twist.angular.z))
        return asked, limited, held.node.config


@pytest.mark.parametrize('seed', [1, 2, 3])
@pytest.mark.parametrize('name', ['diffbot', 'switched_off', 'limits', 'four_rates'])
def test_yaml_of_ros2_controllers_loads_unchanged_and_limits_as_it_does_there(name, seed):
    path = DATA / f'{name}.yaml'
    asked, limited, config = driven(path, seed)
    values = yaml.safe_load(path.read_text())['diff_drive_controller']['ros__parameters']
    assert config.drive.geometry.wheel_radius == values['wheel_radius']
    assert config.drive.geometry.separation == values['wheel_separation'] * values.get(
        'wheel_separation_multiplier', 1.0)
    cut = passed = turned = softened = steps = 0
    for axis, key in enumerate(('linear.x', 'angular.z')):
        limits = limits_of(path, key)
        v1 = v0 = 0.0
        for target, after in zip(asked, limited[1:]):
            goal, jerk = allowed(limits, target[axis]), not math.isnan(limits['max_jerk'])
            if jerk and (v0 - v1) * (goal - v0) < 0.0:
                turned += rate_limited(limits, target[axis], v0, v1) != (
                    rate_limited(limits, target[axis], v0, v0))
                v1 = v0
            v = rate_limited(limits, target[axis], v0, v1)
            if v * v0 < 0.0 and not math.isnan(limits['max_acceleration']):
                passed += v != (v := through_zero(limits, target[axis], v0, v1))
            if jerk and not ends_in_time(limits, v - v0, v0, goal):
                softened += v != (v := planned(limits, v, v0, goal))
            assert after[axis] == pytest.approx(v, rel=1e-9, abs=1e-12)
            cut += abs(v - target[axis]) > 1e-9
            v1, v0 = v0, after[axis]
            steps += 1
    assert (cut == 0) == (name == 'switched_off')
    assert (passed > 5) == (name in ('limits', 'four_rates'))
    assert (turned > 5) == (softened > 5) == (name in ('limits', 'four_rates'))
    assert passed + turned + softened < 0.5 * steps, 'all others are the same'


@pytest.mark.parametrize('alone, target, current, there, here', [
    ({'min_velocity': -1.0}, -5.0, 0.0, -5.0, -1.0),
    ({'max_deceleration': -2.0}, 0.0, 1.0, 0.0, 1.0 - 2.0 * DT),
    ({'max_deceleration_reverse': 2.0}, 0.0, -1.0, 0.0, -1.0 + 2.0 * DT),
    ({'max_acceleration_reverse': -2.0}, -5.0, 0.0, -5.0, -2.0 * DT),
    ({'min_jerk': -50.0}, -5.0, 0.0, -5.0, -50.0 * DT * DT)])
def test_a_limit_whose_partner_is_nan_counts_here_and_not_there(
        alone, target, current, there, here):
    assert rate_limited(alone, target, current, current) == there
    limited = AxisLimits(**alone).limit(target, current=current, before=current, dt=DT)
    assert limited == pytest.approx(here, abs=1e-15)


def test_a_stop_while_speeding_up_slows_down_here_and_speeds_up_there():
    limits = {'max_acceleration': 5.0, 'max_jerk': 10.0}
    v0, v1 = 1.0, 1.0 - 4.0 * DT
    assert rate_limited(limits, 0.0, v0, v1) > v0
    limited = AxisLimits(**limits).limit(0.0, current=v0, before=v1, dt=DT)
    assert limited == pytest.approx(v0 - 10.0 * DT * DT)


def test_an_acceleration_ends_within_its_jerk_here_and_at_once_there():
    limits = {'max_acceleration': 5.0, 'max_jerk': 50.0}
    v0, v1, end = 1.0, 1.0 - 3 * 50.0 * DT * DT, 1.0 + 3 * 50.0 * DT * DT
    assert rate_limited(limits, end, v0, v1) == pytest.approx(end)
    limited = AxisLimits(**limits).limit(end, current=v0, before=v1, dt=DT)
    assert limited == pytest.approx(1.0 + 2 * 50.0 * DT * DT)


def test_a_step_through_zero_speeds_up_at_its_own_rate_here_and_at_the_brakes_there():
    limits = {'max_acceleration': 1.0, 'max_deceleration': -10.0}
    assert rate_limited(limits, -1.0, 0.05, 0.05) == pytest.approx(0.05 - 10.0 * DT)
    limited = AxisLimits(**limits).limit(-1.0, current=0.05, before=0.05, dt=DT)
    assert limited == pytest.approx(-1.0 * (DT - 0.05 / 10.0), abs=1e-15)


@pytest.mark.parametrize('publish_rate', [10.0, 25.0, 1000.0])
@pytest.mark.parametrize('rate', [{}, {'update_rate': 40.0}], ids=['as there', '40 Hz'])
def test_the_step_of_the_limits_is_the_period_of_update_rate_as_there(publish_rate, rate):
    """There the controller manager has one, of 100 Hz; how often it publishes says nothing."""
    period = 1.0 / rate.get('update_rate', 100.0)
    slow = {'publish_rate': publish_rate, 'linear.x.max_acceleration': 1.0,
            'publish_limited_velocity': True, 'cmd_vel_timeout': 0.0, **rate}
    with inside(DiffDriveController, {**KHEPERA, **slow}) as held:
        held.hear('/cmd_vel', twist(10.0, 0.0))
        for ms in range(1, 200):
            held.advance_to(START_NS + ms * 10**6)
        said = held.said['/cmd_vel_out']
    steps = [(stamp_ns(message) - stamp_ns(said[0]), message.twist.linear.x) for message in said]
    changes = [steps[0], *(
        after for before, after in zip(steps, steps[1:]) if after[1] != before[1])]
    assert changes == [
        (round(k * period * 1e9), pytest.approx((k + 1) * period, abs=1e-12))
        for k in range(round(0.2 / period))]
