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

"""Wheel commands of a controller: wheel rates, and on request set points and the limited twist."""

from typing import Any, Iterable, List, Mapping

from diffdrive_kinematics.core.commands import WheelCommand
from diffdrive_kinematics.ros.messages.codec import TwistCodec
from diffdrive_kinematics.ros.messages.wheel_joints import wheel_joints
from diffdrive_kinematics.ros.messages.wheel_messages import set_points, WheelWriter
from diffdrive_kinematics.ros.runtime.node import DiffDriveNode
from geometry_msgs.msg import TwistStamped
from rclpy.publisher import Publisher
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64MultiArray


class WheelCommandPublisher:
    """
    Publishes wheel commands, with their stamps where the message has one.

    Parameters
    ----------
    node : DiffDriveNode
        That publishes.
    values : mapping
        Its parameters.

    """

    def __init__(self, node: DiffDriveNode[Any], values: Mapping[str, Any]) -> None:
        joints, runtime = wheel_joints(values), node.runtime
        self._node, self._joints = node, joints
        self._rates = WheelWriter(joints, node.source())
        self._twist = TwistCodec(values['base_frame_id'])
        self.rates_publisher = runtime.publish(JointState, values['wheel_rates_topic'])
        self._set_point_publisher = runtime.publish_unless_off(
            Float64MultiArray, values['wheel_commands_topic'])
        self._twist_publisher = runtime.publish(
            TwistStamped, values['cmd_vel_out_topic']
        ) if values['publish_limited_velocity'] else None
        self.last_ns = -1  # stamp of the last one; none yet

    def publish(self, commands: Iterable[WheelCommand]) -> None:
        """Publish; the first message has no positions and is the baseline for the others'."""
        for command in commands:
            first = self.last_ns < 0
            self._node.health.sent += 1
            self.last_ns = command.stamp_ns
            self.rates_publisher.publish(self._rates.encode(
                command.stamp_ns, command.rates, None if first else command.angles))
            if self._set_point_publisher:
                self._set_point_publisher.publish(set_points(self._joints, command.rates))
            if self._twist_publisher:
                self._twist_publisher.publish(self._twist.encode(command.stamp_ns, *command.twist))

    def clock_stepped(self, step_ns: int) -> None:
        """Note that the clock of the stamps was stepped."""
        if self.last_ns >= 0:
            self.last_ns = max(0, self.last_ns + step_ns)

    def publishers(self) -> List[Publisher]:
        """Return the publishers in use."""
        return [publisher for publisher in (
            self.rates_publisher, self._set_point_publisher, self._twist_publisher) if publisher]
