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

"""``teleop`` in a pseudo-terminal: keys, what ends them, and the terminal afterwards."""

import os
import pty
import signal
import subprocess
import sys
import termios

from diffdrive_kinematics.tools.keyboard import Key, keys_in
from geometry_msgs.msg import Twist, TwistStamped
import pytest
from rosgraph_msgs.msg import Clock
from support.graph import arguments, stamp_ns, START
from support.killing import kill

pytestmark = pytest.mark.ros


class Terminal:
    """A terminal with the node in it, and what it publishes; the graph ends it."""

    name = 'teleop'

    def __init__(self, graph, kind=Twist, answer=b'\x1b[?62c', **parameters):
        self.graph, self.output = graph, b''
        self.commands = graph.collect(kind, 'cmd_vel')
        self.ours, theirs = pty.openpty()
        self.before = termios.tcgetattr(theirs)
        self.theirs = theirs
        os.set_blocking(self.ours, False)
        self.process = subprocess.Popen(
            [sys.executable, '-c', START.format('teleop'), *arguments(parameters)],
            stdin=theirs, stdout=theirs, stderr=theirs, env=graph._environment)
        graph.processes.append(self)
        self.wait(lambda: b'\x1b[c' in self.read(), 'the question')
        os.write(self.ours, answer)
        self.wait(lambda: b'speed 0' in self.read(), 'the speeds')
        graph.wait_for(lambda: graph.node.count_publishers('cmd_vel'), 'the publisher')

    def read(self):
        try:
            self.output += os.read(self.ours, 10_000)
        except BlockingIOError:
            pass
        return self.output

    def press(self, text):
        os.write(self.ours, text if isinstance(text, bytes) else text.encode())

    def hold(self, key, condition, what):
        """Repeat a key, as a keyboard does, until a condition holds."""
        self.wait(lambda: self.press(key) or condition(), what)

    def wait(self, condition, what):
        return self.graph.wait_for(condition, what)

    def last(self):
        twist = getattr(self.commands[-1], 'twist', self.commands[-1]) if self.commands else None
        return twist and (twist.linear.x, twist.angular.z)

    def kill(self):
        kill(self.process)
        os.close(self.ours)
        os.close(self.theirs)


@pytest.fixture
def terminal(graph):
    return lambda **options: Terminal(graph, **options)


@pytest.mark.parametrize('key, v, w', [
    ('i', 0.2, 0.0), (',', -0.2, 0.0), ('j', 0.0, 1.0), ('l', 0.0, -1.0), ('u', 0.2, 1.0),
    ('o', 0.2, -1.0), ('m', -0.2, -1.0), ('.', -0.2, 1.0)])
def test_a_key_drives_as_in_teleop_twist_keyboard_and_its_silence_ends_it(terminal, key, v, w):
    opened = terminal()
    opened.hold(key, lambda: opened.last() == (v, w), 'the command')
    opened.wait(lambda: opened.last() == (0.0, 0.0), 'the rest')


def test_any_other_key_stops(terminal):
    opened = terminal(key_timeout=1000.0)
    opened.press('i')
    opened.wait(lambda: opened.last() == (0.2, 0.0), 'the command')
    opened.press('k')
    opened.wait(lambda: opened.last() == (0.0, 0.0), 'the rest')


def test_the_speeds_are_those_of_the_yaml_and_go_up_and_down(terminal):
    opened = terminal(kind=TwistStamped, enable_stamped_cmd_vel=True, speed=0.5, yaw_rate=2.0)
    opened.press('qwex')
    expected = 0.5 * 1.1 * 1.1 * 0.9
    opened.hold(
        'i', lambda: opened.last() == (pytest.approx(expected), 0.0), 'the command')
    assert opened.commands[-1].header.stamp.sec
    assert b'yaw rate 2.420 rad/s' in opened.read()


def test_a_terminal_that_tells_releases_is_believed(terminal):
    opened = terminal(answer=b'\x1b[?0u\x1b[?62c', key_timeout=1000.0)
    assert b'\x1b[>11u' in opened.read()
    opened.press(b'\x1b[105u')
    opened.wait(lambda: opened.last() == (0.2, 0.0), 'the command')
    count = len(opened.commands)
    opened.wait(lambda: len(opened.commands) > count + 5, 'more of it, although it is silent')
    assert opened.last() == (0.2, 0.0)
    opened.press(b'\x1b[57441;2:1u\x1b[105;2:')  # shift came down meanwhile, and in two parts
    opened.press(b'3u')
    opened.wait(lambda: opened.last() == (0.0, 0.0), 'the rest')
    opened.press(b'\x1b[99;5u')  # Ctrl-C is a key there
    opened.wait(lambda: opened.process.poll() is not None, 'the end')
    assert opened.process.returncode == 0
    assert opened.read().rstrip().endswith(b'\x1b[<u') or b'\x1b[<u' in opened.read()


def test_a_terminal_that_tells_releases_and_hangs_does_not_drive_on(terminal):
    opened = terminal(answer=b'\x1b[?0u\x1b[?62c')
    opened.hold(b'\x1b[105u', lambda: opened.last() == (0.2, 0.0), 'the command')
    opened.wait(lambda: opened.last() == (0.0, 0.0), 'the rest')


def test_no_key_drives_before_simulated_time_has_begun(terminal, graph):
    opened = terminal(kind=TwistStamped, enable_stamped_cmd_vel=True, use_sim_time=True)
    for shown in (b'0.220', b'0.242', b'0.266'):  # each in a tick of its own
        opened.press('iq')
        opened.wait(lambda: shown in opened.read(), 'a speed')
    clock, now = graph.node.create_publisher(Clock, '/clock', 1), Clock()

    def driven():
        now.clock.sec += 1
        clock.publish(now)
        return opened.last() and opened.last()[0] > 0.0

    opened.hold('i', driven, 'the command')
    assert all(stamp_ns(message) for message in opened.commands)


@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_signal_leaves_the_robot_at_rest_and_the_terminal_as_it_was(terminal, number):
    opened = terminal(key_timeout=1000.0)
    assert termios.tcgetattr(opened.theirs) != opened.before
    opened.press('i')
    opened.wait(lambda: opened.last() == (0.2, 0.0), 'the command')
    opened.process.send_signal(number)
    opened.wait(lambda: opened.process.poll() is not None, 'the end')
    assert opened.process.returncode == 0
    opened.wait(lambda: opened.last() == (0.0, 0.0), 'the rest')
    assert termios.tcgetattr(opened.theirs) == opened.before
    assert b'Traceback' not in opened.read()


def test_without_a_terminal_it_says_so(graph):
    process = graph.start('teleop')
    assert process.wait() == 2
    assert 'standard input is not a terminal' in process.output


@pytest.mark.parametrize('data, keys', [
    (b'ik', [Key('i'), Key('k')]), (b'\x1b[A\x1b[1;2B\x1bOP', []),
    (b'\x1b[105;1:1u\x1b[105;1:3u', [Key('i'), Key('i', True)]), (b'\x1b[57441;2u', []),
    (b'\x1b[105;2:3u', [Key('i', True)]), (b'\x1bi', []), (b'\x1b[1', [])])
def test_keys_are_told_from_what_else_a_terminal_says(data, keys):
    assert keys_in(data) == keys
