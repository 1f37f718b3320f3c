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
"""Params files of other packages: what they mean here, what they do not, and each said once."""

import math

from diffdrive_kinematics.nodes.diff_drive_controller import DiffDriveController
from diffdrive_kinematics.nodes.simulated_base import SimulatedBase
from diffdrive_kinematics.nodes.wheel_odometry import WheelOdometry
from diffdrive_kinematics.ros.parameters import said
from diffdrive_kinematics.ros.parameters.configuration_error import ConfigurationError
from diffdrive_kinematics.ros.parameters.sections import misplaced, sections_of
from diffdrive_kinematics.ros.parameters.tables import TABLES
from diffdrive_kinematics.ros.parameters.unknown_names import ALIASES, MEANS_NOTHING, RIGHT_NAMES
import pytest
from rcl_interfaces.msg import ParameterType
from rcl_interfaces.srv import DescribeParameters, GetParameters, ListParameters, SetParameters
from rclpy.parameter import Parameter, parameter_dict_from_yaml_file, parameter_value_to_python
from support.foreign_files import FAKE, FILES, LOOPBACK
from support.graph import KHEPERA
from support.inside import initialised
import yaml

GEOMETRY = 'wheel_separation: 0.5, wheel_radius: 0.1'


def started(tmp_path, capfd, text, *nodes, key='/**'):
    """Return (configurations, lines of the log) of nodes with a params file."""
    file = tmp_path / 'params.yaml'
    file.write_text(f"'{key}':\n  ros__parameters:\n{text}")
    said._said.clear()  # once a process: this is to be another one
    with initialised(args=['--ros-args', '--params-file', str(file)]):
        made = [kind() for kind in nodes]
        configs = [node.config for node in made]
        for node in made:
            node.destroy_node()
    return configs, [line for line in capfd.readouterr().err.splitlines() if 'parameter ' in line]


@pytest.mark.parametrize('name', FILES)
def test_files_of_other_packages_load_and_each_strange_name_is_said_once(tmp_path, capfd, name):
    text, strange = FILES[name]
    (controller, odometry), lines = started(
        tmp_path, capfd, text, DiffDriveController, WheelOdometry)
    assert sorted(line.split("'")[1] for line in lines) == sorted(strange), lines
    values = yaml.safe_load(text)
    assert controller.drive.geometry.wheel_radius == values['wheel_radius']
    assert controller.values['enable_stamped_cmd_vel'] is values.get('use_stamped_vel', False)
    assert controller.values['publish_limited_velocity'] is values.get(
        'publish_cmd', values.get('publish_limited_velocity', False))
    assert controller.drive.cmd_vel_timeout == values.get('cmd_vel_timeout', 0.5)
    assert odometry.values['enable_odom_tf'] is False
    for node in (controller, odometry):
        assert list(node.values['left_wheel_names']) == values.get(
            'left_wheel_names', ['left_wheel_joint'])


def test_what_is_known_by_another_name_is_told_by_it(tmp_path, capfd):
    _, lines = started(tmp_path, capfd, FAKE + LOOPBACK, SimulatedBase)
    for name, (package, right) in RIGHT_NAMES.items():
        line, = (each for each in lines if f"'{name}'" in each)
        assert package in line and right in line and 'did you mean' not in line


def test_the_own_name_goes_before_an_older_one(tmp_path, capfd):
    text = f'    {{{GEOMETRY}, use_stamped_vel: true, enable_stamped_cmd_vel: false}}\n'
    (controller,), (line,) = started(tmp_path, capfd, text, DiffDriveController)
    assert controller.values['enable_stamped_cmd_vel'] is False
    assert 'use_stamped_vel' in line and 'ignored' in line


def test_no_name_of_another_package_is_one_of_ours():
    ours = {entry.name for table in TABLES.values() for entry in table}
    assert not ours & (MEANS_NOTHING.keys() | RIGHT_NAMES.keys() | ALIASES.keys())
    assert set(ALIASES.values()) <= ours


def test_a_typo_is_reported_before_the_refusal_that_it_leads_to(tmp_path, capfd):
    with pytest.raises(ConfigurationError, match='wheel_radius is not set'):
        started(tmp_path, capfd, '    {wheel_separation: 0.5, wheel_radios: 0.1}\n',
                DiffDriveController)
    assert "did you mean 'wheel_radius'" in capfd.readouterr().err


