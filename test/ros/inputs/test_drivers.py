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

"""Drivers as they are, over the topics: other clocks, wrong velocities, positions alone."""

import math

from diffdrive_kinematics.core.odometry import Mismatch
from diffdrive_kinematics.nodes.simulated_base import SimulatedBase
from diffdrive_kinematics.ros.inputs.driver_watch import clock_text, velocity_text
import pytest
from support.graph import KHEPERA, wheel_motion
from support.health import statuses_of, WARN, with_health
from support.inside import inside, START_NS
from support.stepped import last, nodes, tell_wheels, time_ns

BASE = {**KHEPERA, 'enable_odom_tf': False, 'diagnostics_rate': 20.0}
RADIUS = KHEPERA['wheel_radius']
RATE = 5.0  # [rad/s]


class Drive:
    """A base, and a driver that tells in each step, on its own clock."""

    def __init__(self, robot, *, offset_s=0.0, velocity=None, positions=True):
        self.robot, self._offset_ns = with_health(robot), round(offset_s * 1e9)
        self._velocity, self._positions = velocity, positions

    def tell(self, standing=False):
        """Publish what the wheels do now."""
        angle, rate = RATE * self.robot.time, 0.0 if standing else RATE
        tell_wheels(
            self.robot, [angle, angle] if self._positions else (),
            () if self._velocity is None else [self._velocity * rate] * 2,
            at_ns=time_ns(self.robot) - self._offset_ns)

    def until(self, warning):
        """Tell until the base warns with such words; return what it tells then."""
        def warned():
            self.tell()
            return any(level == WARN and warning(text)
                       for level, text, _ in statuses_of(self.robot, '/simulated_base'))

        self.robot.advance_until(warned, timeout=20.0)
        return statuses_of(self.robot, '/simulated_base')[-1][2]

    def twist(self):
        return last(self.robot, 'odom').twist.twist.linear.x


@pytest.mark.ros
@pytest.mark.parametrize('offset_s', [1_600_000_000.0, 0.6, -3600.0],
                         ids=['since boot', 'late', 'ahead'])
def test_a_driver_with_another_clock_moves_the_robot_and_is_reported_once_and_as_a_warning(
        diffdrive, capfd, offset_s):
    drive = Drive(diffdrive(nodes('simulated_base'), params=BASE), offset_s=offset_s,
                  velocity=1.0, positions=False)
    drive.robot.step_clock(1.7e9)
    drive.robot.advance(0.1)
    values = drive.until(lambda text: 'another' in text or 'clock that is' in text
                         or 'stamped by a clock' in text)
    assert drive.twist() == pytest.approx(RATE * RADIUS)
    assert float(values['stamps are behind by [s]']) == pytest.approx(offset_s, abs=1.0)
    for _ in range(200):
        drive.tell()
        drive.robot.advance(0.02)
    assert capfd.readouterr().err.count('stamped by a clock') == 1
    moved = [each.message.pose.pose.position.x for each in drive.robot.history('odom')]
    assert all(a <= b for a, b in zip(moved, moved[1:]))
    drive.tell(standing=True)
    drive.robot.advance(0.04)
    assert drive.twist() == 0.0


@pytest.mark.ros
def test_velocities_in_rpm_are_reported_with_their_factor_and_the_unit_and_not_used(
        diffdrive, capfd):
    drive = Drive(
        diffdrive(nodes('simulated_base'), params=BASE), velocity=30.0 / math.pi)
    values = drive.until(lambda text: 'in rpm?' in text)
    output = capfd.readouterr().err
    assert 'is 9.55 times what the positions say' in output
    assert output.count('in rpm?') == 1
    assert values['velocities and positions'] == 'disagree'
    assert drive.twist() == pytest.approx(RATE * RADIUS, rel=0.2)


def test_positions_alone_ten_times_a_second_are_published_as_of_the_stamp():
    with inside(SimulatedBase, {**BASE, 'publish_rate': 50.0}) as held:
        for number in range(40):
            now_ns = START_NS + number * 50_000_000
            held.advance_to(now_ns)
            if number % 2 == 0:
                held.hear('/wheel_rates', wheel_motion(now_ns, [RATE * number * 0.05] * 2))
            reading = held.node.reading()
            if number > 10:
                assert reading.pose.x == pytest.approx(RATE * RADIUS * number * 0.05, abs=1e-9)
                assert reading.twist[0] == pytest.approx(RATE * RADIUS)


def test_a_counter_that_wraps_is_a_jump_for_a_base_that_nobody_set_up():
    with inside(SimulatedBase, BASE) as held:
        tick = math.tau / 2048
        for number in range(400):
            now_ns = START_NS + number * 20_000_000
            held.advance_to(now_ns)
            count = (number * 100 + 32768) % 65536 - 32768
            held.hear('/wheel_rates', wheel_motion(now_ns, [count * tick] * 2))
        assert held.node.counts['jump'] == 1
        assert held.node.reading().angles[0] == pytest.approx(399 * 100 * tick, abs=1e-6)


@pytest.mark.parametrize('offset_s, words', [
    (1.7e9, 'behind ours, which is corrected: does its sender stamp the time since boot'),
    (-1.7e9, 'ahead of ours, which is corrected: is use_sim_time true here'),
    (0.6, '0.600 s behind ours'), (-5.0, '5.000 s ahead of ours')])
def test_what_is_said_of_another_clock_says_how_far_and_what_to_do(offset_s, words):
    assert words in clock_text(round(offset_s * 1e9), '/joint_states')


@pytest.mark.parametrize('told, rolled, words', [
    (95.49, 10.0, 'is 9.55 times what the positions say: in rpm?'),
    (-95.49, 10.0, 'in rpm, with the other sign?'), (573.0, 10.0, 'in deg/s?'),
    (1.59, 10.0, 'in turns/s?'), (0.33, 10.0, 'in m/s?'), (-10.0, 10.0, 'the wrong sign?'),
    (0.0, 10.0, 'is it never filled in?'), (2000.0, 10.0, 'in ticks, or another unit?'),
    (20.0, 0.0, 'is it a set point, or what is configured?')])
def test_what_is_said_of_wrong_velocities_names_the_likely_reason(told, rolled, words):
    text = velocity_text(Mismatch('left', told, rolled), 0.033, '/joint_states')
    assert words in text
    assert "velocity of the left wheel on '/joint_states'" in text
