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

"""What the command line and params files set for a node."""

from typing import Mapping

from diffdrive_kinematics.ros.parameters.configuration_error import ConfigurationError
from rclpy.node import Node
from rclpy.parameter import Parameter

__all__ = ['given_overrides']


def given_overrides(node: Node) -> Mapping[str, Parameter]:
    """
    Return the parameters that were set for a node from outside, by name, declared or not.

    rclpy has no public name for them.

    Raises
    ------
    ConfigurationError
        If this rclpy keeps them elsewhere: without them no typo in a params file is noticed, and
        no quality of service that it asks for.

    """
    try:
        return node._parameter_overrides
    except AttributeError:
        from importlib.metadata import PackageNotFoundError, version
        try:
            found = version('rclpy')
        except PackageNotFoundError:
            found = 'of unknown version'
        raise ConfigurationError(
            f'{node.get_fully_qualified_name()} refuses to start: this rclpy ({found}) has no '
            'Node._parameter_overrides, from which typos in params files and qualities of '
            'service are read; expected rclpy 7 (ROS 2 Jazzy), or a newer diffdrive_kinematics'
        ) from None
