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

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from nav_msgs.msg import Odometry
import pytest
from sensor_msgs.msg import JointState
from support.graph import KHEPERA, pose_of, set_stamp

WHEELS = ['fl', 'rl', 'fr', 'rr']
PAIR = ['left_wheel_joint', 'right_wheel_joint']
RADIUS, SEPARATION = KHEPERA['wheel_radius'], KHEPERA['wheel_separation']
BASE = {**KHEPERA, 'enable_odom_tf': False, 'diagnostics_rate': 10.0,
        'extrapolate_positions': False}  # these drivers end in mid-drive
FOUR = {**BASE, 'left_wheel_names': ['fl', 'rl'], 'right_wheel_names': ['fr', 'rr']}
STEP_NS, BATCH = 20_000_000, 8
NAN = math.nan


class Wheels:
    """Publishes what wheels say, message by message, and sees where the base is then."""

    def __init__(self, graph, parameters):
        self.graph = graph
        self.base = graph.start('simulated_base', parameters)
        self.odometry = graph.collect(Odometry, 'odom')
        self.statuses = []
        graph.collect(DiagnosticArray, '/diagnostics', lambda message: self.statuses.extend(
            status for status in message.status if status.name == '/simulated_base'))
        self._publisher = graph.publisher(JointState, 'wheel_rates')
        self.now_ns = graph.now_ns() - 60 * 10**9

    def say(self, names, position=(), velocity=()):
        message = JointState(name=list(names), position=[float(value) for value in position],
                             velocity=[float(value) for value in velocity])
        set_stamp(message, self.now_ns)
        self._publisher.publish(message)

    def play(self, rows, names=WHEELS, velocities=None):
        """Say rows of positions, 20 ms apart, not more at a time than the queue holds."""
        for number, row in enumerate(rows):
            self.now_ns += STEP_NS
            self.say(names, row, velocities[number] if velocities else ())
            if number % BATCH == BATCH - 1:
                count = len(self.odometry)
                self.graph.wait_for(lambda: len(self.odometry) > count + 1, 'the base')

    def wait_for(self, x, yaw=0.0, tolerance=1e-9):
        self.graph.wait_for(
            lambda: self.odometry and self.odometry[-1].pose.pose.position.x == pytest.approx(
                x, abs=tolerance) and pose_of(self.odometry[-1]).theta == pytest.approx(
                    yaw, abs=tolerance), f'x {x}, yaw {yaw}', timeout=30.0)

    def wait_for_report(self, *words):
        def reported():
            return all(word in self.base.output for word in words) and any(
                status.level == DiagnosticStatus.WARN and words[0] in status.message
                for status in self.statuses)

        self.graph.wait_for(reported, f'{words}')


def test_a_wheel_whose_position_is_nan_is_left_out_and_reported_and_moves_nothing(graph):
    wheels = Wheels(graph, FOUR)
    angles = [0.1 * number for number in range(60)]
    rows = [[angle, angle + 5.0, NAN if 10 <= number < 40 else angle - 70.0, angle]
            for number, angle in enumerate(angles)]
    wheels.play(rows)
    wheels.wait_for(RADIUS * angles[-1])
    wheels.wait_for_report("position of 'fr' is nan in '/wheel_rates'", '30 so far')
    assert 'refused' not in wheels.base.output


def test_a_wheel_whose_velocity_is_nan_is_left_out_of_the_twist(graph):
    wheels = Wheels(graph, {**FOUR, 'command_timeout': 0.0})
    wheels.say(WHEELS, velocity=[2.0, NAN, 2.0, 2.0])
    graph.wait_for(lambda: wheels.odometry and wheels.odometry[-1].twist.twist.linear.x, 'motion')
    twist = wheels.odometry[-1].twist.twist
    assert twist.linear.x == pytest.approx(2.0 * RADIUS) and twist.angular.z == pytest.approx(0.0)


@pytest.mark.parametrize('stuck', range(4))
def test_a_stuck_encoder_is_reported_and_does_not_turn_the_robot(graph, stuck):
    wheels = Wheels(graph, FOUR)
    angles = [0.1 * number for number in range(160)]
    rows = [[angle] * 4 for angle in angles]
    for row in rows:
        row[stuck] = 3.0
    wheels.play(rows)
    wheels.wait_for(RADIUS * angles[-1], tolerance=2e-3)
    assert pose_of(wheels.odometry[-1]).theta == pytest.approx(0.0, abs=1e-9)
    wheels.wait_for_report('wheels of a side disagree', f"'{WHEELS[stuck]}' 0.00 rad (left out)")


