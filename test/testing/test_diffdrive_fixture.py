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

"""The fixture ``diffdrive``, which users of the package test their nodes with."""

import fcntl
import math
import os
from pathlib import Path
import re
import subprocess
import sys

from diffdrive_kinematics.testing import stepping
from diffdrive_kinematics.testing.guardian import delete_shared_memory, shared_memory_of
from diffdrive_kinematics.testing.processes import ProcessFailed
from geometry_msgs.msg import PoseStamped, Twist
import pytest
from std_srvs.srv import Empty, Trigger
from support.graph import twist
from support.planners import NOISE, ROBOT
from support.stepped import nodes, tell_wheels

pytestmark = pytest.mark.ros


@pytest.mark.slow
def test_the_example_of_the_tutorial_passes_as_it_is_written(files):
    run = subprocess.run(
        [sys.executable, '-m', 'pytest', '-q', '-p', 'diffdrive_kinematics.testing.plugin',
         'test_my_planner.py'], cwd=files, capture_output=True, text=True)
    assert run.returncode == 0, run.stdout + run.stderr
    assert '1 passed' in run.stdout


def test_without_noise_belief_and_truth_are_one(diffdrive):
    robot = diffdrive(params=ROBOT)
    robot.drive(0.2, 0.0, 1.0)
    robot.drive(0.2, 0.5, 1.0)
    assert robot.odom == pytest.approx(robot.truth, abs=1e-12)
    assert robot.time == 2.0 and robot.odom.speed == pytest.approx(0.2)
    assert robot.odom.distance_to(0.0, 0.0) == pytest.approx(0.39, abs=0.01)
    assert [each.time for each in robot.history('odom')][-3:] == [1.96, 1.98, 2.0]
    robot.advance_until(lambda: robot.odom.speed == 0.0, timeout=1.0)
    assert len(robot.history('cmd_vel')) == 100


def test_noise_parts_belief_and_truth_the_same_way_in_every_run(diffdrive):
    robot = diffdrive(params=ROBOT, noise=NOISE)
    robot.drive(0.2, 0.1, 3.0)
    assert 0.001 < robot.truth.distance_to(*robot.odom[:2]) < 0.1


def test_a_share_of_the_messages_is_lost(diffdrive):
    robot = diffdrive(params=ROBOT)
    robot.drop('cmd_vel', 1.0)
    robot.drive(0.2, 0.0, 0.5)
    assert robot.odom.speed == 0.0
    robot.drop('cmd_vel', 0.5)
    robot.drive(0.2, 0.0, 0.5)
    assert robot.odom.speed == pytest.approx(0.2)


def test_messages_come_late(diffdrive):
    robot = diffdrive(params=ROBOT)
    robot.delay('cmd_vel', 0.2)
    robot.drive(0.2, 0.0, 0.18)
    assert robot.odom.speed == 0.0
    robot.drive(0.2, 0.0, 0.1)
    assert robot.odom.speed == pytest.approx(0.2)


def test_a_node_that_is_killed_is_gone_and_comes_back_where_it_starts(diffdrive):
    robot = diffdrive(params=ROBOT)
    robot.drive(0.2, 0.0, 0.5)
    robot.kill('simulated_base')
    count = len(robot.history('odom'))
    robot.drive(0.2, 0.0, 0.5)
    assert len(robot.history('odom')) == count
    robot.restart('simulated_base')
    robot.drive(0.2, 0.0, 0.5)
    assert robot.odom.x == pytest.approx(robot.truth.x - 0.2, abs=0.01)
    with pytest.raises(LookupError, match="the node is 'nobody'"):
        robot.kill('nobody')


def test_the_clock_steps_and_the_robot_goes_on(diffdrive):
    robot = diffdrive(params=ROBOT)
    robot.drive(0.2, 0.0, 1.0)
    robot.step_clock(-0.5)
    assert robot.time == 0.5
    robot.drive(0.2, 0.0, 1.0)
    assert robot.odom.speed == pytest.approx(0.2) and robot.time == 1.5


def test_times_that_cannot_be_are_refused_by_name_before_anything_moves(diffdrive):
    robot = diffdrive(params=ROBOT)
    robot.delay('cmd_vel', 0.1)
    robot.drive(0.2, 0.0, 0.06)
    for wrong in (0, 0.0, -0.1, math.nan, math.inf, 0.001):
        for move in (lambda **options: robot.advance(0.1, **options),
                     lambda **options: robot.advance_until(lambda: True, timeout=1.0, **options)):
            with pytest.raises(ValueError, match=f'^period is {wrong!r}, expected'):
                move(period=wrong)
        for move in (robot.advance, lambda seconds: robot.drive(0.2, 0.0, seconds)):
            with pytest.raises(ValueError, match=f'^seconds is {wrong!r}, expected'):
                move(wrong)
    for wrong in (-5.0, -0.060000001, math.nan, math.inf, -math.inf, 2.0 ** 31, 1e300):
        with pytest.raises(
                ValueError, match=f'^seconds is {re.escape(repr(wrong))}, expected .* at 0.06 s'):
            robot.step_clock(wrong)
    assert robot.time == 0.06
    robot.drive(0.2, 0.0, 0.1)  # timers go on, and what is late comes when it would have
    assert [each.time for each in robot.history('odom')] == [
        pytest.approx(0.02 * number) for number in range(1, 9)]
    assert robot.odom.speed > 0.0
    robot.step_clock(-robot.time)
    assert robot.time == 0.0


