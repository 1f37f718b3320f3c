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

"""Several wheels of a side, of which one says something else, and one wheel a message."""

import math

import pytest
from support.graph import JOINTS, KHEPERA, pose_of
from support.health import statuses_of, WARN, with_health
from support.stepped import last, nodes, tell_wheels, time_ns

pytestmark = pytest.mark.ros

WHEELS = ['fl', 'rl', 'fr', 'rr']
RADIUS, SEPARATION = KHEPERA['wheel_radius'], KHEPERA['wheel_separation']
BASE = {**KHEPERA, 'enable_odom_tf': False, 'diagnostics_rate': 10.0,
        'extrapolate_positions': False}  # these drivers end in mid-drive
FOUR = {**BASE, 'left_wheel_names': ['fl', 'rl'], 'right_wheel_names': ['fr', 'rr']}
STEP_S = 0.02
NAN = math.nan


class Wheels:
    """Says what wheels do, message by message, and sees where the base is then."""

    def __init__(self, diffdrive, capfd, parameters):
        self.robot = with_health(diffdrive(
            nodes('simulated_base'), params=parameters, clock_step=0.5 * STEP_S))
        self._capfd, self._output = capfd, ''

    def say(self, names, position=(), velocity=(), at_ns=None):
        tell_wheels(self.robot, position, velocity, names=names, at_ns=at_ns)

    def play(self, rows, names=WHEELS, velocities=None):
        """Say rows of positions, 20 ms apart."""
        for number, row in enumerate(rows):
            self.robot.advance(STEP_S)
            self.say(names, row, velocities[number] if velocities else ())

    def output(self):
        self._output += self._capfd.readouterr().err
        return self._output

    def odometry(self):
        """Return the odometry of a step after this."""
        self.robot.advance(STEP_S)
        return last(self.robot, 'odom')

    def said(self, words):
        """Return the levels of the statuses with some words."""
        return [level for level, text, _ in statuses_of(self.robot, '/simulated_base')
                if words in text]

    def assert_at(self, x, yaw=0.0, tolerance=1e-9):
        odometry = self.odometry()
        assert odometry.pose.pose.position.x == pytest.approx(x, abs=tolerance)
        assert pose_of(odometry).theta == pytest.approx(yaw, abs=1e-9)

    def assert_reported(self, *words):
        self.robot.advance(1.0)
        for word in words:
            assert word in self.output()
        assert WARN in self.said(words[0])


@pytest.fixture
def wheels_of(diffdrive, capfd):
    """Return what makes wheels by the parameters of their base."""
    return lambda parameters: Wheels(diffdrive, capfd, parameters)


def test_a_wheel_whose_position_is_nan_is_left_out_and_reported_and_moves_nothing(wheels_of):
    wheels = wheels_of(FOUR)
    angles = [0.1 * number for number in range(60)]
    rows = [[angle, angle + 5.0, NAN if 10 <= number < 40 else angle - 70.0, angle]
            for number, angle in enumerate(angles)]
    wheels.play(rows)
    wheels.assert_at(RADIUS * angles[-1])
    wheels.assert_reported("position of 'fr' is nan in '/wheel_rates'", '30 so far')
    assert 'refused' not in wheels.output()


def test_a_wheel_whose_velocity_is_nan_is_left_out_of_the_twist(wheels_of):
    wheels = wheels_of({**FOUR, 'command_timeout': 0.0})
    wheels.say(WHEELS, velocity=[2.0, NAN, 2.0, 2.0])
    twist = wheels.odometry().twist.twist
    assert twist.linear.x == pytest.approx(2.0 * RADIUS) and twist.angular.z == pytest.approx(0.0)


@pytest.mark.parametrize('stuck', range(4))
def test_a_stuck_encoder_is_reported_and_does_not_turn_the_robot(wheels_of, stuck):
    wheels = wheels_of(FOUR)
    angles = [0.1 * number for number in range(160)]
    rows = [[angle] * 4 for angle in angles]
    for row in rows:
        row[stuck] = 3.0
    wheels.play(rows)
    wheels.assert_at(RADIUS * angles[-1], tolerance=2e-3)
    wheels.assert_reported('wheels of a side disagree', f"'{WHEELS[stuck]}' 0.00 rad (left out)")


