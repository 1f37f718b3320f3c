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

"""A closed loop of a robot and a planner in a process of its own, on a busy machine or not."""

from contextlib import contextmanager
import hashlib
import subprocess
import sys
import time

from diffdrive_kinematics.testing import Robot
from geometry_msgs.msg import PoseStamped
from support.planners import NOISE, ROBOT

__all__ = ['BUSY', 'driven', 'other_work', 'STEP_S']

BUSY = 'while True: pass'
GOAL = 0.3, 0.2
STEP_S = 0.02
HELD_UP_S, TRIES = 0.5, 4


@contextmanager
def other_work(count):
    """Keep the processors busy."""
    others = [subprocess.Popen([sys.executable, '-c', BUSY]) for _ in range(count)]
    try:
        yield
    finally:
        for each in others:
            each.kill()
            each.wait()


def driven(planner, *, busy=0, options=None, **process):
    """
    Return a hash of the odometry of a closed loop to a goal, and where it ended.

    Where this machine lets a process stand still for a second, Fast DDS takes shared memory for
    broken, and messages come late: a drive in which a step took half of that is driven again.
    """
    options = options or {}
    for _ in range(TRIES):
        odometry, truth, longest_s = _driven(planner, busy, options, process)
        if longest_s < HELD_UP_S:
            break
    return odometry, truth


def _driven(planner, busy, options, process):
    """Return a hash, where it ended, and how long the longest step of the clock took."""
    moments = []

    def advance(seconds):
        for _ in range(round(seconds / STEP_S)):
            robot.advance(STEP_S, **options)
            moments.append(time.monotonic())

    def stands():
        moments.append(time.monotonic())
        return robot.odom.speed == 0.0

    with other_work(busy):
        robot = Robot(params=ROBOT, noise=NOISE)
        try:
            robot.start_process([sys.executable, planner], **process)
            moments.append(time.monotonic())
            advance(0.5)
            pose = PoseStamped()
            pose.pose.position.x, pose.pose.position.y = GOAL
            robot.publish('goal_pose', pose)
            advance(0.5)
            robot.advance_until(stands, timeout=30.0, **options)
            longest_s = max(b - a for a, b in zip(moments, moments[1:]))
            assert robot.odom.distance_to(*GOAL) < 0.03 or longest_s >= HELD_UP_S
            kept = [(each.time, each.message) for each in robot.history('odom')]
            return hashlib.sha256(repr(kept).encode()).hexdigest(), robot.truth, longest_s
        finally:
            robot.close()
