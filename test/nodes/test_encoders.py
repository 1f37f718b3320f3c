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
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
import pytest
from sensor_msgs.msg import JointState
from std_msgs.msg import Empty, Float64MultiArray
from support.graph import JOINTS, KHEPERA, set_stamp, stamp_ns, twist, x_of

BASE = {**KHEPERA, 'enable_odom_tf': False, 'extrapolate_positions': False}
RADIUS = KHEPERA['wheel_radius']
STEP_NS = 20_000_000
BATCH = 8  # below the depth of the base's queue
STEPS = 40


def play(graph, readings, distances, joints=JOINTS, velocity=()):
    """Play positions of the joints, one message each 20 ms, and see how far [m] that is."""
    odometry = graph.collect(Odometry, 'odom')
    wheels = graph.publisher(JointState, 'wheel_rates')
    start = graph.now_ns() - len(readings) * STEP_NS
    for number, (reading, distance) in enumerate(zip(readings, distances)):
        message = JointState(name=joints, position=[float(value) for value in reading],
                             velocity=velocity)
        set_stamp(message, start + number * STEP_NS)
        wheels.publish(message)
        if number % BATCH == 0 or number == len(readings) - 1:
            graph.wait_for(
                lambda: odometry and x_of(odometry) == pytest.approx(distance, abs=1e-9),
                f'{distance} m at reading {number}', timeout=20.0)
    return odometry


@pytest.mark.parametrize('low', [-0.5, 0.0], ids=['centred', 'from zero'])
@pytest.mark.parametrize('share', [0.45, -0.13])
def test_positions_that_wrap_around_are_followed(graph, low, share):
    period = 4.0
    graph.start('simulated_base', {**BASE, 'encoder_range': period})
    angles = [share * period * number for number in range(STEPS)]
    readings = [(angle - low * period) % period + low * period for angle in angles]
    play(graph, [(reading, reading) for reading in readings],
         [RADIUS * angle for angle in angles])


def test_ticks_that_wrap_around_are_followed_to_the_tick(graph):
    graph.start('simulated_base', {**BASE, 'encoder_range': math.tau})
    angles = [-0.7 * number for number in range(STEPS)]
    encoder, ticks = Encoder(math.tau, 64), Encoder(resolution=64)
    play(graph, [(encoder.reading(angle),) * 2 for angle in angles],
         [RADIUS * ticks.reading(angle) for angle in angles])


def test_wheels_of_one_side_may_wrap_around_one_after_the_other(graph):
    graph.start('simulated_base', {
        **BASE, 'encoder_range': math.tau, 'left_wheel_names': ['fl', 'rl'],
        'right_wheel_names': ['fr', 'rr']})
    angles = [0.5 * number for number in range(STEPS)]
    wrap = Encoder(math.tau).reading
    play(graph, [[wrap(angle + offset) for offset in (0.0, 1.0, 2.0, 3.0)] for angle in angles],
         [RADIUS * angle for angle in angles], ['fl', 'rl', 'fr', 'rr'])


def test_the_order_of_the_joints_in_a_message_does_not_matter(graph):
    graph.start('simulated_base', {**BASE, 'encoder_range': math.tau})
    angles = [0.5 * number for number in range(STEPS)]
    wrap = Encoder(math.tau).reading
    odometry = play(
        graph, [(7.0 * angle, wrap(angle), 0.3, wrap(angle + 1.0)) for angle in angles],
        [RADIUS * angle for angle in angles],
        ['arm', 'right_wheel_joint', 'gripper', 'left_wheel_joint'])
    assert odometry[-1].pose.pose.orientation.z == pytest.approx(0.0, abs=1e-9)


def test_a_message_with_only_some_of_our_joints_is_reported_once_a_second_at_most(graph):
    base = graph.start('simulated_base', {
        **BASE, 'qos_overrides./wheel_rates.subscription.depth': 1000})  # it hears all of them
    joints = graph.collect(JointState, 'joint_states')
    wheels = graph.publisher(JointState, 'wheel_rates')
    for _ in range(200):
        wheels.publish(JointState(name=['arm', 'left_wheel_joint'], velocity=[1.0, 1.0]))
    wheels.publish(JointState(name=JOINTS, velocity=[0.0, 0.0]))
    graph.wait_for(lambda: joints, 'the message with all joints')
    for _ in range(200):
        wheels.publish(JointState(name=['arm', 'left_wheel_joint'], velocity=[1.0, 1.0]))
    graph.wait_for(
        lambda: "only some of our joints, expected also ['right_wheel_joint']" in base.output,
        'a report')
    assert base.output.count('only some of our joints') < 100
    assert list(joints[-1].position) == [0.0, 0.0]