@pytest.mark.parametrize('config', ['file', 'mapping'])
def test_a_params_file_composes_the_nodes(diffdrive, tmp_path, config):
    sections = {'/**': {'ros__parameters': {**ROBOT, 'clock_step': 0.05}}, '/**/diffdrive_sim': {
        'ros__parameters': {'nodes': ['diff_drive_controller', 'simulated_base:belief']}}}
    if config == 'file':
        import yaml
        path = tmp_path / 'robot.yaml'
        path.write_text(yaml.safe_dump(sections))
        sections = path
    robot = diffdrive(sections, params={'cmd_vel_timeout': 0.2})
    robot.drive(0.1, 0.0, 1.0)
    assert robot.time == pytest.approx(1.0) and robot.odom == robot.truth
    robot.advance(0.3)
    assert robot.odom.speed == 0.0


def test_two_sections_may_share_a_list(diffdrive):
    wheels = {'left_wheel_names': ['fl', 'rl'], 'right_wheel_names': ['fr', 'rr']}
    robot = diffdrive({
        '/**': {'nodes': ['diff_drive_controller', 'simulated_base']},
        '/**/diff_drive_controller': wheels, '/**/simulated_base': wheels}, params=ROBOT)
    robot.drive(0.1, 0.0, 0.5)
    assert robot.odom.speed == pytest.approx(0.1)


def test_a_robot_without_a_base_says_what_did_not_come(diffdrive):
    robot = diffdrive({'/**': {'nodes': ['diff_drive_controller']}}, params=ROBOT)
    with pytest.raises(AssertionError, match='not within 0.1 simulated seconds'):
        robot.advance_until(lambda: False, timeout=0.1)


@pytest.mark.slow
def test_a_process_that_dies_is_reported_by_name_with_its_output(diffdrive, files):
    path = files / 'dies.py'
    path.write_text((files / 'my_planner.py').read_text().replace(
        '        command = Twist()', "        raise RuntimeError('no plan')"))
    robot = diffdrive(params=ROBOT)
    with pytest.raises(ProcessFailed, match=r'dies.py[\s\S]*no plan'):
        robot.start_process([sys.executable, path])
        robot.advance(5.0, wait_for='cmd_vel')
    robot.drive(0.2, 0.0, 1.0)  # it is told once: what the robot does then can be tested
    assert robot.odom.x > 0.1


@pytest.mark.slow
def test_no_step_is_missed_where_another_process_dies(diffdrive, files):
    path = files / 'dies_later.py'
    path.write_text((files / 'my_planner.py').read_text().replace("'cmd_vel'", "'other'").replace(
        '        command = Twist()', '        command = Twist()\n'
        '        if self.get_clock().now().nanoseconds > 500_000_000:\n'
        "            raise RuntimeError('no plan')"))
    robot = diffdrive(params=ROBOT)
    robot.start_process([sys.executable, files / 'my_planner.py'])
    robot.start_process([sys.executable, path])
    with pytest.raises(ProcessFailed, match=r'dies_later.py[\s\S]*no plan'):
        robot.advance(2.0)
    robot.advance(0.5)
    steps = [round(each.time / 0.02) for each in robot.history('cmd_vel')]
    assert steps[-1] > 40 and steps == [*range(steps[0], steps[-1] + 1)]


@pytest.mark.slow
def test_a_process_that_hangs_is_reported_by_name_with_its_output(
        diffdrive, files, monkeypatch):
    path = files / 'hangs.py'
    path.write_text((files / 'in_lockstep.py').read_text().replace(
        '        command = Twist()', "        print('thinking')\n        while True: pass"))
    robot = diffdrive(params=ROBOT)
    process = robot.start_process([sys.executable, path], lockstep=True)
    monkeypatch.setattr(stepping, 'DEADLINE_S', 5.0)  # what starts on a busy machine has longer
    with pytest.raises(ProcessFailed, match=r'my_planner did not acknowledge[\s\S]*thinking'):
        robot.advance(1.0)
    assert process.running


