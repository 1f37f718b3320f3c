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

"""Commands that are old when they come: by their stamps, or out of the queue of a process."""

import signal
import time

from diffdrive_kinematics.testing.processes import on_this_machine
from geometry_msgs.msg import Twist
import pytest
from sensor_msgs.msg import JointState
from support.graph import KHEPERA, stamp_ns, twist, twist_stamped
from support.health import statuses_of, WARN, with_health
from support.once import obeyed_once, OLD
from support.stepped import messages, nodes, time_ns

CONTROLLER = 'diff_drive_controller'
STAMPED = {**KHEPERA, 'enable_stamped_cmd_vel': True}
HOUR_NS = 3600 * 10**9
MS = 10**6
SPEED = 0.2  # [m/s]
TIMEOUT_S = 1.0
LONGEST_S = 1.5 * TIMEOUT_S  # a silence beyond it is not that of the stall alone
TRIES = 8  # as a busy machine may hold up this process, too
HELD_UP_S = 0.4 * TIMEOUT_S  # what the machine may add: a middleware takes half a second more
# its own code is at work elsewhere for longer than that, while its middleware goes on
BUSY = f"""
import signal, time

def work(*_):
    end = time.monotonic() + {TIMEOUT_S + 0.2}
    while (begin := time.monotonic()) < end:
        time.sleep(0.02)
        if time.monotonic() > begin + {HELD_UP_S}:
            print('held up')

signal.signal(signal.SIGUSR1, work)
"""
EXECUTORS = pytest.mark.parametrize('executor', ['events', 'single_threaded'])


def turning(rates):
    return [message for message in rates if any(message.velocity)]


def silences_s(rates):
    """Return the times [s] between two messages, by their stamps, the longest one first."""
    stamps = [stamp_ns(message) for message in rates]
    return sorted(((b - a) / 1e9 for a, b in zip(stamps, stamps[1:])), reverse=True)


def at(rates, v):
    return rates and rates[-1].velocity[0] == pytest.approx(v / 0.021, rel=1e-9)


@pytest.fixture
def robot_with(diffdrive):
    """Return what makes a controller whose clock has shown two hours."""
    def make(**parameters):
        robot = with_health(diffdrive(
            nodes(CONTROLLER), params={**STAMPED, 'diagnostics_rate': 10.0, **parameters}))
        robot.step_clock(7200.0)
        return robot

    return make


def command(robot, v, *, after_ns=0):
    """Say a command that is stamped so long after this time; return the wheel rates so far."""
    robot.publish('cmd_vel', twist_stamped(time_ns(robot) + after_ns, v, 0.0))
    return messages(robot, 'wheel_rates')


@pytest.mark.ros
def test_a_command_of_an_hour_ago_moves_nothing_and_is_counted_and_reported(robot_with, capfd):
    robot = robot_with()
    robot.advance(0.2)
    assert turning(command(robot, SPEED, after_ns=-HOUR_NS)) == []
    robot.advance(0.2)
    values = next(values for level, text, values in statuses_of(robot, f'/{CONTROLLER}')
                  if level == WARN and 'old commands: 1 more, 1 in all' in text)
    assert values['old commands'] == '1' and values['timeouts'] == '0'
    output = capfd.readouterr().err
    assert f'{OLD} 0.5' in output and 'cmd_vel_clock_offset' in output
    assert turning(messages(robot, 'wheel_rates')) == []
    assert at(command(robot, SPEED), SPEED)


@pytest.mark.ros
def test_a_command_from_before_a_stop_that_was_carried_out_moves_nothing(robot_with, capfd):
    robot = robot_with(cmd_vel_timeout=60.0)
    assert at(command(robot, SPEED), SPEED)
    robot.advance(0.02)
    assert at(command(robot, 0.0), 0.0)
    assert at(command(robot, SPEED, after_ns=-MS), 0.0)
    assert 'before the last one obeyed' in capfd.readouterr().err
    robot.advance(0.2)
    assert at(messages(robot, 'wheel_rates'), 0.0)
    assert at(command(robot, -SPEED, after_ns=-200 * MS), -SPEED)  # not older: another thought


@pytest.mark.ros
def test_a_stamp_from_the_future_does_not_lock_out_what_follows(robot_with):
    robot = robot_with()
    for v, after_ns in ((SPEED, HOUR_NS), (-SPEED, 0)):
        assert at(command(robot, v, after_ns=after_ns), v)
        robot.advance(0.1)


@pytest.mark.ros
@pytest.mark.parametrize('offset', [3600.0, float('nan')])
def test_clocks_that_are_known_to_be_apart_are_no_age(robot_with, capfd, offset):
    robot = robot_with(cmd_vel_clock_offset=offset)
    assert at(command(robot, SPEED, after_ns=-HOUR_NS), SPEED)
    assert OLD not in capfd.readouterr().err


