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

"""The demo, which runs where no params file is given, and what is said around it."""

import os
import sys
from typing import Callable

from diffdrive_kinematics.ros.parameters.package_share import share_directory, with_params_file
from diffdrive_kinematics.ros.runtime.alone import keep_to_this_machine
from diffdrive_kinematics.ros.runtime.output import show
from diffdrive_kinematics.ros.runtime.running import run, Stop

DEMO = (
    'no params file given: running the demo (config/demo.yaml), a robot that drives a square with '
    'wheels that slip, so that its odometry drifts away from where it is')


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