@pytest.mark.slow
def test_every_process_ends_with_the_test_even_one_that_ignores_it(diffdrive, files):
    path = files / 'stubborn.py'
    path.write_text('import signal\nfor number in (signal.SIGINT, signal.SIGTERM):\n'
                    '    signal.signal(number, signal.SIG_IGN)\n'
                    + (files / 'my_planner.py').read_text().replace(
                        'rclpy.init()', 'rclpy.init(signal_handler_options='
                        'rclpy.signals.SignalHandlerOptions.NO)'))
    robot = diffdrive(params=ROBOT)
    process = robot.start_process([sys.executable, path])
    assert not shared_memory_of(process.pid)  # which one that is killed leaves behind
    robot.close()
    assert not process.running


def test_shared_memory_whose_name_another_process_has_by_now_stays():
    """Numbers of ports are given out again, on all of the machine, once a process has ended."""
    theirs, nobodys = (f'/dev/shm/fastrtps_port{kind}{os.getpid()}' for kind in (1, 2))
    files = {name: [Path(name), Path(name.replace('shm/', 'shm/sem.') + '_mutex'),
                    Path(f'{name}_el')] for name in (theirs, nobodys)}
    for each in files[theirs] + files[nobodys]:
        each.touch()
    try:
        with files[theirs][-1].open() as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            assert shared_memory_of(os.getpid()) >= {theirs}
            delete_shared_memory(theirs)
            delete_shared_memory(nobodys)
            assert [each for each in files[theirs] + files[nobodys] if each.exists()] \
                == files[theirs]
    finally:
        for each in files[theirs]:
            each.unlink()


def test_robots_of_one_test_do_not_hear_each_other(diffdrive):
    one, other = diffdrive(params=ROBOT), diffdrive(params=ROBOT)
    assert one.domain != other.domain
    one.drive(0.2, 0.0, 0.5)
    other.advance(0.5)
    assert one.odom.x > 0.05 and other.odom.x == 0.0


def test_what_nobody_listens_to_is_said(diffdrive, monkeypatch):
    from diffdrive_kinematics.testing import topics as module
    monkeypatch.setattr(module, 'HEARD_S', 0.3)
    robot = diffdrive(params=ROBOT)
    with pytest.raises(AssertionError, match="who listens to 'goal_pose'"):
        robot.publish('goal_pose', PoseStamped())
    with pytest.raises(KeyError, match='scan'):
        robot.history('scan')


@pytest.mark.slow
def test_what_a_process_says_is_kept_also_where_the_test_or_the_robot_says_something(
        diffdrive, files):
    robot = diffdrive(params=ROBOT)
    robot.drive(0.3, 0.0, 0.1)  # from here on the test publishes cmd_vel, too
    robot.start_process([sys.executable, files / 'in_lockstep.py'], lockstep=True)
    robot.advance(0.2, wait_for='cmd_vel')  # it may say something as it starts
    begun = len(robot.history('cmd_vel'))
    for _ in range(5):
        robot.publish('cmd_vel', twist(0.3, 0.0))
        robot.advance(0.2, wait_for='cmd_vel')
    said = [each.message.linear.x for each in robot.history('cmd_vel')][begun:]
    assert said.count(0.3) == 5 and said.count(0.0) == 50 and len(said) == 55


def test_a_service_of_a_node_is_called(diffdrive):
    robot = diffdrive(params=ROBOT)
    robot.drive(0.2, 0.0, 0.5)
    assert robot.call(Trigger, 'simulated_base/reset', Trigger.Request()).success
    robot.advance(0.1)
    assert robot.odom.x < 0.05 < robot.truth.x


def test_a_topic_of_others_is_kept_when_it_is_listened_to(diffdrive):
    robot = diffdrive(params=ROBOT)
    robot.listen(Twist, 'plan')
    robot.publish('plan', Twist())
    assert [each.time for each in robot.history('plan')] == [0.0]


@pytest.mark.parametrize('wrong', [math.nan, math.inf, -math.inf, -1.0, '1.0', None, True])
def test_arguments_that_are_no_numbers_or_below_the_least_are_refused_before_anything_moves(
        diffdrive, wrong):
    robot = diffdrive(params=ROBOT)
    for call, name in [
            (lambda: robot.advance(wrong), 'seconds'),
            (lambda: robot.drive(0.1, 0.0, wrong), 'seconds'),
            (lambda: robot.step_clock(wrong), 'seconds'),
            (lambda: robot.delay('cmd_vel', wrong), 'seconds'),
            (lambda: robot.drop('cmd_vel', wrong), 'share'),
            (lambda: robot.advance_until(lambda: True, timeout=wrong), 'timeout'),
            (lambda: diffdrive({'/**': {'clock_step': wrong or 'none'}}), 'clock_step')]:
        word = re.escape(repr(wrong or 'none' if name == 'clock_step' else wrong))
        with pytest.raises(ValueError, match=f'^{name} is {word}, expected .'):
            call()
    assert robot.time == 0.0 and not robot.history('cmd_vel')


