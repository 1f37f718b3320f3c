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

"""What the page of ``web_view`` shows: messages in, a frame of numbers for JSON out."""

import math
from typing import Any, Dict, Iterable, List, Optional, Tuple

from diagnostic_msgs.msg import DiagnosticArray
from diffdrive_kinematics.core.kinematics import advance, Pose, wrap_angle
from diffdrive_kinematics.ros.messages.messages import nanoseconds, pose_in_plane
from geometry_msgs.msg import PolygonStamped, PoseArray
from nav_msgs.msg import Odometry
import numpy as np

THIN = 0.05  # of the wheel separation: how far apart the points of a trail are
LONGEST = 5000  # points of a trail
NEAR_NS = 500_000_000  # between truth and belief


class Trail:
    """The way of a robot, thinned out."""

    def __init__(self, apart: float) -> None:
        self.points: List[Tuple[float, float]] = []
        self._apart, self._sent = apart, 0

    def add(self, pose: Pose) -> None:
        """Add a pose that is far enough from the last one."""
        if not self.points or math.dist(self.points[-1], pose[:2]) >= self._apart:
            self.points.append((round(pose.x, 4), round(pose.y, 4)))
            if len(self.points) > LONGEST:
                del self.points[0]
                self._sent -= 1

    def again(self) -> None:
        """Let all points be news."""
        self._sent = 0

    def news(self) -> List[Tuple[float, float]]:
        """Return the points that were added since it was asked last."""
        since, self._sent = max(0, self._sent), len(self.points)
        return self.points[since:]


def check_numbers(numbers: Iterable[float]) -> None:
    """Raise ``ValueError`` for what JSON has no word for."""
    for number in numbers:
        if not math.isfinite(number):
            raise ValueError(f'{number}, expected a finite number')


def _places(points: Iterable[Any]) -> List[Tuple[float, float]]:
    places = [(round(point.x, 4), round(point.y, 4)) for point in points]
    check_numbers(number for place in places for number in place)
    return places


class PageFrame:
    """
    Collects what has changed since the page was drawn last.

    All is drawn in one plane, that of the odometry: belief and truth start alike.

    Parameters
    ----------
    separation : float
        Of the wheels [m].

    """

    def __init__(self, separation: float) -> None:
        self.belief: Optional[Pose] = None
        self.frame_id = ''
        self._truth: Optional[Tuple[int, Pose, float, float]] = None
        self._health: Dict[str, Tuple[int, str]] = {}
        self._changed: Dict[str, Any] = {}
        self._separation = separation
        self.begin_anew()

    def begin_anew(self) -> None:
        """Forget the ways."""
        self._trails = [Trail(THIN * self._separation), Trail(THIN * self._separation)]

    def again(self) -> None:
        """Let the whole ways be in the next frame."""
        for trail in self._trails:
            trail.again()

    def show(self, name: str, value: Any) -> None:
        """Let something be in the next frame."""
        self._changed[name] = value

    def taken(self) -> Dict[str, Any]:
        """Return what has changed since it was taken last."""
        changed, self._changed = self._changed, {}
        return {**changed, 'trails': [trail.news() for trail in self._trails]}

    def take_belief(self, message: Odometry) -> None:
        """Show where the robot believes to be, and how far that is from the truth."""
        pose, twist = pose_in_plane(message.pose.pose), message.twist.twist
        self.frame_id = message.header.frame_id
        covariance = np.reshape(message.pose.covariance, (6, 6))[np.ix_((0, 1, 5), (0, 1, 5))]
        check_numbers([twist.linear.x, twist.angular.z, *covariance.flat])
        self.belief = pose
        self._trails[0].add(pose)
        self._changed['belief'] = [*pose, twist.linear.x, twist.angular.z]
        self._changed['covariance'] = [covariance[0, 0], covariance[0, 1], covariance[1, 1]]
        truth = self._truth_at(nanoseconds(message.header.stamp))
        if truth is not None:
            error = np.array([truth.x - pose.x, truth.y - pose.y,
                              wrap_angle(truth.theta - pose.theta)])
            self._changed['drift'] = [float(math.hypot(*error[:2])), float(error[2])]
            if np.linalg.eigvalsh(covariance)[0] > 0.0:
                self._changed['nees'] = float(error @ np.linalg.solve(covariance, error))

    def take_truth(self, message: Odometry) -> None:
        """Show where the robot is."""
        pose, twist = pose_in_plane(message.pose.pose), message.twist.twist
        check_numbers([twist.linear.x, twist.angular.z])
        self._truth = nanoseconds(message.header.stamp), pose, twist.linear.x, twist.angular.z
        self._trails[1].add(pose)
        self._changed['truth'] = list(pose)

    def _truth_at(self, stamp_ns: int) -> Optional[Pose]:
        """Return where the robot really is at a stamp, by its last odometry of not long before."""
        if self._truth is None or abs(stamp_ns - self._truth[0]) > NEAR_NS:
            return None
        said_ns, pose, v, w = self._truth
        seconds = (stamp_ns - said_ns) / 1e9
        return advance(pose, v * seconds, w * seconds)

    def take_poses(self, message: PoseArray) -> None:
        """Show where it may be."""
        self._changed['poses'] = _places([pose.position for pose in message.poses])

    def take_boundary(self, message: PolygonStamped) -> None:
        """Show the boundary of where it can be."""
        self._changed['boundary'] = _places(message.polygon.points) or None

    def take_diagnostics(self, message: DiagnosticArray) -> None:
        """Show how the nodes are."""
        for status in message.status:
            self._health[status.name] = ord(status.level), status.message
            for pair in status.values:
                if pair.key == 'emergency stop':
                    self._changed['stopped'] = pair.value != 'off'
        self._changed['status'] = [
            (level, name, text) for name, (level, text) in sorted(self._health.items())]
