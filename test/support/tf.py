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

"""What is on ``/tf``, with and without tf2_msgs."""

import importlib.util
import struct
from types import SimpleNamespace

from diffdrive_kinematics.ros.messages.tf_message_type import tf_message_type
from geometry_msgs.msg import TransformStamped
from rclpy.serialization import deserialize_message

__all__ = ['read', 'transforms', 'transforms_of']

HAS_TF2_MSGS = importlib.util.find_spec('tf2_msgs') is not None
HEADER_BYTES = 4  # before what is aligned


def transforms(graph):
    """Return a list to which every transform on /tf is added."""
    found = []
    if HAS_TF2_MSGS:
        from tf2_msgs.msg import TFMessage
        graph.collect(TFMessage, '/tf', lambda message: found.extend(message.transforms))
    else:
        graph.node.create_subscription(
            tf_message_type(), '/tf', lambda data: found.append(transform_of(data)), 1000,
            raw=True)
    return found


def transforms_of(robot):
    """Return every transform of a robot of the fixture ``diffdrive`` so far."""
    return [one for _, message in robot.history('/tf') for one in (
        [transform_of(message)] if isinstance(message, bytes) else message.transforms)]


def read(data, message_type):
    """Return a serialised message as an object, or what has the transforms of one of tf."""
    if message_type is tf_message_type():
        return SimpleNamespace(transforms=[transform_of(data)])
    return deserialize_message(data, message_type)


def transform_of(data):
    """Return the one transform of a serialised TFMessage."""
    body, at = data[HEADER_BYTES:], 4

    def take(form, align):
        nonlocal at
        at += -at % align
        values = struct.unpack_from(form, body, at)
        at += struct.calcsize(form)
        return values

    assert struct.unpack_from('<I', body) == (1,)
    stamp, texts = take('<iI', 4), []
    for _ in range(2):
        length, = take('<I', 4)
        text, = take(f'<{length}s', 1)
        texts.append(text[:-1].decode())
    numbers = take('<7d', 8)
    message = TransformStamped(child_frame_id=texts[1])
    message.header.frame_id = texts[0]
    message.header.stamp.sec, message.header.stamp.nanosec = stamp
    for part, names, values in (
            (message.transform.translation, 'xyz', numbers[:3]),
            (message.transform.rotation, 'xyzw', numbers[3:])):
        for name, value in zip(names, values):
            setattr(part, name, value)
    return message
