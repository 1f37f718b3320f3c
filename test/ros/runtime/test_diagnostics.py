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
"""What the nodes tell about their health on /diagnostics."""

import math

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from diffdrive_kinematics.nodes.simulated_base import SimulatedBase
from diffdrive_kinematics.nodes.wheel_noise import WheelNoise
from diffdrive_kinematics.ros.runtime.diagnostics import (
    MessageStatistics, Problem, RateSample, Reporter, Status)
import pytest
from rosgraph_msgs.msg import Clock
from support.graph import clock_at, CONFIG, KHEPERA, stamp_ns, twist, wheel_motion
from support.health import ERROR, OK, statuses_of, WARN, with_health
from support.inside import inside, START_NS
from support.stepped import last, nodes, tell_wheels, time_ns

CONTROLLER, CONTROLLER_PATH, BASE = (
    'diff_drive_controller', '/diff_drive_controller', '/simulated_base')
NODES = {
    CONTROLLER: KHEPERA, 'wheel_noise': {'wheel_radius': 0.021}, 'simulated_base': KHEPERA,
    'command_sequence': {'commands': [0.1, 0.0, 60.0]}, 'forward_projection': KHEPERA}
FAST = {'diagnostics_rate': 20.0}


class Listeners:
    """Stands in for a publisher."""

    def __init__(self, count=1):
        self.count, self.levels, self.messages = count, [], []

    def get_subscription_count(self):
        return self.count

    def publish(self, message):
        self.levels.append(message.status[0].level)
        self.messages.append(message.status[0].message)


@pytest.mark.ros
@pytest.mark.parametrize('name', NODES)
def test_every_node_tells_its_health_on_the_absolute_topic_under_its_full_name(diffdrive, name):
    robot = with_health(diffdrive(
        nodes(f'{name}:robot1/{name}'), params={**NODES[name], **FAST}))
    robot.advance(0.2)
    (status,) = last(robot, '/diagnostics').status
    assert (status.name, status.hardware_id) == (f'/robot1/{name}', 'robot1')
    assert status.level == (OK if name == CONTROLLER else WARN)
    assert 'yet' in status.message or 'waiting for' in status.message
    assert 'refused' in {pair.key for pair in status.values}


@pytest.mark.ros
def test_a_rate_of_zero_is_off(diffdrive):
    robot = diffdrive(nodes(CONTROLLER), params={**KHEPERA, 'diagnostics_rate': 0.0})
    robot.advance(1.5)
    with pytest.raises(KeyError, match='/diagnostics'):
        robot.history('/diagnostics')


def at_level(robot, name, level, words=''):
    """Let time pass until a node tells that level, with some words; return what it tells."""
    begun = len(statuses_of(robot, name))

    def told():
        return [status for status in statuses_of(robot, name)[begun:]
                if status[0] == level and words in status[1]]

    robot.advance_until(told, timeout=3.0)
    return told()[0]


@pytest.mark.ros
def test_the_controller_tells_of_commands_timeouts_cuts_and_refusals(diffdrive):
    robot = with_health(diffdrive(nodes(CONTROLLER), params={
        **KHEPERA, 'diagnostics_rate': 5.0, 'max_wheel_rate': 5.0,
        'linear.x.max_velocity': 0.2}))
    at_level(robot, CONTROLLER_PATH, OK, "no messages on '/cmd_vel' yet")
    robot.drive(0.5, 0.0, 1.0)
    level, message, values = statuses_of(robot, CONTROLLER_PATH)[-1]
    assert (level, message) == (OK, 'ok') and float(values['saturated']) > 0
    assert 40 <= int(values['command messages']) <= 50
    assert int(values['limited']) > 0 and int(values['timeouts']) == 0
    assert 0.0 <= float(values['age of the last command [s]']) < 0.5
    assert float(values['achieved publish rate [Hz]']) > 0.8 * 50.0
    values = at_level(robot, CONTROLLER_PATH, WARN, 'timeouts: 1 more')[2]
    assert values['timeouts'] == '1'
    at_level(robot, CONTROLLER_PATH, OK, "at rest, no messages on '/cmd_vel' for")
    robot.publish('cmd_vel', twist(math.nan, 0.0))
    values = at_level(robot, CONTROLLER_PATH, ERROR, 'refused: 1 more, 1 in all')[2]
    assert values['refused'] == '1'


