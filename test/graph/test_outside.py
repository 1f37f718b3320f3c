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

"""What a system service and a pipe do to executables: no HOME, no log directory, no stdout."""

import importlib.util
import os
import re
import subprocess
import sys

import pytest
from support.graph import START

DRIFT = re.compile(r'^drift +[\d.]+ mm', re.M)
KHEPERA = ['--ros-args', '-p', 'wheel_radius:=0.021', '-p', 'wheel_separation:=0.0885']
SQUARES = """\
clockwise,true_x,true_y,odom_x,odom_y
1,0.01,0.02,0,0
1,0.01,0.021,0,0
0,0.02,-0.01,0,0
0,0.021,-0.01,0,0
"""
FAST = ['--ros-args', '-p', 'real_time_factor:=0.0']
LOG_VARIABLES = 'ROS_LOG_DIR', 'ROS_HOME', 'HOME'


class Outside:
    """Runs executables in a domain and a directory of their own."""

    def __init__(self, domain, directory):
        self.directory = directory
        self.environment = {
            **os.environ, 'ROS_DOMAIN_ID': str(domain), 'ROS_LOG_DIR': str(directory / 'log'),
            'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST', 'RCUTILS_COLORIZED_OUTPUT': '0'}

    def run(self, name, *args, prefix=(), stdout=subprocess.PIPE, **environment):
        """Return the ended process; variables that are None are unset."""
        merged = {**self.environment, **environment}
        return subprocess.run(
            [*prefix, sys.executable, '-c', START.format(name), *args], stdin=subprocess.DEVNULL,
            stdout=stdout, stderr=subprocess.PIPE, text=True, cwd=self.directory, timeout=90,
            env={key: value for key, value in merged.items() if value is not None})


@pytest.fixture
def outside(tmp_path):
    from support.domains import own_domain
    with own_domain() as domain:
        yield Outside(domain, tmp_path)


def full(run):
    with open('/dev/full', 'w') as stdout:
        return run(stdout=stdout)


def hung_up(run):
    reading, writing = os.pipe()
    os.close(reading)
    try:
        return run(stdout=writing)
    finally:
        os.close(writing)


def closed(run):
    return run(prefix=('sh', '-c', 'exec "$@" >&-', 'sh'))


WAYS = pytest.mark.parametrize('without_stdout', [full, hung_up, closed])


def assert_said_on_stderr(process, word):
    assert process.returncode == 1, process.stderr
    for traceback in ('Traceback', 'Exception ignored'):
        assert traceback not in process.stderr
    assert len(re.findall('stdout cannot be written', process.stderr)) == 1
    assert re.search(word, process.stderr, re.M), process.stderr


@WAYS
def test_a_drive_goes_on_without_stdout_and_says_its_drift_on_stderr(outside, without_stdout):
    demo = without_stdout(lambda **how: outside.run('diffdrive_sim', *FAST, **how))
    assert_said_on_stderr(demo, DRIFT.pattern)
    assert ' of 24.0 s' not in demo.stderr  # that was of the moment


@WAYS
def test_calibrate_writes_its_file_without_stdout(outside, without_stdout):
    (outside.directory / 'runs.csv').write_text(SQUARES)
    process = without_stdout(lambda **how: outside.run(
        'calibrate', *KHEPERA, '-p', 'square_runs:=runs.csv', '-p', 'square_side:=1.0', **how))
    assert_said_on_stderr(process, 'wrote calibration.yaml')
    assert 'wheel_separation_multiplier' in process.stderr
    assert 'wheel_separation_multiplier' in (outside.directory / 'calibration.yaml').read_text()


@WAYS
@pytest.mark.skipif(importlib.util.find_spec('matplotlib') is None, reason='needs matplotlib')
def test_plot_paths_draws_without_stdout(outside, without_stdout):
    process = without_stdout(lambda **how: outside.run('plot_paths', **how))
    assert_said_on_stderr(process, r'^paths\.png$')
    assert (outside.directory / 'paths.png').stat().st_size > 1000


@pytest.mark.parametrize('how', ['full', 'closed', 'with stdin closed'])
def test_a_drive_goes_on_without_stderr(outside, how):
    """Nor does what it says of who hears it, where nothing is set about that, end it."""
    closes = {'full': '2>/dev/full', 'closed': '2>&-', 'with stdin closed': '<&- 2>&-'}[how]
    demo = outside.run('diffdrive_sim', *FAST, prefix=('sh', '-c', f'exec "$@" {closes}', 'sh'),
                       ROS_AUTOMATIC_DISCOVERY_RANGE='')
    assert demo.returncode == 0 and DRIFT.search(demo.stdout)


def test_an_error_without_stderr_is_in_the_exit_status(outside):
    for closes in ('2>/dev/full', '2>&-'):
        process = outside.run('simulated_base', '--ros-args', 'nonsense', prefix=(
            'sh', '-c', f'exec "$@" {closes}', 'sh'))
        assert process.returncode == 2


def test_with_stdout_results_are_there_and_nowhere_else(outside):
    demo = outside.run('diffdrive_sim', *FAST)
    assert demo.returncode == 0 and DRIFT.search(demo.stdout) and not DRIFT.search(demo.stderr)


def test_without_any_home_one_line_names_the_remedy(outside):
    process = outside.run('simulated_base', *KHEPERA, **dict.fromkeys(LOG_VARIABLES))
    assert process.returncode == 2
    line, = process.stderr.splitlines()
    for word in ('ROS_LOG_DIR', 'ROS_HOME', 'HOME', 'systemd', '--disable-external-lib-logs'):
        assert word in line


@pytest.mark.parametrize('variable, value', [
    ('ROS_LOG_DIR', '/proc/none'), ('ROS_LOG_DIR', '/dev/null/log'), ('ROS_HOME', '/proc/none'),
    ('HOME', '/proc/none')])
def test_a_log_directory_that_cannot_be_written_is_named_with_the_remedy(
        outside, variable, value):
    process = outside.run(
        'simulated_base', *KHEPERA, **{**dict.fromkeys(LOG_VARIABLES), variable: value})
    assert process.returncode == 2
    line, = process.stderr.splitlines()
    assert value in line and 'ROS_LOG_DIR to a directory that can be written' in line
    assert '/src/' not in line


@pytest.mark.parametrize('remedy', [
    {'ROS_LOG_DIR': 'log'}, {'ROS_HOME': 'home'}, {'HOME': 'home'}, {}])
def test_each_remedy_helps(outside, remedy):
    variables = {name: str(outside.directory / value) for name, value in remedy.items()}
    none = [] if remedy else ['--disable-external-lib-logs']
    process = outside.run(
        'command_sequence', '--ros-args', '-p', 'commands:=[0.1]', *none,
        **{**dict.fromkeys(LOG_VARIABLES), **variables})
    assert process.returncode == 2 and 'commands has 1 numbers' in process.stderr
    assert 'log' not in process.stderr