def test_a_stuck_encoder_that_tells_velocities_only_does_not_turn_the_robot(graph):
    wheels = Wheels(graph, {**FOUR, 'command_timeout': 0.0})
    wheels.play([()] * 80, velocities=[[5.0, 0.0, 5.0, 5.0]] * 80)
    wheels.wait_for_report('wheels of a side disagree', "'rl' 0.00 rad (left out)")
    graph.wait_for(lambda: wheels.odometry[-1].twist.twist.angular.z == pytest.approx(0.0), 'calm')
    assert wheels.odometry[-1].twist.twist.linear.x == pytest.approx(5.0 * RADIUS)


def test_wheels_that_differ_by_some_per_cent_are_nothing_to_report(graph):
    wheels = Wheels(graph, FOUR)
    angles = [0.1 * number for number in range(160)]
    wheels.play([[1.05 * angle, 0.95 * angle, 0.9 * angle, 1.1 * angle] for angle in angles])
    wheels.wait_for(RADIUS * angles[-1])
    count = len(wheels.statuses)
    graph.wait_for(lambda: len(wheels.statuses) > count + 15, 'more than a second')
    assert 'disagree' not in wheels.base.output
    assert not any('disagree' in status.message for status in wheels.statuses)


def test_a_single_wheel_that_says_nan_is_refused_as_there_is_nothing_else_to_use(graph):
    wheels = Wheels(graph, BASE)
    wheels.play([(0.0, 0.0), (0.1, NAN), (0.2, 0.2)], PAIR)
    wheels.wait_for(RADIUS * 0.2)
    assert 'expected finite numbers' in wheels.base.output


def test_messages_that_carry_one_wheel_each_are_put_together_by_joint(graph):
    wheels = Wheels(graph, BASE)
    for number in range(101):
        for joint, position in zip(PAIR, (0.1 * number, 0.05 * number)):
            wheels.now_ns += STEP_NS // 2
            wheels.say([joint], [position])
        if number % 4 == 3:
            count = len(wheels.odometry)
            graph.wait_for(lambda: len(wheels.odometry) > count + 1, 'the base')
    yaw = RADIUS * (5.0 - 10.0) / SEPARATION
    radius = 0.5 * SEPARATION * (5.0 + 10.0) / (5.0 - 10.0)

    def there():
        left_late = yaw + RADIUS * 0.05 / SEPARATION  # the left wheel was measured earlier
        return wheels.odometry and yaw - 1e-9 <= pose_of(wheels.odometry[-1]).theta <= left_late

    graph.wait_for(there, f'yaw {yaw}', timeout=30.0)
    assert wheels.odometry[-1].pose.pose.position.x == pytest.approx(
        radius * math.sin(yaw), abs=2e-3)
    assert wheels.odometry[-1].pose.pose.position.y == pytest.approx(
        radius * (1.0 - math.cos(yaw)), abs=2e-3)
    assert 'refused' not in wheels.base.output


def test_boards_with_clocks_of_their_own_are_reported(graph):
    wheels = Wheels(graph, BASE)

    def going_on():
        for joint, apart_ns in zip(PAIR, (0, 50 * 10**9)):
            wheels.now_ns += STEP_NS + apart_ns
            wheels.say([joint], [0.0])
            wheels.now_ns -= apart_ns
        return "stamps of 'left_wheel_joint' on '/wheel_rates' are 50." in wheels.base.output

    graph.wait_for(going_on, 'a report')
    wheels.wait_for_report("stamps of 'left_wheel_joint'", 'a clock of its own')


def test_messages_of_the_front_and_of_the_rear_wheels_are_put_together(graph):
    wheels = Wheels(graph, FOUR)
    for number in range(80):
        wheels.now_ns += STEP_NS
        wheels.say(['fl', 'fr'], [0.1 * number, 0.1 * number])
        wheels.say(['rl', 'rr'], [0.1 * number + 9.0, 0.1 * number - 9.0])
        if number % 4 == 3:
            count = len(wheels.odometry)
            graph.wait_for(lambda: len(wheels.odometry) > count + 1, 'the base')
    wheels.wait_for(RADIUS * 7.9)


def test_a_joint_that_falls_silent_is_reported_by_name(graph):
    wheels = Wheels(graph, BASE)
    for joint in PAIR:
        wheels.say([joint], [0.0])
    graph.wait_for(lambda: wheels.odometry, 'odometry')

    def going_on():
        wheels.now_ns += STEP_NS
        wheels.say(PAIR[:1], [0.0])
        return "no messages of ['right_wheel_joint'] on '/wheel_rates'" in wheels.base.output

    graph.wait_for(going_on, 'a report')
    wheels.wait_for_report("no messages of ['right_wheel_joint']")