@pytest.mark.ros
def test_the_base_tells_of_wheel_motion_its_stamps_and_its_rate(diffdrive):
    robot = with_health(diffdrive(nodes('simulated_base'), params={
        **KHEPERA, 'enable_odom_tf': False, 'command_timeout': 0.0, **FAST}))
    robot.advance(1.0)
    assert statuses_of(robot, BASE)[-1][:2] == (WARN, "no messages on '/wheel_rates' yet")
    late_ns = time_ns(robot) - 700_000_000
    for offset, angle in ((0, 0.0), (100_000_000, 1.0), (50_000_000, 0.5), (-1, 0.0)):
        tell_wheels(robot, [angle, angle], at_ns=late_ns + offset)
    at_level(robot, BASE, WARN, 'out of order: ')
    values = at_level(robot, BASE, OK)[2]
    assert values['wheel motion messages'] == '4'
    assert float(values['largest now - stamp [s]']) == pytest.approx(0.7, abs=1e-3)
    assert int(values['out of order']) >= 1 and values['clock steps in stamps'] == '0'
    assert float(values['age of the last wheel motion [s]']) >= 0.0
    assert robot.history('odom')


@pytest.mark.ros
def test_the_base_tells_of_encoders_that_began_again_elsewhere(diffdrive):
    robot = with_health(diffdrive(nodes('simulated_base'), params={
        **KHEPERA, 'enable_odom_tf': False, 'max_encoder_rate': 50.0, **FAST}))
    at_level(robot, BASE, WARN, 'no messages')
    for number, angle in enumerate((0.0, 700.0)):
        tell_wheels(robot, [angle, angle], at_ns=time_ns(robot) + number)
    values = at_level(robot, BASE, WARN, 'position jumps: 1 more, 1 in all')[2]
    assert values['position jumps'] == '1'


@pytest.mark.ros
def test_diagnostics_follow_the_stepped_clock_and_show_progress(diffdrive):
    robot = with_health(diffdrive(CONFIG / 'demo.yaml'))
    robot.advance(16.0)
    arrays = [each.message for each in robot.history('/diagnostics')]
    assert all(stamp_ns(array) % 10**9 == 0 for array in arrays)
    names = {array.status[0].name for array in arrays}
    assert names == {'/diff_drive_controller', '/wheel_noise', '/simulated_base', '/ground_truth',
                     '/command_sequence'}
    progress = [float(pair.value) for array in arrays for pair in array.status[0].values
                if pair.key == 'progress [%]']
    assert progress == sorted(progress) and max(progress) > 50.0
    late = [array.status[0] for array in arrays if stamp_ns(array) > 10 * 10**9]
    assert {status.level for status in late} == {OK}, [status.message for status in late]


def test_what_has_grown_since_the_last_look_is_trouble_once_the_worst_first():
    listeners = Listeners()
    reporter = Reporter('/node', 'robot', listeners)
    silence = [Problem(OK, 'silence')]
    for refused, order, problems in ((0, 0, []), (2, 1, silence), (2, 1, silence), (2, 3, [])):
        reporter.report(1, Status({'refused': refused, 'out of order': order}, problems))
    assert listeners.levels == [OK, ERROR, OK, WARN]
    assert listeners.messages == [
        'ok', 'refused: 2 more, 2 in all; out of order: 1 more, 1 in all; silence', 'silence',
        'out of order: 2 more, 3 in all']


def test_nothing_is_published_where_nobody_listens():
    listeners = Listeners(count=0)
    Reporter('/node', 'robot', listeners).report(1, Status({'refused': 3}, []))
    assert listeners.levels == []


def test_a_rate_is_what_was_sent_since_the_last_look_and_judged_where_there_is_enough_of_it():
    reporter = Reporter('/node', 'robot', Listeners())
    assert reporter.sample(10**9, 0).rate is None
    assert reporter.sample(2 * 10**9, 3).rate is None  # it began in between
    assert reporter.sample(3 * 10**9, 53) == RateSample(3 * 10**9, 50.0, 1.0)
    assert reporter.sample(3 * 10**9, 60).rate is None
    assert RateSample(0, 39.0, 1.0).problems(50.0) == [
        Problem(WARN, 'publishes at 39.0 Hz, set to 50.0')]
    assert RateSample(0, 41.0, 1.0).problems(50.0) == []
    assert RateSample(0, 0.0, 1.0).problems(4.0) == []


