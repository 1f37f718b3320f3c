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
What ``ros2 run`` starts: one function an executable.

Signals are answered from the first moment on, before rclpy and numpy are imported, which takes
longer than an impatient Ctrl-C.
"""

import gc
from importlib import import_module
import signal
import sys

__all__ = [
    'calibrate', 'command_sequence', 'diff_drive_controller', 'diffdrive_sim',
    'forward_projection', 'goal_steering', 'plot_paths', 'robot_description', 'simulated_base',
    'teleop', 'web_view', 'wheel_noise', 'wheel_odometry']


def _start(name: str) -> None:
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: sys.exit(0))
    gc.disable()  # what is imported stays: to look for garbage in it takes a tenth of the start
    from diffdrive_kinematics.ros.runtime.command_line import answer_arguments
    module = import_module(f'diffdrive_kinematics.nodes.{name}')
    gc.freeze()
    gc.enable()
    answer_arguments(name, module.__doc__, sys.argv)
    module.main()


def calibrate() -> None:
    """Run ``calibrate``."""
    _start('calibrate')


def command_sequence() -> None:
    """Run ``command_sequence``."""
    _start('command_sequence')


def diff_drive_controller() -> None:
    """Run ``diff_drive_controller``."""
    _start('diff_drive_controller')


def diffdrive_sim() -> None:
    """Run ``diffdrive_sim``."""
    _start('diffdrive_sim')


def forward_projection() -> None:
    """Run ``forward_projection``."""
    _start('forward_projection')


def goal_steering() -> None:
    """Run ``goal_steering``."""
    _start('goal_steering')


def plot_paths() -> None:
    """Run ``plot_paths``."""
    _start('plot_paths')


def robot_description() -> None:
    """Run ``robot_description``."""
    _start('robot_description')


def simulated_base() -> None:
    """Run ``simulated_base``."""
    _start('simulated_base')


def teleop() -> None:
    """Run ``teleop``."""
    _start('teleop')


def web_view() -> None:
    """Run ``web_view``."""
    _start('web_view')


def wheel_noise() -> None:
    """Run ``wheel_noise``."""
    _start('wheel_noise')


def wheel_odometry() -> None:
    """Run ``wheel_odometry``."""
    _start('wheel_odometry')
