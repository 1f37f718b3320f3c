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

"""What a test gets to hear of a robot that it makes, asks or watches wrongly."""

import re
import subprocess
import sys
import threading

from diffdrive_kinematics.testing import Robot, topics
from diffdrive_kinematics.testing.composition import composition
from diffdrive_kinematics.testing.matching import has_subscribers
from diffdrive_kinematics.testing.processes import ProcessFailed
from geometry_msgs.msg import PoseStamped, Twist
import numpy
import pytest
import rclpy
from rclpy.duration import Duration
from rclpy.qos import DurabilityPolicy, qos_profile_sensor_data, QoSProfile
from std_msgs.msg import Empty
from std_srvs.srv import Trigger
from support.graph import twist
from support.planners import NOISE, ROBOT
from support.stepped import nodes
import yaml

pytestmark = pytest.mark.ros


LATCHED = 'QoSProfile(depth=1, durability=rclpy.qos.DurabilityPolicy.TRANSIENT_LOCAL)'


def adapted(files, old, new):
    """Return the planner of the tutorial with another text in place of one."""
    text = (files / 'my_planner.py').read_text()
    assert old in text
    path = files / 'adapted.py'
    path.write_text(text.replace(old, new))
    return path


@pytest.fixture
def latched(files):
    """Return a planner that asks for goals of before it came."""
    return adapted(files, 'self.on_goal, 10', f'self.on_goal, rclpy.qos.{LATCHED}')


def goal_at(x):
    """Return a goal [m] ahead, or behind."""
    goal = PoseStamped()
    goal.pose.position.x = x
    return goal


def python(text):
    """Return a command that runs some Python."""
    return [sys.executable, '-c', text, '--']


@pytest.mark.parametrize('options, words', [
    ({'params': {**ROBOT, 'wheel_radios': 0.1}},
     "params has 'wheel_radios', expected a parameter of a node of this package, did you "
     "mean 'wheel_radius'?"),
    ({'params': ROBOT, 'noise': {'left_biass': 0.1}},
     "noise has 'left_biass', expected a parameter of wheel_noise, did you mean 'left_bias'?"),
    ({'params': ROBOT, 'noise': {'cmd_vel_timeout': 0.1}}, "noise has 'cmd_vel_timeout', exp"),
    ({'params': {**ROBOT, 3: 1}}, 'params has 3, expected a parameter'),
    ({'params': {**ROBOT, 'linear': {'x': {'max_velocityy': 1.0}}}},
     "params has 'linear.x.max_velocityy', expected"),
    ({'params': {**ROBOT, 'seed': object()}}, 'seed is <object .*, expected a number'),
    ({'params': {**ROBOT, 'seed': {1, 2}}}, r'seed is \{1, 2\}, expected a number'),
    ({'config': {'/**': {**ROBOT, 'nodes': [3]}}}, r'nodes is \[3\], expected a list of names'),
    ({'config': {'/**': {**ROBOT, 'nodes': 5}}}, 'nodes is 5, expected a list of names'),
    ({'params': ROBOT, 'noise': {'use_stamped_vel': True}},
     "noise has 'use_stamped_vel', expected a parameter of wheel_noise"),
    ({'config': {'/**': {**ROBOT, 'nodes': 'simulated_base'}}},
     "nodes is 'simulated_base', expected a list of names"),
    ({'config': {'r1': {'base': {'ros__parameters': ROBOT}, 'wheel_radius': 0.1}}},
     'r1/wheel_radius is 0.1, expected a mapping')])
def test_parameters_that_cannot_be_meant_are_refused_by_name(diffdrive, options, words):
    with pytest.raises(ValueError, match=f'^{words}'):
        diffdrive(**options)


def test_parameters_may_be_given_as_numpy_and_paths_and_by_their_parts(diffdrive, tmp_path):
    robot = diffdrive(
        params={'wheel_radius': numpy.float64(0.033), 'wheel_separation': numpy.float64(0.16),
                'linear': {'x': {'max_velocity': numpy.float32(0.25)}},
                'recording': tmp_path / 'none.csv', 'commands': numpy.array([0.1, 0.0, 1.0])},
        noise={'seed': numpy.int64(3)})
    robot.drive(0.5, 0.0, 0.5)
    assert robot.odom.speed == pytest.approx(0.25)


