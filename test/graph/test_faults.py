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

from itertools import cycle
import math
from pathlib import Path
import random
import statistics
import time

from builtin_interfaces.msg import Time
from diffdrive_kinematics.core.kinematics import advance, Pose, WheelGeometry
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
import pytest
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState
from support.graph import (
    assert_pose, KHEPERA, pose_of, set_stamp, SimulatedTime, stamp_ns, twist, x_of)
from support.relay import composed, merging_error, Relay
from support.stepped import messages, nodes

GEOMETRY = WheelGeometry(KHEPERA['wheel_separation'], KHEPERA['wheel_radius'])
TIMEOUT_S = 0.4
HELD = {'cmd_vel_timeout': 0.0}
RELAYED = {'wheel_motion_topic': 'relayed'}
HOUR_NS = 3600 * 10**9
SPEED = 0.2  # [m/s]
NO_TIMES = [Time(sec=sec, nanosec=nanosec) for sec, nanosec in (
    (-1, 0), (-2**31, 5), (2**31 - 1, 0), (100, 10**9), (2**31 - 1, 2**32 - 1))]


def is_still(message):
    return message.twist.twist.linear.x == message.twist.twist.angular.z == 0.0


def assert_even(odometry, speed, within=1e-9):
    """Straight on at one speed, x tells nothing but the time."""
    moving = [message for message in odometry if not is_still(message)]
    starts = [message.pose.pose.position.x
              - speed * (stamp_ns(message) - stamp_ns(moving[0])) / 1e9 for message in moving]
    assert len(starts) > 20
    assert max(abs(start - starts[0]) for start in starts) < within


@pytest.mark.ros
def test_a_base_whose_controller_was_killed_at_speed_stops_exactly_after_the_timeout(diffdrive):
    robot = diffdrive(nodes('diff_drive_controller', 'simulated_base'), params={
        **KHEPERA, **HELD, 'command_timeout': TIMEOUT_S})
    robot.publish('cmd_vel', twist(SPEED, 0.7))
    robot.advance(1.0)
    robot.kill('diff_drive_controller')
    robot.advance(1.0)
    rates = [message for message in messages(robot, 'wheel_rates') if any(message.velocity)]
    seconds = (stamp_ns(rates[-1]) - stamp_ns(rates[0])) / 1e9 + TIMEOUT_S
    assert is_still(messages(robot, 'odom')[-1])
    assert_pose(pose_of(messages(robot, 'odom')[-1]), advance(
        Pose(0.0, 0.0, 0.0), SPEED * seconds, 0.7 * seconds))


@pytest.mark.ros
def test_a_base_that_was_killed_begins_anew_and_the_others_live_on(diffdrive):
    robot = diffdrive(
        nodes('diff_drive_controller', 'simulated_base', 'simulated_base:other',
              other={'odom_topic': 'other', 'joint_states_topic': ''}),
        params={**KHEPERA, **HELD, 'command_timeout': 0.0})
    robot.publish('cmd_vel', twist(SPEED, 0.0))
    robot.advance(1.0)
    robot.kill('simulated_base')
    robot.advance(0.5)
    before = messages(robot, 'odom')
    robot.restart('simulated_base')
    robot.advance(1.0)
    after, other = messages(robot, 'odom')[len(before):], messages(robot, 'other')
    for drive in (before, after, other):
        assert_even(drive, SPEED)
    lived = next(message for message in other if stamp_ns(message) >= stamp_ns(after[0]))
    assert 0.0 <= after[0].pose.pose.position.x
    assert after[0].pose.pose.position.x < lived.pose.pose.position.x - 0.1  # from 0, not from it


@pytest.mark.ros
def test_a_noise_node_that_was_killed_and_comes_back_costs_the_truth_nothing(diffdrive):
    robot = diffdrive(params={**KHEPERA, **HELD, 'command_timeout': 0.0})
    robot.publish('cmd_vel', twist(SPEED, 0.0))
    robot.advance(1.0)
    robot.kill('wheel_noise')
    robot.advance(0.6)
    heard = len(robot.history('noisy_wheel_rates'))
    robot.restart('wheel_noise')
    robot.advance(1.0)
    assert len(robot.history('noisy_wheel_rates')) >= heard + 50
    assert_even(messages(robot, 'ground_truth'), SPEED)
    assert robot.truth.x == pytest.approx(robot.odom.x, abs=1e-9)


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


