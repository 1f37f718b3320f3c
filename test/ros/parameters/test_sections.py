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

"""Sections of params files: which nodes have them, and which are reported as meant for another."""

from diffdrive_kinematics.ros.parameters.sections import doubts, matches, params_files, sections_of
from diffdrive_kinematics.ros.parameters.tables import TABLES
import pytest
import rclpy
from rclpy.node import Node

KEYS = ('/**', '/**/n', '/*/n', 'n', '/n', '/r/n', 'r/n', '/r/**', '/r/*', '*', '/*', '**',
        '/**/r/n', '/r/s/n', '/*/*/n', '/**/*', '/nn', '/**/s/*')
GEOMETRY = {'wheel_radius': 0.1, 'wheel_separation': 0.3}


def file_of(tmp_path, *keys, parameters='{a: 1}'):
    file = tmp_path / f'params{len(list(tmp_path.iterdir()))}.yaml'  # files are read once
    file.write_text(''.join(f"'{key}':\n  ros__parameters: {parameters}\n" for key in keys))
    return str(file)


def doubts_of(tmp_path, keys, node, kind='simulated_base', given=GEOMETRY, neighbours=(), **file):
    sections = sections_of((file_of(tmp_path, *keys, **file),))
    return list(doubts(sections, node, TABLES[kind], given, neighbours))


@pytest.mark.parametrize('namespace', ['/', '/r', '/r/s', '/other', '/q/r'])
def test_sections_are_for_the_nodes_that_rcl_gives_them_to(tmp_path, namespace):
    from support.domains import own_domain
    file = tmp_path / 'params.yaml'
    file.write_text(''.join(f"'{key}':\n  ros__parameters: {{p{number}: 1}}\n"
                            for number, key in enumerate(KEYS)))
    with own_domain() as domain:
        rclpy.init(args=['--ros-args', '--params-file', str(file)], domain_id=domain)
        node = Node('n', namespace=namespace)
        try:
            given = {KEYS[int(name[1:])] for name in node._parameter_overrides if name[0] == 'p'}
            name = node.get_fully_qualified_name()
        finally:
            node.destroy_node()
            rclpy.try_shutdown()
    assert {key for key in KEYS if matches(key, name)} == given


def test_nested_namespaces_and_names_are_one_key(tmp_path):
    file = tmp_path / 'nested.yaml'
    file.write_text('r:\n  n:\n    ros__parameters:\n      a: 1\n      b: {c: {d: 2}, e: 3}\n')
    section, = sections_of((str(file),))
    assert (section.key, section.names) == ('r/n', {'a', 'b.c.d', 'b.e'})


@pytest.mark.parametrize('argv, files', [
    ([], ()),
    (['x', '--params-file', 'a'], ()),
    (['x', '--ros-args', '--params-file', 'a', '-p', 'b:=1', '--params-file', 'c'], ('a', 'c')),
    (['x', '--ros-args', '--params-file', 'a', '--', '--params-file', 'b'], ('a',)),
    (['x', '--ros-args', '-r', 'a:=b', '--', 'y', '--ros-args', '--params-file', 'c'], ('c',)),
])
def test_params_files_are_those_of_the_arguments_of_ros(argv, files):
    assert params_files(argv) == files


@pytest.mark.parametrize('text', ['', '[1, 2]', 'a: b: c', '{[1]: 2}', '\t', 'a: &a [*a]', '\0',
                                  '1: {ros__parameters: {2: 3}}', 'a: {ros__parameters: }'])
def test_a_file_that_is_no_params_file_is_left_to_rcl(tmp_path, text):
    file = tmp_path / 'odd.yaml'
    file.write_text(text)
    sections = sections_of((str(file), str(tmp_path / 'none.yaml'), str(tmp_path)))
    assert not list(doubts(sections, '/simulated_base', TABLES['simulated_base'], {}))


@pytest.mark.parametrize('key', ['/**/simulated_bas', 'simulatedbase', '/Simulated_Base',
                                 '/**/simulatted_base', '/r/simulated_baes'])
