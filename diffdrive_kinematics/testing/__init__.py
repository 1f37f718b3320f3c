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
Tests of a user's own nodes against a robot that is simulated in lockstep with them.

The fixture ``diffdrive`` of the pytest plugin makes a :class:`~robot.Robot`.  A node under test
that calls :func:`spin` instead of ``rclpy.spin`` is waited for in every step.  This room is
imported by pytest in every environment, also in one without ROS: names load where they are used.
"""

from typing import Any

__all__ = ['Robot', 'spin']


def __getattr__(name: str) -> Any:
    if name == 'spin':
        from diffdrive_kinematics.testing.lockstep import spin
        return spin
    if name == 'Robot':
        from diffdrive_kinematics.testing.robot import Robot
        return Robot
    raise AttributeError(f'module {__name__!r} has no attribute {name!r}')
