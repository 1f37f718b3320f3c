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
The least that a base in Python can cost: one flat function, and nothing around it.

It sleeps, takes what came, follows the arc of the wheel rates, and writes pose, yaw and wheel
angles into prebuilt bytes.  No covariance, no checks, no timeout, no other executor than for
rclpy's own services, ten times a second.  Arguments: rate [Hz].
"""

import gc
import math
import struct
import sys
import time

from diffdrive_kinematics.ros.runtime.rclpy_private import taker_of
from nav_msgs.msg import Odometry
import rclpy
from rclpy.experimental import EventsExecutor
from rclpy.serialization import serialize_message
from sensor_msgs.msg import JointState

RADIUS, SEPARATION = 0.033, 0.16
NANOSECONDS = 10**9


class Flat(rclpy.node.Node):
    """A node whose subscriptions no executor looks after."""

    subscriptions = ()


def run(take, odometry, joints, publish_odometry, publish_joints, serve, period_ns):
    """Integrate and publish until asked to stop."""
    x = y = theta = left = right = angle_left = angle_right = 0.0
    last_ns = time.time_ns()
    monotonic_ns, time_ns, sleep = time.monotonic_ns, time.time_ns, time.sleep
    sin, cos = math.sin, math.cos
    unpack_rates, pack_pair = struct.Struct('=2d').unpack_from, struct.Struct('=2d').pack_into
    unpack_stamp, pack_stamp = struct.Struct('=iI').unpack_from, struct.Struct('=iI').pack_into
    pack_pose = struct.Struct('=7d').pack_into
    pose_at, angles_at = len(odometry) - 85 * 8, len(joints) - 44
    next_ns, ticks = monotonic_ns() + period_ns, 0
    while True:
        left_ns = next_ns - monotonic_ns()
        if left_ns > 0:
            sleep(left_ns * 1e-9)
        next_ns += period_ns
        ticks += 1
        while True:
            taken = take()
            if not taken:
                break
            data = taken[0]
            sec, nanosec = unpack_stamp(data, 4)
            stamp_ns = sec * NANOSECONDS + nanosec
            seconds = (stamp_ns - last_ns) * 1e-9
            last_ns = stamp_ns
            d_left, d_right = left * seconds, right * seconds
            angle_left += d_left
            angle_right += d_right
            half = 0.5 * RADIUS * (d_right - d_left) / SEPARATION
            chord = 0.5 * RADIUS * (d_left + d_right) * (sin(half) / half if half else 1.0)
            x += chord * cos(theta + half)
            y += chord * sin(theta + half)
            theta += 2.0 * half
            left, right = unpack_rates(data, len(data) - 20)  # no effort: a count ends it
        now_ns = time_ns()
        seconds = (now_ns - last_ns) * 1e-9
        d_left, d_right = left * seconds, right * seconds
        half = 0.5 * RADIUS * (d_right - d_left) / SEPARATION
        chord = 0.5 * RADIUS * (d_left + d_right) * (sin(half) / half if half else 1.0)
        yaw = 0.5 * theta + half
        pack_pose(odometry, pose_at, x + chord * cos(theta + half), y + chord * sin(theta + half),
                  0.0, 0.0, 0.0, sin(yaw), cos(yaw))
        pack_pair(joints, angles_at, angle_left + d_left, angle_right + d_right)
        sec, nanosec = divmod(now_ns, NANOSECONDS)
        pack_stamp(odometry, 4, sec, nanosec)
        publish_odometry(bytes(odometry))
        pack_stamp(joints, 4, sec, nanosec)
        publish_joints(bytes(joints))
        if ticks % 10 == 0:
            serve()


def main():
    """Publish until asked to stop."""
    rclpy.init()
    node, rate = Flat('flat'), float(sys.argv[1])
    odometry, joints = Odometry(), JointState(name=['left_wheel_joint', 'right_wheel_joint'])
    odometry.header.frame_id, odometry.child_frame_id = 'odom', 'base_link'
    joints.position = joints.velocity = [0.0, 0.0]
    subscription = node.create_subscription(JointState, 'wheel_rates', len, 10, raw=True)
    executor = EventsExecutor()
    executor.add_node(node)
    publishers = [node.create_publisher(kind, topic, 10) for kind, topic in (
        (Odometry, 'odom'), (JointState, 'joint_states'))]
    gc.freeze()
    run(taker_of(subscription), *(
        bytearray(serialize_message(message)) for message in (odometry, joints)), *(
            publisher.publish for publisher in publishers),
        lambda: executor.spin_once(timeout_sec=0.0), round(NANOSECONDS / rate))


main()
