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

from importlib import import_module
import os
import pty
import shlex
import signal
import subprocess
import sys

from diffdrive_kinematics.ros.parameters.package_share import share_directory
from diffdrive_kinematics.ros.parameters.tables import TABLES
from diffdrive_kinematics.ros.runtime.command_line import answer_arguments, example_of, help_of
import pytest
from support.graph import START
from support.killing import kill


def answered(name, args, capfd):
    """Return the status, stdout and stderr of an executable that ends by its arguments alone."""
    module = import_module(f'diffdrive_kinematics.nodes.{name}')
    capfd.readouterr()
    with pytest.raises(SystemExit) as ended:
        answer_arguments(name, module.__doc__, [name, *args])
    return ended.value.code, *capfd.readouterr()


def test_the_demo_begins_with_what_it_does_and_ends_with_where_to_go_on(graph):
    demo = graph.start('diffdrive_sim', args=['--ros-args', '-p', 'real_time_factor:=0.0'])
    assert demo.wait() == 0, demo.output
    lines = demo.output.splitlines()
    assert lines[0].startswith('no params file given: running the demo')
    assert '--ros-args --params-file' in lines[-1] and lines[-1].endswith('web.yaml')
    assert 'does not reach' not in demo.output  # /** of the file has it
    assert '[WARN]' not in demo.output


def test_a_parameter_that_a_section_of_the_demo_beats_is_told_with_the_form_that_works(graph):
    form = 'diffdrive_sim:nodes:=[simulated_base]'
    geometry = ['-p', 'wheel_radius:=0.1', '-p', 'wheel_separation:=0.1']
    sim = graph.start('diffdrive_sim', args=[
        '--ros-args', '-p', 'nodes:=[simulated_base]', *geometry])
    graph.wait_for(lambda: f'use -p {form}' in sim.output, 'the warning')
    sim.stop()
    graph.wait_for(lambda: 'simulated_base' not in graph.node.get_node_names(), 'its node to go')
    obeyed = graph.start('diffdrive_sim', args=['--ros-args', '-p', form, *geometry])
    graph.wait_for(lambda: 'simulated_base' in graph.node.get_node_names(), 'the base')
    assert obeyed.stop() == 0, obeyed.output
    assert 'does not reach' not in obeyed.output and 'playing' not in obeyed.output


@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGTERM])
def test_a_demo_that_is_interrupted_shows_its_table_of_what_it_has_driven(graph, number):
    demo = graph.start('diffdrive_sim', args=['--ros-args', '-p', 'real_time_factor:=1.0'])
    graph.wait_for(lambda: ' 2.4 of 24.0 s' in demo.output, 'some of the course')
    assert demo.stop(number) == 0, demo.output
    assert '24.0 of 24.0 s' not in demo.output
    row = next(line for line in demo.output.splitlines() if line.startswith('belief (/sim'))
    assert 0.2 < float(row.split()[2]) <= 0.4  # at the end of the first side it turns


def test_a_terminal_sees_where_the_robot_is_and_a_file_does_not(graph):
    params = str(share_directory() / 'config' / 'noiseless.yaml')
    ours, theirs = pty.openpty()
    shown = subprocess.Popen(
        [sys.executable, '-c', START.format('diffdrive_sim'), '--ros-args', '--params-file',
         params], stdin=theirs, stdout=theirs, stderr=subprocess.DEVNULL,
        env=graph._environment)
    try:
        os.set_blocking(ours, False)
        seen = b''

        def lines():
            nonlocal seen
            try:
                seen += os.read(ours, 10_000)
            except BlockingIOError:
                pass
            return seen.count(b's   belief (  0.000,   0.000,    0.0 deg)\x1b[K\r')

        graph.wait_for(lambda: lines() > 2, 'a line that is written over and over')
        assert b'\n' not in seen
    finally:
        kill(shown)
        os.close(ours)
        os.close(theirs)
    piped = graph.start('diffdrive_sim', args=['--ros-args', '--params-file', params])
    graph.wait_for(lambda: 'to drive; Ctrl-C ends' in piped.output, 'the robot')
    assert piped.stop() == 0
    assert 'belief' not in piped.output and '\r' not in piped.output


@pytest.mark.parametrize('args, form', [
    (['config/x.yaml'], '--ros-args --params-file config/x.yaml'),
    (['--params-file', 'x.yaml'], '--ros-args --params-file x.yaml'),
    (['-p', 'seed:=2'], '--ros-args -p seed:=2'), (['seed:=2'], '--ros-args -p seed:=2'),
    (['--ros-args', '-p', 'seed:=2', '--', '--what'], '--ros-args --params-file FILE')])
def test_an_argument_that_is_not_for_ros_is_refused_with_the_form_that_works(capfd, args, form):
    status, out, err = answered('calibrate', args, capfd)
    assert status == 2 and not out
    assert_refuses(err, 'calibrate', form)