def test_sections_of_a_params_file_may_stand_in_their_namespaces(diffdrive):
    kinds = 'diff_drive_controller', 'simulated_base'
    robot = diffdrive(
        {'/**': {'ros__parameters': ROBOT}, 'diffdrive_sim': {'ros__parameters': {'nodes': [
            f'{kind}:/fleet/{name}/{kind}' for name in ('r1', 'r2') for kind in kinds]}},
         'fleet': {name: {kinds[0]: {'ros__parameters': {'linear': {'x': {'max_velocity': most}}}}}
                   for name, most in (('r1', 0.1), ('r2', 0.05))}})
    for name, most in (('r1', 0.1), ('r2', 0.05)):
        robot.publish(f'/fleet/{name}/cmd_vel', twist(1.0, 0.0))
        robot.advance(0.1)
        message = robot.history(f'/fleet/{name}/odom')[-1].message
        assert message.twist.twist.linear.x == pytest.approx(most)


def test_sections_of_a_params_file_may_be_in_parts_and_of_other_packages(tmp_path):
    path = tmp_path / 'robot.yaml'
    path.write_text("""
/ns/controller: {ros__parameters: {cmd_vel_timeout: 1.0}}
/ns: {controller: {ros__parameters: {publish_rate: 10.0}}}
fleet: {ros__parameters: {seed: 1}, noise: {ros__parameters: {seed: 2}}}
camera: {ros__parameters: {released: 2024-01-02}}
diffdrive_sim: {ros__parameters: {nodes: [simulated_base]}}
""")
    read = yaml.safe_load(composition(path, {}, {}, None).params)
    sections = {name: section['ros__parameters'] for name, section in read.items()}
    assert sections['/ns/controller'] == {'cmd_vel_timeout': 1.0, 'publish_rate': 10.0}
    assert sections['fleet'] == {'seed': 1} and sections['fleet/noise'] == {'seed': 2}
    assert str(sections['camera']['released']) == '2024-01-02'


@pytest.mark.parametrize('content', [b'', b'a: [1\nb: }', b'\xff\xfe\x80', b'- a', b'a: 5'])
def test_a_params_file_that_is_none_is_named(diffdrive, tmp_path, content):
    path = tmp_path / 'robot.yaml'
    path.write_bytes(content)
    with pytest.raises(ValueError, match=f'^config is {re.escape(repr(str(path)))}, expected a'):
        diffdrive(path)


@pytest.mark.parametrize('name', ['a b', 'x' * 300, '1a', 'a//b', '{this}'])
def test_names_of_topics_and_services_that_cannot_be_are_refused_by_name(diffdrive, name):
    robot = diffdrive(nodes('simulated_base'), params=ROBOT)
    word = re.escape(repr(name))
    for call in (robot.history, lambda topic: robot.drop(topic, 0.1),
                 lambda topic: robot.publish(topic, Trigger)):
        with pytest.raises(ValueError, match=f'^topic is {word}, expected a name of ROS: '):
            call(name)
    with pytest.raises(ValueError, match=f'^wait_for is {word}, expected a name of ROS: '):
        robot.advance(0.1, wait_for=name)
    with pytest.raises(ValueError, match=f'^name is {word}, expected a name of ROS: '):
        robot.call(Trigger, name, Trigger.Request())


def test_a_delay_after_the_end_of_time_is_refused(diffdrive):
    robot = diffdrive(params=ROBOT)
    with pytest.raises(ValueError, match=r'^seconds is 1e\+300, expected'):
        robot.delay('odom', 1e300)


@pytest.mark.parametrize('environment, words', [
    (['A'], r"environment is \['A'\], expected a mapping"),
    ({'A': 1}, r"environment is \{'A': 1\}, expected a mapping of text to text")])
def test_an_environment_that_cannot_be_is_refused_before_a_process_starts(
        diffdrive, environment, words):
    robot = diffdrive(params=ROBOT)
    with pytest.raises(ValueError, match=f'^{words}'):
        robot.start_process(python('pass'), environment=environment)


