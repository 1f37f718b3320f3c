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

from diffdrive_kinematics.testing import Robot
from geometry_msgs.msg import PoseStamped
from support.planners import NOISE, ROBOT

__all__ = ['BUSY', 'driven', 'other_work', 'STEP_S']

BUSY = 'while True: pass'
GOAL = 0.3, 0.2
STEP_S = 0.02


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
    """Return a hash of the odometry of a closed loop to a goal, and where it ended."""
    options = options or {}
    with other_work(busy):
        robot = Robot(params=ROBOT, noise=NOISE)
        try:
            robot.start_process([sys.executable, planner], **process)
            robot.advance(0.5, **options)
            pose = PoseStamped()
            pose.pose.position.x, pose.pose.position.y = GOAL
            robot.publish('goal_pose', pose)
            robot.advance(0.5, **options)
            robot.advance_until(lambda: robot.odom.speed == 0.0, timeout=30.0, **options)
            assert robot.odom.distance_to(*GOAL) < 0.03
            kept = [(each.time, each.message) for each in robot.history('odom')]
            return hashlib.sha256(repr(kept).encode()).hexdigest(), robot.truth
        finally:
            robot.close()
