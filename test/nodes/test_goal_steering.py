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

from geometry_msgs.msg import PoseStamped, Twist
from nav_msgs.msg import Odometry, Path as PathMessage
import pytest
from sensor_msgs.msg import JointState
from support.graph import CONFIG, KHEPERA, odometry_of, pose_of, put, stamp_ns
from support.stepped import last, nodes, refusal, time_ns

pytestmark = pytest.mark.ros

FAST = {'max_speed': 0.5, 'max_yaw_rate': 4.0}
QUICK = {**FAST, 'distance_gain': 2.0, 'heading_gain': 6.0, 'publish_rate': 50.0}


def stamped_pose(x, y, theta=0.0, frame_id='odom'):
    message = PoseStamped()
    message.header.frame_id = frame_id
    put(message.pose, x, y, theta)
    return message


class StandIn:
    """Odometry of a robot that stands, in every step of the clock, and what is made of it."""

    def __init__(self, diffdrive, capfd, params, *others):
        self.robot = diffdrive(nodes('goal_steering', *others), params=params)
        self._capfd, self.output, self.frame_id = capfd, '', 'odom'

    def send(self, goal):
        self.robot.publish('goal_pose', goal)

    def tell(self, at_ns=None):
        self.robot.publish('odom', odometry_of(
            time_ns(self.robot) if at_ns is None else at_ns, (0.0, 0.0, 0.0), self.frame_id))

    def until(self, condition, tell=True):
        """Let time pass until a condition holds."""
        def held():
            self.output += self._capfd.readouterr().err
            return condition() or (tell and self.tell())

        self.robot.advance_until(held, timeout=10.0)

    def speed(self):
        """Return the forward speed that was commanded last."""
        message = last(self.robot, 'cmd_vel')
        return getattr(message, 'twist', message).linear.x

    def commanded(self):
        return self.robot.history('cmd_vel') and self.speed()

    def stopped(self):
        return self.speed() == 0.0


@pytest.fixture
def stand_in(diffdrive, capfd):
    """Return what makes a stand-in, by the parameters of the steering."""
    return lambda *others, **params: StandIn(diffdrive, capfd, params, *others)


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


def driven(diffdrive, topic, message, **settings):
    """Let a robot that obeys for ever drive to something; return where it comes to rest."""
    robot = diffdrive(
        nodes('diff_drive_controller', 'simulated_base', 'goal_steering',
              goal_steering={**QUICK, **settings}),
        params={**KHEPERA, 'cmd_vel_timeout': 0.0, 'command_timeout': 0.0,
                'enable_odom_tf': False})
    robot.advance(0.1)
    robot.publish(topic, message)
    robot.advance_until(lambda: robot.odom.speed > 0.1, timeout=5.0)
    robot.advance_until(
        lambda: list(last(robot, 'wheel_rates').velocity) == [0.0, 0.0], timeout=20.0)
    robot.advance(0.1)
    assert robot.odom.speed == 0.0
    return pose_of(last(robot, 'odom'))


def test_a_goal_as_rviz_publishes_it_is_driven_to_and_the_robot_rests_there(diffdrive, capfd):
    pose = driven(diffdrive, 'goal_pose', stamped_pose(0.2, 0.1, 1.0))
    assert 'arrived at the goal' in capfd.readouterr().err
    assert math.hypot(pose.x - 0.2, pose.y - 0.1) <= 0.04  # what it goes on until it hears
    assert abs(pose.theta - 1.0) <= 0.2


def test_a_path_is_driven_to_its_end(diffdrive, capfd):
    message = PathMessage(poses=[stamped_pose(0.2, 0.0), stamped_pose(0.2, 0.2)])
    message.header.frame_id = 'odom'
    pose = driven(diffdrive, 'path', message, lookahead=0.05, enable_stamped_cmd_vel=False)
    assert 'arrived at the path of 2 points' in capfd.readouterr().err
    assert math.dist(pose[:2], (0.2, 0.2)) <= 0.04


