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
"""``robot_description``: the robot of the geometry as URDF, on a topic or in a file."""

import math
from typing import Any, Mapping, NamedTuple

from diffdrive_kinematics.ros.messages.urdf import default_wheel_base, Shape, urdf_of
from diffdrive_kinematics.ros.messages.wheel_joints import wheel_joints
from diffdrive_kinematics.ros.parameters.configuration_error import refusing
from diffdrive_kinematics.ros.parameters.from_values import check_sides, wheel_geometry
from diffdrive_kinematics.ros.parameters.qos import latched
from diffdrive_kinematics.ros.parameters.tables import ROBOT_DESCRIPTION
from diffdrive_kinematics.ros.runtime.node import DiffDriveNode
from diffdrive_kinematics.ros.runtime.running import main_of
from diffdrive_kinematics.tools.output_files import write_files
from std_msgs.msg import String

WIDTH = 0.5  # of a wheel whose width is not set, in radii


class Config(NamedTuple):
    """What is described, and how."""

    urdf: str
    values: Mapping[str, Any]


def build(values: Mapping[str, Any]) -> Config:
    """Return the configuration of parameter values, or raise ``ValueError``."""
    check_sides(values)
    geometry = wheel_geometry(values)
    joints = wheel_joints(values)
    wheel_base, width = values['wheel_base'], values['wheel_width']
    if math.isnan(wheel_base):
        wheel_base = default_wheel_base(geometry, max(map(len, joints.names)))
    if math.isnan(width):
        width = WIDTH * min(geometry.left_radius, geometry.right_radius)
    return Config(urdf_of(
        geometry, joints, name=values['robot_name'], base=values['base_frame_id'],
        shape=Shape(wheel_base, width)), values)


class RobotDescription(DiffDriveNode[Config]):
    """Publishes the URDF for all who come, now or later; with ``output`` it writes it and ends."""

    def __init__(self, name: str = 'robot_description', **composition: Any) -> None:
        super().__init__(name, ROBOT_DESCRIPTION, build, **composition)
        values = self.config.values
        if values['output']:
            self._write(values['output'])
            self.done = True
            return
        self._publisher = self.runtime.publish(
            String, values['robot_description_topic'], latched())
        self._publish(self.config)
        self.parameters.on_change(self._publish)

    def _publish(self, config: Config) -> None:
        self._publisher.publish(String(data=config.urdf))

    def _write(self, file: str) -> None:
        text = _params_file(self.config.urdf) if file.endswith('.yaml') else self.config.urdf
        with refusing(self.get_fully_qualified_name()):
            write_files({file: text.encode()}, overwrite=self.config.values['overwrite'])
        self.get_logger().info(f'wrote {file}')


def _params_file(urdf: str) -> str:
    """Return a params file with the parameter that robot_state_publisher takes."""
    lines = ''.join(f'      {line}\n' for line in urdf.splitlines())
    return f'/**:\n  ros__parameters:\n    robot_description: |\n{lines}'


main = main_of(RobotDescription)
