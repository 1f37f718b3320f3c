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

"""Transforms for tf2, optional at run time, and the names of their frames."""

from typing import Any, Mapping, Optional, Tuple

from diffdrive_kinematics.core.kinematics import Pose
from diffdrive_kinematics.ros.messages.codec import TransformCodec
from diffdrive_kinematics.ros.messages.tf_message_type import tf_message_type
from diffdrive_kinematics.ros.runtime.node import DiffDriveNode
from diffdrive_kinematics.ros.runtime.rclpy_private import given_overrides


def frame_prefix(values: Mapping[str, Any], namespace: str) -> str:
    """
    Return what stands before the frames of a node, as in ros2_controllers; '' where not enabled.

    Without a prefix of its own it is the namespace, which is ``~`` in one; it ends with a slash
    and begins with none.
    """
    if not values['tf_frame_prefix_enable']:
        return ''
    prefix = values['tf_frame_prefix'] or '~'
    if prefix.startswith('~'):
        prefix = namespace + prefix[1:]
    prefix = prefix.strip('/')
    return f'{prefix}/' if prefix else ''


def _message_type() -> Optional[type]:
    try:
        from tf2_msgs.msg import TFMessage
    except ImportError:
        return tf_message_type()
    return TFMessage


class TransformPublisher:
    """Publishes transforms on ``/tf``."""

    def __init__(self, node: DiffDriveNode, message_type: type) -> None:
        self._message = TransformCodec('', '')
        self._publisher = node.runtime.publish(message_type, '/tf')

    def publish(self, stamp_ns: int, frames: Tuple[str, str], pose: Pose) -> None:
        """Publish the pose of a frame in another one; frames are (parent, child)."""
        if frames != self._message.frames:
            self._message = TransformCodec(*frames)
        self._publisher.publish(self._message.encode(stamp_ns, pose))


def transforms(node: DiffDriveNode, switch: str) -> Optional[TransformPublisher]:
    """
    Return what publishes transforms, where a parameter asks for it.

    Where tf2_msgs is missing, and its type cannot be made, one line says how to get it or do
    without (set the parameter to false).  It is a warning where somebody set it, and for
    information where it is on by default.
    """
    if not node.config.values[switch]:
        return None
    if message_type := _message_type():
        return TransformPublisher(node, message_type)
    log = node.get_logger()
    say = log.warning if switch in given_overrides(node) else log.info
    say('tf is off: the package tf2_msgs is missing (apt install ros-jazzy-tf2-msgs); '
        f'set {switch} to false to run without it')
    return None