def test_what_a_test_says_wrongly_is_refused_at_once_by_name_value_and_rule(diffdrive):
    robot = diffdrive(nodes('diff_drive_controller', 'simulated_base'), params=ROBOT)
    pose, trigger = PoseStamped(), Trigger.Request()
    for call, words in [
            (lambda: robot.publish('cmd_vel', pose),
             "type of message is .*Stamped'>, expected geometry_msgs/msg/Twist, which '/cmd_vel"),
            (lambda: robot.publish('cmd_vel', Twist), 'type of message is <class .*, exp'),
            (lambda: robot.publish('goal_pose', 'here'), "type of message is <class 'str'>, exp"),
            (lambda: robot.publish(5, pose), 'topic is 5, expected a name'),
            (lambda: robot.listen(PoseStamped, 'odom'),
             "message_type is .* expected nav_msgs/msg/Odometry, which '/odom' has"),
            (lambda: robot.listen('Twist', 'plan'), "message_type is 'Twist', expected a type"),
            (lambda: robot.history(None), 'topic is None, expected a name'),
            (lambda: robot.drop('cmd_vel', 1.5), 'share is 1.5, expected from 0 to 1'),
            (lambda: diffdrive(clock_step=2e9), 'clock_step is 2000000000.0, expected from'),
            (lambda: robot.drop('cmd_vel', 0.5, seed=None), 'seed is None, expected an integer'),
            (lambda: robot.call(Empty, 'simulated_base/reset', Empty.Request()),
             "service_type is .*, expected std_srvs/srv/Trigger, which 'simulated_base/reset'"),
            (lambda: robot.call(Trigger, 'simulated_base/reset', Trigger), 'request is .*Request'),
            (lambda: robot.call(Trigger, None, trigger), 'name is None, expected a name'),
            (lambda: robot.drive('fast', 0.0, 1.0), "v is 'fast', expected a number"),
            (lambda: robot.advance(1.0, wait_for='plan'),
             "wait_for is 'plan', expected a topic to which the robot listens"),
            (lambda: robot.advance_until(robot.odom.speed == 0.0, timeout=1.0),
             'condition is True, expected a function'),
            (lambda: robot.start_process('my_planner.py'),
             "command is 'my_planner.py', expected a list of words"),
            (lambda: robot.start_process([]), r'command is \[\], expected a list of words'),
            (lambda: diffdrive(5), 'config is 5, expected a file'),
            (lambda: diffdrive({'/**': 'fast'}), 'config is .*fast.*, expected'),
            (lambda: diffdrive(params=['wheel_radius']), r"params is \['wheel_radius'\], exp")]:
        with pytest.raises(ValueError, match=f'^{words}'):
            call()
    for call, words in [
            (lambda: robot.drop('cmd_vell', 1.0), "'/cmd_vell' is not kept, expected one of"),
            (lambda: robot.delay('cmd_vell', 0.1), "'/cmd_vell' is not kept, expected one of"),
            (lambda: robot.restart('nobody'), "the node is 'nobody', expected one of"),
            (lambda: robot.kill(None), 'the node is None, expected one of')]:
        with pytest.raises(LookupError, match=words):
            call()
    assert robot.time == 0.0
    robot.publish('cmd_vel', twist(0.2, 0.0))
    robot.kill('diff_drive_controller')
    with pytest.raises(LookupError, match='no diff_drive_controller is alive, expected one'):
        robot.drive(0.1, 0.0, 1.0)


def test_a_sequence_that_waits_says_for_what_and_begins_once_it_is_there(diffdrive, capfd):
    robot = diffdrive(
        nodes('command_sequence', 'simulated_base', command_sequence={
            'commands': [0.2, 0.0, 1.0], 'wait_for_topics': ['odom']}), params=ROBOT)
    with pytest.raises(AssertionError, match='command_sequence says: waiting for /odom\n'
                       "simulated_base says: no messages on '/wheel_rates' yet"):
        robot.advance_until(lambda: robot.odom.speed > 0.0, timeout=1.0)
    assert 'waiting' not in capfd.readouterr().err
    robot.advance(4.1)
    assert capfd.readouterr().err.count('waiting for /odom') == 1
    tell_wheels(robot, velocity=[0.0, 0.0])
    with pytest.raises(AssertionError, match='says: waiting for a subscriber of /cmd_vel'):
        robot.advance_until(lambda: robot.odom.speed > 0.0, timeout=1.0)
    robot.listen(Twist, 'cmd_vel')
    robot.advance(0.1)
    assert robot.history('cmd_vel')[-1].message.linear.x == 0.2
