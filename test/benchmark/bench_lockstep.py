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
How much faster than real time a closed loop with a process under test is.

Run: ``python test/benchmark/bench_lockstep.py [--seconds 10]`` (about a minute).

The planner of the tutorial drives towards a goal that is far away, at 50 Hz, and again at 20 Hz.
The processor time of the test (with the robot in it) and of the planner are those of one simulated
second: on a busy machine they say more than the ratio.
"""

import argparse
import os
from pathlib import Path
import sys
import tempfile
import time

from diffdrive_kinematics.testing import Robot
from geometry_msgs.msg import PoseStamped

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from support.planners import NOISE, OTHERS, ROBOT, shown  # noqa: E402, I100

TIMER = 'self.create_timer(0.02'
WAYS = [('use_sim_time alone', False, {}), ("wait_for='cmd_vel'", False, {'wait_for': 'cmd_vel'}),
        ('lockstep=True', True, {})]


def cpu_seconds(pid):
    """Return the processor time [s] of a process so far."""
    return time.clock_gettime(~pid << 3 | 2)


def measured(planner, lockstep, options, seconds):
    """Return seconds, and processor seconds of the test and the planner, a simulated second."""
    robot = Robot(params=ROBOT, noise=NOISE)
    try:
        process = robot.start_process([sys.executable, planner], lockstep=lockstep)
        robot.advance(0.6, **options)
        pose = PoseStamped()
        pose.pose.position.x = 100.0
        robot.publish('goal_pose', pose)
        robot.advance(0.6, **options)
        before = time.monotonic(), time.process_time(), cpu_seconds(process.pid)
        robot.advance(seconds, **options)
        after = time.monotonic(), time.process_time(), cpu_seconds(process.pid)
        return [(last - first) / seconds for first, last in zip(before, after)]
    finally:
        robot.close()


def main():
    """Print a line for each planner and each way to wait for it."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[1])
    parser.add_argument('--seconds', type=float, default=10.0, help='simulated, of each run')
    seconds = parser.parse_args().seconds
    print(f'load {os.getloadavg()[0]:.1f} on {os.cpu_count()} processors')
    print('planner waited for by          x real time   test [ms]  planner [ms]')
    with tempfile.TemporaryDirectory() as directory:
        for rate in (50, 20):
            for way, lockstep, options in WAYS:
                text = shown()['my_planner.py'].replace(TIMER, f'{TIMER[:-4]}{1 / rate}')
                for old, new in OTHERS['in_lockstep'] if lockstep else ():
                    text = text.replace(old, new)
                path = Path(directory) / 'planner.py'
                path.write_text(text)
                if options and rate == 20:
                    options = {**options, 'period': 0.1}  # two messages, in whole steps
                wall, own, planner = measured(path, lockstep, options, seconds)
                print(f'{rate:3} Hz  {way:22}{1.0 / wall:12.1f}{1e3 * own:12.0f}'
                      f'{1e3 * planner:14.0f}', flush=True)


if __name__ == '__main__':
    main()
