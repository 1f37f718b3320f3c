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

"""The params files of ``config/``: what they promise holds, for nodes one by one too."""

from itertools import count
import re

from diffdrive_kinematics.ros.parameters.tables import TABLES
from geometry_msgs.msg import Twist, TwistStamped
from nav_msgs.msg import Odometry
import pytest
import rclpy
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from sensor_msgs.msg import JointState
from std_msgs.msg import String
from support.graph import CONFIG, KHEPERA, twist, wheel_motion, x_of
from support.stepped import messages, nodes
import yaml

FILES = sorted(CONFIG.glob('*.yaml'))
FRAME = 'base_frame_id'


def composed_nodes(file):
    """Return (class, namespace, name) of all nodes that a file lists for diffdrive_sim."""
    sections = yaml.safe_load(file.read_text()).values()
    for entry in next((one['ros__parameters']['nodes'] for one in sections
                       if 'nodes' in one['ros__parameters']), []):
        kind, _, path = entry.partition(':')
        namespace, _, name = (path or kind).rpartition('/')
        yield kind, f'/{namespace}', name


def bases_of(file):
    """Return {namespace: {node: its base_frame_id}} of all that can run with a file."""
    nodes = {*composed_nodes(file)}
    nodes |= {(kind, namespace, kind) for kind in TABLES for _, namespace, _ in {
        ('', '/', ''), *nodes}}
    found = {}
    for kind, namespace, name in nodes:
        for entry in TABLES[kind]:
            if entry.name == FRAME:
                node = Node(name, namespace=namespace, start_parameter_services=False)
                base = node.declare_parameter(FRAME, entry.default).value
                node.destroy_node()
                found.setdefault(namespace, {})[name] = base
    return found


@pytest.mark.parametrize('file', FILES, ids=lambda file: file.stem)
def test_all_nodes_of_a_robot_name_its_base_alike_and_no_two_robots_do(file):
    """Or else the links of the URDF and the transforms of the odometry are two trees."""
    from support.domains import own_domain
    with own_domain() as domain:
        rclpy.init(args=['--ros-args', '--params-file', str(file)], domain_id=domain)
        try:
            found = bases_of(file)
        finally:
            rclpy.try_shutdown()
    assert len(found['/']) >= 5
    names = [set(bases.values()) for bases in found.values()]
    assert all(len(bases) == 1 for bases in names), found
    assert len(set().union(*names)) == len(names), found
    assert 'tf_frame_prefix' not in file.read_text()  # not all nodes have it


def params(name, *extra):
    return ['--ros-args', '--params-file', str(CONFIG / name), *extra]


def test_the_nodes_of_robot_yaml_do_the_same_each_by_itself(graph):
    processes = [graph.start(name, args=params('robot.yaml')) for name in (
        'diff_drive_controller', 'wheel_odometry', 'robot_description')]
    odometry = graph.collect(Odometry, 'odom')
    rates, limited = graph.collect(JointState, 'wheel_rates'), graph.collect(
        TwistStamped, 'cmd_vel_out')
    described = []
    graph.node.create_subscription(String, 'robot_description', described.append, QoSProfile(
        depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL))
    joints, positions = graph.publisher(JointState, 'joint_states'), count(step=0.1)

    def driven():
        joints.publish(wheel_motion(graph.now_ns(), [next(positions)] * 2, names=[
            'wheel_right_joint', 'wheel_left_joint']))
        return odometry and x_of(odometry) > 0.01 and odometry[-1]

    moved = graph.wait_for(driven, 'odometry')
    assert (moved.header.frame_id, moved.child_frame_id) == ('odom', 'base_footprint')
    assert graph.node.count_publishers('joint_states') == 1  # the driver's
    commands = graph.publisher(Twist, 'cmd_vel')
    graph.wait_for(lambda: commands.publish(twist(0.1, 0.0)) or (
        described and rates and limited), 'rates and a description')
    assert limited[-1].header.frame_id == 'base_footprint'
    assert re.search(r'<link name="base_footprint"', described[-1].data)
    for process in processes:
        assert 'section' not in process.output


@pytest.mark.parametrize('name, key, executable', [
    ('robot.yaml', '/**/wheel_odometry', 'simulated_base'),
    ('demo.yaml', '/**/simulated_base', 'wheel_odometry')])
def test_a_base_with_the_file_of_the_other_one_is_told(graph, name, key, executable):
    """It would hear the rates that were asked for, and publish on the topic of the driver."""
    process = graph.start(executable, args=params(name))
    graph.wait_for(lambda: f"section '{key}'" in process.output, 'the report')
    assert process.stop() == 0


def test_a_typo_in_the_key_of_a_section_is_told_before_the_node_refuses_to_start(graph, tmp_path):
    file = tmp_path / 'robot.yaml'
    file.write_text('/**/simulated_bas:\n  ros__parameters:\n    wheel_radius: 0.1\n')
    process = graph.start('simulated_base', args=['--ros-args', '--params-file', str(file)])
    assert process.wait() == 2
    told, refused, *_ = process.output.splitlines()
    assert "'/**/simulated_bas'" in told and "'/**/simulated_base' meant" in told
    assert 'wheel_radius is not set' in refused


@pytest.mark.parametrize('name', ['demo.yaml', 'two_robots.yaml', 'noisy_odom.yaml',
                                  'noiseless.yaml', 'robot.yaml'])
def test_nothing_is_said_of_the_sections_of_a_file_to_the_nodes_that_it_is_for(graph, name):
    sim = graph.start('diffdrive_sim', args=params(name))
    graph.wait_for(lambda: 'diffdrive_sim' in graph.node.get_node_names()
                   and len(graph.node.get_node_names()) > 2, 'the nodes')
    assert sim.stop() == 0, sim.output
    assert 'section' not in sim.output


@pytest.mark.ros
def test_wheel_odometry_is_a_simulated_base_that_hears_the_robot(diffdrive, capfd):
    """Beside the simulated base of this process, which is the driver here."""
    robot = diffdrive(
        nodes('diff_drive_controller', 'simulated_base', 'wheel_odometry',
              wheel_odometry={'odom_topic': 'read'}),
        params={**KHEPERA, 'enable_odom_tf': False})
    robot.drive(0.0, 0.0, 0.1)
    robot.publish('cmd_vel', twist(0.1, 0.0))
    robot.advance(2.0)
    odometry, read = (messages(robot, topic)[-1] for topic in ('odom', 'read'))
    assert odometry.twist.twist.linear.x == read.twist.twist.linear.x == 0.0
    assert odometry.pose.pose.position.x > 0.01
    assert odometry.pose.pose.position.x == pytest.approx(read.pose.pose.position.x)
    assert len(robot.history('joint_states')) == len(robot.history('odom'))  # the driver's alone
    assert 'section' not in capfd.readouterr().err
