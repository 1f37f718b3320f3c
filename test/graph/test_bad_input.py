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

"""Bad commands and bad parameters: refused with a clear word, and nothing moves or dies."""

import math

from diffdrive_kinematics.nodes.diffdrive_sim import node_class
from diffdrive_kinematics.nodes.simulated_base import SimulatedBase
from diffdrive_kinematics.ros.parameters.configuration_error import ConfigurationError
from geometry_msgs.msg import Twist, TwistStamped
import pytest
from rcl_interfaces.srv import GetParameters, SetParameters, SetParametersAtomically
from rclpy.parameter import Parameter
from sensor_msgs.msg import JointState
from support.graph import arguments, JOINTS, KHEPERA, twist, twist_stamped
from support.inside import initialised
from support.stepped import last, messages, nodes, tell_wheels

CONTROLLER = 'diff_drive_controller'
HELD = {**KHEPERA, 'cmd_vel_timeout': 0.0}


def parameter(name, value):
    return Parameter(name, value=value).to_parameter_msg()


def ask(robot, change, service=SetParameters):
    """Let the controller change parameters; return its answer."""
    name = 'set_parameters' + '_atomically' * (service is SetParametersAtomically)
    return robot.call(service, f'{CONTROLLER}/{name}', service.Request(parameters=change))


def values_of(robot, *names):
    return robot.call(GetParameters, f'{CONTROLLER}/get_parameters',
                      GetParameters.Request(names=names)).values


@pytest.mark.parametrize('v, w', [
    (math.nan, 0.0), (0.0, math.nan), (math.inf, 0.0), (0.1, -math.inf), (1e308, 1e308)])
@pytest.mark.ros
def test_a_command_that_is_not_finite_stops_the_robot_and_is_reported(diffdrive, capfd, v, w):
    robot = diffdrive(nodes(CONTROLLER), params=HELD)
    robot.publish('cmd_vel', twist(0.1, 0.5))
    assert any(last(robot, 'wheel_rates').velocity)
    robot.publish('cmd_vel', twist(v, w))
    assert list(last(robot, 'wheel_rates').velocity) == [0.0, 0.0]
    output = capfd.readouterr().err
    for word in ('refused', "'cmd_vel'", repr((v, w)), 'expected finite numbers'):
        assert word in output
    robot.publish('cmd_vel', twist(0.1, 0.5))
    assert any(last(robot, 'wheel_rates').velocity)
    assert all(map(math.isfinite, (
        value for message in messages(robot, 'wheel_rates') for value in message.velocity)))


REFUSED = [  # executable, parameters, words of the refusal
    (CONTROLLER, {}, ['wheel_separation is not set', 'wheel_radius is not set', '[m]']),
    (CONTROLLER, {**KHEPERA, 'wheel_radius': -0.1}, ['wheel_radius is -0.1', 'above 0']),
    (CONTROLLER, {**KHEPERA, 'wheel_radius': 0}, ['wheel_radius is 0.0', 'above 0']),
    (CONTROLLER, {**KHEPERA, 'wheel_radius': 'big'}, ["wheel_radius is 'big'", 'a number']),
    (CONTROLLER, {**KHEPERA, 'linear.x.max_deceleration': 2.0},
     ['linear.x.max_deceleration is 2.0', 'below 0']),
    (CONTROLLER, {**KHEPERA, 'wheel_rates_topic': 'cmd_vel'},
     ["wheel_rates_topic is 'cmd_vel'", 'another topic']),
    (CONTROLLER, {**KHEPERA, 'left_wheel_names': ['a'], 'right_wheel_names': ['a']},
     ["both have ['a']", 'different joints']),
    (CONTROLLER, {**KHEPERA, 'publish_rate': 1e9}, ['publish_rate is 1000000000.0', '1e6 Hz']),
    ('wheel_noise', {'wheel_radius': 0.02, 'left_bias': -1.5}, ['left_bias is -1.5', 'above -1']),
    ('wheel_noise', {'wheel_radius': 0.02, 'slip_model': 'x'}, ["slip_model is 'x'", "'travel'"]),
    ('simulated_base', {**KHEPERA, 'initial_pose': [1.0, 2.0]},
     ['initial_pose is [1.0, 2.0]', 'three finite numbers']),
    ('simulated_base', {**KHEPERA, 'odom_frame_id': 'base_link'},
     ["odom_frame_id and base_frame_id are both 'base_link'", 'different frames']),
    ('simulated_base', {**KHEPERA, 'odom_topic': 'wheel_rates'},
     ["odom_topic is 'wheel_rates'", 'another topic']),
    ('simulated_base', {**KHEPERA, 'executor': 'multi_threaded'},
     ["executor is 'multi_threaded'", "expected one of 'auto'"]),
    ('simulated_base', {**KHEPERA, 'odom_topic': 'bad-topic'},
     ["odom_topic is 'bad-topic'", 'expected a topic name']),
    ('robot_description', {**KHEPERA, 'output': 'robot.txt'},
     ["output is 'robot.txt'", 'a .urdf or .yaml file']),
    ('robot_description', {**KHEPERA, 'output': '/no/such/robot.urdf'},
     ["output is '/no/such/robot.urdf'", 'a directory that can be written']),
    ('robot_description', {**KHEPERA, 'wheel_width': 0.0}, ['wheel_width is 0.0', 'above 0']),
    ('robot_description', {**KHEPERA, 'wheel_base': -1.0}, ['wheel_base is -1.0', '0 or above']),
    ('robot_description', {**KHEPERA, 'right_wheel_names': ['left_wheel_joint']},
     ['right_wheel_names', 'different joints']),
    ('command_sequence', {}, ['commands is []', 'one of them']),
    ('command_sequence', {'commands': [0.1, 0.2]}, ['commands has 2 numbers', 'three']),
    ('command_sequence', {'commands': [0.1, 0.0, 0.0]}, ['last 0 s', 'above 0']),
    ('command_sequence', {'recording': '/no/such.csv'}, ["'/no/such.csv'", 'cannot be read']),
]