@pytest.mark.parametrize('name', ['ground_truth', 'wheel_noise'])
def test_the_truth_is_no_belief_where_a_node_of_it_was_killed(diffdrive, name):
    robot = diffdrive(params=ROBOT, noise={**NOISE, 'left_bias': 0.2})
    robot.drive(0.2, 0.0, 2.0)
    truth, odom = robot.truth, robot.odom
    assert truth.distance_to(odom.x, odom.y) > 0.01
    robot.kill(name)
    assert robot.odom == odom
    if name == 'wheel_noise':
        assert robot.truth == truth
    else:
        with pytest.raises(LookupError, match='no ground_truth is alive, expected one'):
            robot.truth
        robot.kill('simulated_base')
        robot.restart('ground_truth')
        with pytest.raises(LookupError, match='no simulated_base is alive, expected one'):
            robot.odom
        assert robot.truth.x == 0.0


@pytest.mark.slow
@pytest.mark.parametrize('end', ["'cmd_vel', 10", 'self.on_odom, 10'])
def test_a_process_whose_quality_of_service_does_not_fit_is_told_by_what_it_says(
        diffdrive, files, end):
    ours = {"'cmd_vel', 10": 'qos_profile_sensor_data', 'self.on_odom, 10': LATCHED}[end]
    robot = diffdrive(params=ROBOT)
    robot.start_process([sys.executable, adapted(files, end, f'{end[:-2]}rclpy.qos.{ours}')])
    robot.publish('goal_pose', goal_at(1.0))
    with pytest.raises(AssertionError, match='not within 1.0 .*[\\s\\S]*incompatible QoS'):
        robot.advance_until(lambda: robot.odom.x > 0.05, timeout=1.0)


@pytest.mark.slow
def test_a_process_that_subscribes_to_what_is_latched_hears_the_test(diffdrive, latched):
    robot = diffdrive(params=ROBOT)
    robot.start_process([sys.executable, latched])
    robot.publish('goal_pose', goal_at(1.0))
    robot.advance_until(lambda: robot.odom.x > 0.05, timeout=2.0)
    robot.publish('goal_pose', goal_at(-1.0))
    robot.advance_until(lambda: abs(robot.odom.yaw) > 1.0, timeout=5.0)


@pytest.mark.slow
def test_a_process_that_comes_later_is_heard_by_what_it_listens_with(diffdrive, latched):
    robot = diffdrive(params=ROBOT)
    robot.listen(PoseStamped, 'goal_pose')
    robot.publish('goal_pose', PoseStamped())  # to one that asks for nothing of before
    robot.start_process([sys.executable, latched])
    robot.publish('goal_pose', goal_at(1.0))
    robot.advance_until(lambda: robot.odom.x > 0.05, timeout=2.0)


@pytest.mark.parametrize('profile, fits', [
    (QoSProfile(depth=10), True), (qos_profile_sensor_data, True),
    (QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL), False),
    (QoSProfile(depth=1, deadline=Duration(seconds=1)), False)])
def test_a_publisher_awaits_whom_it_fits_and_nobody_else(diffdrive, profile, fits):
    near, far = (diffdrive(nodes('simulated_base'), params=ROBOT)._nodes.observer
                 for _ in range(2))  # in two domains: they never find each other
    near.create_subscription(Empty, 'talk', print, profile)
    assert has_subscribers(far.create_publisher(Empty, 'talk', 100), near) is not fits
    publisher = near.create_publisher(Empty, 'talk', 100)
    while not has_subscribers(publisher, near):
        pass
    assert publisher.get_subscription_count() == fits


def test_a_message_that_another_one_publishes_is_waited_for_without_a_process(diffdrive):
    robot = diffdrive(params=ROBOT)
    context, done = rclpy.Context(), threading.Event()
    rclpy.init(context=context, domain_id=robot.domain)
    node = rclpy.create_node('other', context=context)
    publisher = node.create_publisher(Twist, 'cmd_vel', 10)

    def talk():
        while not done.wait(0.01):
            publisher.publish(twist(0.1, 0.0))

    thread = threading.Thread(target=talk)
    try:
        thread.start()
        robot._stepping.wait(lambda: robot._observer.count_publishers('/cmd_vel'), 'see it', [])
        robot.advance(0.1, wait_for='cmd_vel')
    finally:
        done.set()
        thread.join()
        node.destroy_node()
        context.shutdown()
    assert len(robot.history('cmd_vel')) >= 5


def test_processes_end_although_the_robot_does_not_end_well(files, monkeypatch):
    robot = Robot(params=ROBOT)
    process = robot.start_process([sys.executable, files / 'my_planner.py'])
    end = robot._nodes.close

    def fail():
        end()
        raise RuntimeError('not well')

    monkeypatch.setattr(robot._nodes, 'close', fail)
    with pytest.raises(RuntimeError, match='not well'):
        robot.close()
    assert not process.running


