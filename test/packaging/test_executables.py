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

"""The executables are where the installation promises them."""

from importlib.metadata import distributions
import os
from pathlib import Path
import sys

from ament_index_python import get_package_prefix
import pytest

PACKAGE_NAME = 'diffdrive_kinematics'
EXECUTABLES = ('calibrate', 'command_sequence', 'diff_drive_controller', 'diffdrive_sim',
               'forward_projection', 'goal_steering', 'plot_paths', 'robot_description',
               'simulated_base', 'teleop', 'web_view', 'wheel_noise', 'wheel_odometry')


def colcon_directory():
    """Return the directory in which `ros2 run` looks, or None outside of a ROS workspace."""
    try:
        prefix = Path(get_package_prefix(PACKAGE_NAME))
    except LookupError:  # PackageNotFoundError is one
        return None
    except EnvironmentError:  # no AMENT_PREFIX_PATH
        return None
    return None if prefix == Path(sys.prefix) else prefix / 'lib' / PACKAGE_NAME


def pip_directory():
    """Return the directory of this Python's executables, or None if pip installed nothing."""
    installed = any(distribution.read_text('RECORD') is not None
                    for distribution in distributions(name=PACKAGE_NAME))
    return Path(sys.executable).parent if installed else None


@pytest.mark.parametrize('name', EXECUTABLES)
def test_the_executable_is_installed(name):
    """Under lib/diffdrive_kinematics by colcon, beside the interpreter by pip."""
    directory = colcon_directory() or pip_directory()
    if directory is None:
        pytest.skip(f'{PACKAGE_NAME} is not installed')
    executable = directory / name
    assert executable.is_file()
    assert os.access(executable, os.X_OK)