@pytest.mark.parametrize('own', [(), ('/**/simulated_base',)])
def test_a_name_that_is_spelt_alike_is_reported_with_the_one_that_was_meant(tmp_path, key, own):
    report, = doubts_of(tmp_path, ['/**', key, *own], '/simulated_base')
    assert f"'{key}'" in report and 'params0.yaml' in report and "'/**/simulated_base'" in report


def test_a_letter_tells_no_siblings_apart_where_the_node_has_no_section(tmp_path):
    assert doubts_of(tmp_path, ['/**/wheel_odometry_b'], '/wheel_odometry_a', 'wheel_odometry')


def test_a_section_of_the_same_class_is_reported_where_the_node_has_none_of_its_own(tmp_path):
    """A params file of a robot, given to the base that simulates."""
    report, = doubts_of(tmp_path, ['/**', '/**/wheel_odometry'], '/simulated_base')
    for word in ("'/**/wheel_odometry'", '/simulated_base', 'or the executable wheel_odometry'):
        assert word in report
    assert doubts_of(tmp_path, ['/**/simulated_base'], '/wheel_odometry', 'wheel_odometry')
    assert doubts_of(tmp_path, ['/**/simulated_base'], '/my_base')  # renamed


def test_a_file_of_calibrate_beside_it_does_not_hide_the_file_of_the_other_base(tmp_path):
    robot = file_of(tmp_path, '/**', '/**/wheel_odometry')
    written = file_of(tmp_path, '/**', '/**/wheel_odometry', '/**/simulated_base')
    report, = doubts(
        sections_of((robot, written)), '/simulated_base', TABLES['simulated_base'], GEOMETRY)
    assert robot in report


def test_a_section_that_has_what_the_node_lacks_is_reported(tmp_path):
    """As where the file is that of ros2_controllers, under the name that it has there."""
    keys, parameters = ['diffbot_base_controller'], '{wheel_radius: 0.1, wheel_separation: 0.2}'
    report, = doubts_of(tmp_path, keys, '/diff_drive_controller', 'diff_drive_controller',
                        given={}, parameters=parameters)
    assert "'diffbot_base_controller'" in report and 'wheel_radius and wheel_separation' in report
    assert not doubts_of(tmp_path, keys, '/diff_drive_controller', 'diff_drive_controller',
                         parameters=parameters)


def test_a_section_without_the_namespace_of_the_node_is_reported(tmp_path):
    report, = doubts_of(tmp_path, ['simulated_base'], '/robot1/simulated_base')
    assert 'namespace' in report and "'/**/simulated_base'" in report
    assert doubts_of(tmp_path, ['/robot1/simulated_base'], '/simulated_base')


@pytest.mark.parametrize('keys, node, neighbours', [
    (['/**', '/**/simulated_base'], '/simulated_base', ()),
    (['/**/simulated_base', '/**/wheel_odometry'], '/simulated_base', ()),
    (['/**/simulated_base', '/**/wheel_noise', '/**/amcl', 'controller_manager'],
     '/simulated_base', ()),
    (['/**', '/**/ground_truth', '/**/diff_drive_controller'], '/simulated_base', ()),
    (['/**/wheel_odometry'], '/simulated_base', ('simulated_base', 'wheel_odometry')),
    (['/**/base_1', '/**/base_2'], '/base_1', ()),
    (['/**/wheel_odometry_a', '/**/wheel_odometry_b'], '/wheel_odometry_a', ()),
    (['/**/wheel_odometry_fl', '/**/wheel_odometry_rr', '/**/wheel_odometry_fr'],
     '/wheel_odometry_fl', ()),
    (['/robot1/simulated_base', '/robot2/simulated_base'], '/robot1/simulated_base', ()),
    (['/robot1/simulated_base'], '/robot2/simulated_base', ()),
    (['/**/odometry_left', '/**/odometry_right'], '/odometry_left', ())])
def test_sections_of_other_processes_are_none_of_the_nodes_business(
        tmp_path, keys, node, neighbours):
    assert not doubts_of(tmp_path, keys, node, neighbours=neighbours)
