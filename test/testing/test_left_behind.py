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

"""Tests of users do not hear each other, and leave nothing behind, however they end."""

import os
from pathlib import Path
import signal
import subprocess
import sys
import time

from diffdrive_kinematics.testing import Robot
import pytest
from sensor_msgs.msg import JointState
from support.domains import own_domain
from support.graph import Graph, KHEPERA
from support.killing import segments_of
from support.planners import ROBOT

pytestmark = [pytest.mark.ros, pytest.mark.slow]

DEADLINE_S = 60.0
WORKERS = 4
TALK = f"""
import sys

import pytest
from std_msgs.msg import Float64


@pytest.mark.parametrize('number', range({2 * WORKERS}))
def test_it_hears_only_itself(diffdrive, number):
    robot = diffdrive(params={ROBOT!r})
    robot.start_process([sys.executable, 'my_planner.py'])
    robot.listen(Float64, 'number')
    robot.publish('number', Float64(data=float(number)))
    robot.advance(1.0)
    assert [each.message.data for each in robot.history('number')] == [number]
    assert len(robot.history('cmd_vel')) == 50  # of its own planner, one in a step
    for topic in ('odom', 'ground_truth', 'wheel_rates'):
        times = [each.time for each in robot.history(topic)]
        assert len(times) == len(set(times))
"""
END = """
import os
from pathlib import Path
import signal
import sys

from diffdrive_kinematics.testing.guardian import shared_memory_of


def test_it(diffdrive):
    robot = diffdrive(params={robot!r})
    process = robot.start_process([sys.executable, 'my_planner.py'])
    robot.advance(0.1)
    used = {{name for name in shared_memory_of(os.getpid())
            if '_port' not in name}}  # ports are given out again
    assert used
    Path('used').write_text('\\n'.join(file for name in used for file in (name, f'{{name}}_el')))
    Path('pid').write_text(str(process.pid))
    {last}
"""
ENDS = {
    'fails': 'assert False',
    'is interrupted':  # also where tests run in the background, which ignores this signal
    'signal.signal(signal.SIGINT, signal.default_int_handler); signal.raise_signal(signal.SIGINT)',
    'is killed': 'os.kill(os.getpid(), signal.SIGKILL)'}


def run_pytest(directory, *arguments):
    """Run the tests of a user, and return what came of it."""
    return subprocess.run(
        [sys.executable, '-m', 'pytest', '-q', '-p', 'diffdrive_kinematics.testing.plugin',
         *arguments], cwd=directory, capture_output=True, text=True)


def test_tests_side_by_side_do_not_hear_each_other(files):
    (files / 'test_it.py').write_text(TALK)
    run = run_pytest(files, '-n', str(WORKERS), 'test_it.py')
    assert f'{2 * WORKERS} passed' in run.stdout, run.stdout + run.stderr


def left_of(directory):
    """Return what is left of the process of a test, and of the memory that the test had."""
    process = f"/proc/{(directory / 'pid').read_text()}"
    return [each for each in (process, *(directory / 'used').read_text().split('\n'))
            if Path(each).exists()]


@pytest.mark.parametrize('workers', [[], ['-n', '1']], ids=['alone', 'in a worker'])
@pytest.mark.parametrize('end', ENDS)
def test_a_test_leaves_nothing_behind_when_it(files, end, workers):
    (files / 'test_it.py').write_text(END.format(robot=ROBOT, last=ENDS[end]))
    run = run_pytest(files, *workers, 'test_it.py')
    assert run.returncode in (1, 2, -signal.SIGKILL), run.stdout + run.stderr
    deadline = time.monotonic() + DEADLINE_S
    while left_of(files):
        assert time.monotonic() < deadline, left_of(files)


def test_a_process_that_a_graph_ends_leaves_no_segment_behind_and_those_of_others_stay(graph):
    def there(names):
        return [Path(name).exists() for name in names]

    own = segments_of(os.getpid())
    with own_domain() as domain:
        other = Graph(domain)
        try:
            base = other.start('simulated_base', {**KHEPERA, 'enable_odom_tf': False})
            other.publisher(JointState, 'wheel_rates')
            theirs = segments_of(base.pid)
            base.kill()
            assert own and theirs and all(there(theirs))  # the graph may still read them
        finally:
            other.close()
    assert not any(there(theirs)) and all(there(own))


def test_a_graph_ends_its_own_context_before_it_kills_who_writes_to_it():
    """Fast DDS dies of a segmentation fault otherwise, now and then."""
    with own_domain() as domain:
        graph = Graph(domain)
        base = graph.start('simulated_base', {**KHEPERA, 'enable_odom_tf': False})
        lived = []
        graph.context.on_shutdown(lambda: lived.append(base.running))
        graph.close()
    assert lived == [True]


def test_a_robot_ends_before_the_processes_that_write_to_it(files):
    robot = Robot(params=ROBOT)
    try:
        planner = robot.start_process([sys.executable, files / 'my_planner.py'])
        lived = []
        robot._nodes._context.on_shutdown(lambda: lived.append(planner.running))
    finally:
        robot.close()
    assert lived == [True] and not planner.running