def test_the_skew_of_stamps_is_kept_with_its_sign_and_its_largest():
    received = MessageStatistics()
    assert received.age(5) is None
    assert received.problems(5, 1.0, 'in') == [Problem(WARN, "no messages on 'in' yet")]
    assert received.problems(5, 1.0, 'in', none_yet=OK)[0].level == OK
    for now, stamp in ((10, 9), (20, 25), (30, 28)):
        received.note(now, stamp)
    assert (received.count, received.skew_ns, received.largest_skew_ns) == (3, 2, -5)
    assert received.age(30 + 2 * 10**9) == 2.0
    assert received.problems(31, 1.0, 'in') == received.problems(9 * 10**9, 0.0, 'in') == []
    assert 'for 2.0 s' in received.problems(30 + 2 * 10**9, 1.0, 'in')[0].message


def test_ages_and_rates_are_those_of_before_where_the_clock_was_stepped():
    with inside(SimulatedBase, {**KHEPERA, 'enable_odom_tf': False}) as held:
        held.hear('/wheel_rates', wheel_motion(0, velocity=[1.0, 1.0]))
        held.advance_to(START_NS + 700_000_000)
        back = START_NS - 500 * 10**9
        held.clock.advance_to(back)
        held.hear('/wheel_rates', wheel_motion(0, velocity=[1.0], names=['arm']))  # no news
        status = held.node.status(RateSample(back))
        assert status.values['age of the last wheel motion [s]'] == 0.7
        assert [trouble.level for trouble in status.problems] == [WARN]
    reporter = Reporter('/node', 'robot', Listeners())
    reporter.sample(10**12, 1)
    reporter.clock_stepped(-5 * 10**11)
    assert reporter.sample(5 * 10**11 + 10**9, 51).rate == 50.0


@pytest.mark.parametrize('rate, level', [(0.0, OK), (1.0, WARN)])
@pytest.mark.parametrize('make, topic', [
    (SimulatedBase, '/wheel_rates'), (WheelNoise, '/wheel_rates')], ids=['base', 'noise'])
def test_wheels_that_fell_silent_are_well_at_rest_and_a_warning_where_they_turned(
        make, topic, rate, level):
    with inside(make, {**KHEPERA, 'enable_odom_tf': False}) as held:
        held.hear(topic, wheel_motion(START_NS, velocity=[rate, rate]))
        later = START_NS + 3600 * 10**9
        held.advance_to(later)
        (trouble,) = held.node.status(RateSample(later)).problems
        assert trouble.level == level
        assert "no messages on '/wheel_rates' for 3600.0 s" in trouble.message
        assert ('at rest' in trouble.message) == (level == OK)


@pytest.mark.ros
def test_a_parked_robot_is_well_and_nothing_is_ever_stale(diffdrive):
    """Controller and base, an hour or a second after the last command."""
    robot = with_health(diffdrive(
        nodes(CONTROLLER, 'simulated_base'), params={**KHEPERA, 'enable_odom_tf': False, **FAST}))
    for v in (0.1, 0.0):
        robot.publish('cmd_vel', twist(v, 0.0))
        robot.advance(0.02)
    at_level(robot, CONTROLLER_PATH, OK, "at rest, no messages on '/cmd_vel' for 1.")
    assert statuses_of(robot, BASE)[-1][:2] == (OK, 'ok')
    parked = [len(statuses_of(robot, name)) for name in (CONTROLLER_PATH, BASE)]
    robot.advance(2.0)
    heard = [statuses_of(robot, name) for name in (CONTROLLER_PATH, BASE)]
    for statuses, begin in zip(heard, parked):
        assert len(statuses) > begin + 20
        assert {level for level, *_ in statuses[begin:]} == {OK}
    assert DiagnosticStatus.STALE not in {level for each in heard for level, *_ in each}


def test_reports_come_though_simulated_time_stands_and_on_the_clock_it_shows(graph):
    arrays = graph.collect(DiagnosticArray, '/diagnostics')
    graph.start(CONTROLLER, {**KHEPERA, 'use_sim_time': True, **FAST})
    graph.wait_for(lambda: len(arrays) > 3, 'diagnostics')
    clock = graph.publisher(Clock, '/clock')
    graph.wait_for(  # again, as whoever listens to a clock may lose a message
        lambda: clock.publish(clock_at(7 * 10**9)) or stamp_ns(arrays[-1]) == 7 * 10**9,
        'diagnostics on the new time')
    (status,) = graph.wait_for(
        lambda: [status for status in arrays[-1].status if '/clock stands at' in status.message],
        'that it stands')
    assert status.level == WARN and '/clock stands at 7.000 s' in status.message
