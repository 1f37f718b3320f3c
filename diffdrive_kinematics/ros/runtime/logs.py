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

"""
What to do about errors of rcl, and the directory of log files, which it insists on.

A service without HOME has none.
"""

from typing import Mapping, Sequence

from diffdrive_kinematics.ros.parameters.configuration_error import ConfigurationError

DIRECTORIES = 'ROS_LOG_DIR', 'ROS_HOME', 'HOME'
NO_FILES = '--disable-external-lib-logs'
REMEDY = (
    'set ROS_LOG_DIR to a directory that can be written (Environment= or LogsDirectory= of a '
    f'systemd unit), or ROS_HOME or HOME, or keep no log files: --ros-args {NO_FILES}')

HINTS = {  # to what rcl says of params files, -p and -r
    'Sequence should be of same type':
        'all numbers of a list need the same form: [0.1, 0.0, 4.0], not [0.1, 0, 4]',
    'Error opening YAML file':
        'the file does not exist (paths are relative to the current directory), or cannot be '
        'read',
    'Cannot have a value before ros__parameters':
        'expected a line NODE: (or /**:), below it ros__parameters: (two underscores), and the '
        'values below that, each level two spaces further right',
    'Error parsing a event':
        'there is no YAML: is it a directory? If not, indent by spaces instead of tabs',
    "Couldn't parse remap rule":
        "expected -r FROM:=TO; a namespace begins with '/' and has letters, digits and '_', as in "
        '-r __ns:=/robot1'}


def check_log_directory(environment: Mapping[str, str], argv: Sequence[str]) -> None:
    """Raise ``ConfigurationError`` where rcl would find no directory, and say so at length."""
    elsewhere = NO_FILES in argv or environment.get('RCL_LOGGING_IMPLEMENTATION')
    if not elsewhere and not any(environment.get(name) for name in DIRECTORIES):
        raise ConfigurationError(
            f"there is no directory for log files, as {', '.join(DIRECTORIES)} are not set: "
            f'{REMEDY}')


def with_remedy(error: str) -> str:
    """Return what rcl says, with what to do where that is known."""
    for words, hint in HINTS.items():
        if words in error:
            return f"{error.partition(', at ')[0]}: {hint}"
    if 'log directory' not in error and 'logging directory' not in error:
        return error
    return f"{error.partition(', at ')[0]}: {REMEDY}"
