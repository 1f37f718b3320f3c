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

"""Encoders of real robots: wrap-around, ticks, order, mirrored motors, restarts elsewhere."""

import math

from diffdrive_kinematics.core.odometry import Encoder
import pytest
from support.graph import JOINTS, KHEPERA, stamp_ns, twist, x_of
from support.stepped import last, messages, nodes, refusal, tell_wheels

pytestmark = pytest.mark.ros

BASE = {**KHEPERA, 'enable_odom_tf': False, 'extrapolate_positions': False}
RADIUS = KHEPERA['wheel_radius']
STEPS = 40


def base(diffdrive, **parameters):
    """Return a robot that is a base alone."""
    return diffdrive(nodes('simulated_base'), params={**BASE, **parameters})


def play(robot, readings, distances, joints=JOINTS, velocity=()):
    """Play positions of the joints, one message each 20 ms, and see how far [m] that is."""
    for reading, distance in zip(readings, distances):
        tell_wheels(robot, reading, velocity, names=joints)
        robot.advance(0.02)
        assert last(robot, 'odom').pose.pose.position.x == pytest.approx(distance, abs=1e-9)


@pytest.mark.parametrize('low', [-0.5, 0.0], ids=['centred', 'from zero'])
@pytest.mark.parametrize('share', [0.45, -0.13])
def test_positions_that_wrap_around_are_followed(diffdrive, low, share):
    period = 4.0
    robot = base(diffdrive, encoder_range=period)
    angles = [share * period * number for number in range(STEPS)]
    readings = [(angle - low * period) % period + low * period for angle in angles]
    play(robot, [(reading, reading) for reading in readings],
         [RADIUS * angle for angle in angles])


def test_ticks_that_wrap_around_are_followed_to_the_tick(diffdrive):
    angles = [-0.7 * number for number in range(STEPS)]
    encoder, ticks = Encoder(math.tau, 64), Encoder(resolution=64)
    play(base(diffdrive, encoder_range=math.tau),
         [(encoder.reading(angle),) * 2 for angle in angles],
         [RADIUS * ticks.reading(angle) for angle in angles])


def test_wheels_of_one_side_may_wrap_around_one_after_the_other(diffdrive):
    robot = base(diffdrive, encoder_range=math.tau, left_wheel_names=['fl', 'rl'],
                 right_wheel_names=['fr', 'rr'])
    angles = [0.5 * number for number in range(STEPS)]
    wrap = Encoder(math.tau).reading
    play(robot, [[wrap(angle + offset) for offset in (0.0, 1.0, 2.0, 3.0)] for angle in angles],
         [RADIUS * angle for angle in angles], ['fl', 'rl', 'fr', 'rr'])


def test_the_order_of_the_joints_in_a_message_does_not_matter(diffdrive):
    robot = base(diffdrive, encoder_range=math.tau)
    angles = [0.5 * number for number in range(STEPS)]
    wrap = Encoder(math.tau).reading
    play(
        robot, [(7.0 * angle, wrap(angle), 0.3, wrap(angle + 1.0)) for angle in angles],
        [RADIUS * angle for angle in angles],
        ['arm', 'right_wheel_joint', 'gripper', 'left_wheel_joint'])
    assert last(robot, 'odom').pose.pose.orientation.z == pytest.approx(0.0, abs=1e-9)


def test_a_message_with_only_some_of_our_joints_is_reported_once_a_second_at_most(
        diffdrive, capfd):
    robot = base(diffdrive)
    for number in range(401):
        if number == 200:
            tell_wheels(robot, velocity=[0.0, 0.0])
        tell_wheels(robot, velocity=[1.0, 1.0], names=['arm', 'left_wheel_joint'])
        robot.advance(0.02)
    output = capfd.readouterr().err
    assert "only some of our joints, expected also ['right_wheel_joint']" in output
    assert 1 <= output.count('only some of our joints') <= 9
    assert list(last(robot, 'joint_states').position) == [0.0, 0.0]


