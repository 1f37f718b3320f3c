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
Ears of a test on another machine: what ``odom`` and ``wheel_rates`` say, as lines of JSON.

``python watcher.py``; it runs until it is killed.
"""

import json
import math

from nav_msgs.msg import Odometry
import rclpy
from rclpy.executors import SingleThreadedExecutor
from sensor_msgs.msg import JointState


def say(kind, message, *values):
    """Print the stamp [ns] of a message and what it says."""
    stamp = message.header.stamp
    print(json.dumps([kind, stamp.sec * 10**9 + stamp.nanosec, *values]), flush=True)


def main():
    """Listen."""
    rclpy.init()
    node = rclpy.create_node('watcher')
    node.create_subscription(Odometry, 'odom', lambda message: say(
        'odom', message, message.pose.pose.position.x, message.pose.pose.position.y,
        2.0 * math.atan2(message.pose.pose.orientation.z, message.pose.pose.orientation.w),
        message.twist.twist.linear.x), 100)
    node.create_subscription(JointState, 'wheel_rates', lambda message: say(
        'wheels', message, *message.velocity, *message.position), 100)
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    executor.spin()


if __name__ == '__main__':
    main()