@pytest.mark.parametrize('executable, parameters, words', REFUSED)
def test_a_bad_parameter_at_start_is_refused_by_name_value_and_rule(
        executable, parameters, words):
    with initialised(parameters), pytest.raises(ConfigurationError) as refused:
        node_class(executable)(executable)
    for word in ('refuses to start', *words):
        assert word in str(refused.value)


@pytest.mark.parametrize(
    'executable, parameters, words', {each[0]: each for each in REFUSED}.values())
def test_a_process_that_is_refused_its_parameters_ends_with_status_2_and_no_traceback(
        graph, executable, parameters, words):
    process = graph.start(executable, parameters)
    assert process.wait() == 2
    assert 'Traceback' not in process.output
    for word in ('refuses to start', *words):
        assert word in process.output


@pytest.mark.parametrize('args, word', [
    (['--params-file', 'no_such.yaml'], 'no_such.yaml'),
    (['-p', 'cmd_vel_topic:=my', 'topic'], "['topic']")], ids=['file', 'argument'])
def test_a_params_file_or_an_argument_that_ros_does_not_know_is_named(graph, args, word):
    process = graph.start(CONTROLLER, args=['--ros-args', *args])
    assert process.wait() == 2
    assert word in process.output and 'Traceback' not in process.output


@pytest.mark.parametrize('change, words', [
    (parameter('wheel_radius', 0.0), ['wheel_radius is 0.0', 'above 0']),
    (parameter('wheel_radius', math.nan), ['wheel_radius is nan', 'above 0']),
    (parameter('wheel_separation_multiplier', math.inf), ['wheel_separation_multiplier is inf']),
    (parameter('wheel_radius', 'abc'), ["wheel_radius is 'abc'", 'a number']),
    (parameter('linear.x.max_acceleration', -1.0),
     ['linear.x.max_acceleration is -1.0', 'above 0']),
])
@pytest.mark.ros
def test_a_bad_parameter_at_run_time_is_refused_and_the_old_value_stays(
        diffdrive, capfd, change, words):
    robot = diffdrive(nodes(CONTROLLER), params=HELD)
    before = values_of(robot, change.name)
    answer = ask(robot, [change])
    assert not answer.results[0].successful
    output = capfd.readouterr().err
    for word in words:
        assert word in answer.results[0].reason and word in output
    assert repr(values_of(robot, change.name)) == repr(before)
    robot.publish('cmd_vel', twist(0.021, 0.0))
    assert last(robot, 'wheel_rates').velocity[0] == pytest.approx(1.0, rel=1e-12)


@pytest.mark.ros
def test_a_parameter_of_no_type_is_refused_and_what_comes_before_it_holds(diffdrive, capfd):
    robot = diffdrive(nodes(CONTROLLER), params=HELD)
    odd = parameter('wheel_separation', 0.3)
    odd.value.type = 99
    change = [parameter('wheel_radius', 0.042), odd, parameter('wheel_separation', 0.2)]
    answer = ask(robot, change)
    assert [result.successful for result in answer.results] == [True, False, False]
    assert '99' in answer.results[1].reason and '99' in capfd.readouterr().err
    answer = ask(robot, change, SetParametersAtomically)
    assert not answer.result.successful and '99' in answer.result.reason
    assert [value.double_value for value in values_of(
        robot, 'wheel_radius', 'wheel_separation')] == [0.042, KHEPERA['wheel_separation']]


