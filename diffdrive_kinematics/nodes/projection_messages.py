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

"""Messages about where a robot may be: samples of its pose, and the boundary of all of them."""

from diffdrive_kinematics.core.arc import Pose
from diffdrive_kinematics.nodes.messages import quaternion_of
from geometry_msgs.msg import Point32, PolygonStamped, Pose as PoseMsg, PoseArray
import numpy as np
from numpy.typing import NDArray
from std_msgs.msg import Header

__all__ = ['PolygonMessage', 'PosesMessage']


class PosesMessage:
    """A PoseArray that is filled anew each time."""

    def __init__(self) -> None:
        self.message = PoseArray()

    def filled(self, header: Header, poses: Pose) -> PoseArray:
        """Return the message with a header and poses [m, rad], arrays of shape (N,)."""
        self.message.header = header
        count = len(poses.x)
        if len(self.message.poses) != count:
            self.message.poses = [PoseMsg() for _ in range(count)]
        for pose, x, y, theta in zip(
                self.message.poses, poses.x.tolist(), poses.y.tolist(), poses.theta.tolist()):
            pose.position.x, pose.position.y = x, y
            pose.orientation.z, pose.orientation.w = quaternion_of(theta)
        return self.message


class PolygonMessage:
    """A PolygonStamped that is filled anew each time; its numbers travel as float32."""

    def __init__(self) -> None:
        self.message = PolygonStamped()

    def filled(
            self, header: Header, x: NDArray[np.float64], y: NDArray[np.float64]
    ) -> PolygonStamped:
        """Return the message with a header and vertices [m], not closed."""
        self.message.header = header
        self.message.polygon.points = [
            Point32(x=px, y=py) for px, py in zip(x.tolist(), y.tolist())]
        return self.message
