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

"""A robot and processes under test in lockstep: what is the same in every run, and what is not."""

from concurrent.futures import ProcessPoolExecutor
from itertools import cycle
import multiprocessing
import os
import signal
import subprocess
import sys
from types import SimpleNamespace
from unittest.mock import ANY

from diffdrive_kinematics.testing import arrival, stepping
from diffdrive_kinematics.testing.at_rest import can_tell, Rest, Threads
from diffdrive_kinematics.testing.processes import ProcessFailed, sleepless
from geometry_msgs.msg import PoseStamped
import pytest
from support.closed_loop import BUSY, driven, other_work, STEP_S
from support.planners import ROBOT

pytestmark = [pytest.mark.ros, pytest.mark.skipif(
    not can_tell(), reason='this system does not tell what threads do')]

AT_A_TIME = 2
HANGS_S = 5.0  # after which a process that is there counts as one that hangs
WAITS = {'wait_for': 'cmd_vel'}


@pytest.mark.slow
@pytest.mark.timeout(900)
def test_a_node_that_knows_nothing_of_us_does_the_same_in_twenty_runs(files):
    """Four of them on a busy machine; some at a time, as most of a run is its start."""
    planner = files / 'my_planner.py'
    with ProcessPoolExecutor(AT_A_TIME, multiprocessing.get_context('spawn')) as pool:
        runs = [*pool.map(driven, [planner] * 16)]
        with other_work(3):
            runs += pool.map(driven, [planner] * 4)
    assert len(runs) == 20 and len({odometry for odometry, _ in runs}) == 1


@pytest.mark.slow
def test_it_does_not_matter_how_a_node_is_waited_for(files):
    """Nor that what it does depends on whether odometry or the clock comes first."""
    plain, ours = files / 'reads_clock.py', files / 'reads_clock_in_lockstep.py'
    assert len({driven(*arguments, busy=busy, **options)[0] for busy in (0, 3) for
                arguments, options in (
                    ([plain], {}), ([plain], {'options': WAITS}),
                    ([ours], {'lockstep': True}))}) == 1


@pytest.mark.slow
def test_where_lockstep_is_not_promised_it_is_told_by_how_much_runs_differ(
        files, record_property):
    """A thread that works when it wants to: the robot comes to its goal, not by the same bits."""
    (one, ends), (other, there) = [
        driven(files / 'has_thread.py', busy=busy) for busy in (0, 3)]
    apart = ends.distance_to(*there[:2])
    record_property('runs end apart [m]', apart)
    print(f'two runs end {apart:.6f} m apart')
    assert one != other
    assert apart < 0.06  # as each believes to be within 0.03 m


def test_a_process_that_sleeps_is_at_rest_and_one_that_works_is_not():
    sleeper = subprocess.Popen([sys.executable, '-c', 'input()'], stdin=subprocess.PIPE)
    worker = subprocess.Popen([sys.executable, '-c', BUSY])
    parent = subprocess.Popen(
        ['sh', '-c', f'{sys.executable} -c "{BUSY}"; true'], start_new_session=True)
    threads = {each: Threads(each.pid) for each in (sleeper, worker, parent)}
    try:
        def looks():
            for each in threads.values():
                each.find()
            return [each.asleep() for each in threads.values()]

        while looks() != [True, False, False]:
            assert worker.poll() is None and parent.poll() is None
        before = threads[sleeper].cpu_time()
        assert threads[worker].cpu_time() > (0,)
        assert threads[sleeper].cpu_time() == before
    finally:
        os.killpg(parent.pid, signal.SIGKILL)
        for each in threads:
            each.kill()
            each.wait()
            threads[each].close()


def test_a_process_that_is_stopped_is_not_at_rest_as_messages_may_lie_before_it():
    stopped = subprocess.Popen([sys.executable, '-c', 'input()'], stdin=subprocess.PIPE)
    threads = Threads(stopped.pid)
    try:
        stopped.send_signal(signal.SIGSTOP)
        os.waitid(os.P_PID, stopped.pid, os.WSTOPPED | os.WNOWAIT)
        threads.find()
        assert not threads.asleep()
    finally:
        stopped.kill()
        stopped.communicate()
        threads.close()


class Looks:
    """Stands in for threads that do not run: whether they sleep, look by look."""

    newest = ANY

    def __init__(self, *looks):
        self.asleep = iter(looks).__next__

    def cpu_time(self):
        return (1,)


def test_a_thread_that_is_woken_by_one_that_falls_asleep_is_found_by_the_second_look():
    rest = Rest(object())
    try:
        assert not rest.asleep([Looks(True, False)])
        assert not rest.asleep([Looks(True, True), Looks(True, False)])
        assert rest.asleep([Looks(True, True), Looks(True, True)])
    finally:
        rest.close()


