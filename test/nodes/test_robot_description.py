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
"""The URDF that robot_description makes of the geometry."""

import math
from xml.etree import ElementTree

from diffdrive_kinematics.core.kinematics import WheelGeometry
from diffdrive_kinematics.ros.messages.urdf import Shape, urdf_of
from diffdrive_kinematics.ros.messages.wheel_joints import WheelJoints
import pytest
from rcl_interfaces.srv import SetParameters
import rclpy
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String
from support.graph import arguments, KHEPERA
from support.inside import initialised

LATE = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
GEOMETRY = WheelGeometry(
    0.4, 0.1, wheel_separation_multiplier=1.1, left_wheel_radius_multiplier=1.01,
    right_wheel_radius_multiplier=0.98)

JOINTS = WheelJoints((('l',), ('r',)))


def numbers(element, attribute):
    return [float(part) for part in element.get(attribute).split()]


def parsed(urdf):
    """Return the links and joints of a URDF by name, after checking that they make a tree."""
    robot = ElementTree.fromstring(urdf)
    assert robot.tag == 'robot' and robot.get('name')
    links = {link.get('name'): link for link in robot.findall('link')}
    joints = {joint.get('name'): joint for joint in robot.findall('joint')}
    assert len(links) + len(joints) == len(list(robot))
    children = [joint.find('child').get('link') for joint in joints.values()]
    assert len(set(children)) == len(children) == len(links) - 1
    (root,) = set(links) - set(children)
    assert all(joint.find('parent').get('link') == root for joint in joints.values())
    return root, links, joints


def test_wheels_stand_on_the_ground_at_half_the_effective_separation_with_effective_radii():
    root, links, joints = parsed(urdf_of(
        GEOMETRY, JOINTS, name='robot', base='base_link', shape=Shape(0.0, 0.05)))
    assert root == 'base_link'
    for name, side, radius in (('l', 1.0, 0.101), ('r', -1.0, 0.098)):
        origin = joints[name].find('origin')
        assert numbers(origin, 'xyz') == pytest.approx([0.0, side * 0.22, radius], abs=1e-12)
        assert numbers(origin, 'rpy') == [0.0, 0.0, 0.0]
        cylinder = links[joints[name].find('child').get('link')].find('visual/geometry/cylinder')
        assert float(cylinder.get('radius')) == pytest.approx(radius, rel=1e-12)
        assert float(cylinder.get('length')) == 0.05


@pytest.mark.parametrize('inverted', [(False, False), (True, False), (False, True)])
def test_the_angle_that_a_joint_tells_of_a_wheel_that_rolls_forward_rolls_it_forward(inverted):
    """Turn the top of the wheel about the axis: REP-103, right-handed, x forward, z up."""
    _, links, joints = parsed(urdf_of(
        GEOMETRY, WheelJoints((('l',), ('r',)), inverted), name='robot', base='base_link',
        shape=Shape(0.0, 0.05)))
    for name, upside_down in zip('lr', inverted):
        joint = joints[name]
        assert joint.get('type') == 'continuous'
        ax, ay, az = numbers(joint.find('axis'), 'xyz')
        top = (0.0, 0.0, 1.0)
        moved = (ay * top[2] - az * top[1], az * top[0] - ax * top[2], ax * top[1] - ay * top[0])
        assert moved == ((-1.0 if upside_down else 1.0), 0.0, 0.0)
        tyre = links[joint.find('child').get('link')].find('visual')
        roll, pitch, yaw = numbers(tyre.find('origin'), 'rpy')
        assert (abs(math.sin(roll)), pitch, yaw) == (1.0, 0.0, 0.0)  # cylinder axis z onto y


