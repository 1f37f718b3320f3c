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
Thirty hours of driving in the core, 5.4 million messages, against 50 digits.

``python test/benchmark/soak_core.py [--hours N]``

A course of 500 commands, each with rates of its own for 20 ms, is driven again and again, from
``Drive`` by ``WheelSample`` to ``Odometry``, as over the topics.  Every lap is the same motion,
so the exact pose after n laps needs the arcs of one lap only: the lap turns by T and moves by d,
and n laps move by the sum of d turned by 0, T, 2 T, ...  Takes some minutes; status 1 where the
pose is further off than 1e-6 m.
"""

import argparse
import math
from pathlib import Path
import sys
import time

sys.path.insert(0, str(Path(__file__).parents[1]))

from support.long_drive import Course, PERIOD_NS  # noqa: E402, I100

BOUND_M = 1e-6


def main():
    """Drive, compare, and judge."""
    parser = argparse.ArgumentParser(description=__doc__.split('\n')[1])
    parser.add_argument('--hours', type=float, default=30.0)
    options = parser.parse_args()
    course = Course()
    laps = max(1, round(options.hours * 3600e9 / PERIOD_NS / len(course.twists)))
    began = time.monotonic()
    reading = course.driven(laps)
    seconds = time.monotonic() - began
    x, y, theta = course.exact(laps)
    off = math.hypot(reading.pose.x - float(x), reading.pose.y - float(y))
    turned = math.remainder(reading.pose.theta - float(theta), math.tau)
    print(f'{laps * len(course.twists)} messages, {laps * len(course.twists) * PERIOD_NS / 3.6e12}'
          f' h, in {seconds:.0f} s: the pose is off by {off:.2e} m, {abs(turned):.2e} rad')
    return 1 if off > BOUND_M else 0


if __name__ == '__main__':
    sys.exit(main())