def test_joint_states_are_read_by_encoders_that_wrap_and_tick_and_the_velocity_is_not(diffdrive):
    period, resolution = 3.0, 50
    robot = base(diffdrive, encoder_range=period, encoder_resolution=resolution,
                 command_timeout=0.0, publish_rate=200.0)
    tell_wheels(robot, velocity=[8.0, -9.3])
    robot.advance(2.0)
    read, joints = Encoder(period, resolution).reading, messages(robot, 'joint_states')
    assert stamp_ns(joints[-1]) == 2 * 10**9
    for message in joints:
        seconds = stamp_ns(message) / 1e9
        for position, rate in zip(message.position, message.velocity):
            assert -0.5 * period <= position < 0.5 * period
            near = {round(read(rate * seconds + error), 9) for error in (-1e-9, 0.0, 1e-9)}
            assert round(position, 9) in near
        assert list(message.velocity) == [8.0, -9.3]
    assert max(message.position[0] for message in joints) > 1.2


def test_a_base_that_reads_the_encoders_of_another_is_right_to_a_tick(diffdrive):
    encoders = {'encoder_range': math.tau, 'encoder_resolution': 512}
    robot = diffdrive(
        nodes('simulated_base', 'simulated_base:reader', simulated_base={'command_timeout': 0.2},
              reader={'wheel_motion_topic': 'joint_states', 'joint_states_topic': '',
                      'odom_topic': 'wheel_odometry'}),
        params={**BASE, **encoders})
    tell_wheels(robot, velocity=[0.0, 0.0])
    robot.advance(0.1)
    tell_wheels(robot, velocity=[60.0, 60.0])
    robot.advance(0.5)
    odometry, read = messages(robot, 'odom'), messages(robot, 'wheel_odometry')
    assert odometry[-1].twist.twist.linear.x == 0.0
    assert x_of(odometry) == pytest.approx(60.0 * 0.2 * RADIUS, abs=1e-12)
    assert abs(x_of(read) - x_of(odometry)) <= RADIUS * math.tau / 512


@pytest.mark.parametrize('inverted', [(True, False), (False, True), (True, True)])
def test_inverted_wheels_have_the_sign_of_their_joints_in_every_message(diffdrive, inverted):
    joints = dict(zip(('left_wheel_inverted', 'right_wheel_inverted'), inverted))
    signs = [-1.0 if side else 1.0 for side in inverted]
    robot = diffdrive(
        nodes('diff_drive_controller', 'wheel_noise', 'simulated_base',
              diff_drive_controller={'wheel_commands_topic': 'wheel_commands'},
              wheel_noise={'right_bias': 0.1},
              simulated_base={'wheel_motion_topic': 'noisy_wheel_rates', 'publish_rate': 10.0}),
        params={**BASE, **joints, 'cmd_vel_timeout': 0.0})
    robot.advance(0.1)
    robot.publish('cmd_vel', twist(RADIUS, 0.0))
    robot.advance_until(lambda: abs(last(robot, 'joint_states').position[0]) > 0.5, timeout=2.0)
    rates, arrays, noisy, odometry, states = (messages(robot, topic) for topic in (
        'wheel_rates', 'wheel_commands', 'noisy_wheel_rates', 'odom', 'joint_states'))
    assert list(rates[-1].velocity) == pytest.approx(signs, rel=1e-12)
    assert list(arrays[-1].data) == pytest.approx(signs, rel=1e-12)
    assert rates[-1].position[0] * signs[0] > 0.0
    for message in noisy[-1], states[-1]:
        assert list(message.velocity) == pytest.approx([signs[0], 1.1 * signs[1]], rel=1e-9)
        assert message.position[1] / message.position[0] == pytest.approx(
            1.1 * signs[0] * signs[1], rel=1e-6)
    motion = odometry[-1].twist.twist
    assert motion.linear.x == pytest.approx(1.05 * RADIUS, rel=1e-9)
    assert motion.angular.z == pytest.approx(0.1 * RADIUS / KHEPERA['wheel_separation'], rel=1e-9)