def test_several_wheels_of_a_side_are_spread_from_front_to_rear():
    _, _, joints = parsed(urdf_of(
        GEOMETRY, WheelJoints((('fl', 'ml', 'rl'), ('fr', 'rr'))), name='robot', base='base_link',
        shape=Shape(0.6, 0.05)))
    xs = {name: numbers(joint.find('origin'), 'xyz')[0] for name, joint in joints.items()}
    assert xs == pytest.approx({'fl': 0.3, 'ml': 0.0, 'rl': -0.3, 'fr': 0.3, 'rr': -0.3})


def test_links_are_prefixed_as_the_base_frame_is_and_names_are_escaped():
    root, links, joints = parsed(urdf_of(
        GEOMETRY, WheelJoints((('a<b',), ('r&d',))), name='x"y', base='robot1/base_link',
        shape=Shape(0.0, 0.05)))
    assert root == 'robot1/base_link' and set(joints) == {'a<b', 'r&d'}
    assert all(name.startswith('robot1/') for name in links)


def test_a_late_listener_gets_the_description_and_every_change_of_geometry(graph):
    graph.start('robot_description', {**KHEPERA, 'left_wheel_names': ['fl', 'rl'],
                                      'right_wheel_names': ['fr', 'rr'],
                                      'right_wheel_inverted': True,
                                      'tf_frame_prefix_enable': True, 'tf_frame_prefix': 'a'})
    graph.wait_for(lambda: graph.node.count_publishers('robot_description'), 'the node')
    heard = []
    graph.node.create_subscription(String, 'robot_description', heard.append, LATE)
    root, _, joints = parsed(graph.wait_for(lambda: heard, 'the description')[0].data)
    assert root == 'base_link' and set(joints) == {'fl', 'rl', 'fr', 'rr'}
    assert numbers(joints['fl'].find('origin'), 'xyz')[1:] == pytest.approx([0.04425, 0.021])
    assert [numbers(joints[name].find('axis'), 'xyz')[1] for name in ('fl', 'rl', 'fr', 'rr')] \
        == [1.0, 1.0, -1.0, -1.0]
    gap = (numbers(joints['fl'].find('origin'), 'xyz')[0]
           - numbers(joints['rl'].find('origin'), 'xyz')[0])
    assert gap > 2 * 0.021  # they do not touch
    graph.call(SetParameters, 'robot_description/set_parameters', SetParameters.Request(
        parameters=[Parameter('wheel_radius', value=0.042).to_parameter_msg()]))
    graph.wait_for(lambda: len(heard) == 2, 'the new description')
    joints = parsed(heard[1].data)[2]
    assert numbers(joints['fl'].find('origin'), 'xyz')[2] == pytest.approx(0.042)


@pytest.mark.ros
def test_a_file_for_robot_state_publisher_has_the_urdf_as_its_parameter(here, tmp_path):
    for name in ('robot.urdf', 'robot.yaml'):
        writer = here('robot_description', arguments(
            {**KHEPERA, 'output': str(tmp_path / name)}))
        assert writer.wait() == 0, writer.output
    urdf = (tmp_path / 'robot.urdf').read_text()
    assert parsed(urdf)[0] == 'base_link'
    with initialised(args=['--ros-args', '--params-file', str(tmp_path / 'robot.yaml')]):
        node = rclpy.create_node('robot_state_publisher')
        assert node.declare_parameter('robot_description', '').value == urdf
        node.destroy_node()


@pytest.mark.ros
def test_the_params_file_of_the_robot_is_not_written_over_unless_asked_to(here, tmp_path):
    params = tmp_path / 'robot.yaml'
    text = '/**:\n  ros__parameters: {wheel_radius: 0.1, wheel_separation: 0.4}\n'
    params.write_text(text)
    args = ['--ros-args', '--params-file', str(params), '-p', f'output:={params}']
    refused = here('robot_description', args)
    assert refused.wait() == 2 and 'which exists' in refused.output
    assert len(refused.output.strip().splitlines()) == 1, refused.output
    assert params.read_text() == text
    asked = here('robot_description', [*args, '-p', 'overwrite:=true'])
    assert asked.wait() == 0, asked.output
    assert 'robot_description: |' in params.read_text()
