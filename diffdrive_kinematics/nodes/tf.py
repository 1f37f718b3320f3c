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

import math
from typing import Any, Mapping, TYPE_CHECKING

from builtin_interfaces.msg import Time
from diffdrive_kinematics.core.arc import Pose
from geometry_msgs.msg import TransformStamped
from nav_msgs.msg import Odometry

if TYPE_CHECKING:
    from diffdrive_kinematics.nodes.node import DiffDriveNode

__all__ = ['TransformPublisher', 'frame_prefix']


def frame_prefix(values: Mapping[str, Any], namespace: str) -> str:
    """
    Return what stands before the frames of a node, as in ros2_controllers; '' where not enabled.

    Without a prefix of its own it is the namespace; it ends with a slash and begins with none.
    """
    if not values['tf_frame_prefix_enable']:
        return ''
    prefix = (values['tf_frame_prefix'] or namespace).strip('/')
    return f'{prefix}/' if prefix else ''


class TransformPublisher:
    """
    Publishes transforms on ``/tf``.

    Where tf2_msgs is missing one warning says how to get it or do without (set ``switch``, the
    parameter that asked for tf, to false), and nothing is published.
    """

    def __init__(self, node: 'DiffDriveNode', switch: str) -> None:
        self._publisher = None
        try:
            from tf2_msgs.msg import TFMessage
        except ImportError:
            node.get_logger().warning(
                'tf is off: the package tf2_msgs is missing (apt install ros-jazzy-tf2-msgs); '
                f'set {switch} to false to do without')
            return
        self._message = TFMessage(transforms=[TransformStamped()])
        self._publisher = node.publisher(TFMessage, '/tf')

    def __bool__(self) -> bool:
        """Return whether tf2_msgs is there."""
        return self._publisher is not None

    def publish(self, odometry: Odometry) -> None:
        """Publish the transform header.frame_id -> child_frame_id of an odometry."""
        if self._publisher is None:
            return
        transform = self._message.transforms[0]
        transform.header = odometry.header
        transform.child_frame_id = odometry.child_frame_id
        transform.transform.translation.x = odometry.pose.pose.position.x
        transform.transform.translation.y = odometry.pose.pose.position.y
        transform.transform.rotation = odometry.pose.pose.orientation
        self._publisher.publish(self._message)

    def publish_pose(self, stamp: Time, frame_id: str, child_frame_id: str, pose: Pose) -> None:
        """Publish the pose of a frame in another one."""
        if self._publisher is None:
            return
        transform = self._message.transforms[0]
        transform.header.stamp = stamp
        transform.header.frame_id, transform.child_frame_id = frame_id, child_frame_id
        transform.transform.translation.x = float(pose.x)
        transform.transform.translation.y = float(pose.y)
        transform.transform.rotation.z = math.sin(0.5 * pose.theta)
        transform.transform.rotation.w = math.cos(0.5 * pose.theta)
        self._publisher.publish(self._message)
