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

"""The plain codec for messages of many poses: paths, samples of the pose, boundaries."""

from collections import deque
from typing import Deque, List

from diffdrive_kinematics.core.kinematics import Array, Pose
from diffdrive_kinematics.ros.messages.plain import header_of, pose_message
from geometry_msgs.msg import Point32, PolygonStamped, Pose as PoseMessage, PoseArray, PoseStamped
from nav_msgs.msg import Path
from std_msgs.msg import Header

__all__ = ['PathCodec', 'encode_polygon', 'encode_poses']


class PathCodec:
    """A Path that grows at its end, and loses its oldest poses beyond a length."""

    def __init__(self, frame_id: str, most: int) -> None:
        self._frame_id = frame_id
        self._poses: Deque[PoseStamped] = deque(maxlen=most)
        self._stamp_ns = 0

    def __len__(self) -> int:
        """Return the number of poses."""
        return len(self._poses)

    def clear(self) -> None:
        """Forget all poses."""
        self._poses.clear()

    def add(self, time_ns: int, pose: Pose) -> None:
        """Add a pose with its time [ns], which is that of the path as well."""
        self._stamp_ns = time_ns
        self._poses.append(PoseStamped(
            header=header_of(self._frame_id, time_ns), pose=pose_message(pose)))

    def encode(self) -> Path:
        """Return the message."""
        return Path(header=header_of(self._frame_id, self._stamp_ns), poses=list(self._poses))


def encode_poses(header: Header, rows: Array) -> PoseArray:
    """Return a PoseArray of rows, shape (N, 7): x, y, z [m] and the quaternion x, y, z, w."""
    poses: List[PoseMessage] = []
    for row in rows.tolist():
        pose = PoseMessage()
        pose.position.x, pose.position.y, pose.position.z = row[:3]
        q = pose.orientation
        q.x, q.y, q.z, q.w = row[3:]
        poses.append(pose)
    return PoseArray(header=header, poses=poses)


def encode_polygon(header: Header, x: Array, y: Array) -> PolygonStamped:
    """Return a PolygonStamped of vertices [m]; its numbers travel as float32."""
    message = PolygonStamped(header=header)
    message.polygon.points = [Point32(x=a, y=b) for a, b in zip(x.tolist(), y.tolist())]
    return message