def test_a_message_is_waited_for_only_while_a_process_runs_that_may_publish_it(diffdrive):
    robot = diffdrive(params=ROBOT)
    expected = "^'/cmd_vel' is waited for, and no process runs that could publish it"
    with pytest.raises(ProcessFailed, match=f'{expected}$'):
        robot.advance(0.1, wait_for='cmd_vel')
    robot.start_process(python("print('bye')"))
    with pytest.raises(ProcessFailed, match=f'{expected}\npython .* has ended[\\s\\S]*bye$'):
        robot.advance(0.1, wait_for='cmd_vel')
    assert robot.time == 0.0


def test_a_process_that_has_ended_is_not_said_to_run_and_may_write_what_is_no_text(diffdrive):
    robot = diffdrive(params=ROBOT)
    process = robot.start_process(python(r"import os; os.write(1, b'no \xff text\n')"))
    with pytest.raises(
            AssertionError, match='has ended with status 0; its output ends:\nno . text$'):
        robot.advance_until(lambda: False, timeout=0.1)
    assert process.output == 'no \ufffd text\n'


def test_of_long_lines_of_a_process_an_error_has_the_ends(diffdrive):
    robot = diffdrive(params=ROBOT)
    process = robot.start_process(python("print(('x' * 100_000 + 'end\\n') * 100)"))
    with pytest.raises(AssertionError, match='its output ends:\n[.]{3}x+end\n') as raised:
        robot.advance_until(lambda: False, timeout=0.1)
    assert len(str(raised.value)) < 40_000 < len(process.output)


def test_a_process_that_dies_is_told_at_the_step_after_it(diffdrive, files):
    path = files / 'dies.py'
    path.write_text((files / 'my_planner.py').read_text().replace(
        '        command = Twist()', '        command = Twist()\n'
        '        if self.get_clock().now().nanoseconds > 500_000_000:\n'
        "            raise RuntimeError('no plan')"))
    robot = diffdrive(params=ROBOT)
    robot.start_process([sys.executable, path])
    with pytest.raises(ProcessFailed, match=r'dies.py ended with status 1[\s\S]*no plan'):
        robot.advance(30.0)
    assert 0.5 < robot.time < 0.6


TEST_OF_DEATH = """
import sys


def test_it(diffdrive):
    robot = diffdrive(params={'wheel_radius': 0.03, 'wheel_separation': 0.1})
    process = robot.start_process([sys.executable, 'my_planner.py'])
    process._popen.send_signal(9)
    process._popen.wait()


def test_that_fails_by_itself(diffdrive):
    test_it(diffdrive)
    assert not 'this is told'
"""


@pytest.mark.slow
def test_a_process_that_died_after_the_last_step_fails_the_test_too(files):
    (files / 'test_death.py').write_text(TEST_OF_DEATH)
    run = subprocess.run(
        [sys.executable, '-m', 'pytest', '-q', '-p', 'diffdrive_kinematics.testing.plugin',
         'test_death.py'], cwd=files, capture_output=True, text=True)
    ends = [f'{number} {word}' for number, word in [(1, 'failed'), (1, 'passed'), (2, 'errors')]]
    assert run.returncode == 1 and all(
        end in run.stdout.splitlines()[-1] for end in ends), run.stdout + run.stderr
    assert run.stdout.count('ProcessFailed: python my_planner.py ended with status -9') >= 2
    assert 'this is told' in run.stdout


def test_time_goes_on_for_no_less_than_was_asked(diffdrive):
    robot = diffdrive(params=ROBOT, clock_step=0.02)
    robot.advance(0.05)
    assert robot.time == 0.06
    robot.advance(0.1 + 0.2)  # a little more than 15 steps, as it is said in decimals
    assert robot.time == 0.36
    with pytest.raises(ValueError, match='seconds is 0.019, expected at least a step'):
        robot.advance(0.019)


def test_who_does_not_listen_is_told_of_each_time(diffdrive, monkeypatch):
    robot = diffdrive(params=ROBOT)
    monkeypatch.setattr(topics, 'HEARD_S', 0.1)
    for _ in range(2):
        with pytest.raises(ProcessFailed, match="find who listens to 'nobody'"):
            robot.publish('nobody', Empty())
