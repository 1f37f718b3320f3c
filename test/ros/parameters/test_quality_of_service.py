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
"""Quality of service that the YAML overrides: for every topic, in every node, or refused."""

from itertools import cycle

from diffdrive_kinematics.nodes.diff_drive_controller import DiffDriveController
from diffdrive_kinematics.nodes.diffdrive_sim import DiffDriveSim
from diffdrive_kinematics.ros.parameters.configuration_error import ConfigurationError
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
import pytest
from rclpy.qos import QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import JointState
from std_msgs.msg import Empty
from support.graph import arguments, CONFIG, KHEPERA, twist, wheel_motion
from support.inside import initialised

BEST_EFFORT = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
CONTROLLER = 'diff_drive_controller'
ENDPOINTS = {
    CONTROLLER: (
        {**KHEPERA, 'wheel_commands_topic': 'commands', 'publish_limited_velocity': True},
        ['wheel_rates', 'commands', 'cmd_vel_out'], ['cmd_vel']),
    'wheel_noise': ({'wheel_radius': 0.021}, ['noisy_wheel_rates'], ['wheel_rates']),
    'simulated_base': (
        {**KHEPERA, 'enable_odom_tf': False}, ['odom', 'joint_states'], ['wheel_rates']),
    'command_sequence': (
        {'commands': [0.1, 0.0, 60.0], 'wait_for_topics': ['awaited']}, ['cmd_vel'],
        ['awaited']),
    'forward_projection': (
        KHEPERA, ['projected_poses', 'projected_boundary'], ['odom', 'wheel_rates'])}


def override(topic, end, policy):
    return f'qos_overrides./{topic}.{end}.{policy}'


@pytest.mark.parametrize('executable', ENDPOINTS)
def test_every_topic_of_every_node_can_be_best_effort(graph, executable):
    parameters, published, heard = ENDPOINTS[executable]
    overrides = {
        override(topic, end, 'reliability'): 'best_effort'
        for end, topics in (('publisher', published), ('subscription', heard))
        for topic in topics}
    graph.node.create_publisher(Odometry, 'awaited', 1)
    process = graph.start(executable, {**parameters, **overrides})

    def reliabilities():
        return [end.qos_profile.reliability for topics, look in (
            (published, graph.node.get_publishers_info_by_topic),
            (heard, graph.node.get_subscriptions_info_by_topic))
            for topic in topics for end in look(f'/{topic}') if end.node_name == executable]

    graph.wait_for(lambda: len(reliabilities()) == len(overrides), 'all ends of all topics')
    assert set(reliabilities()) == {ReliabilityPolicy.BEST_EFFORT}
    assert process.stop() == 0
    assert 'is ignored' not in process.output, process.output


def test_topics_without_override_are_reliable(graph):
    graph.start(CONTROLLER, {**KHEPERA, override('cmd_vel', 'subscription', 'depth'): 3})
    found = graph.wait_for(
        lambda: graph.node.get_publishers_info_by_topic('/wheel_rates')
        and graph.node.get_subscriptions_info_by_topic('/cmd_vel'), 'the controller')
    assert found[0].qos_profile.reliability == ReliabilityPolicy.RELIABLE


def test_a_base_hears_a_best_effort_driver_where_the_yaml_says_so(graph, tmp_path):
    params = tmp_path / 'robot.yaml'
    params.write_text(
        '/**:\n  ros__parameters:\n    wheel_radius: 0.021\n    wheel_separation: 0.0885\n'
        '    enable_odom_tf: false\n    wheel_motion_topic: joint_states\n'
        "    joint_states_topic: ''\n    qos_overrides:\n      /joint_states:\n"
        '        subscription: {reliability: best_effort, depth: 1}\n')
    base = graph.start('simulated_base', args=['--ros-args', '--params-file', str(params)])
    odometry = graph.collect(Odometry, 'odom')
    driver = graph.node.create_publisher(JointState, 'joint_states', BEST_EFFORT)
    angle = iter(range(10**9))

    def driving():
        position = float(next(angle))
        driver.publish(wheel_motion(graph.now_ns(), [position, position]))
        return odometry and odometry[-1].pose.pose.position.x > 0.0

    graph.wait_for(driving, 'motion')
    assert 'is ignored' not in base.output


