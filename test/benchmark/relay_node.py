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
The least that can answer a command: a node that publishes a prebuilt message for each one heard.

The executor is that of the package.  Argument: ``objects`` for message objects in and out, as
most nodes have them; ``bytes`` for serialised ones, which is what the package uses.
"""

import sys

from geometry_msgs.msg import Twist
import rclpy
from rclpy.experimental import EventsExecutor
from rclpy.serialization import serialize_message
from sensor_msgs.msg import JointState


def main():
    """Answer until asked to stop."""
    raw = sys.argv[1] == 'bytes'
    rclpy.init()
    node = rclpy.create_node('relay')
    answer = JointState(name=['left_wheel_joint', 'right_wheel_joint'], velocity=[1.0, 2.0])
    publisher = node.create_publisher(JointState, 'wheel_rates', 10)
    prebuilt = serialize_message(answer) if raw else answer
    node.create_subscription(
        Twist, 'cmd_vel', lambda _: publisher.publish(prebuilt), 10, raw=raw)
    executor = EventsExecutor()
    executor.add_node(node)
    while True:
        executor.spin_once(timeout_sec=1.0)


main()