@pytest.mark.ros
def test_geometry_can_be_changed_at_run_time_and_integers_are_accepted_for_doubles(diffdrive):
    robot = diffdrive(nodes(CONTROLLER), params={**HELD, 'cmd_vel_timeout': 0})
    robot.publish('cmd_vel', twist(0.021, 0.0))
    for change, expected in (
            (parameter('wheel_radius', 0.042), 0.5), (parameter('wheel_radius', 1), 0.021)):
        assert ask(robot, [change]).results[0].successful
        robot.advance(0.02)
        assert last(robot, 'wheel_rates').velocity[0] == pytest.approx(expected, rel=1e-12)


@pytest.mark.ros
def test_a_typo_in_the_yaml_is_reported_with_what_was_meant(diffdrive, capfd):
    diffdrive(nodes(CONTROLLER, diff_drive_controller={
        **KHEPERA, 'wheel_seperation_multiplier': 1.1, 'open_loop': True, 'seed': 3}))
    output = capfd.readouterr().err
    assert "'wheel_seperation_multiplier' is ignored" in output
    assert "did you mean 'wheel_separation_multiplier'" in output
    assert "'open_loop' of ros2_controllers means nothing here" in output
    assert "'seed'" not in output  # another node's


@pytest.mark.parametrize('stamped', [True, False])
def test_commands_of_the_other_type_are_reported(graph, stamped):
    controller = graph.start(CONTROLLER, {**KHEPERA, 'enable_stamped_cmd_vel': stamped})
    graph.node.create_publisher(Twist if stamped else TwistStamped, 'cmd_vel', 1)
    graph.wait_for(lambda: 'enable_stamped_cmd_vel' in controller.output, 'a report')
    assert f"carries geometry_msgs/msg/{'Twist' if stamped else 'TwistStamped'}, expected" \
        in controller.output


@pytest.mark.ros
def test_a_stamped_controller_listens_to_stamped_commands(diffdrive):
    robot = diffdrive(nodes(CONTROLLER), params={**HELD, 'enable_stamped_cmd_vel': True})
    robot.publish('cmd_vel', twist_stamped(0, 0.021, 0.0))
    assert any(last(robot, 'wheel_rates').velocity)


@pytest.mark.parametrize('name, positions, velocities, words', [
    (JOINTS, [], [math.nan, 1.0], 'expected finite numbers'),
    (JOINTS, [math.inf, 0.0], [], 'expected finite numbers'),
    (JOINTS, [], [1.0], 'velocity has 1 values, expected 2'),
    (JOINTS, [], [], 'at least one of them'),
    (JOINTS, [], [1.7e308, 1.0], 'expected finite numbers'),
    (['left_wheel_joint'], [], [1.0], "expected also ['right_wheel_joint']"),
])
@pytest.mark.ros
def test_bad_wheel_motion_is_refused_and_moves_nothing(
        diffdrive, capfd, name, positions, velocities, words):
    robot = diffdrive(nodes('simulated_base'), params={**KHEPERA, 'enable_odom_tf': False})
    robot.publish('wheel_rates', JointState(name=name, position=positions, velocity=velocities))
    robot.advance(2.0)  # a wheel that is missing may come in another message
    assert words in capfd.readouterr().err
    tell_wheels(robot, velocity=[9.0, 0.0, 0.0], names=['arm', *JOINTS])
    robot.advance(0.1)
    message = last(robot, 'joint_states')
    assert list(message.position) == list(message.velocity) == [0.0, 0.0]


@pytest.mark.ros
def test_a_name_of_its_own_is_no_topic_to_hear_once_names_are_resolved():
    args = arguments({**KHEPERA, 'wheel_motion_topic': '/r/odom'}, '-r', '__ns:=/r')
    with initialised(args=args), pytest.raises(
            ConfigurationError, match="hear itself on '/r/odom'"):
        SimulatedBase()


@pytest.mark.ros
def test_an_empty_list_in_the_yaml_is_an_empty_list(diffdrive):
    robot = diffdrive(nodes('command_sequence'), params={
        'commands': [0.1, 0.0, 0.1], 'wait_for_topics': []})
    robot.listen(Twist, 'cmd_vel')
    robot.advance(1.0)
    assert 0.1 in {message.linear.x for message in messages(robot, 'cmd_vel')}


@pytest.mark.ros
def test_two_types_of_cmd_vel_in_one_process_are_refused_by_topic(diffdrive):
    with pytest.raises(ConfigurationError, match="'/cmd_vel' cannot carry TwistStamped"):
        diffdrive(nodes('command_sequence', CONTROLLER, diff_drive_controller={
            'enable_stamped_cmd_vel': True}), params={**KHEPERA, 'commands': [0.1, 0.0, 1.0]})
