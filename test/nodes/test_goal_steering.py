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

"""``goal_steering``: arrives, says so, and leaves the wheels at rest whatever ends it."""

import math
import re
import signal

from geometry_msgs.msg import PoseStamped, Twist, TwistStamped
from nav_msgs.msg import Odometry, Path as PathMessage
import pytest
from sensor_msgs.msg import JointState
from support.graph import CONFIG, KHEPERA, set_stamp, stamp_ns

FAST = {'max_speed': 0.5, 'max_yaw_rate': 4.0}
QUICK = {**FAST, 'distance_gain': 2.0, 'heading_gain': 6.0, 'publish_rate': 50.0}


def stamped_pose(x, y, theta=0.0, frame_id='odom'):
    message = PoseStamped()
    message.header.frame_id = frame_id
    message.pose.position.x, message.pose.position.y = x, y
    message.pose.orientation.z, message.pose.orientation.w = (
        math.sin(0.5 * theta), math.cos(0.5 * theta))
    return message


class StandIn:
    """Odometry of a robot that stands, published as long as somebody waits."""

    def __init__(self, graph):
        self.graph, self.frame_id, self.x = graph, 'odom', 0.0
        self.publisher = graph.publisher(Odometry, 'odom')

    def until(self, condition, what):
        def fed():
            message = Odometry()
            message.header.frame_id, message.pose.pose.position.x = self.frame_id, self.x
            message.pose.pose.orientation.w = 1.0
            set_stamp(message, self.graph.now_ns())
            self.publisher.publish(message)
            return condition()

        return self.graph.wait_for(fed, what)


def square(graph, settings):
    """Drive the square of config/goal.yaml; return {stamp: pose} of the belief, and the log."""
    odometry = graph.collect(Odometry, 'odom')
    sim = graph.start('diffdrive_sim', args=[
        '--ros-args', '--params-file', str(CONFIG / 'goal.yaml'), *settings])
    graph.wait_for(lambda: not sim.running, 'the square')
    assert sim.wait() == 0, sim.output
    for subscription in [each for each in graph.node.subscriptions if each.topic_name == '/odom']:
        graph.node.destroy_subscription(subscription)
    return {stamp_ns(message): (
        message.pose.pose.position.x, message.pose.pose.position.y,
        message.pose.pose.orientation.z) for message in odometry}, sim.output


def test_the_square_of_goals_ends_within_the_tolerance_of_belief_five_times_alike(graph):
    """The table, and whatever another process hears to the bit: a run waits for nobody."""
    settings = ['-p', 'real_time_factor:=0.0']
    first, output = square(graph, settings)
    assert output.count('arrived at the goal') == 4
    x, y, yaw = map(float, re.search(r'belief.*?(\S+) +(\S+) +(\S+)\n', output).groups())
    assert math.hypot(x, y) <= 0.0101 and abs(yaw) <= math.degrees(0.0201)
    table = output[output.index('belief ('):output.index('times real time') - 5].strip()
    assert float(re.search(r'drift +(\S+) mm', table)[1]) > 10.0  # where it really went
    for _ in range(4):
        again, output = square(graph, settings)
        assert table in output
        both = first.keys() & again.keys()
        assert all(first[stamp] == again[stamp] for stamp in both)


@pytest.mark.parametrize('law', ['heading', 'point'])
def test_the_other_laws_drive_the_square_as_well(graph, law):
    _, output = square(graph, ['-p', 'real_time_factor:=0.0', '-p', f'goal_steering:law:={law}'])
    assert output.count('arrived at the goal') == 4


def robot(graph):
    """Start a robot that obeys for ever, and return its odometry and wheel rates."""
    graph.start('diff_drive_controller', {**KHEPERA, 'cmd_vel_timeout': 0.0})
    graph.start('simulated_base', {
        **KHEPERA, 'enable_odom_tf': False, 'command_timeout': 0.0})
    odometry, rates = graph.collect(Odometry, 'odom'), graph.collect(JointState, 'wheel_rates')
    graph.wait_for(lambda: odometry, 'odometry')
    return odometry, rates


def test_a_goal_as_rviz_publishes_it_is_driven_to_and_the_robot_rests_there(graph):
    odometry, rates = robot(graph)
    steering = graph.start('goal_steering', QUICK)
    graph.publisher(PoseStamped, 'goal_pose').publish(stamped_pose(0.2, 0.1, 1.0))
    graph.wait_for(lambda: 'arrived at the goal' in steering.output, 'arrival')
    graph.wait_for(lambda: list(rates[-1].velocity) == [0.0, 0.0], 'rest')
    done = graph.now_ns()
    pose = graph.wait_for(lambda: stamp_ns(odometry[-1]) > done and odometry[-1], 'odometry')
    at = pose.pose.pose.position
    assert math.hypot(at.x - 0.2, at.y - 0.1) <= 0.04  # what it goes on until it hears
    assert abs(2.0 * math.asin(pose.pose.pose.orientation.z) - 1.0) <= 0.2


def test_a_path_is_driven_to_its_end(graph):
    odometry, rates = robot(graph)
    steering = graph.start('goal_steering', {
        **QUICK, 'lookahead': 0.05, 'enable_stamped_cmd_vel': False})
    message = PathMessage(poses=[stamped_pose(0.2, 0.0), stamped_pose(0.2, 0.2)])
    message.header.frame_id = 'odom'
    graph.publisher(PathMessage, 'path').publish(message)
    graph.wait_for(lambda: 'arrived at the path of 2 points' in steering.output, 'arrival')
    graph.wait_for(lambda: list(rates[-1].velocity) == [0.0, 0.0], 'rest')
    done = graph.now_ns()
    pose = graph.wait_for(lambda: stamp_ns(odometry[-1]) > done and odometry[-1], 'odometry')
    assert math.dist((pose.pose.pose.position.x, pose.pose.pose.position.y), (0.2, 0.2)) <= 0.04