@pytest.mark.parametrize('gear', [8.0, 37.3])
def test_a_loop_over_geared_motors_drives_as_one_without(diffdrive, gear):
    """Controller, noise and base; a gear of a power of two is exact."""
    ends = []
    for ratio in (1.0, gear):
        robot = diffdrive(
            nodes('diff_drive_controller', 'wheel_noise', 'simulated_base',
                  simulated_base={'wheel_motion_topic': 'noisy_wheel_rates'}),
            params={
                **KHEPERA, 'right_wheel_inverted': True, 'gear_ratio': ratio,
                'enable_odom_tf': False, 'max_wheel_rate': 8.0, 'right_bias': 0.1,
                'left_slip_variance': 1e-5, 'wheel_commands_topic': 'wheel_commands'},
            clock_step=0.01)
        for command in ((0.1, 0.5, 0.5), (0.3, -1.0, 0.5), (0.0, 0.0, 1.0)):
            robot.drive(*command)
        heard = {topic: messages(robot, topic) for topic in (
            'wheel_rates', 'wheel_commands', 'joint_states', 'noisy_wheel_rates', 'odom')}
        assert heard['odom'][-1].twist.twist.linear.x == 0.0
        fastest = [max(abs(value) for message in heard[topic] for value in getattr(message, field))
                   for topic, field in (
                       ('wheel_rates', 'velocity'), ('wheel_commands', 'data'),
                       ('noisy_wheel_rates', 'velocity'), ('joint_states', 'velocity'))]
        pose = heard['odom'][-1].pose.pose
        rolled = [tuple(heard[topic][-1].position) for topic in (
            'wheel_rates', 'noisy_wheel_rates', 'joint_states')]
        ends.append(([pose.position.x, pose.position.y, pose.orientation.z], fastest, rolled))
    (pose, fastest, rolled), (geared_pose, geared_fastest, geared_rolled) = ends
    rounding = 0.0 if gear == 8.0 else 1e-9  # the root of what slip makes of the last bit
    assert geared_pose == pytest.approx(pose, rel=rounding, abs=rounding)
    assert fastest[0] == fastest[1] == pytest.approx(8.0, rel=1e-12)  # of the wheel
    assert geared_fastest == pytest.approx([gear * rate for rate in fastest], rel=1e-9)
    for motors, wheels in zip(geared_rolled, rolled):
        assert wheels[0] > 0.0 > wheels[1]
        assert motors == pytest.approx([gear * angle for angle in wheels], rel=1e-9)


def test_encoders_that_start_again_elsewhere_are_reported_and_do_not_move_the_robot(
        diffdrive, capfd):
    robot = base(diffdrive, max_encoder_rate=50.0)
    readings = [0.1 * number for number in range(STEPS)]
    angles = list(readings)
    for number in range(STEPS // 2, STEPS):  # from here on they count from elsewhere
        readings[number] -= 700.0
        angles[number] -= 0.1
    play(robot, [(reading, reading) for reading in readings],
         [RADIUS * angle for angle in angles])
    assert "jump in the positions of 'wheel_rates' (1 so far)" in capfd.readouterr().err


def test_positions_that_a_driver_tells_late_or_with_gaps_are_no_motion_before_they_are_told(
        diffdrive):
    """A broadcaster fills in NaN for what an encoder has not measured yet, or for once."""
    nan = math.nan
    positions = [nan, nan, 500.0, 500.1, 500.2, nan, 500.2, 500.3, nan, 500.3, 500.4]
    angles = [0.0, 0.0, 0.0, 0.1, 0.2, 0.2, 0.2, 0.3, 0.3, 0.3, 0.4]
    play(base(diffdrive), [(position, position) for position in positions],
         [RADIUS * angle for angle in angles], velocity=[0.0, 0.0])


@pytest.mark.parametrize('name, value', [
    ('encoder_range', -1.0), ('encoder_range', 1.5e+300), ('encoder_range', 1.5e-300),
    ('encoder_resolution', -1.0), ('encoder_resolution', 1.5e+300),
    ('encoder_resolution', 1.5e-300), ('max_encoder_rate', 0.0)])
def test_impossible_encoders_are_refused_at_start(diffdrive, name, value):
    assert f'{name} is {value}' in refusal(diffdrive, 'simulated_base', {**BASE, name: value})