@pytest.mark.ros
@pytest.mark.parametrize('make_link', [dropping, shuffling])
def test_messages_that_are_lost_late_or_doubled_cost_no_angle_and_only_their_own_arc(
        diffdrive, make_link):
    robot = diffdrive(nodes(
        'diff_drive_controller', 'simulated_base', 'simulated_base:whole', simulated_base=RELAYED,
        whole={'odom_topic': 'whole_odom', 'joint_states_topic': 'whole_joints'}),
        params={**KHEPERA, **HELD}, clock_step=0.01)
    relay = Relay(robot, make_link())
    generator = random.Random(3)
    for number in range(24):
        v, w = generator.uniform(-0.2, 0.2), generator.uniform(-2.0, 2.0)
        robot.publish('cmd_vel', twist(v, w) if number < 23 else twist(0.0, 0.0))
        # every other command between two repeats of the rates, which come every 0.02 s
        relay.advance(2.03 if number % 8 == 0 else 0.21, every=0.07)
    relay.advance(0.49, every=0.07)
    pose, whole = messages(robot, 'odom')[-1], messages(robot, 'whole_odom')[-1]
    joints, wheels = messages(robot, 'joint_states')[-1], messages(robot, 'whole_joints')[-1]
    assert is_still(pose) and is_still(whole) and not any([*joints.velocity, *wheels.velocity])
    first = next(number for number, message in enumerate(relay.came) if message.position)
    came = relay.came[max(0, first - 1):]
    assert_pose(pose_of(whole), composed(GEOMETRY, came))
    assert list(joints.position) == pytest.approx(list(wheels.position), abs=1e-12)
    heading, expected = pose_of(pose).theta, pose_of(whole).theta
    assert abs(math.remainder(heading - expected, math.tau)) < 1e-12
    bound = merging_error(GEOMETRY, came, relay.went)
    assert 0.0 < bound < 0.05
    assert 0.0 < math.dist(pose_of(pose)[:2], pose_of(whole)[:2]) < bound


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
    before = statistics.median(answered() for _ in range(20))
    memory = resident_kb(controller)
    flood()
    graph.wait_for(lambda: statistics.median(answered() for _ in range(20)) < 10.0 * before,
                   'answers as soon as before')
    assert resident_kb(controller) - memory < 2048


@pytest.mark.ros
@pytest.mark.parametrize('step_ns', [-HOUR_NS, HOUR_NS])
def test_stamps_that_are_an_hour_off_from_now_on_move_nothing_and_stall_nothing(
        diffdrive, capfd, step_ns):
    shift = {'ns': 0}

    def link(message):
        set_stamp(message, stamp_ns(message) + shift['ns'])
        return [message]

    robot = diffdrive(nodes('diff_drive_controller', 'simulated_base', simulated_base=RELAYED),
                      params={**KHEPERA, **HELD, 'command_timeout': TIMEOUT_S})
    robot.step_clock(2.0 * HOUR_NS / 1e9)
    relay = Relay(robot, link)
    robot.publish('cmd_vel', twist(SPEED, 0.0))
    relay.advance(1.0, every=0.1)
    passed = robot.odom.x
    assert passed > 0.1
    shift['ns'] = step_ns
    relay.advance(3.0, every=0.1)
    assert robot.odom.x > passed + 0.3
    odometry = messages(robot, 'odom')
    for a, b in zip(odometry, odometry[1:]):
        seconds = (stamp_ns(b) - stamp_ns(a)) / 1e9
        way = b.pose.pose.position.x - a.pose.pose.position.x
        assert abs(way) < SPEED * (seconds + TIMEOUT_S + 1.0)
    assert capfd.readouterr().err.count('clock step in the stamps') == 1


