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

"""The type of velocity commands, and whether somebody publishes them in another one."""

from typing import Any, Mapping

from geometry_msgs.msg import Twist, TwistStamped

LOOK_PERIOD_NS = 2_000_000_000


class CommandType:
    """
    The type of the commands that a node listens to, and its topic.

    Parameters
    ----------
    node : DiffDriveNode
        That listens.
    values : mapping
        Its parameters.

    """

    def __init__(self, node: Any, values: Mapping[str, Any]) -> None:
        self._node, self.stamped = node, values['enable_stamped_cmd_vel']
        self.message_type = TwistStamped if self.stamped else Twist
        self.name = f'geometry_msgs/msg/{self.message_type.__name__}'
        self.topic = node.resolve_topic_name(values['cmd_vel_topic'])
        self._look_at_ns = node.runtime.now_ns() + LOOK_PERIOD_NS

    def look_for_others(self, now_ns: int) -> None:
        """Say so now and then where commands are published in a type that is not heard."""
        if now_ns < self._look_at_ns:
            return
        self._look_at_ns = now_ns + LOOK_PERIOD_NS
        others = {info.topic_type for info in self._node.get_publishers_info_by_topic(self.topic)}
        if others := others - {self.name}:
            self._node.get_logger().warning(
                f"'{self.topic}' carries {', '.join(sorted(others))}, expected {self.name}: is "
                f'enable_stamped_cmd_vel (now {str(self.stamped).lower()}) set as it should be?')