@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGTERM])
def test_a_signal_leaves_the_wheels_at_rest(graph, number):
    graph.start('diff_drive_controller', {**KHEPERA, 'cmd_vel_timeout': 0.0})
    graph.start('simulated_base', {
        **KHEPERA, 'enable_odom_tf': False, 'command_timeout': 0.0})
    rates = graph.collect(JointState, 'wheel_rates')
    steering = graph.start('goal_steering')
    graph.publisher(PoseStamped, 'goal_pose').publish(stamped_pose(50.0, 0.0))
    graph.wait_for(lambda: rates and any(rates[-1].velocity), 'the robot to drive')
    assert steering.stop(number) == 0, steering.output
    graph.wait_for(lambda: list(rates[-1].velocity) == [0.0, 0.0], 'the last word')


def test_silence_of_odometry_leaves_the_wheels_at_rest_until_it_is_back(stand_in):
    steering = stand_in('diff_drive_controller', **KHEPERA, cmd_vel_timeout=0.0,
                        odom_timeout=0.3, patience=60.0)

    def turning():
        return any(last(steering.robot, 'wheel_rates').velocity)

    steering.send(stamped_pose(1.0, 0.0))
    steering.until(turning)
    silent = steering.robot.time
    steering.until(lambda: not turning(), tell=False)
    assert 0.28 < steering.robot.time - silent < 0.42  # and a period
    assert "no odometry on '/odom' for 0.3 s" in steering.output
    steering.until(turning)
    assert 'odometry has resumed' in steering.output


def test_odometry_of_one_stamp_is_as_good_as_none(stand_in):
    steering = stand_in(odom_timeout=0.3)
    steering.robot.listen(Twist, 'cmd_vel')
    steering.robot.advance(0.1)
    steering.send(stamped_pose(1.0, 0.0))
    steering.until(lambda: 'the robot is stopped' in steering.output or steering.tell(10**8),
                   tell=False)
    steering.until(steering.stopped, tell=False)


def test_goals_of_another_frame_are_refused_and_end_where_odometry_gets_another(stand_in):
    steering = stand_in(patience=60.0, enable_stamped_cmd_vel=True)
    steering.send(stamped_pose(1.0, 0.0))
    steering.until(steering.commanded)
    steering.send(stamped_pose(1.0, 0.0, frame_id='map'))
    steering.until(lambda: "frame_id is 'map', expected 'odom'" in steering.output)
    assert steering.speed() > 0.0
    steering.frame_id = 'elsewhere'
    steering.until(lambda: "odometry in 'elsewhere'" in steering.output)
    steering.until(steering.stopped, tell=False)
    assert last(steering.robot, 'cmd_vel').header.frame_id == 'base_link'


def test_a_robot_that_comes_no_nearer_gives_up_and_says_so(stand_in):
    steering = stand_in(patience=0.5)
    steering.send(stamped_pose(1.0, 0.0))
    steering.until(
        lambda: 'no progress for 0.5 s, 1.000 m away from it' in steering.output)
    steering.until(steering.stopped, tell=False)
    count, end = len(steering.robot.history('cmd_vel')), steering.robot.time + 0.5
    steering.until(lambda: steering.robot.time > end)
    assert len(steering.robot.history('cmd_vel')) == count  # silent without a goal


def test_a_bad_goal_is_refused_and_the_one_before_stays(stand_in):
    steering = stand_in(patience=60.0)
    steering.send(stamped_pose(1.0, 0.0))
    steering.until(steering.commanded)
    steering.send(stamped_pose(math.nan, 0.0))
    steering.until(lambda: 'position (x, y) is (nan, 0.0)' in steering.output)
    count = len(steering.robot.history('cmd_vel'))
    steering.until(lambda: len(steering.robot.history('cmd_vel')) > count + 2)
    assert steering.speed() > 0.0


@pytest.mark.parametrize(('settings', 'words'), [
    ({'law': 'fuzzy'}, "law is 'fuzzy', expected one of"),
    ({'goals': [1.0, 2.0]}, 'goals has 2 numbers, expected three'),
    ({'law': 'heading', 'heading_gain': 0.5}, 'heading_gain is 0.5, expected above'),
    ({'odom_timeout': 0.0}, 'odom_timeout is 0.0'),
    ({'max_speed': -0.2}, 'max_speed is -0.2')])
def test_bad_settings_are_refused_by_name_and_value(diffdrive, settings, words):
    assert words in refusal(diffdrive, 'goal_steering', settings)
