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
A hand-written Python node that publishes prebuilt bytes, to compare the package with.

Wheel rates in (raw), odometry and joint states out at a fixed rate, as bytes of which only the
stamp is overwritten; a timer of rclpy, EventsExecutor.  It integrates nothing.
Arguments: rate [Hz].
"""

import struct
import sys
import time

from nav_msgs.msg import Odometry
import rclpy
from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.experimental import EventsExecutor
from rclpy.serialization import serialize_message
from sensor_msgs.msg import JointState

STAMP = struct.Struct('<iI')


def main():
    """Publish until asked to stop."""
    rclpy.init()
    node = rclpy.create_node('prebuilt')
    odometry, joints = Odometry(), JointState(name=['left_wheel_joint', 'right_wheel_joint'])
    odometry.header.frame_id, odometry.child_frame_id = 'odom', 'base_link'
    joints.position = joints.velocity = [0.0, 0.0]
    templates = [bytearray(serialize_message(message)) for message in (odometry, joints)]
    publishers = [node.create_publisher(kind, topic, 10) for kind, topic in (
        (Odometry, 'odom'), (JointState, 'joint_states'))]
    heard = []

    def tick():
        now_ns = time.time_ns()
        for template, publisher in zip(templates, publishers):
            STAMP.pack_into(template, 4, now_ns // 10**9, now_ns % 10**9)
            publisher.publish(bytes(template))

    def on_wheels(data):
        heard[:] = [len(data)]

    node.create_subscription(JointState, 'wheel_rates', on_wheels, 10, raw=True)
    node.create_timer(1.0 / float(sys.argv[1]), tick, clock=Clock(
        clock_type=ClockType.STEADY_TIME))
    executor = EventsExecutor()
    executor.add_node(node)
    while True:
        executor.spin_once(timeout_sec=1.0)


main()
