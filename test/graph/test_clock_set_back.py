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

"""A simulated clock that is set back in mid-drive: what it takes is no time, for any node."""

import pytest
from support.graph import KHEPERA
from support.stepped import messages

pytestmark = pytest.mark.ros

SPEED, PERIOD_S = 0.2, 0.02  # [m/s], of the clock and of all that is published
STEPS_S = [-0.05, -0.5, -5.0, -99.0]  # less and more than timeouts; rosbag2 in a loop, a reset
STEP_OF_X = SPEED * PERIOD_S


def driving(diffdrive, **options):
    """Return a robot at speed, 100 s after time began."""
    robot = diffdrive(params={**KHEPERA, **options.pop('params', {})}, **options)
    robot.step_clock(100.0)
    robot.drive(SPEED, 0.0, 0.6)
    return robot


def places(robot, topic):
    return [message.pose.pose.position.x for message in messages(robot, topic)]


@pytest.mark.parametrize('step_s', STEPS_S)
@pytest.mark.parametrize('stamped', [False, True])
def test_belief_and_truth_go_on_as_if_nothing_had_been(diffdrive, step_s, stamped):
    robot = driving(diffdrive, params={'enable_stamped_cmd_vel': stamped})
    before = robot.odom, robot.truth
    robot.step_clock(step_s)
    assert (robot.odom, robot.truth) == before
    robot.drive(SPEED, 0.0, 0.8)
    belief, truth = places(robot, 'odom'), places(robot, 'ground_truth')
    assert truth == pytest.approx(belief, abs=1e-9)
    ways = [b - a for a, b in zip(belief, belief[1:])]
    assert ways == pytest.approx([STEP_OF_X] * len(ways), abs=1e-9)
    robot.advance(1.0)
    assert robot.odom.speed == robot.truth.speed == 0.0
    assert robot.truth.x == pytest.approx(robot.odom.x, abs=1e-9)