@pytest.mark.parametrize('step_ns', [-HOUR_NS, HOUR_NS])
def test_a_simulated_clock_that_jumps_by_an_hour_moves_nothing_and_stalls_nothing(graph, step_ns):
    simulated = {**KHEPERA, 'use_sim_time': True}
    graph.start('diff_drive_controller', simulated)
    graph.start('wheel_noise', {'wheel_radius': 0.021, 'use_sim_time': True})
    graph.start('simulated_base', {
        **simulated, 'enable_odom_tf': False, 'wheel_motion_topic': 'noisy_wheel_rates'})
    places = []  # (x, time that has gone on until the message came)
    graph.collect(Odometry, 'odom', lambda message: places.append(
        (message.pose.pose.position.x, (clock.now_ns - began_ns) / 1e9)))
    commands = graph.publisher(Twist, 'cmd_vel')
    began_ns, clock = 2 * HOUR_NS, SimulatedTime(graph, 2 * HOUR_NS, 20_000_000)

    def past(x):
        commands.publish(twist(SPEED, 0.0))
        return places and places[-1][0] > x

    clock.wait_for(lambda: past(0.1), 'the robot to drive')
    began_ns, clock.now_ns, passed = began_ns + step_ns, clock.now_ns + step_ns, places[-1][0]
    clock.wait_for(lambda: past(passed + 0.2), 'the robot to go on')
    furthest = 0.0
    for x, seconds in places:
        furthest = max(furthest, x)
        assert furthest - SPEED * 1.0 < x < SPEED * (seconds + 1.0)


def test_a_simulated_clock_that_shows_what_is_no_time_ends_no_node_and_they_go_on(graph):
    odometry = graph.collect(Odometry, 'odom')
    nodes = {
        'diff_drive_controller': KHEPERA, 'wheel_noise': {'wheel_radius': 0.021},
        'simulated_base': {**KHEPERA, 'enable_odom_tf': False, 'path_topic': 'path'},
        'forward_projection': KHEPERA, 'command_sequence': {'commands': [SPEED, 0.0, 1000.0]}}
    processes = [graph.start(name, {**parameters, 'use_sim_time': True})
                 for name, parameters in nodes.items()]
    nonsense, no_times = graph.publisher(Clock, '/clock', listeners=len(nodes)), cycle(NO_TIMES)
    clock = SimulatedTime(graph, 10**12, 20_000_000)

    def refused():
        nonsense.publish(Clock(clock=next(no_times)))  # of those that come at once one is heard
        return all(process.output.count("refused message on '/clock': ") > 1
                   for process in processes)

    clock.wait_for(lambda: odometry and x_of(odometry) > 0.1, 'the robot to drive')
    passed = x_of(odometry)
    graph.wait_for(refused, 'the refusals')
    clock.wait_for(lambda: x_of(odometry) > passed + 0.1, 'the robot to go on')
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
    clock = SimulatedTime(graph, step_ns=20_000_000)
    clock.wait_for(lambda: commands.publish(twist(SPEED, 0.0)) or (
        rates and odometry and x_of(odometry) > 0.0), 'the base to hear the controller')
    commands.publish(twist(0.0, 0.0))
    graph.wait_for_rest(
        [rates], [odometry], clock.now_ns if use_sim_time else None, clock.wait_for)
    began, position = x_of(odometry), rates[-1].position[0]
    commands.publish(twist(SPEED, 0.0))
    graph.wait_for(lambda: rates[-1].velocity[0] > 0.0, 'the robot to drive')
    assert controller.stop() == 0
    graph.wait_for(lambda: rates[-1].velocity[0] == 0.0, 'the last word')
    last = stamp_ns(rates[-1])
    clock.wait_for(lambda: stamp_ns(odometry[-1]) > last + 500_000_000, 'odometry after it')
    driving = max(n for n, message in enumerate(rates) if message.velocity[0] > 0.0)
    assert len({tuple(message.position) for message in rates[driving + 1:]}) == 1
    rolled = (rates[-1].position[0] - position) * KHEPERA['wheel_radius']
    assert x_of(odometry) - began == pytest.approx(rolled, abs=1e-9)
    assert 'out of order' not in base.output
