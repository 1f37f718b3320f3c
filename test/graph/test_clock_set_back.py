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

from diffdrive_kinematics.nodes.simulated_base import SimulatedBase
from diffdrive_kinematics.nodes.wheel_noise import WheelNoise
import pytest
from support.graph import JOINTS, KHEPERA, wheel_motion
from support.inside import inside, START_NS
from support.stepped import messages

pytestmark = pytest.mark.ros

SPEED, PERIOD_S = 0.2, 0.02  # [m/s], of the clock and of all that is published
STEPS_S = [-0.05, -0.5, -5.0, -99.0]  # less and more than timeouts; rosbag2 in a loop, a reset
STEP_OF_X = SPEED * PERIOD_S
RATE, PERIOD_MS, MS = 10.0, 20, 10**6  # [rad/s] of both wheels
ORDERS = 'together', 'the clock', 'stamps'
SAYS = 'rates', 'both', 'both, of a driver', 'a wheel at a time'


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


def rolling(held, step_ms, first, says):
    """
    Roll on for 1.2 s, half of it after the clock was set back; yield the time [ms] that passed.

    One of the clock and the stamps of wheel motion may be set back a message before the other.
    """
    for number in range(60):
        passed_ms, back = PERIOD_MS * number, step_ms * (number >= 30)
        held.advance_to(START_NS + MS * (
            passed_ms + (0 if first == 'stamps' and number == 30 else back)))
        stamp_ns = START_NS + MS * (
            passed_ms + (0 if first == 'the clock' and number == 30 else back))
        for joints in [JOINTS[:1], JOINTS[1:]] if says == 'a wheel at a time' else [JOINTS]:
            told = says != 'rates' and (number or says != 'both')
            held.hear('/wheel_rates', wheel_motion(
                stamp_ns, [RATE * passed_ms / 1e3] * len(joints) if told else (),
                [RATE] * len(joints), names=joints,
                frame_id='/controller#1' if says in ('rates', 'both') else ''))
        yield passed_ms


@pytest.mark.parametrize('says', SAYS)
@pytest.mark.parametrize('first', ORDERS)
@pytest.mark.parametrize('step_ms', [-50, -500, -5000, -900_000])
def test_a_base_is_two_messages_behind_at_most_whatever_is_set_back_first(step_ms, first, says):
    """Where positions are set back before the clock it is ahead for that one message."""
    with inside(SimulatedBase, {**KHEPERA, 'enable_odom_tf': False}) as held:
        errors_ms = [
            held.node.reading().pose.x / (KHEPERA['wheel_radius'] * RATE) * 1e3 - passed_ms
            for passed_ms in rolling(held, step_ms, first, says)]
    if first == 'stamps':
        del errors_ms[30]
    assert -2.001 * PERIOD_MS < min(errors_ms) and max(errors_ms) < 1e-6 * PERIOD_MS


@pytest.mark.parametrize('says', SAYS)
@pytest.mark.parametrize('first', ORDERS)
@pytest.mark.parametrize('step_ms', [-50, -500, -5000, -900_000])
def test_the_noise_hands_on_all_motion_whatever_is_set_back_first(step_ms, first, says):
    with inside(WheelNoise, {'wheel_radius': KHEPERA['wheel_radius']}) as held:
        *_, passed_ms = rolling(held, step_ms, first, says)
        said = held.said['/noisy_wheel_rates']
    assert len(said) >= 57
    angles = [message.position[0] if message.position else 0.0 for message in said]
    assert angles[-1] == pytest.approx(RATE * passed_ms / 1e3, abs=1.001 * RATE * PERIOD_MS / 1e3)
    if first != 'stamps':
        ways = [b - a for a, b in zip(angles, angles[1:])]
        assert 0.0 <= min(ways) and max(ways) < 3.001 * RATE * PERIOD_MS / 1e3