@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGTERM])
def test_a_signal_leaves_the_wheels_at_rest(graph, number):
    _, rates = robot(graph)
    steering = graph.start('goal_steering')
    graph.publisher(PoseStamped, 'goal_pose').publish(stamped_pose(50.0, 0.0))
    graph.wait_for(lambda: rates and any(rates[-1].velocity), 'the robot to drive')
    assert steering.stop(number) == 0, steering.output
    graph.wait_for(lambda: list(rates[-1].velocity) == [0.0, 0.0], 'the last word')


def test_silence_of_odometry_leaves_the_wheels_at_rest_until_it_is_back(graph):
    graph.start('diff_drive_controller', {**KHEPERA, 'cmd_vel_timeout': 0.0})
    steering = graph.start('goal_steering', {'odom_timeout': 0.3, 'patience': 60.0})
    rates, stand_in = graph.collect(JointState, 'wheel_rates'), StandIn(graph)
    graph.publisher(PoseStamped, 'goal_pose').publish(stamped_pose(1.0, 0.0))
    stand_in.until(lambda: rates and any(rates[-1].velocity), 'the robot to drive')
    graph.wait_for(lambda: list(rates[-1].velocity) == [0.0, 0.0], 'rest in silence')
    assert "no odometry on '/odom' for 0.3 s" in steering.output
    stand_in.until(lambda: any(rates[-1].velocity), 'the robot to drive again')
    assert 'odometry is back' in steering.output


@pytest.mark.quick
def test_odometry_of_one_stamp_is_as_good_as_none(graph):
    steering = graph.start('goal_steering', {'odom_timeout': 0.3})
    odometry = graph.publisher(Odometry, 'odom')
    commands = graph.collect(Twist, 'cmd_vel')
    graph.publisher(PoseStamped, 'goal_pose').publish(stamped_pose(1.0, 0.0))
    message = Odometry()
    message.header.frame_id, message.pose.pose.orientation.w = 'odom', 1.0
    set_stamp(message, graph.now_ns())

    def told_again():
        odometry.publish(message)
        return 'is to stand still' in steering.output

    graph.wait_for(told_again, 'the timeout')
    graph.wait_for(lambda: commands and commands[-1].linear.x == 0.0, 'zeros')


def test_goals_of_another_frame_are_refused_and_end_where_odometry_gets_another(graph):
    steering = graph.start('goal_steering', {'patience': 60.0, 'enable_stamped_cmd_vel': True})
    stand_in, goals = StandIn(graph), graph.publisher(PoseStamped, 'goal_pose')
    commands = graph.collect(TwistStamped, 'cmd_vel')
    goals.publish(stamped_pose(1.0, 0.0))
    stand_in.until(lambda: commands and commands[-1].twist.linear.x, 'the robot to drive')
    goals.publish(stamped_pose(1.0, 0.0, frame_id='map'))
    stand_in.until(lambda: "frame_id is 'map', expected 'odom'" in steering.output, 'refusal')
    stand_in.frame_id = 'elsewhere'
    stand_in.until(lambda: "odometry in 'elsewhere'" in steering.output, 'the end')
    graph.wait_for(lambda: commands[-1].twist.linear.x == 0.0, 'rest')
    assert commands[-1].header.frame_id == 'base_link'


def test_a_robot_that_comes_no_nearer_gives_up_and_says_so(graph):
    steering = graph.start('goal_steering', {'patience': 0.5})
    stand_in, commands = StandIn(graph), graph.collect(Twist, 'cmd_vel')
    graph.publisher(PoseStamped, 'goal_pose').publish(stamped_pose(1.0, 0.0))
    stand_in.until(lambda: 'came no nearer for 0.5 s, 1.000 m before it' in steering.output,
                   'the end')
    graph.wait_for(lambda: commands and commands[-1].linear.x == 0.0, 'rest')
    count = len(commands)
    stand_in.until(lambda: True, 'odometry')
    assert steering.running and len(commands) == count  # silent without a goal


def test_a_bad_goal_is_refused_and_the_one_before_stays(graph):
    steering = graph.start('goal_steering', {'patience': 60.0})
    stand_in, goals = StandIn(graph), graph.publisher(PoseStamped, 'goal_pose')
    commands = graph.collect(Twist, 'cmd_vel')
    goals.publish(stamped_pose(1.0, 0.0))
    stand_in.until(lambda: commands and commands[-1].linear.x, 'the robot to drive')
    goals.publish(stamped_pose(math.nan, 0.0))
    stand_in.until(lambda: 'position (x, y) is (nan, 0.0)' in steering.output, 'refusal')
    count = len(commands)
    stand_in.until(lambda: len(commands) > count + 2, 'commands')
    assert commands[-1].linear.x > 0.0


@pytest.mark.parametrize(('settings', 'words'), [
    ({'law': 'fuzzy'}, "law is 'fuzzy', expected one of"),
    ({'goals': [1.0, 2.0]}, 'goals has 2 numbers, expected three'),
    ({'law': 'heading', 'heading_gain': 0.5}, 'heading_gain is 0.5, expected above'),
    ({'odom_timeout': 0.0}, 'odom_timeout is 0.0'),
    ({'max_speed': -0.2}, 'max_speed is -0.2')])
def test_bad_settings_are_refused_by_name_and_value(graph, settings, words):
    steering = graph.start('goal_steering', settings)
    assert steering.wait() == 2
    assert words in steering.output and 'Traceback' not in steering.output
