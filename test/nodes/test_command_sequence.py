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

"""Courses as they appear on cmd_vel."""

from diffdrive_kinematics.nodes.command_sequence import CommandSequence
from diffdrive_kinematics.ros.parameters.configuration_error import ConfigurationError
from geometry_msgs.msg import Twist, TwistStamped
from nav_msgs.msg import Odometry
import pytest
from rosgraph_msgs.msg import Clock
from std_msgs.msg import Empty
from support.graph import clock_at, DEEP, KHEPERA, stamp_ns
from support.inside import beside, initialised
from support.stepped import last, messages, nodes, refusal

pytestmark = pytest.mark.ros

COMMANDS = [0.1, 0.5, 0.2, -0.1, 0.0, 0.1]


def changes(messages):
    """Return the messages whose twist differs from the one before."""
    twists = [(getattr(message, 'twist', message).linear.x,
               getattr(message, 'twist', message).angular.z) for message in messages]
    return [(message, twist) for message, twist, before in zip(
        messages, twists, [None, *twists]) if twist != before]


def played_by(diffdrive, seconds, message_type=TwistStamped, **params):
    """Return the changes of the commands of a course alone, in a time from its start."""
    robot = diffdrive(nodes('command_sequence'), params={
        'enable_stamped_cmd_vel': message_type is TwistStamped, **params}, clock_step=0.01)
    robot.listen(message_type, 'cmd_vel')
    robot.advance(seconds)
    return changes(messages(robot, 'cmd_vel'))


@pytest.mark.parametrize('message_type', [Twist, TwistStamped], ids=lambda kind: kind.__name__)
def test_a_list_is_played_in_order_and_ends_with_zero(diffdrive, message_type):
    played = played_by(diffdrive, 1.0, message_type, commands=COMMANDS)
    assert [twist for _, twist in played][-3:] == [(0.1, 0.5), (-0.1, 0.0), (0.0, 0.0)]


def test_a_process_that_has_played_its_course_ends_with_zero(graph):
    commands = graph.collect(Twist, 'cmd_vel')
    go = graph.publisher(Empty, 'go', listeners=0)
    sequence = graph.start('command_sequence', {'commands': COMMANDS, 'wait_for_topics': ['go']})
    graph.wait_for(lambda: commands, 'zeros before the course')
    graph.play_out(sequence, go)
    assert (0.1, 0.5) in [twist for _, twist in changes(commands)]
    graph.wait_for(lambda: changes(commands) and changes(commands)[-1][1] == (0.0, 0.0), 'zero')


def test_a_recording_is_played_at_its_times_and_the_last_of_duplicate_stamps_wins(
        diffdrive, tmp_path, capfd):
    recording = tmp_path / 'drive.csv'
    recording.write_text(
        'time_sec,linear_x,angular_z\n5.0,0.1,0.0\n5.1,0.7,0.7\n5.1,0.2,0.5\n5.25,0.3,0.0\n'
        '5.4,0.9,0.9\n')
    played = played_by(diffdrive, 1.0, recording=str(recording))[-4:]
    assert '1 rows of the recording' in capfd.readouterr().err
    assert [twist for _, twist in played] == [(0.1, 0.0), (0.2, 0.5), (0.3, 0.0), (0.0, 0.0)]
    start = stamp_ns(played[0][0])
    assert [stamp_ns(message) - start for message, _ in played] == [
        0, 100_000_000, 250_000_000, 400_000_000]


def test_a_lap_takes_the_time_of_its_commands_and_the_next_begins_without_a_gap(diffdrive):
    played = played_by(diffdrive, 2.0, commands=[0.1, 0.0, 0.15, 0.2, 0.0, 0.1], loop=True)
    begins = [stamp_ns(message) for message, twist in played if twist == (0.1, 0.0)]
    assert len(begins) == 8
    assert {b - a for a, b in zip(begins, begins[1:])} == {250_000_000}
    assert all(twist[0] for _, twist in played[-16:])  # no zero between laps


def test_zeros_are_sent_until_the_topics_to_wait_for_answer_and_at_the_end(graph):
    commands = graph.collect(TwistStamped, 'cmd_vel')
    sequence = graph.start('command_sequence', {
        'commands': [0.1, 0.5, 600.0], 'enable_stamped_cmd_vel': True, 'loop': True,
        'wait_for_topics': ['odom']})
    graph.wait_for(lambda: len(commands) > 20, 'zeros')
    assert [twist for _, twist in changes(commands)] == [(0.0, 0.0)]
    assert stamp_ns(commands[-1]) > stamp_ns(commands[0]) > 0
    odometry = graph.node.create_publisher(Odometry, 'odom', 1)

    def playing():
        odometry.publish(Odometry())
        return (0.1, 0.5) in [twist for _, twist in changes(commands)]

    graph.wait_for(playing, 'the course')
    assert sequence.stop() == 0
    graph.wait_for(lambda: changes(commands)[-1][1] == (0.0, 0.0), 'zero at the end')


