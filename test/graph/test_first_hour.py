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

"""What executables say to the arguments of somebody who meets them for the first time."""

import shlex

from diffdrive_kinematics.ros.parameters.tables import TABLES
from diffdrive_kinematics.ros.runtime.command_line import example_of
import pytest


def test_the_demo_begins_with_what_it_does_and_ends_with_where_to_go_on(graph):
    demo = graph.start('diffdrive_sim', args=['--ros-args', '-p', 'real_time_factor:=0.0'])
    assert demo.wait() == 0, demo.output
    lines = demo.output.splitlines()
    assert lines[0].startswith('no params file given: running the demo')
    assert '--ros-args --params-file' in lines[-1] and lines[-1].endswith('web.yaml')
    assert 'does not reach' not in demo.output  # /** of the file has it


def test_a_parameter_that_a_section_of_the_demo_beats_is_told_with_the_form_that_works(graph):
    form = 'diffdrive_sim:nodes:=[simulated_base]'
    geometry = ['-p', 'wheel_radius:=0.1', '-p', 'wheel_separation:=0.1']
    sim = graph.start('diffdrive_sim', args=[
        '--ros-args', '-p', 'nodes:=[simulated_base]', *geometry])
    graph.wait_for(lambda: f'use -p {form}' in sim.output, 'the warning')
    sim.stop()
    obeyed = graph.start('diffdrive_sim', args=['--ros-args', '-p', form, *geometry])
    graph.wait_for(lambda: 'simulated_base' in graph.node.get_node_names(), 'the base')
    assert obeyed.stop() == 0, obeyed.output
    assert 'does not reach' not in obeyed.output and 'playing' not in obeyed.output


@pytest.mark.parametrize('args, form', [
    (['config/x.yaml'], '--ros-args --params-file config/x.yaml'),
    (['--params-file', 'x.yaml'], '--ros-args --params-file x.yaml'),
    (['-p', 'seed:=2'], '--ros-args -p seed:=2'), (['seed:=2'], '--ros-args -p seed:=2'),
    (['--ros-args', '-p', 'seed:=2', '--', '--what'], '--ros-args --params-file FILE')])
@pytest.mark.parametrize('name', ['diffdrive_sim', 'calibrate'])
def test_an_argument_that_is_not_for_ros_is_refused_with_the_form_that_works(
        graph, name, args, form):
    process = graph.start(name, args=args)
    assert process.wait() == 2
    line, = process.output.splitlines()
    assert line.startswith(f'{name}: ') and f'expected: {name} {form} ' in line


@pytest.mark.parametrize('name', TABLES)
def test_help_names_what_must_be_set_and_an_example(graph, name):
    process = graph.start(name, args=['--help'])
    assert process.wait() == 0, process.output
    assert process.output.startswith(f'{name}: ')
    assert example_of(name) in process.output
    for entry in TABLES[name]:
        assert (f'  {entry.name}: ' in process.output) == entry.required
        if entry.name.endswith('cmd_vel_topic'):
            assert f'  {entry.name} (' in process.output


@pytest.mark.parametrize('name', [
    name for name in TABLES if name not in ('plot_paths', 'teleop', 'web_view')])
def test_the_example_of_the_help_runs(graph, name):
    process = graph.start(name, args=shlex.split(example_of(name))[1:])
    graph.wait_for(lambda: name in graph.node.get_node_names() or not process.running, name)
    assert process.stop() == 0, process.output
    assert 'refuses' not in process.output
