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

"""Transforms of the odometry, for tf2; optional at run time."""

from typing import TYPE_CHECKING

from geometry_msgs.msg import TransformStamped
from nav_msgs.msg import Odometry

if TYPE_CHECKING:
    from diffdrive_kinematics.nodes.node import DiffDriveNode

__all__ = ['TransformPublisher']


class TransformPublisher:
    """
    Publishes the pose of an odometry as a transform on ``/tf``.

    Where tf2_msgs is missing one warning says how to get it, and nothing is published.
    """

    def __init__(self, node: 'DiffDriveNode') -> None:
        self._publisher = None
        try:
            from tf2_msgs.msg import TFMessage
        except ImportError:
            node.get_logger().warning(
                'tf is off: the package tf2_msgs is missing (apt install ros-jazzy-tf2-msgs); '
                'set enable_odom_tf to false to do without')
            return
        self._message = TFMessage(transforms=[TransformStamped()])
        self._publisher = node.publisher(TFMessage, '/tf')

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
