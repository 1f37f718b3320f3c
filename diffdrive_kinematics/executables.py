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

from functools import partial
import gc
from importlib import import_module
import sys

from diffdrive_kinematics.ros.runtime.signals import answer_signals

__all__ = [
    'calibrate', 'command_sequence', 'diff_drive_controller', 'diffdrive_sim',
    'forward_projection', 'goal_steering', 'plot_paths', 'robot_description', 'simulated_base',
    'teleop', 'web_view', 'wheel_noise', 'wheel_odometry']


def _start(name: str) -> None:
    answer_signals(lambda *_: sys.exit(0))
    gc.disable()  # what is imported stays: to look for garbage in it takes a tenth of the start
    from diffdrive_kinematics.ros.runtime.command_line import answer_arguments
    module = import_module(f'diffdrive_kinematics.nodes.{name}')
    gc.freeze()
    gc.enable()
    answer_arguments(name, module.__doc__ or name, sys.argv)  # there is none with python -OO
    module.main()


calibrate = partial(_start, 'calibrate')
command_sequence = partial(_start, 'command_sequence')
diff_drive_controller = partial(_start, 'diff_drive_controller')
diffdrive_sim = partial(_start, 'diffdrive_sim')
forward_projection = partial(_start, 'forward_projection')
goal_steering = partial(_start, 'goal_steering')
plot_paths = partial(_start, 'plot_paths')
robot_description = partial(_start, 'robot_description')
simulated_base = partial(_start, 'simulated_base')
teleop = partial(_start, 'teleop')
web_view = partial(_start, 'web_view')
wheel_noise = partial(_start, 'wheel_noise')
wheel_odometry = partial(_start, 'wheel_odometry')
