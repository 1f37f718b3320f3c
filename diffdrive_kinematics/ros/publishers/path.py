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
"""The way that a base has come, as a nav_msgs/Path: bounded, thinned out, and told slowly."""

import math
import struct
from typing import Any, Mapping, Optional, TYPE_CHECKING

from diffdrive_kinematics.core.kinematics import Pose
from diffdrive_kinematics.ros.messages.cdr import HEADER, NANOSECONDS, stamped_sequence
from diffdrive_kinematics.ros.messages.messages import quaternion_of
from nav_msgs.msg import Path

if TYPE_CHECKING:
    from diffdrive_kinematics.ros.runtime.node import DiffDriveNode

__all__ = ['PathMessage', 'PathPublisher']


class PathMessage:
    """
    A serialised Path that grows at its end, and loses its oldest poses beyond a length.

    A message object of 1000 poses costs milliseconds each time that it is published, and one of
    100,000 half a second.  Every pose ends where a double does, so all but the first begin alike.
    """

    def __init__(self, frame_id: str, most: int) -> None:
        self.frame_id, self._most = frame_id, most
        self._stamp = (0, 0)
        encoded = frame_id.encode() + b'\0'
        self._name = struct.pack('=I', len(encoded)) + encoded
        begin = len(stamped_sequence(*self._stamp, frame_id, 0)) - len(HEADER)
        in_frame = f'=iI{len(self._name)}s'
        used = struct.calcsize(in_frame)
        self._first = struct.Struct(f'{in_frame}{-(begin + used) % 8}x')
        self._pose = struct.Struct(f'{in_frame}{-used % 8}x7d')
        self._numbers_at = self._pose.size - struct.calcsize('=7d')
        self._poses = bytearray()

    def __len__(self) -> int:
        """Return the number of poses."""
        return len(self._poses) // self._pose.size

    def clear(self) -> None:
        """Forget all poses."""
        self._poses.clear()

    def add(self, time_ns: int, pose: Pose) -> None:
        """Add a pose with its time [ns], which is that of the path as well."""
        self._stamp = time_ns // NANOSECONDS, time_ns % NANOSECONDS
        if len(self) >= self._most:
            del self._poses[:self._pose.size]
        self._poses += self._pose.pack(
            *self._stamp, self._name, pose.x, pose.y, 0.0, 0.0, 0.0, *quaternion_of(pose.theta))

    def message(self) -> bytes:
        """Return what is to be published."""
        front = stamped_sequence(*self._stamp, self.frame_id, len(self))
        if not self._poses:
            return front
        first = self._first.pack(*struct.unpack_from('=iI', self._poses), self._name)
        return b''.join((front, first, memoryview(self._poses)[self._numbers_at:]))


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

    def __init__(
            self, node: 'DiffDriveNode[Any]', values: Mapping[str, Any], frame_id: str) -> None:
        self._spacing = values['path_spacing']
        self._message = PathMessage(frame_id, values['path_length'])
        self._last: Optional[Pose] = None
        self._told_to = 0
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
        self._told_to = 0

    def _publish(self) -> None:
        """Publish what somebody has not heard yet."""
        listeners = self._publisher.get_subscription_count()
        if len(self._message) and listeners > self._told_to:
            self._publisher.publish(self._message.message())
        self._told_to = listeners
