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

"""What an executable does about its arguments: its help, a refusal, or the demo without any."""

import os
import sys
from typing import Callable, MutableMapping, Optional, Sequence

from diffdrive_kinematics.ros.parameters.package_share import share_directory, with_params_file
from diffdrive_kinematics.ros.parameters.parameter_checks import check_optional_topic, check_topic
from diffdrive_kinematics.ros.parameters.parameter_spec import ParameterSpec
from diffdrive_kinematics.ros.parameters.tables import TABLES
from diffdrive_kinematics.ros.runtime.output import complain, exit_status, report, show
from diffdrive_kinematics.ros.runtime.running import run, Stop

ROS_ARGS = '--ros-args'
HELP = '-h', '--help'
OPTIONS = {  # of ROS, and what follows them
    '--params-file': 'FILE', '-p': 'NAME:=VALUE', '--param': 'NAME:=VALUE', '-r': 'FROM:=TO',
    '--remap': 'FROM:=TO', '--log-level': 'LEVEL'}
VALUES = {'wheel_radius': '0.033', 'wheel_separation': '0.16'}  # of what must be set
MORE = {'command_sequence': "-p commands:='[0.1, 0.0, 4.0]'", 'plot_paths': '-p output:=paths.svg'}
MODES = {  # of executables that do quite different things
    'calibrate': 'one of -p square_runs:=FILE.csv (UMBmark), -p recordings:=[FILE, ...] (a fit to '
                 'recorded drives), or neither (live topics, until Ctrl-C or a call of ~/finish)'}
NOTES = {  # on what no parameter that must be set tells
    'command_sequence': 'One of -p commands:=[V, OMEGA, DURATION, ...], -p recording:=FILE and -p '
                        'square_side:=METRES has to be set.',
    'diffdrive_sim': 'It runs the demo without a params file. -p record:=drive.csv keeps a drive, '
                     '-p picture:=drive.png draws it.'}
UNKNOWN = 2  # exit status
DEMO = (
    'no params file given: running the demo (config/demo.yaml), a robot that drives a square with '
    'wheels that slip, so that its odometry drifts away from where it is')
RANGE = 'ROS_AUTOMATIC_DISCOVERY_RANGE'
REACH = RANGE, 'ROS_LOCALHOST_ONLY', 'ROS_STATIC_PEERS', 'ROS_DISCOVERY_SERVER'


def answer_arguments(name: str, summary: str, argv: Sequence[str]) -> None:
    """
    Print the help of an executable that is asked for it, refuse what it does not know, and exit.

    Parameters
    ----------
    name : str
        Of the executable.
    summary : str
        What it is, of which the first line counts.
    argv : sequence of str
        The command line; with arguments for ROS only, nothing is done. Without any, the modes
        are named where there are several.

    """
    others = _not_for_ros(argv)
    if len(argv) == 1 and name in MODES:
        complain(f'{name}: {MODES[name]}')
    if any(argument in HELP for argument in others):
        report(help_of(name, summary))
        sys.exit(exit_status())
    if others:
        complain(refusal_of(name, others[0], argv))
        sys.exit(UNKNOWN)


def refusal_of(name: str, argument: str, argv: Sequence[str]) -> str:
    """Return one line that refuses an argument, with the form that works."""
    known: Optional[str] = OPTIONS.get(argument)
    if known:
        following = [*argv, ''][list(argv).index(argument) + 1]
        reason = f'{argument} needs {ROS_ARGS} before it'
        form = f'{ROS_ARGS} {argument} {following or known}'
    else:
        reason = f'unknown argument {argument!r}'
        form = f'{ROS_ARGS} ' + (
            f'--params-file {argument}' if argument.endswith(('.yaml', '.yml')) else
            f'-p {argument}' if ':=' in argument else '--params-file FILE')
    return f'{name}: {reason}, expected: {name} {form} (--help says more)'


def help_of(name: str, summary: str) -> str:
    """Return what an executable is, its topics, what must be set, and an example."""
    table = TABLES[name]
    topics = [entry for entry in table if entry.check in (check_topic, check_optional_topic)]
    required = [entry for entry in table if entry.required]
    return '\n'.join([
        summary.strip().partition('\n')[0].replace('``', ''), '',
        'Topics, by the parameter that names them:', *map(_topic, topics),
        *([] if topics else ['  none of its own']), '',
        'Parameters that must be set:',
        *(f'  {entry.name}: {entry.description}' for entry in required),
        *([] if required else ['  none']), '',
        *([f'Modes: {MODES[name]}', ''] if name in MODES else []),
        *([NOTES[name], ''] if name in NOTES else []),
        'Example:', f'  {example_of(name)}', '',
        'All parameters: docs/reference/parameters.md'])


def example_of(name: str) -> str:
    """Return a command line of an executable that works as it stands."""
    if name == 'diffdrive_sim':
        return f"{name} {ROS_ARGS} --params-file {share_directory() / 'config' / 'noiseless.yaml'}"
    settings = [f'-p {entry.name}:={VALUES[entry.name]}' for entry in TABLES[name]
                if entry.required]
    settings += [MORE[name]] if name in MORE else []
    return ' '.join([name, *([ROS_ARGS] if settings else []), *settings])


def _topic(entry: ParameterSpec) -> str:
    return f"  {entry.name} ({entry.default or 'off'}): {entry.description}"


def _not_for_ros(argv: Sequence[str]) -> Sequence[str]:
    """Return the arguments that are not for ROS, which is told by where they stand."""
    others, of_ros = [], False
    for argument in argv[1:]:
        if argument in (ROS_ARGS, '--'):
            of_ros = argument == ROS_ARGS
        elif argument and not of_ros:
            others.append(argument)
    return others


def run_or_demo(work: Callable[[Stop], int]) -> int:
    """Do ``work``, with the params file of the demo where there is none; return its status."""
    program, argv = sys.argv[0], with_params_file(sys.argv, 'demo.yaml')
    if argv is sys.argv:
        return run(work)
    show(DEMO)
    keep_to_this_machine(os.environ)
    sys.argv = argv  # where nodes look for the files that they were given
    status = run(work)
    if not status:
        show(f'to drive a robot in the browser: {program} --ros-args --params-file '
             + str(share_directory() / 'config' / 'web.yaml'))
    return status


def keep_to_this_machine(environment: MutableMapping[str, str]) -> None:
    """Let nobody else hear this process, where nothing is set about it; say so in one line."""
    if not any(environment.get(name) for name in REACH):
        environment[RANGE] = 'LOCALHOST'
        complain('diffdrive_kinematics: the demo is visible on this machine only; '
                 f'{RANGE}=SUBNET makes it visible on other machines')