def test_joint_states_are_read_by_encoders_that_wrap_and_tick_and_the_velocity_is_not(graph):
    period, resolution = 3.0, 50
    graph.start('simulated_base', {
        **BASE, 'encoder_range': period, 'encoder_resolution': resolution,
        'command_timeout': 0.0, 'publish_rate': 200.0})
    joints = graph.collect(JointState, 'joint_states')
    wheels = graph.publisher(JointState, 'wheel_rates')
    start = graph.now_ns()
    message = JointState(name=JOINTS, velocity=[8.0, -9.3])
    set_stamp(message, start)
    wheels.publish(message)
    graph.wait_for(lambda: joints and stamp_ns(joints[-1]) > start + 2 * 10**9, 'two seconds')
    read = Encoder(period, resolution).reading
    for message in joints:
        seconds = (stamp_ns(message) - start) / 1e9
        for position, rate in zip(message.position, message.velocity):
            assert -0.5 * period <= position < 0.5 * period
            near = {round(read(rate * seconds + error), 9) for error in (-1e-9, 0.0, 1e-9)}
            assert round(position, 9) in near
        assert list(message.velocity) == [8.0, -9.3]
    assert max(message.position[0] for message in joints) > 1.2


def test_a_base_that_reads_the_encoders_of_another_is_right_to_a_tick(graph):
    encoders = {'encoder_range': math.tau, 'encoder_resolution': 512}
    graph.start('simulated_base', {**BASE, **encoders, 'command_timeout': 0.2})
    graph.start('simulated_base', {
        **BASE, **encoders, 'wheel_motion_topic': 'joint_states', 'joint_states_topic': '',
        'odom_topic': 'wheel_odometry'}, '-r', '__node:=wheel_odometry')
    odometry = graph.collect(Odometry, 'odom')
    read = graph.collect(Odometry, 'wheel_odometry')
    wheels = graph.publisher(JointState, 'wheel_rates')
    wheels.publish(JointState(name=JOINTS, velocity=[0.0, 0.0]))
    graph.wait_for(lambda: read, 'odometry from encoders')
    wheels.publish(JointState(name=JOINTS, velocity=[60.0, 60.0]))
    graph.wait_for(lambda: odometry and x_of(odometry) > 0.2
                   and odometry[-1].twist.twist.linear.x == 0.0, 'the stop')
    assert x_of(odometry) == pytest.approx(60.0 * 0.2 * RADIUS, abs=1e-12)
    tick = RADIUS * math.tau / 512
    graph.wait_for(lambda: abs(x_of(read) - x_of(odometry)) <= tick, 'the same of the encoders')


@pytest.mark.parametrize('inverted', [(True, False), (False, True), (True, True)])
def test_inverted_wheels_have_the_sign_of_their_joints_in_every_message(graph, inverted):
    joints = dict(zip(('left_wheel_inverted', 'right_wheel_inverted'), inverted))
    signs = [-1.0 if side else 1.0 for side in inverted]
    graph.start('diff_drive_controller', {
        **KHEPERA, **joints, 'cmd_vel_timeout': 0.0, 'wheel_commands_topic': 'wheel_commands'})
    graph.start('wheel_noise', {'wheel_radius': RADIUS, **joints, 'right_bias': 0.1})
    graph.start('simulated_base', {
        **BASE, **joints, 'wheel_motion_topic': 'noisy_wheel_rates', 'publish_rate': 10.0})
    rates = graph.collect(JointState, 'wheel_rates')
    arrays = graph.collect(Float64MultiArray, 'wheel_commands')
    noisy = graph.collect(JointState, 'noisy_wheel_rates')
    odometry = graph.collect(Odometry, 'odom')
    states = graph.collect(JointState, 'joint_states')
    graph.wait_for(lambda: all((rates, arrays, noisy, odometry, states)), 'every topic')
    graph.publisher(Twist, 'cmd_vel').publish(twist(RADIUS, 0.0))
    graph.wait_for(lambda: odometry[-1].twist.twist.linear.x
                   and abs(states[-1].position[0]) > 0.5, 'motion')
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


