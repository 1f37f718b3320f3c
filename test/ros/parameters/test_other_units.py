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

"""Values that cannot be meant, as they are in other units: one warning each, and no refusal."""

from diffdrive_kinematics.nodes.command_sequence import CommandSequence
from diffdrive_kinematics.nodes.diff_drive_controller import DiffDriveController
from diffdrive_kinematics.nodes.simulated_base import SimulatedBase
from diffdrive_kinematics.ros.parameters.other_units import doubt_of
import pytest
from rclpy.parameter import Parameter
from support.graph import KHEPERA
from support.inside import initialised, inside

MM = {'wheel_radius': 33, 'wheel_separation': 160}
NO_TF = {'enable_odom_tf': False}


def warnings(capfd):
    """Return what was warned of since this was asked for last, but unknown names."""
    return [line for line in capfd.readouterr().err.splitlines()
            if '[WARN]' in line and 'no node of this package' not in line]


@pytest.mark.parametrize('name, value, words', [
    ('wheel_radius', 33.0, 'wheel_radius is 33.0, in metres: 33 millimetres are 0.033'),
    ('wheel_radius', 16.5, 'wheel_radius is 16.5, in metres: 16.5 millimetres are 0.0165'),
    ('wheel_separation', 88.5, 'wheel_separation is 88.5, in metres: 88.5 millimetres are 0.0885'),
    ('cmd_vel_timeout', 500.0, 'cmd_vel_timeout is 500.0, in seconds: 500 milliseconds are 0.5'),
    ('command_timeout', 250.0, 'command_timeout is 250.0, in seconds: 250 milliseconds are 0.25'),
    ('odom_timeout', 1000.0, 'odom_timeout is 1000.0, in seconds: 1000 milliseconds are 1'),
    ('publish_rate', 0.02, 'publish_rate is 0.02, in Hz: once in 0.02 seconds is 50'),
    ('initial_pose', (0.0, 1.0, 90.0),
     'the yaw in initial_pose is 90.0, in radians: 90 degrees are 1.5708'),
    ('goals', (1.0, 0.0, 0.0, 2.0, 0.0, -45.0),
     'the yaw in goals is -45.0, in radians: -45 degrees are -0.785398')])
def test_what_cannot_be_meant_is_doubted_with_what_probably_was(name, value, words):
    assert doubt_of(name, value).startswith(words)


@pytest.mark.parametrize('name, value', [
    *(('wheel_radius', value) for value in (0.008, 0.021, 0.4, 2.0)),  # up to mining trucks
    *(('wheel_separation', value) for value in (0.03, 0.5, 15.0, float('nan'))),
    *(('cmd_vel_timeout', value) for value in (0.0, 0.5, 60.0)),
    *(('publish_rate', value) for value in (0.1, 1.0, 1000.0)),
    *(('initial_pose', (90.0, 45.0, yaw)) for yaw in (-3.2, 6.3)), ('goals', ()),
    ('cmd_vel_topic', 'cmd_vel'), ('response_delay', 0.1)])
def test_what_real_robots_have_is_not_doubted(name, value):
    assert doubt_of(name, value) == ''


@pytest.mark.ros
def test_each_is_said_once_in_a_process_and_the_nodes_start(capfd):
    with initialised({**MM, **NO_TF, 'cmd_vel_timeout': 500, 'publish_rate': 50.0}):
        for made in (DiffDriveController(), SimulatedBase()):
            made.destroy_node()
    said = [line.split(']: ')[1].split(' is ')[0] for line in warnings(capfd)]
    assert sorted(said) == ['cmd_vel_timeout', *MM]


@pytest.mark.ros
def test_one_that_is_set_on_the_way_is_said_as_well(capfd):
    with inside(SimulatedBase, {**KHEPERA, **NO_TF}) as held:
        assert not warnings(capfd)
        held.node.set_parameters([Parameter('wheel_radius', value=21.0)])
        line, = warnings(capfd)
        assert '21 millimetres are 0.021' in line
        held.node.set_parameters([Parameter('wheel_separation', value=0.09)])
        assert not warnings(capfd)


@pytest.mark.ros
def test_a_course_of_a_robot_in_metres_is_not_doubted(capfd):
    with initialised({'commands': [0.2, 0.0, 300.0]}):
        CommandSequence().destroy_node()
    assert not warnings(capfd)
