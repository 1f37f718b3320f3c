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

"""Killed processes, bad links, floods and clocks that jump: what it costs is known, or nothing."""

from itertools import count, cycle
import math
from pathlib import Path
import random
import signal
import statistics
import time

from builtin_interfaces.msg import Time
from diffdrive_kinematics.core.kinematics import advance, Pose, WheelGeometry
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
import pytest
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState
from support.graph import KHEPERA, pose_of, set_stamp, stamp_ns, twist
from support.relay import composed, merging_error, Relay

GEOMETRY = WheelGeometry(KHEPERA['wheel_separation'], KHEPERA['wheel_radius'])
TIMEOUT_S = 0.4
HELD = {'cmd_vel_timeout': 0.0}
BASE = {**KHEPERA, 'enable_odom_tf': False, 'wheel_motion_topic': 'relayed'}
HOUR_NS = 3600 * 10**9
SPEED = 0.2  # [m/s]
NO_TIMES = [Time(sec=sec, nanosec=nanosec) for sec, nanosec in (
    (-1, 0), (-2**31, 5), (2**31 - 1, 0), (100, 10**9), (2**31 - 1, 2**32 - 1))]


def time_of(time_ns):
    return Time(sec=time_ns // 10**9, nanosec=time_ns % 10**9)


def assert_pose(message, expected, within=1e-9):
    x, y, yaw = pose_of(message)
    assert math.hypot(x - expected.x, y - expected.y) < within
    assert abs(math.remainder(yaw - expected.theta, math.tau)) < 1e-9


def is_still(message):
    return message.twist.twist.linear.x == message.twist.twist.angular.z == 0.0


def assert_even(odometry, speed, within=1e-9):
    """Straight on at one speed, x tells nothing but the time."""
    moving = [message for message in odometry if not is_still(message)]
    starts = [message.pose.pose.position.x
              - speed * (stamp_ns(message) - stamp_ns(moving[0])) / 1e9 for message in moving]
    assert len(starts) > 20
    assert max(abs(start - starts[0]) for start in starts) < within


def test_a_base_whose_controller_was_killed_at_speed_stops_exactly_after_the_timeout(graph):
    controller = graph.start('diff_drive_controller', {**KHEPERA, **HELD})
    graph.start('simulated_base', {**BASE, 'command_timeout': TIMEOUT_S})
    relay = Relay(graph, lambda message: [message])
    odometry = graph.collect(Odometry, 'odom')
    graph.wait_for(lambda: odometry, 'odometry')
    graph.publisher(Twist, 'cmd_vel').publish(twist(SPEED, 0.7))
    graph.wait_for(lambda: odometry[-1].pose.pose.position.y > 0.02, 'the robot to drive')
    controller.stop(signal.SIGKILL)
    stopped = graph.wait_for(lambda: is_still(odometry[-1]) and odometry[-1], 'the stop')
    first = next(message for message in relay.went if any(message.velocity))
    seconds = (stamp_ns(relay.went[-1]) - stamp_ns(first)) / 1e9 + TIMEOUT_S
    assert_pose(stopped, advance(Pose(0.0, 0.0, 0.0), SPEED * seconds, 0.7 * seconds))


def test_a_base_that_was_killed_begins_anew_and_the_others_live_on(graph):
    graph.start('diff_drive_controller', {**KHEPERA, **HELD})
    parameters = {**BASE, 'wheel_motion_topic': 'wheel_rates', 'command_timeout': 0.0}
    base = graph.start('simulated_base', parameters)
    graph.start('simulated_base', {
        **parameters, 'odom_topic': 'other', 'joint_states_topic': ''}, '-r', '__node:=other')
    odometry, other = graph.collect(Odometry, 'odom'), graph.collect(Odometry, 'other')
    commands = graph.publisher(Twist, 'cmd_vel')
    graph.wait_for(lambda: odometry and other, 'odometry')
    commands.publish(twist(SPEED, 0.0))
    graph.wait_for(lambda: odometry[-1].pose.pose.position.x > 0.1, 'the robot to drive')
    base.stop(signal.SIGKILL)
    before = list(odometry)
    graph.start('simulated_base', parameters)
    graph.wait_for(lambda: len(odometry) > len(before) + 50, 'odometry again')
    after = [message for message in odometry if stamp_ns(message) > stamp_ns(before[-1]) + 10**8]
    for drive in (before, after, other):
        assert_even(drive, SPEED)
    graph.wait_for(lambda: stamp_ns(other[-1]) > stamp_ns(after[0]), 'the other one to live on')
    lived = next(message for message in other if stamp_ns(message) >= stamp_ns(after[0]))
    assert 0.0 <= after[0].pose.pose.position.x
    assert after[0].pose.pose.position.x < lived.pose.pose.position.x - 0.1  # from 0, not from it


def test_a_noise_node_that_was_killed_and_comes_back_costs_the_truth_nothing(graph):
    graph.start('diff_drive_controller', {**KHEPERA, **HELD})
    noise = graph.start('wheel_noise', {'wheel_radius': 0.021})
    graph.start('simulated_base', {
        **BASE, 'wheel_motion_topic': 'noisy_wheel_rates', 'command_timeout': 0.0})
    truth = graph.collect(Odometry, 'odom')
    noisy = graph.collect(JointState, 'noisy_wheel_rates')
    graph.wait_for(lambda: truth, 'odometry')
    graph.publisher(Twist, 'cmd_vel').publish(twist(SPEED, 0.0))
    graph.wait_for(lambda: truth[-1].pose.pose.position.x > 0.1, 'the robot to drive')
    noise.stop(signal.SIGKILL)
    heard = len(noisy)
    graph.start('wheel_noise', {'wheel_radius': 0.021})
    graph.wait_for(lambda: len(noisy) > heard + 50, 'noise again')
    assert_even(truth, SPEED)


def deep(topic):
    """Return parameters of a base that loses no message of its own, however busy the machine."""
    return {f'qos_overrides./{topic}.subscription.depth': 1000}


def dropping():
    """Return a link that loses three messages of ten."""
    generator = random.Random(7)
    return lambda message: [] if generator.random() < 0.3 else [message]


def shuffling():
    """Return a link that holds messages back behind the next, and says some of them twice."""
    generator, waiting = random.Random(7), []

    def link(message):
        if not waiting and generator.random() < 0.3:
            waiting.append(message)
            return []
        out = [message, *waiting]
        waiting.clear()
        return out * 2 if generator.random() < 0.3 else out

    return link


@pytest.mark.parametrize('make_link', [dropping, shuffling])
def test_messages_that_are_lost_late_or_doubled_cost_no_angle_and_only_their_own_arc(
        graph, make_link):
    graph.start('diff_drive_controller', {**KHEPERA, **HELD})
    graph.start('simulated_base', {**BASE, **deep('relayed')})
    graph.start('simulated_base', {
        **BASE, **deep('wheel_rates'), 'wheel_motion_topic': 'wheel_rates',
        'odom_topic': 'whole_odom',
        'joint_states_topic': 'whole_joints'}, '-r', '__node:=whole')
    poses, joints = graph.collect(Odometry, 'odom'), graph.collect(JointState, 'joint_states')
    whole, wheels = graph.collect(Odometry, 'whole_odom'), graph.collect(
        JointState, 'whole_joints')
    relay = Relay(graph, make_link())
    commands = graph.publisher(Twist, 'cmd_vel')
    graph.wait_for(lambda: poses and whole and joints and wheels, 'odometry')
    generator = random.Random(3)
    for number in range(24):
        heard = len(relay.came)
        v, w = generator.uniform(-0.2, 0.2), generator.uniform(-2.0, 2.0)
        commands.publish(twist(v, w) if number < 23 else twist(0.0, 0.0))
        held = 100 if number % 8 == 0 else 8
        graph.wait_for(lambda: len(relay.came) > heard + held, 'some wheel rates')

    def standing():
        return all(
            is_still(pose) and stamp_ns(pose) > stamp_ns(relay.came[-9]) for pose in
            (poses[-1], whole[-1])) and not any([*joints[-1].velocity, *wheels[-1].velocity])

    graph.wait_for(standing, 'both to stand')
    first = next(number for number, message in enumerate(relay.came) if message.position)
    came = relay.came[max(0, first - 1):]
    assert_pose(whole[-1], composed(GEOMETRY, came))
    assert list(joints[-1].position) == pytest.approx(list(wheels[-1].position), abs=1e-12)
    heading, expected = pose_of(poses[-1]).theta, pose_of(whole[-1]).theta
    assert abs(math.remainder(heading - expected, math.tau)) < 1e-12
    bound = merging_error(GEOMETRY, came, relay.went)
    assert 0.0 < bound < 0.05
    print(f'bound {bound:.6f} m, off by '
          f'{math.dist(pose_of(poses[-1])[:2], pose_of(whole[-1])[:2]):.6f} m')
    assert math.dist(pose_of(poses[-1])[:2], pose_of(whole[-1])[:2]) < bound


def resident_kb(process):
    """Return the resident memory of a process."""
    status = Path(f'/proc/{process.pid}/status').read_text()
    return int(next(line for line in status.splitlines() if 'VmRSS' in line).split()[1])


def test_a_flood_of_commands_leaves_nothing_behind_and_the_newest_one_wins(graph):
    controller = graph.start('diff_drive_controller', {**KHEPERA, **HELD})
    rates = graph.collect(JointState, 'wheel_rates')
    commands = graph.publisher(Twist, 'cmd_vel')
    asked = iter(range(1, 10**6))

    def answered():
        """Return how long [s] a command takes to become wheel rates."""
        rate = float(next(asked))
        began = time.monotonic()
        commands.publish(twist(0.021 * rate, 0.0))
        graph.wait_for(
            lambda: rates and rates[-1].velocity[0] == pytest.approx(rate, rel=1e-9), 'an answer')
        return time.monotonic() - began

    def flood(seconds=3.0, rate=5000):
        """Send many commands, and be left with the last of them."""
        began, sent = time.monotonic(), 0

        def enough():
            nonlocal sent
            due = round((time.monotonic() - began) * rate)
            for _ in range(min(due - sent, 500)):
                commands.publish(twist(-0.021 * (1 + sent % 7), 0.0))
                sent += 1
            return sent >= seconds * rate

        graph.wait_for(enough, 'the flood')
        answered()
        heard = len(rates)
        graph.wait_for(lambda: len(rates) > heard + 25, 'repeats')
        assert len({tuple(message.velocity) for message in rates[heard:]}) == 1

    flood(1.0)
    before = [answered() for _ in range(20)]
    memory = resident_kb(controller)
    flood()
    after = [answered() for _ in range(20)]
    grown = resident_kb(controller) - memory
    print(f'latency {statistics.median(before) * 1e3:.2f} ms before, '
          f'{statistics.median(after) * 1e3:.2f} ms after; memory grew by {grown} kB')
    assert grown < 2048
    assert statistics.median(after) < 10.0 * statistics.median(before)


@pytest.mark.parametrize('step_ns', [-HOUR_NS, HOUR_NS])
def test_stamps_that_are_an_hour_off_from_now_on_move_nothing_and_stall_nothing(graph, step_ns):
    shift = {'ns': 0}

    def link(message):
        set_stamp(message, stamp_ns(message) + shift['ns'])
        return [message]

    graph.start('diff_drive_controller', {**KHEPERA, **HELD})
    base = graph.start('simulated_base', {**BASE, 'command_timeout': TIMEOUT_S})
    Relay(graph, link)
    odometry = graph.collect(Odometry, 'odom')
    graph.wait_for(lambda: odometry, 'odometry')
    graph.publisher(Twist, 'cmd_vel').publish(twist(SPEED, 0.0))
    graph.wait_for(lambda: odometry[-1].pose.pose.position.x > 0.1, 'the robot to drive')
    shift['ns'] = step_ns
    graph.wait_for(lambda: 'clock step' in base.output, 'a report')
    passed = odometry[-1].pose.pose.position.x
    graph.wait_for(
        lambda: odometry[-1].pose.pose.position.x > passed + 0.3, 'the robot to go on')
    for a, b in zip(odometry, odometry[1:]):
        seconds = (stamp_ns(b) - stamp_ns(a)) / 1e9
        way = b.pose.pose.position.x - a.pose.pose.position.x
        assert abs(way) < SPEED * (seconds + TIMEOUT_S + 1.0)
    assert base.output.count('clock step in the stamps') == 1


@pytest.mark.parametrize('step_ns', [-HOUR_NS, HOUR_NS])
def test_a_simulated_clock_that_jumps_by_an_hour_moves_nothing_and_stalls_nothing(graph, step_ns):
    simulated = {**KHEPERA, 'use_sim_time': True}
    graph.start('diff_drive_controller', simulated)
    graph.start('wheel_noise', {'wheel_radius': 0.021, 'use_sim_time': True})
    graph.start('simulated_base', {
        **simulated, 'enable_odom_tf': False, 'wheel_motion_topic': 'noisy_wheel_rates'})
    odometry = graph.collect(Odometry, 'odom')
    clock = graph.node.create_publisher(Clock, '/clock', 1)
    commands = graph.publisher(Twist, 'cmd_vel')
    now = 2 * HOUR_NS

    def past(x):
        nonlocal now
        now += 20_000_000
        clock.publish(Clock(clock=time_of(now)))
        commands.publish(twist(SPEED, 0.0))
        return odometry and odometry[-1].pose.pose.position.x > x

    graph.wait_for(lambda: past(0.1), 'the robot to drive')
    passed = odometry[-1].pose.pose.position.x
    now += step_ns
    graph.wait_for(lambda: past(passed + 0.2), 'the robot to go on')
    xs = [message.pose.pose.position.x for message in odometry]
    assert max(abs(b - a) for a, b in zip(xs, xs[1:])) < SPEED * 1.0


def test_a_simulated_clock_that_shows_what_is_no_time_ends_no_node_and_they_go_on(graph):
    odometry = graph.collect(Odometry, 'odom')
    nodes = {
        'diff_drive_controller': KHEPERA, 'wheel_noise': {'wheel_radius': 0.021},
        'simulated_base': {**KHEPERA, 'enable_odom_tf': False, 'path_topic': 'path'},
        'forward_projection': KHEPERA, 'command_sequence': {'commands': [SPEED, 0.0, 1000.0]}}
    processes = [graph.start(name, {**parameters, 'use_sim_time': True})
                 for name, parameters in nodes.items()]
    clock = graph.publisher(Clock, '/clock', listeners=len(nodes))
    steps, no_times = count(), cycle(NO_TIMES)

    def past(x):
        clock.publish(Clock(clock=time_of(10**12 + next(steps) * 20_000_000)))
        return odometry and odometry[-1].pose.pose.position.x > x

    def refused():
        clock.publish(Clock(clock=next(no_times)))  # of those that come at once one is heard
        return all(process.output.count("refused message on '/clock': ") > 1
                   for process in processes)

    graph.wait_for(lambda: past(0.1), 'the robot to drive')
    passed = odometry[-1].pose.pose.position.x
    graph.wait_for(refused, 'the refusals')
    graph.wait_for(lambda: past(passed + 0.1), 'the robot to go on')
    for process in processes:
        assert process.running
        assert 'clock was stepped' not in process.output


@pytest.mark.parametrize('use_sim_time', [False, True])
def test_a_robot_whose_controller_ends_at_speed_stands_from_its_last_word_on(graph, use_sim_time):
    """However often it is said; simulated time stands still since the command came."""
    settings = {**KHEPERA, 'use_sim_time': use_sim_time}
    base = graph.start('simulated_base', {
        **settings, 'enable_odom_tf': False, 'command_timeout': 9.0})
    controller = graph.start('diff_drive_controller', {**settings, **HELD})
    odometry, rates = graph.collect(Odometry, 'odom'), graph.collect(JointState, 'wheel_rates')
    commands = graph.publisher(Twist, 'cmd_vel')
    clock = graph.node.create_publisher(Clock, '/clock', 1)
    now = HOUR_NS

    def on(condition):
        nonlocal now
        now += 20_000_000
        clock.publish(Clock(clock=time_of(now)))
        return condition()

    graph.wait_for(lambda: on(lambda: odometry), 'odometry')
    commands.publish(twist(SPEED, 0.0))
    graph.wait_for(lambda: rates and rates[-1].velocity[0] > 0.0, 'the robot to drive')
    assert controller.stop() == 0
    graph.wait_for(lambda: rates[-1].velocity[0] == 0.0, 'the last word')
    last = stamp_ns(rates[-1])
    graph.wait_for(
        lambda: on(lambda: stamp_ns(odometry[-1]) > last + 500_000_000), 'odometry after it')
    driving = max(n for n, message in enumerate(rates) if message.velocity[0] > 0.0)
    assert len({tuple(message.position) for message in rates[driving + 1:]}) == 1
    rolled = rates[-1].position[0] * KHEPERA['wheel_radius']
    assert odometry[-1].pose.pose.position.x == pytest.approx(rolled, abs=1e-9)
    assert 'out of order' not in base.output