@pytest.mark.parametrize('name, value, words', [
    (override('wheel_rates', 'publisher', 'reliability'), 'best-effort', 'best_effort'),
    (override('wheel_rates', 'publisher', 'depth'), 0, 'an integer from 1'),
    (override('wheel_rates', 'publisher', 'depth'), 'deep', 'an integer from 1'),
    (override('wheel_rates', 'publisher', 'deadline'), -1, 'an integer of nanoseconds from 0'),
    (override('wheel_rates', 'publisher', 'reliabilty'), 'reliable', 'POLICY one of reliability'),
    (override('wheel_rates', 'publishers', 'depth'), 1, 'END publisher or subscription'),
    (override('cmd_vel', 'subscription', 'lifespan'), 1, 'for a publisher only'),
    ('qos_overrides.wheel_rates.publisher.depth', 1, 'the resolved name'),
    (override('odom', 'publisher', 'durability'), 'transient', 'transient_local'),
])
@pytest.mark.ros
def test_a_bad_override_is_refused_by_name_value_and_rule(name, value, words):
    with initialised({**KHEPERA, name: value}), pytest.raises(ConfigurationError) as refused:
        DiffDriveController()
    assert 'refuses to start' in str(refused.value)
    assert name in str(refused.value) and words in str(refused.value)


@pytest.mark.parametrize('end, policy, value', [
    ('publisher', 'reliability', 'best_effort'), ('subscription', 'reliability', 'best_effort'),
    ('publisher', 'depth', 1), ('publisher', 'lifespan', 1),
    ('subscription', 'durability', 'transient_local'), ('subscription', 'deadline', 1)])
@pytest.mark.ros
def test_fast_mode_refuses_what_could_lose_a_message(end, policy, value):
    name = override('wheel_rates', end, policy)
    demo = arguments({name: value}, '--params-file', str(CONFIG / 'demo.yaml'))
    with initialised(args=demo), pytest.raises(ConfigurationError) as refused:
        DiffDriveSim()
    assert f'{name} is {value!r}, expected none while the time is stepped' in str(refused.value)


def test_fast_mode_takes_overrides_that_lose_nothing(graph):
    go = graph.publisher(Empty, 'go', listeners=0)
    sim = graph.start('diffdrive_sim', {
        'real_time_factor': 0.0, override('wheel_rates', 'publisher', 'durability'):
        'transient_local', override('clock', 'publisher', 'reliability'): 'best_effort',
        override('wheel_rates', 'subscription', 'depth'): 2000},
        '-p', "command_sequence:wait_for_topics:=['go']")
    clocks = graph.wait_for(
        lambda: graph.node.get_publishers_info_by_topic('/clock'), 'the clock')
    assert clocks[0].qos_profile.reliability == ReliabilityPolicy.BEST_EFFORT
    graph.play_out(sim, go)
    assert 'was lost' not in sim.output and 'times real time' in sim.output


@pytest.mark.parametrize('settings, profile', [
    ({'reliability': 'best_effort'}, BEST_EFFORT), ({}, BEST_EFFORT),
    ({'depth': 1}, QoSProfile(depth=1)), ({'depth': 300}, QoSProfile(depth=1000)),
    ({'history': 'keep_all'}, QoSProfile(depth=1000))])
def test_the_last_word_is_heard_whatever_the_quality_of_service(graph, settings, profile):
    controller = graph.start(CONTROLLER, {**KHEPERA, 'cmd_vel_timeout': 0.0, **{
        override('wheel_rates', 'publisher', policy): value
        for policy, value in settings.items()}})
    rates = []
    graph.node.create_subscription(JointState, 'wheel_rates', rates.append, profile)
    graph.publisher(Twist, 'cmd_vel').publish(twist(0.1, 0.0))
    graph.wait_for(lambda: rates and any(rates[-1].velocity), 'the robot to drive')
    assert controller.stop() == 0
    graph.wait_for(lambda: list(rates[-1].velocity) == [0.0, 0.0], 'the last word')
    assert 'not acknowledged' not in controller.output


def test_the_last_word_is_repeated_for_who_does_not_acknowledge(graph):
    controller = graph.start(CONTROLLER, {**KHEPERA, 'cmd_vel_timeout': 0.0, 'publish_rate': 0.01})
    rates = []
    graph.node.create_subscription(
        JointState, 'wheel_rates', rates.append,
        QoSProfile(depth=100, reliability=ReliabilityPolicy.BEST_EFFORT))
    commands = graph.publisher(Twist, 'cmd_vel')
    speeds = cycle((0.1, 0.2))
    graph.wait_for(  # at another speed each time, as nothing repeats the rates
        lambda: commands.publish(twist(next(speeds), 0.0)) or rates and any(rates[-1].velocity),
        'the robot to drive')
    assert controller.stop() == 0
    graph.wait_for(
        lambda: [any(message.velocity) for message in rates[-3:]] == [False] * 3,
        'the last word, three times')
