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
"""The way that a base has come, as a nav_msgs/Path: bounded, thinned out, and published slowly."""

import math
from typing import Any, Mapping, Optional

from diffdrive_kinematics.core.kinematics import Pose
from diffdrive_kinematics.ros.messages.codec import PathCodec
from diffdrive_kinematics.ros.runtime.node import DiffDriveNode
from nav_msgs.msg import Path


class PathPublisher:
    """
    Keeps the last poses of a base, and publishes them where they have changed.

    Parameters
    ----------
    node : DiffDriveNode
        The node that publishes.
    values : mapping
        Its parameters: ``path_topic``, ``path_length``, ``path_spacing``, ``path_rate``.
    frame_id : str
        Of the poses.

    """

    def __init__(self, node: DiffDriveNode[Any], values: Mapping[str, Any], frame_id: str) -> None:
        self._spacing = values['path_spacing']
        self._message = PathCodec(frame_id, values['path_length'])
        self._last: Optional[Pose] = None
        self._subscribers = 0
        self._publisher = node.runtime.publish(Path, values['path_topic'])
        node.runtime.every(values['path_rate'], self._publish)

    def begin_anew(self) -> None:
        """Forget the way so far: a robot that was put elsewhere did not drive there."""
        self._message.clear()
        self._last = None

    def add(self, time_ns: int, pose: Pose) -> None:
        """Add a pose where it is far enough from the last one."""
        if self._last is not None and math.hypot(
                pose.x - self._last.x, pose.y - self._last.y) < self._spacing:
            return
        self._last = pose
        self._message.add(time_ns, pose)
        self._subscribers = 0

    def _publish(self) -> None:
        """Publish the path where it has changed, or somebody subscribes anew."""
        subscribers = self._publisher.get_subscription_count()
        if len(self._message) and subscribers > self._subscribers:
            self._publisher.publish(self._message.encode())
        self._subscribers = subscribers