LOOP = """\
/**:
  ros__parameters:
    wheel_radius: 0.021
    wheel_separation: 0.0885
    right_wheel_inverted: true
    gear_ratio: {gear}
    enable_odom_tf: false
    commands: [0.1, 0.5, 0.5, 0.3, -1.0, 0.5, 0.0, 0.0, 1.0]
    max_wheel_rate: 8.0
    right_bias: 0.1
    left_slip_variance: 1.0e-5
    wheel_commands_topic: wheel_commands
    nodes: [diff_drive_controller, wheel_noise, simulated_base, command_sequence]
    wait_for_topics: [odom, go]
    real_time_factor: 2.0
    clock_step: 0.01
/**/simulated_base:
  ros__parameters:
    wheel_motion_topic: noisy_wheel_rates
"""
HEARD = {'wheel_rates': JointState, 'wheel_commands': Float64MultiArray,
         'joint_states': JointState, 'noisy_wheel_rates': JointState, 'odom': Odometry}


@pytest.mark.parametrize('gear', [8.0, 37.3])
def test_a_loop_over_geared_motors_drives_as_one_without(graph, tmp_path, gear):
    """Controller, noise and base, on stepped time; a gear of a power of two is exact."""
    settings, heard = tmp_path / 'loop.yaml', {
        topic: graph.collect(kind, topic) for topic, kind in HEARD.items()}
    go, ends = graph.publisher(Empty, 'go', listeners=0), []
    for ratio in (1.0, gear):
        settings.write_text(LOOP.format(gear=ratio))
        sim = graph.start('diffdrive_sim', args=['--ros-args', '--params-file', str(settings)])
        graph.wait_for(lambda: heard['odom'], 'odometry')
        graph.play_out(sim, go)
        assert heard['odom'][-1].twist.twist.linear.x == 0.0
        fastest = [max(abs(value) for message in heard[topic] for value in getattr(message, field))
                   for topic, field in (
                       ('wheel_rates', 'velocity'), ('wheel_commands', 'data'),
                       ('noisy_wheel_rates', 'velocity'), ('joint_states', 'velocity'))]
        pose = heard['odom'][-1].pose.pose
        rolled = [tuple(heard[topic][-1].position) for topic in (
            'wheel_rates', 'noisy_wheel_rates', 'joint_states')]
        ends.append(([pose.position.x, pose.position.y, pose.orientation.z], fastest, rolled))
        for messages in heard.values():
            messages.clear()
    (pose, fastest, rolled), (geared_pose, geared_fastest, geared_rolled) = ends
    rounding = 0.0 if gear == 8.0 else 1e-9  # the root of what slip makes of the last bit
    assert geared_pose == pytest.approx(pose, rel=rounding, abs=rounding)
    assert fastest[0] == fastest[1] == pytest.approx(8.0, rel=1e-12)  # of the wheel
    assert geared_fastest == pytest.approx([gear * rate for rate in fastest], rel=1e-9)
    for motors, wheels in zip(geared_rolled, rolled):
        assert wheels[0] > 0.0 > wheels[1]
        assert motors == pytest.approx([gear * angle for angle in wheels], rel=1e-9)


def test_encoders_that_start_again_elsewhere_are_reported_and_do_not_move_the_robot(graph):
    base = graph.start('simulated_base', {**BASE, 'max_encoder_rate': 50.0})
    readings = [0.1 * number for number in range(STEPS)]
    angles = list(readings)
    for number in range(STEPS // 2, STEPS):  # from here on they count from elsewhere
        readings[number] -= 700.0
        angles[number] -= 0.1
    play(graph, [(reading, reading) for reading in readings],
         [RADIUS * angle for angle in angles])
    assert "jump in the positions of 'wheel_rates' (1 so far)" in base.output


def test_positions_that_a_driver_tells_late_or_with_gaps_are_no_motion_before_they_are_told(graph):
    """A broadcaster fills in NaN for what an encoder has not measured yet, or for once."""
    graph.start('simulated_base', BASE)
    nan = math.nan
    positions = [nan, nan, 500.0, 500.1, 500.2, nan, 500.2, 500.3, nan, 500.3, 500.4]
    angles = [0.0, 0.0, 0.0, 0.1, 0.2, 0.2, 0.2, 0.3, 0.3, 0.3, 0.4]
    play(graph, [(position, position) for position in positions],
         [RADIUS * angle for angle in angles], velocity=[0.0, 0.0])


@pytest.mark.parametrize('name, value', [
    ('encoder_range', -1.0), ('encoder_range', 1.5e+300), ('encoder_range', 1.5e-300),
    ('encoder_resolution', -1.0), ('encoder_resolution', 1.5e+300),
    ('encoder_resolution', 1.5e-300), ('max_encoder_rate', 0.0)])
def test_impossible_encoders_are_refused_at_start(graph, name, value):
    base = graph.start('simulated_base', {**BASE, name: value})
    assert base.wait() == 2
    assert f'{name} is {value}' in base.output and 'Traceback' not in base.output
