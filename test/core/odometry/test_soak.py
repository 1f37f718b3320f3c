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
The pose after 30 hours, by its last minutes.

All 5.4 million messages take minutes: ``test/benchmark/soak_core.py``.  What could go wrong late
is that sums have grown large, so here the odometry begins with what 30 hours would have left.
"""

import math

from diffdrive_kinematics.core.kinematics import Pose, RunningSum
from diffdrive_kinematics.core.odometry import Odometry
import pytest
from support.long_drive import Course, PERIOD_NS

ROLLED = 30 * 3600 * 0.4 / 0.021  # [rad]
TURNED = 30 * 3600 * 0.2  # [rad]
LAPS = 100


@pytest.mark.slow
def test_the_last_minutes_of_a_drive_of_30_hours_are_as_exact_as_the_first():
    course = Course()
    start = Odometry.starting_at(
        Pose(1e4, -2e4, TURNED), geometry=course.geometry, timeout_ns=None)
    start = start._replace(wheels=start.wheels._replace(
        left=RunningSum(ROLLED), right=RunningSum(ROLLED)))
    reading = course.driven(LAPS, start)
    x, y, theta = course.exact(LAPS, (1e4, -2e4, TURNED))
    off = math.hypot(reading.pose.x - float(x), reading.pose.y - float(y))
    turned = math.remainder(reading.pose.theta - float(theta % (2 * math.pi)), math.tau)
    right = sum(v + 0.5 * course.geometry.separation * w for v, w in course.twists)
    rolled = LAPS * right / course.geometry.right_radius * PERIOD_NS / 1e9
    print(f'off by {off:.2e} m, {abs(turned):.2e} rad, '
          f'{abs(reading.angles[1] - ROLLED - rolled):.2e} rad of the wheel')
    assert off < 1e-10
    assert abs(turned) < 1e-9
    assert abs(reading.angles[1] - ROLLED - rolled) < 1e-9


@pytest.mark.slow
def test_the_first_minutes_agree_to_the_last_digits():
    course = Course()
    reading = course.driven(LAPS)
    x, y, _ = course.exact(LAPS)
    assert math.hypot(reading.pose.x - float(x), reading.pose.y - float(y)) < 1e-11