def assert_refuses(output, name, form):
    line, = output.splitlines()
    assert line.startswith(f'{name}: ') and f'expected: {name} {form} ' in line


def test_a_process_refuses_an_argument_before_it_does_anything_else(graph):
    process = graph.start('diffdrive_sim', args=['config/x.yaml'])
    assert process.wait() == 2
    assert_refuses(process.output, 'diffdrive_sim', '--ros-args --params-file config/x.yaml')


@pytest.mark.parametrize('name', TABLES)
def test_help_names_what_must_be_set_and_an_example(capfd, name):
    status, out, err = answered(name, ['--help'], capfd)
    assert status == 0 and not err
    assert out.startswith(f'{name}: ')
    assert example_of(name) in out
    for entry in TABLES[name]:
        assert (f'  {entry.name}: ' in out) == entry.required
        if entry.name.endswith('cmd_vel_topic'):
            assert f'  {entry.name} (' in out


def test_a_process_that_is_asked_for_help_gives_it_and_ends_with_0(graph):
    process = graph.start('calibrate', args=['--help'])
    assert process.wait() == 0, process.output
    assert process.output.startswith('calibrate: ')
    assert example_of('calibrate') in process.output


def test_a_process_without_docstrings_gives_its_help_as_well(graph):
    process = graph.start('calibrate', args=['--help'], environment={'PYTHONOPTIMIZE': '2'})
    assert process.wait() == 0, process.output
    assert process.output.startswith('calibrate\n')
    assert example_of('calibrate') in process.output


@pytest.mark.parametrize('name, words', [
    ('diffdrive_sim', ('the demo without a params file', '-p record:=', '-p picture:=')),
    ('command_sequence', ('-p commands:=', '-p recording:=', '-p square_side:='))])
def test_help_says_what_no_parameter_that_must_be_set_tells(name, words):
    assert all(each in help_of(name, '') for each in words)


@pytest.mark.parametrize('name', [
    name for name in TABLES if name not in ('plot_paths', 'teleop', 'web_view')])
def test_the_example_of_the_help_runs(graph, name):
    process = graph.start(name, args=shlex.split(example_of(name))[1:])
    graph.wait_for(lambda: name in graph.node.get_node_names() or not process.running, name)
    assert process.stop() == 0, process.output
    assert 'refuses' not in process.output


@pytest.mark.parametrize('name, args, words', [
    ('command_sequence', ['-p', 'commands:=[0.1, 0.0, 4.0]', '-p', 'square_side:=1.0'],
     'expected exactly one of them'),
    ('simulated_base', ['-p', 'wheel_radius:=-1.0', '-p', 'wheel_separation:=0.1'],
     'wheel_radius is -1.0'),
    ('command_sequence', ['-p', 'commands:=[0.1, 0, 4]'], 'not [0.1, 0, 4]'),
    ('command_sequence', ['--params-file', 'none.yaml'], 'the file does not exist'),
    ('command_sequence', ['-r', '__ns:=robot1'], "a namespace begins with '/'"),
    ('command_sequence', ['-r', '__ns:=/robot-1'], "letters, digits and '_'")])
def test_what_is_set_wrongly_is_refused_without_advice_on_how_to_set_parameters(
        here, name, args, words):
    process = here(name, ['--ros-args', *args])
    assert process.wait() == 2
    assert words in process.output
    assert 'Set parameters' not in process.output and ', at /' not in process.output


@pytest.mark.parametrize('text, words', [
    ('wheel_radius: 0.1\n', 'two underscores'),
    ('/**:\n  ros_parameters:\n    wheel_radius: 0.1\n', 'two underscores'),
    ('/**:\n\tros__parameters:\n', 'spaces instead of tabs'),
    (None, 'a directory')])
def test_a_file_that_is_no_params_file_is_refused_with_what_one_looks_like(
        here, tmp_path, text, words):
    file = tmp_path / 'robot.yaml'
    file.mkdir() if text is None else file.write_text(text)
    process = here('simulated_base', ['--ros-args', '--params-file', str(file)])
    assert process.wait() == 2
    assert words in process.output and ', at /' not in process.output


@pytest.mark.parametrize('name', ['command_sequence', 'simulated_base'])
def test_what_is_missing_is_refused_with_advice_on_how_to_set_parameters(here, name):
    process = here(name, [])
    assert process.wait() == 2
    assert ' is not set, expected ' in process.output and 'Set parameters' in process.output
    assert '..' not in process.output and '.;' not in process.output  # one sentence


def test_calibrate_alone_names_its_three_modes(graph):
    process = graph.start('calibrate', args=[])
    assert process.wait() == 2
    first = process.output.splitlines()[0]
    assert all(word in first for word in ('square_runs', 'recordings', 'live topics'))
