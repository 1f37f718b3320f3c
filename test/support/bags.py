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

"""Bags for tests, written by ``rosbags`` and not by the package."""

from diffdrive_kinematics.ros.messages.messages import quaternion_of
from geometry_msgs.msg import Pose
from rclpy.serialization import serialize_message
from rosbags.rosbag2 import Reader, ReaderError, StoragePlugin, Writer
from rosbags.typesys import get_typestore, Stores
from sensor_msgs.msg import JointState
from support.graph import set_stamp

__all__ = [
    'Reader', 'ReaderError', 'STORES', 'joints', 'pose', 'transform', 'write_bag']

STORES = {'mcap': StoragePlugin.MCAP, 'sqlite3': StoragePlugin.SQLITE3}
TYPES = get_typestore(Stores.ROS2_JAZZY)


def write_bag(path, messages, storage='mcap'):
    """Write (topic, time received [ns], message) into the directory of a bag."""
    with Writer(path, version=9, storage_plugin=STORES[storage]) as writer:
        connections = {}
        for topic, received_ns, message in messages:
            package, *_ = type(message).__module__.split('.')
            kind = getattr(message, '__msgtype__', f'{package}/msg/{type(message).__name__}')
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, kind, typestore=TYPES)
            data = (TYPES.serialize_cdr(message, kind) if hasattr(message, '__msgtype__')
                    else serialize_message(message))
            writer.write(connections[topic], received_ns, data)
    return path


def joints(time_ns, left, right):
    """Return a JointState of the wheels' angles."""
    message = JointState(name=['right_wheel_joint', 'left_wheel_joint'],
                         position=[float(right), float(left)])
    set_stamp(message, time_ns)
    return message


def pose(x, y, theta):
    """Return a Pose in the plane."""
    found = Pose()
    found.position.x, found.position.y = float(x), float(y)
    found.orientation.z, found.orientation.w = quaternion_of(float(theta))
    return found


def transform(time_ns, parent, child, x, y, theta):
    """Return a TFMessage of one transform, of the types of rosbags, as no wheel has tf2_msgs."""
    types = TYPES.types
    z, w = quaternion_of(float(theta))
    return types['tf2_msgs/msg/TFMessage']([types['geometry_msgs/msg/TransformStamped'](
        header=types['std_msgs/msg/Header'](
            stamp=types['builtin_interfaces/msg/Time'](*divmod(time_ns, 10**9)), frame_id=parent),
        child_frame_id=child,
        transform=types['geometry_msgs/msg/Transform'](
            translation=types['geometry_msgs/msg/Vector3'](float(x), float(y), 0.0),
            rotation=types['geometry_msgs/msg/Quaternion'](0.0, 0.0, z, w)))])
