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

"""
Controller and base on two machines: network namespaces with addresses of their own and a cable.

They find each other by DDS's multicast alone.  That nothing goes another way is seen where the
cable is pulled.
"""

import json
import math
import os
from pathlib import Path
import select
import shutil
import signal
import subprocess
import sys
import time

from diffdrive_kinematics.core.kinematics import advance, Pose
import pytest
from support.graph import arguments, DEADLINE_S, KHEPERA, START
from support.killing import kill

WATCHER = Path(__file__).parents[1] / 'support' / 'watcher.py'
SPEED, TURN = 0.1, 0.5
TIMEOUT_S = 0.3
POLL_S = 0.05


def ip(*words):
    """Change the network; ``CalledProcessError`` where that is not allowed."""
    subprocess.run(['ip', *words], check=True, capture_output=True, text=True)


class Machines:
    """Two namespaces, and the processes in them."""

    def __init__(self, directory, domain):
        self._directory, self._processes = directory, []
        self.names = [f'ddk{os.getpid()}{side}' for side in 'ab']
        self.environment = {
            **os.environ, 'ROS_AUTOMATIC_DISCOVERY_RANGE': 'SUBNET', 'PYTHONUNBUFFERED': '1',
            'ROS_DOMAIN_ID': str(domain), 'ROS_LOG_DIR': str(directory)}
        self.environment.pop('ROS_LOCALHOST_ONLY', None)

    def wire(self):
        a, b = self.names
        for name in self.names:
            ip('netns', 'add', name)
        ip('link', 'add', 'cable', 'netns', a, 'type', 'veth', 'peer', 'name', 'cable',
           'netns', b)
        for number, name in enumerate(self.names):
            ip('-n', name, 'addr', 'add', f'10.213.77.{number + 1}/24', 'dev', 'cable')
            self.plug(name)

    def plug(self, name):
        for link in ('lo', 'cable'):
            ip('-n', name, 'link', 'set', link, 'up')
        ip('-n', name, 'route', 'replace', '224.0.0.0/4', 'dev', 'cable')

    def pull(self, name):
        ip('-n', name, 'link', 'set', 'cable', 'down')

    def start(self, name, *command):
        """Start a process on a machine; return the file that its output is appended to."""
        path = self._directory / f'{len(self._processes)}.txt'
        with open(path, 'a') as file:
            self._processes.append(subprocess.Popen(
                ['ip', 'netns', 'exec', name, sys.executable, *command],
                stdin=subprocess.DEVNULL, stdout=file, stderr=subprocess.STDOUT,
                env=self.environment))
        return path

    def node(self, name, executable, parameters):
        return self.start(name, '-c', START.format(executable), *arguments(parameters))

    def interrupt_last(self):
        """End the process that was started last, and return its exit status."""
        self._processes[-1].send_signal(signal.SIGINT)
        return self._processes[-1].wait(DEADLINE_S)

    def wait_for(self, condition, what):
        deadline = time.monotonic() + DEADLINE_S
        while not condition():
            assert time.monotonic() < deadline, f'{what}\n{self.outputs()}'
            select.select([], [], [], POLL_S)  # a look at a file is all that can be waited for

    def outputs(self):
        return '\n'.join(path.read_text()[-2000:] for path in sorted(self._directory.iterdir())
                         if path.suffix == '.txt')

    def close(self):
        for process in self._processes:
            kill(process)
        for name in self.names:
            subprocess.run(['ip', 'netns', 'del', name], capture_output=True)


@pytest.fixture
def machines(tmp_path):
    """Yield two machines, or skip where they cannot be made."""
    from support.domains import own_domain
    if not shutil.which('ip'):
        pytest.skip('ip (iproute2) is not installed')
    with own_domain() as domain:
        made = Machines(tmp_path, domain)
        try:
            made.wire()
        except subprocess.CalledProcessError as error:
            made.close()
            pytest.skip(f'network namespaces cannot be made: {error.stderr.strip()}')
        try:
            yield made
        finally:
            made.close()