def test_a_stuck_encoder_that_tells_velocities_only_does_not_turn_the_robot(wheels_of):
    wheels = wheels_of({**FOUR, 'command_timeout': 0.0})
    wheels.play([()] * 80, velocities=[[5.0, 0.0, 5.0, 5.0]] * 80)
    wheels.assert_reported('wheels of a side disagree', "'rl' 0.00 rad (left out)")
    twist = wheels.odometry().twist.twist
    assert twist.angular.z == pytest.approx(0.0)
    assert twist.linear.x == pytest.approx(5.0 * RADIUS)


def test_wheels_that_differ_by_some_per_cent_are_nothing_to_report(wheels_of):
    wheels = wheels_of(FOUR)
    angles = [0.1 * number for number in range(160)]
    wheels.play([[1.05 * angle, 0.95 * angle, 0.9 * angle, 1.1 * angle] for angle in angles])
    wheels.assert_at(RADIUS * angles[-1])
    wheels.robot.advance(1.5)
    assert 'disagree' not in wheels.output()
    assert not wheels.said('disagree')


def test_a_single_wheel_that_says_nan_is_refused_as_there_is_nothing_else_to_use(wheels_of):
    wheels = wheels_of(BASE)
    wheels.play([(0.0, 0.0), (0.1, NAN), (0.2, 0.2)], JOINTS)
    wheels.assert_at(RADIUS * 0.2)
    assert 'expected finite numbers' in wheels.output()


def test_messages_that_carry_one_wheel_each_are_put_together_by_joint(wheels_of):
    wheels = wheels_of(BASE)
    for number in range(101):
        for joint, position in zip(JOINTS, (0.1 * number, 0.05 * number)):
            wheels.robot.advance(0.5 * STEP_S)
            wheels.say([joint], [position])
    yaw = RADIUS * (5.0 - 10.0) / SEPARATION
    radius = 0.5 * SEPARATION * (5.0 + 10.0) / (5.0 - 10.0)
    odometry = wheels.odometry()
    early, late = 0.025 * RADIUS / SEPARATION, 0.05 * RADIUS / SEPARATION  # of half a step
    assert yaw - early - 1e-9 <= pose_of(odometry).theta <= yaw + late
    assert odometry.pose.pose.position.x == pytest.approx(radius * math.sin(yaw), abs=2e-3)
    assert odometry.pose.pose.position.y == pytest.approx(
        radius * (1.0 - math.cos(yaw)), abs=2e-3)
    assert 'refused' not in wheels.output()


def test_boards_with_clocks_of_their_own_are_reported(wheels_of):
    wheels = wheels_of(BASE)
    for _ in range(200):
        wheels.robot.advance(STEP_S)
        for joint, apart_ns in zip(JOINTS, (0, 50 * 10**9)):
            wheels.say([joint], [0.0], at_ns=time_ns(wheels.robot) + apart_ns)
    assert "stamps of 'left_wheel_joint' on '/wheel_rates' are 50." in wheels.output()
    assert wheels.said('a clock of its own')
    wheels.assert_reported("stamps of 'left_wheel_joint'", 'a clock of its own')


def test_messages_of_the_front_and_of_the_rear_wheels_are_put_together(wheels_of):
    wheels = wheels_of(FOUR)
    for number in range(80):
        wheels.robot.advance(STEP_S)
        wheels.say(['fl', 'fr'], [0.1 * number, 0.1 * number])
        wheels.say(['rl', 'rr'], [0.1 * number + 9.0, 0.1 * number - 9.0])
    wheels.assert_at(RADIUS * 7.9)


def test_a_joint_that_falls_silent_is_reported_by_name(wheels_of):
    wheels = wheels_of(BASE)
    for joint in JOINTS:
        wheels.say([joint], [0.0])
    for _ in range(150):
        wheels.robot.advance(STEP_S)
        wheels.say(JOINTS[:1], [0.0])
    wheels.assert_reported("no messages of ['right_wheel_joint'] on '/wheel_rates'")