@pytest.mark.parametrize('side', ['left', 'right'])
def test_a_negative_multiplier_is_refused_with_the_parameter_for_mirrored_motors(
        tmp_path, capfd, side):
    with pytest.raises(ConfigurationError, match=f'{side}_wheel_inverted'):
        started(tmp_path, capfd,
                f'    {{{GEOMETRY}, {side}_wheel_radius_multiplier: -1.0}}\n', SimulatedBase)


def test_a_section_of_one_node_with_names_of_another_is_told_in_a_line(tmp_path):
    file = tmp_path / 'mine.yaml'
    file.write_text(
        '/**/diff_drive_controller:\n  ros__parameters: {wheel_radius: 0.1, enable_odom_tf: false,'
        ' odom_frame_id: o}\n/**:\n  ros__parameters: {seed: 3}\n')
    sections = sections_of((str(file),))
    known = {entry.name for entry in TABLES['diff_drive_controller']}
    line, = misplaced(sections, '/diff_drive_controller', known)
    for word in ('enable_odom_tf, odom_frame_id', 'simulated_base', 'wheel_odometry', "'/**'"):
        assert word in line
    assert not list(misplaced(sections, '/simulated_base', known))


def test_a_renamed_controller_s_section_is_told_by_the_running_node(graph, tmp_path):
    file = tmp_path / 'mine.yaml'
    file.write_text('diff_drive_controller:\n  ros__parameters:\n    wheel_radius: 0.1\n'
                    '    wheel_separation: 0.5\n    enable_odom_tf: false\n')
    node = graph.start('diff_drive_controller', args=['--ros-args', '--params-file', str(file)])
    graph.wait_for(lambda: 'sets enable_odom_tf' in node.output, 'the line')


def test_what_ros2_param_dump_writes_can_be_loaded(graph, tmp_path):
    """The commands are not there without ROS; they do this."""
    node = '/diff_drive_controller'
    graph.start('diff_drive_controller', {
        **KHEPERA, 'wheel_separation': 1, 'linear.x.max_velocity': math.inf})
    names = graph.call(ListParameters, f'{node}/list_parameters', ListParameters.Request())
    names = [name for name in names.result.names if not name.startswith('qos_')]
    values = graph.call(GetParameters, f'{node}/get_parameters', GetParameters.Request(
        names=names)).values
    before = dict(zip(names, values))
    assert before['wheel_separation'].type == ParameterType.PARAMETER_DOUBLE
    descriptors = graph.call(
        DescribeParameters, f'{node}/describe_parameters', DescribeParameters.Request(
            names=names)).descriptors
    read_only = {each.name for each in descriptors if each.read_only}
    said = {each.name: each.additional_constraints for each in descriptors}
    assert said['wheel_radius'] == 'a finite number above 0'
    assert said['publish_rate'] == 'a rate from 1e-6 to 1e6 Hz'
    assert 'left_wheel_names' in read_only and 'publish_rate' not in read_only
    dump = tmp_path / 'dump.yaml'
    dump.write_text(yaml.dump({node: {'ros__parameters': {
        name: parameter_value_to_python(value) for name, value in before.items()
        if name not in read_only}}}))
    assert '.nan' in dump.read_text() and '.inf' in dump.read_text()
    loaded = [
        parameter for name, parameter in parameter_dict_from_yaml_file(str(dump)).items()]
    results = graph.call(SetParameters, f'{node}/set_parameters', SetParameters.Request(
        parameters=loaded)).results
    assert [result.reason for result in results if not result.successful] == []
    integer = Parameter('wheel_separation', Parameter.Type.INTEGER, 2).to_parameter_msg()
    assert graph.call(SetParameters, f'{node}/set_parameters', SetParameters.Request(
        parameters=[integer])).results[0].successful
    after = dict(zip(names, graph.call(GetParameters, f'{node}/get_parameters',
                                       GetParameters.Request(names=names)).values))
    assert after['wheel_separation'].double_value == 2.0
    for name in set(names) - {'wheel_separation'}:
        assert repr(parameter_value_to_python(after[name])) == repr(
            parameter_value_to_python(before[name])), name
        assert after[name].type == before[name].type, name