def test_who_only_has_to_do_at_times_is_not_named_beside_one_that_never_sleeps():
    def process(*looks):
        return SimpleNamespace(threads=SimpleNamespace(asleep=cycle(looks).__next__))

    hangs, innocent, other = process(False), process(False, True), process(False, False, True)
    assert sleepless([innocent, hangs, other]) == [hangs]
    assert sleepless([innocent]) == [innocent]


def commands(robot):
    """Return the steps of the clock at which the robot was commanded."""
    return [round(each.time / STEP_S) for each in robot.history('cmd_vel')]


@pytest.mark.slow
def test_a_node_that_takes_long_to_start_misses_no_step(diffdrive, files, monkeypatch):
    """Though all of its threads sleep, and the graph shows nothing new."""
    path = files / 'loads_a_map.py'
    path.write_text((files / 'my_planner.py').read_text().replace(
        "super().__init__('my_planner')",
        "super().__init__('my_planner')\n        time.sleep(2.0)").replace(
        'import math', 'import math\nimport time'))
    monkeypatch.setattr(arrival, 'SILENT_S', 60.0)  # however busy this machine is
    robot = diffdrive(params=ROBOT)
    robot.start_process([sys.executable, path])
    robot.advance(10 * STEP_S)
    assert commands(robot) == [*range(1, 11)]


@pytest.mark.slow
def test_what_a_node_says_when_it_hears_the_time_for_the_first_time_is_of_that_time(
        diffdrive, files):
    robot = diffdrive(params=ROBOT)
    robot.advance(50 * STEP_S)
    robot.start_process([sys.executable, files / 'my_planner.py'])
    assert commands(robot) == [50]
    robot.advance(10 * STEP_S)
    assert commands(robot) == [*range(50, 61)]


@pytest.mark.slow
def test_a_node_that_acknowledges_no_messages_hears_the_first_one_of_a_topic(diffdrive, files):
    path = files / 'hears_at_best_effort.py'
    text = (files / 'my_planner.py').read_text().replace(
        'import rclpy\n', 'import rclpy\nfrom rclpy.qos import qos_profile_sensor_data\n')
    hears = '    def on_goal(self, message):\n'
    path.write_text(text.replace(hears, f"{hears}        print('goal')\n").replace(
        'self.on_goal, 10)', 'self.on_goal, qos_profile_sensor_data)'))
    robot = diffdrive(params=ROBOT)
    process = robot.start_process([sys.executable, path])
    robot.publish('goal_pose', PoseStamped())
    robot.advance(STEP_S)
    assert process.output == 'goal\n'


@pytest.mark.slow
def test_a_node_that_is_started_again_under_its_name_misses_no_step(diffdrive, files):
    robot, command = diffdrive(params=ROBOT), [sys.executable, files / 'my_planner.py']
    for number in range(2):
        process = robot.start_process(command)
        robot.advance(10 * STEP_S)
        assert commands(robot) == [*range(1, 11), *range(10, 21)][:10 + 11 * number]
        process.kill()


@pytest.mark.slow
def test_a_node_that_hangs_is_named_though_it_tells_nothing(diffdrive, files, monkeypatch):
    path = files / 'hangs.py'
    path.write_text((files / 'my_planner.py').read_text().replace(
        '        command = Twist()', "        print('thinking')\n        while True: pass"))
    robot = diffdrive(params=ROBOT)
    innocent = robot.start_process([sys.executable, files / 'my_planner.py'])
    robot.start_process([sys.executable, path])
    monkeypatch.setattr(stepping, 'REST_S', HANGS_S)
    with pytest.raises(ProcessFailed, match='hangs.py did not come to rest') as held:
        robot.advance(1.0)
    assert 'thinking' in str(held.value)
    assert innocent.running and 'my_planner' not in str(held.value)


@pytest.mark.slow
def test_a_node_that_waits_for_ever_is_named_by_who_waits_for_the_robot(diffdrive, files):
    path = files / 'waits.py'
    path.write_text((files / 'my_planner.py').read_text().replace(
        '        command = Twist()', "        print('thinking')\n        signal.pause()").replace(
            'import math', 'import math\nimport signal'))
    robot = diffdrive(params=ROBOT)
    robot.start_process([sys.executable, path])
    with pytest.raises(
            AssertionError, match=r'not within 1.0 simulated[\s\S]*waits.py[\s\S]*thinking'):
        robot.advance_until(lambda: robot.odom.speed > 0.1, timeout=1.0)