@pytest.mark.parametrize('content, words', [
    ('', 'expected also'),
    ('time_sec,linear_x\n0,1\n', "['angular_z']"),
    ('time_sec,linear_x,angular_z\n', 'no rows'),
    ('time_sec,linear_x,angular_z\n0,0.1,0\n1,fast,0\n', 'row 2'),
    ('time_sec,linear_x,angular_z\n0,0.1,0\n1,nan,0\n', 'linear_x in row 2 is nan'),
    ('time_sec,linear_x,angular_z\n1,0.1,0\n0,0.1,0\n', 'sorted'),
])
def test_a_bad_recording_is_refused_with_the_row(diffdrive, tmp_path, content, words):
    recording = tmp_path / 'drive.csv'
    recording.write_text(content)
    refused = refusal(diffdrive, 'command_sequence', {'recording': str(recording)})
    assert 'drive.csv' in refused and words in refused


ROBOT = nodes('command_sequence', 'diff_drive_controller', 'simulated_base')
EXACT = {**KHEPERA, 'enable_stamped_cmd_vel': True, 'stamp_tolerance': 5.0, 'cmd_vel_timeout': 5.0,
         'enable_odom_tf': False, 'wait_for_topics': ['odom']}


def test_the_course_closes_through_controller_and_base_at_two_joints_a_side(diffdrive):
    robot = diffdrive(ROBOT, params={
        **EXACT, 'left_wheel_names': ['fl', 'rl'], 'right_wheel_names': ['fr', 'rr'],
        'commands': [0.1, 2.0, 0.2, 0.1, -2.0, 0.2, -0.1, 2.0, 0.2, -0.1, -2.0, 0.2]})
    robot.advance_until(lambda: robot.odom.x > 0.02, timeout=2.0)
    robot.advance(2.0)
    final = last(robot, 'odom')
    assert final.pose.pose.position.x == pytest.approx(0.0, abs=1e-9)
    assert final.pose.pose.position.y == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize('clockwise, radius', [(True, 0.0), (False, 0.03)])
def test_the_square_of_umbmark_closes_either_way_round(diffdrive, clockwise, radius):
    robot = diffdrive(ROBOT, params={
        **EXACT, 'square_side': 0.1, 'square_speed': 0.5, 'square_yaw_rate': 8.0,
        'square_pause': 0.1, 'square_clockwise': clockwise, 'square_corner_radius': radius})
    robot.advance(5.0)
    odometry = messages(robot, 'odom')
    final = odometry[-1]
    assert final.twist.twist.linear.x == 0.0
    assert final.pose.pose.position.x == pytest.approx(0.0, abs=1e-9)
    assert final.pose.pose.position.y == pytest.approx(0.0, abs=1e-9)
    assert abs(final.pose.pose.orientation.w) == pytest.approx(1.0, abs=1e-12)
    side = -1.0 if clockwise else 1.0
    reached = max(side * message.pose.pose.position.y for message in odometry)
    assert reached == pytest.approx(0.1, abs=0.01)
    assert min(side * message.pose.pose.position.y for message in odometry) > -0.01


def test_two_courses_at_once_are_refused(diffdrive):
    assert 'square_side is 1.0' in refusal(diffdrive, 'command_sequence', {
        'square_side': 1.0, 'commands': [0.1, 0.0, 1.0]})


@pytest.mark.parametrize('settings', [
    {'square_rounds': 2, 'commands': [0.1, 0.0, 1.0]},
    {'square_rounds': 2, 'square_side': 1.0, 'loop': True}], ids=['no square', 'loop'])
def test_rounds_that_would_not_be_driven_are_refused(settings):
    with initialised(settings), pytest.raises(ConfigurationError, match='square_rounds is 2'):
        CommandSequence()


def test_a_step_back_of_the_time_that_clock_messages_tell_is_no_time_of_the_course():
    """With rclpy's own clock and timers, which are told the time one message after the other."""
    said, now_ns, period_ns, passed = [], 100 * 10**9, 20_000_000, 0
    with beside(CommandSequence, {
            'use_sim_time': True, 'commands': [0.1, 0.0, 2.0], 'publish_rate': 50.0}) as (
                node, test, spin_until):
        test.create_subscription(Twist, 'cmd_vel', said.append, DEEP)
        clock = test.create_publisher(Clock, '/clock', 1)

        def tell(time_ns):
            """Say the time until it is heard."""
            spin_until(lambda: clock.publish(clock_at(time_ns)) or (
                node.get_clock().now().nanoseconds == time_ns))

        def tick(time_ns):
            """Let a period pass, in which the sequence says something."""
            sent = node.health.sent
            tell(time_ns)
            spin_until(lambda: node.health.sent > sent)

        spin_until(lambda: node.count_subscribers('cmd_vel'))
        tell(now_ns)
        while not node.begun():
            tick(now_ns := now_ns + period_ns)
        begun_ns = round(node.elapsed_s() * 1e9)
        while not node.done:
            if passed == 50:
                tell(now_ns := now_ns - 50 * 10**9)
            passed += 1
            tick(now_ns := now_ns + period_ns)
        spin_until(lambda: said and said[-1].linear.x == 0.0 and len(said) > 2)
    assert node.counts['clock steps'] == 1
    assert round(node.elapsed_s() * 1e9) == begun_ns + passed * period_ns
    assert passed == pytest.approx(100, abs=1)  # periods of the two seconds
    assert {message.linear.x for message in said} == {0.0, 0.1}
