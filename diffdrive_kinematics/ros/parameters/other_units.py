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

"""Values that are within their checks and cannot be meant, as they are in other units."""

import math
from typing import Any, Callable, Mapping

from diffdrive_kinematics.ros.parameters.said import is_new

LONGEST_RADIUS_M, WIDEST_M = 5.0, 20.0  # wheels of mining trucks have 2 m, gantries are 15 m wide
LONGEST_TIMEOUT_S = 100.0  # for which nobody lets a robot drive on without a word
SLOWEST_HZ = 0.1


def _length(most: float) -> Callable[[str, float], str]:
    def doubt(name: str, value: float) -> str:
        return '' if not value > most else (
            f'{name} is {value!r}, in metres: {value:g} millimetres are {1e-3 * value:g}')
    return doubt


def _timeout(name: str, value: float) -> str:
    return '' if value < LONGEST_TIMEOUT_S else (
        f'{name} is {value!r}, in seconds: {value:g} milliseconds are {1e-3 * value:g}')


def _rate(name: str, value: float) -> str:
    return '' if value >= SLOWEST_HZ else (
        f'{name} is {value!r}, in Hz: once in {value:g} seconds is {1.0 / value:g}')


def _poses(name: str, values: Any) -> str:
    for yaw in values[2::3]:
        if abs(yaw) > 6.3:  # a turn, however it was rounded
            return (f'the yaw in {name} is {yaw!r}, in radians: {yaw:g} degrees are '
                    f'{math.radians(yaw):g}')
    return ''


DOUBTS: Mapping[str, Callable[[str, Any], str]] = {
    'wheel_radius': _length(LONGEST_RADIUS_M), 'wheel_separation': _length(WIDEST_M),
    'cmd_vel_timeout': _timeout, 'command_timeout': _timeout, 'odom_timeout': _timeout,
    'publish_rate': _rate, 'initial_pose': _poses, 'goals': _poses}


def doubt_of(name: str, value: Any) -> str:
    """Return in words that the value of a parameter cannot be meant; empty: it can."""
    doubt = DOUBTS[name](name, value) if name in DOUBTS else ''
    return doubt and f'{doubt}, is that meant?'


def report_other_units(node: Any, values: Mapping[str, Any], before: Mapping[str, Any]) -> None:
    """
    Report values that cannot be meant, each once in a process.

    Parameters
    ----------
    node : rclpy.node.Node
        For which they are set.
    values, before : mapping
        Of its parameters, now and before; of what did not change nothing is said.

    """
    for name in DOUBTS:
        if name not in values or values[name] == before.get(name):
            continue
        text = doubt_of(name, values[name])
        if text and is_new(node, text):
            node.get_logger().warning(text)