@pytest.mark.slow
def test_a_node_that_never_rests_is_told_so_and_may_be_given_silence(
        diffdrive, files, monkeypatch):
    command = [sys.executable, files / 'never_rests.py']
    robot = diffdrive(params=ROBOT)
    with monkeypatch.context() as patch, pytest.raises(
            ProcessFailed, match='never_rests.py did not come to rest.*restless=True'):
        patch.setattr(stepping, 'REST_S', HANGS_S)
        robot.start_process(command)
    other = diffdrive(params=ROBOT)
    other.start_process(command, restless=True)
    other.advance(1.0)
    assert other.history('cmd_vel')


@pytest.mark.slow
def test_a_request_to_the_robot_is_answered_before_time_moves(diffdrive, files):
    path = files / 'asks.py'
    path.write_text((files / 'my_planner.py').read_text().replace(
        'from rclpy.node', 'from std_srvs.srv import Trigger\nfrom rclpy.node').replace(
        '        self.create_timer(', """\
        self.client = self.create_client(Trigger, 'simulated_base/reset')
        self.create_timer(1.0, self.ask)
        self.create_timer(""").replace('    def on_timer', """\
    def ask(self):
        asked = self.get_clock().now()
        self.client.call_async(Trigger.Request()).add_done_callback(
            lambda _: print('waited', (self.get_clock().now() - asked).nanoseconds))

    def on_timer"""))
    robot = diffdrive(params=ROBOT)
    process = robot.start_process([sys.executable, path])
    robot.advance(3.0)
    assert process.output.split('\n')[:3] == ['waited 0'] * 3


@pytest.mark.slow
def test_a_node_in_lockstep_ends_and_one_of_its_name_comes(diffdrive, files):
    robot, command = diffdrive(params=ROBOT), [sys.executable, files / 'in_lockstep.py']
    for _ in range(2):
        process = robot.start_process(command, lockstep=True)
        said = len(robot.history('cmd_vel'))
        robot.advance(0.2)
        assert len(robot.history('cmd_vel')) == said + 10
        process.kill()


@pytest.mark.slow
def test_a_node_in_lockstep_is_waited_for_after_the_clock_was_set_back(diffdrive, files):
    robot = diffdrive(params=ROBOT)
    robot.start_process([sys.executable, files / 'in_lockstep.py'], lockstep=True)
    robot.advance(1.0)
    robot.step_clock(-0.5)
    acknowledgements = robot._stepping._acknowledgements
    for _ in range(10):
        robot.advance(0.02)
        assert acknowledgements.of('/my_planner') == round(robot.time * 1e9)


@pytest.mark.slow
def test_the_clock_of_processes_moves_by_a_period_in_every_way_to_wait(diffdrive, files):
    path = files / 'tells_time.py'
    path.write_text((files / 'in_lockstep.py').read_text().replace(
        '    def on_timer(self):\n', '    def on_timer(self):\n'
        "        print('at', self.get_clock().now().nanoseconds // 10**6)\n"))
    robot = diffdrive(params=ROBOT)
    process = robot.start_process([sys.executable, path], lockstep=True)
    robot.advance(0.3, period=0.1)
    assert process.output.split('\n')[:-1] == ['at 100', 'at 200', 'at 300']


def test_after_each_call_the_processes_have_the_time_of_the_robot(diffdrive, files):
    path = files / 'slow.py'
    path.write_text((files / 'in_lockstep.py').read_text().replace(
        'self.create_timer(0.02', 'self.create_timer(0.2'))
    robot = diffdrive(params=ROBOT)
    robot.start_process([sys.executable, path], lockstep=True)
    acknowledgements = robot._stepping._acknowledgements
    for seconds, options in [
            *[(0.02, {'period': 0.1})] * 6, *[(0.1, {'period': 0.2})] * 2,
            (0.5, {'period': 0.2}), (0.02, {}),
            (0.5, {'period': 0.2, 'wait_for': 'cmd_vel'}),  # no message comes in its last 0.1 s
            (0.4, {'period': 0.2, 'wait_for': 'cmd_vel'})]:
        robot.advance(seconds, **options)
        assert acknowledgements.of('/my_planner') == round(robot.time * 1e9)


@pytest.mark.slow
def test_a_node_in_lockstep_is_found_though_the_graph_does_not_tell_whose_topics_are(
        diffdrive, files, monkeypatch):
    def unknown(*_):
        raise RuntimeError('nonexistent node')

    robot = diffdrive(params=ROBOT)
    for look in ('subscriber', 'publisher'):
        monkeypatch.setattr(robot._observer, f'get_{look}_names_and_types_by_node', unknown)
    monkeypatch.setattr(stepping, 'DEADLINE_S', 60.0)
    robot.start_process([sys.executable, files / 'in_lockstep.py'], lockstep=True)
    robot.advance(0.2)
    assert len(robot.history('cmd_vel')) == 10
