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
"""What ``ros2 param describe`` tells of a parameter."""

import math

from diffdrive_kinematics.ros.parameters.parameter_spec import Kind, ParameterSpec
from rcl_interfaces.msg import ParameterDescriptor

__all__ = ['descriptor_of']

IMPOSSIBLE = {Kind.DOUBLE: -math.inf, Kind.INTEGER: -2**62, Kind.STRING: '~ ', Kind.STRINGS: (),
              Kind.DOUBLES: (-math.inf,)}


def descriptor_of(entry: ParameterSpec) -> ParameterDescriptor:
    """
    Return the descriptor of a parameter.

    What its check expects stands there in words, as many bounds are open or allow NaN.  Its type
    is said to be dynamic so that values of another type are refused in our words, not rclpy's.
    """
    return ParameterDescriptor(
        description=entry.description, dynamic_typing=True, read_only=entry.read_only,
        additional_constraints=_expected(entry))


def _expected(entry: ParameterSpec) -> str:
    """Return what the check of a parameter expects, in the words of its error; '' for none."""
    try:
        if entry.check is not None:
            entry.check(entry.name, IMPOSSIBLE[entry.kind])
    except ValueError as error:
        return str(error).partition('expected ')[2].partition(' (topic')[0]
    return ''