def started(graph, before='', **parameters):
    """Start a controller; return it, what it tells, and what publishes commands."""
    # shared memory of a process that is stopped is taken for broken now and then
    controller = graph.start(
        CONTROLLER, {**KHEPERA, **parameters}, environment=on_this_machine(), before=before)
    return controller, graph.collect(JointState, 'wheel_rates'), graph.publisher(Twist, 'cmd_vel')


@EXECUTORS
def test_what_lay_in_the_queue_while_the_process_was_stopped_is_not_driven(graph, executor):
    controller, rates, commands = started(graph, executor=executor)
    graph.wait_for(lambda: rates, 'rates')
    graph.hold_up(controller, 1.0, lambda: [
        commands.publish(twist(SPEED, 0.0)) for _ in range(5)])
    graph.wait_for(lambda: f'{OLD} 0.5' in controller.output, 'a report')
    heard = len(rates)
    graph.wait_for(lambda: len(rates) > heard + 25, 'rates')
    assert turning(rates) == []
    graph.wait_for(lambda: commands.publish(twist(SPEED, 0.0)) or turning(rates), 'the robot')


@EXECUTORS
@pytest.mark.parametrize('limits', [{}, {'linear.x.max_acceleration': 0.5}], ids=['', 'ramps'])
@pytest.mark.parametrize('stall', [signal.SIGUSR1, signal.SIGSTOP], ids=['busy', 'stopped'])
def test_a_stall_while_commands_flow_sends_no_needless_stop(graph, executor, limits, stall):
    """
    Nor does it slow down; and while nobody was there the wheels are not said to have turned.

    A process that is stopped as a whole has a middleware that may bring no command for half a
    second afterwards, so that a stop is right: there only the rest is asked for.
    """
    controller, rates, commands = started(
        graph, BUSY, **limits, executor=executor, cmd_vel_timeout=TIMEOUT_S)
    told_at = []

    def flowing(condition):
        def flow():
            told_at.append(time.monotonic())
            commands.publish(twist(SPEED, 0.0))
            return condition()
        return flow

    def stalled():
        """Stall it once; return whether nothing else held up it, or this process."""
        told_at.clear()
        asked_ns = graph.now_ns()  # what lies in the queue of this process tells nothing
        graph.wait_for(flowing(lambda: at(rates, SPEED) and stamp_ns(rates[-1]) > asked_ns),
                       'the speed')
        before, held_up = len(rates), controller.output.count('held up')
        controller.send(stall)
        over = time.monotonic() + TIMEOUT_S + 0.2
        graph.wait_for(flowing(lambda: time.monotonic() > over), 'the stall')
        heard = len(rates)
        controller.send(signal.SIGCONT)
        graph.wait_for(flowing(lambda: len(rates) > heard + 10), 'rates after it')
        during = rates[before - 1:]
        longest, next_one, *_ = silences_s(during)
        if (max(b - a for a, b in zip(told_at, told_at[1:])) > 0.5 * TIMEOUT_S
                or not TIMEOUT_S < longest < LONGEST_S or next_one > HELD_UP_S
                or controller.output.count('held up') > held_up):
            return False  # the machine did
        rolled = max(b.position[0] - a.position[0] for a, b in zip(during, during[1:]))
        assert rolled < SPEED / 0.021 * (TIMEOUT_S + 0.15)
        if stall == signal.SIGUSR1:
            assert all(at([message], SPEED) for message in rates[before:])
        return True

    graph.wait_for(flowing(lambda: at(rates, SPEED)), 'the robot to drive')
    for _ in range(2):
        assert any(stalled() for _ in range(TRIES))
    graph.wait_for(flowing(lambda: at(rates, SPEED)), 'the speed again')


def test_a_command_that_ended_during_a_stall_is_over_when_the_process_goes_on(graph):
    controller, rates, commands = started(graph)
    graph.wait_for(lambda: rates, 'rates')
    send = obeyed_once(controller, lambda: commands.publish(twist(SPEED, 0.0)))
    graph.wait_for(lambda: send() or turning(rates), 'the robot to drive')
    graph.hold_up(controller, 1.0, lambda: commands.publish(twist(2.0 * SPEED, 0.0)))
    graph.wait_for(lambda: at(rates, 0.0), 'the stop')
    assert {round(m.velocity[0] * 0.021, 9) for m in turning(rates)} == {SPEED}
    turned = [any(message.velocity) for message in rates]
    start = turned.index(True)
    stop = turned.index(False, start)
    assert stamp_ns(rates[stop]) - stamp_ns(rates[start]) == 500 * MS