class Ears:
    """What the watcher has heard so far."""

    def __init__(self, machines, path):
        self._machines, self._path = machines, path
        self.odom, self.wheels = [], []

    def read(self):
        lines = self._path.read_text().split('\n')[:-1]  # the last one may not be complete
        heard = [json.loads(line) for line in lines if line.startswith('[')]
        self.odom = [line[1:] for line in heard if line[0] == 'odom']
        self.wheels = [line[1:] for line in heard if line[0] == 'wheels']

    def wait_for(self, condition, what):
        def heard():
            self.read()
            return self.odom and self.wheels and condition()

        self._machines.wait_for(heard, what)


def after(seconds):
    return advance(Pose(0.0, 0.0, 0.0), SPEED * seconds, TURN * seconds)


def driven(wheels):
    """Return how long [s] the wheels have turned at their rate."""
    _, _, right_rate, _, right_position = wheels
    return right_position / right_rate


def off_by(odom, expected):
    return max(math.dist(odom[1:3], expected[:2]),
               abs(math.remainder(odom[3] - expected.theta, math.tau)))


def test_a_base_on_another_machine_is_exact_and_stops_when_the_cable_is_pulled(machines):
    a, b = machines.names
    machines.node(b, 'simulated_base', {
        **KHEPERA, 'enable_odom_tf': False, 'command_timeout': TIMEOUT_S})
    ears = Ears(machines, machines.start(b, str(WATCHER)))
    machines.node(a, 'diff_drive_controller', {**KHEPERA, 'cmd_vel_timeout': 0.0})
    machines.node(a, 'command_sequence', {
        'commands': [SPEED, TURN, 600.0], 'wait_for_topics': ['odom']})
    unheard = None  # [s] driven before the base had found the controller

    def turned():
        """Return how long [s] the wheels had turned when the last odometry was told."""
        odom, wheels = ears.odom[-1], ears.wheels[-1]
        return driven(wheels) + (odom[0] - wheels[0]) / 1e9

    def goes_on():
        odom = ears.odom[-1]
        return odom[4] != 0.0 and off_by(odom, after(turned() - unheard)) < 1e-9

    def drives():
        nonlocal unheard
        if ears.odom[-1][2] < 0.01 or not any(ears.wheels[-1][1:3]):
            return False
        unheard = turned() - ears.odom[-1][3] / TURN
        return goes_on()

    def stopped():
        odom, last = ears.odom[-1], ears.wheels[-3:]  # the base may have heard one less
        return odom[4] == 0.0 and min(
            off_by(odom, after(driven(wheels) - unheard + TIMEOUT_S)) for wheels in last) < 1e-9

    ears.wait_for(drives, 'the robot drives')
    machines.pull(a)
    ears.wait_for(stopped, 'the base stops')
    machines.plug(a)
    ears.wait_for(goes_on, 'the base goes on')


def test_the_demo_is_heard_on_another_machine_only_where_the_user_says_so(machines):
    """A robot in the same laboratory that listens to Twist would obey."""
    a, b = machines.names
    ears = Ears(machines, machines.start(b, str(WATCHER)))
    reach = machines.environment.pop('ROS_AUTOMATIC_DISCOVERY_RANGE')
    demo = '-c', START.format('diffdrive_sim'), '--ros-args', '-p', 'real_time_factor:=1.0'
    report = machines.start(a, *demo)
    machines.wait_for(lambda: ' 2.4 of 24.0 s' in report.read_text(), 'some of the demo')
    assert machines.interrupt_last() == 0, machines.outputs()
    assert 'on this machine only' in report.read_text()
    ears.read()
    assert not ears.odom and not ears.wheels
    machines.environment['ROS_AUTOMATIC_DISCOVERY_RANGE'] = reach
    report = machines.start(a, *demo)
    ears.wait_for(lambda: ears.odom[-1][1] > 0.0, 'the demo')
    assert machines.interrupt_last() == 0, machines.outputs()
    assert 'on this machine only' not in report.read_text()
