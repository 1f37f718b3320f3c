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

"""Following a list of points: pure pursuit (Coulter 1992, CMU-RI-TR-92-01)."""

from dataclasses import dataclass
import math
from typing import NamedTuple

from diffdrive_kinematics.core.commands.steering import SteeringCommand, SteeringLimits
from diffdrive_kinematics.core.commands.waypoints import Waypoints
from diffdrive_kinematics.core.commands.wheel_command import STILL
from diffdrive_kinematics.core.kinematics import check_length, check_positive, Pose, wrap_angle


class PursuitCommand(NamedTuple):
    """
    What to do, and how far along the path the robot is.

    Parameters
    ----------
    steered : SteeringCommand
        What to do.
    along : float
        Way [m] from the first point of the path.

    Examples
    --------
    See :class:`PurePursuit`.

    """

    steered: SteeringCommand
    along: float


@dataclass(frozen=True)
class PurePursuit:
    """
    Drive the arc that meets the path a little way ahead: its curvature is ``2 y / l^2``.

    y is how far the point that is pursued lies to the left, l how far away.  Where it lies behind
    the axle the robot turns on the spot, the short way.  The robot goes along the path and never
    back, so paths may cross themselves.

    Parameters
    ----------
    lookahead : float
        Way [m] along the path from what is nearest to the robot to the point that is pursued.
    heading_gain, distance_gain : float
        Of the turn on the spot, and of the speed before the end [1/s].
    limits : SteeringLimits
        Bounds and tolerances; the end has no yaw.

    Raises
    ------
    ValueError
        If the lookahead is no length, or a gain not above 0.

    Examples
    --------
    >>> path = Waypoints(((0.0, 0.0), (1.0, 0.0), (1.0, 1.0)))
    >>> law = PurePursuit(lookahead=0.5)
    >>> pursued: PursuitCommand = law.follow(Pose(0.8, 0.1, 0.0), path, 0.0)
    >>> round(pursued.along, 9), round(pursued.steered.distance, 9), pursued.steered.twist.w > 0.0
    (0.8, 1.2, True)

    """

    lookahead: float = 0.3
    heading_gain: float = 2.0
    distance_gain: float = 1.0
    limits: SteeringLimits = SteeringLimits()

    def __post_init__(self) -> None:
        check_length('lookahead', self.lookahead)
        check_positive('heading_gain', self.heading_gain)
        check_positive('distance_gain', self.distance_gain)

    def follow(self, pose: Pose, path: Waypoints, along: float) -> PursuitCommand:
        """
        Return what to do at a pose, ``along`` being how far along [m] the robot has come.

        Parameters
        ----------
        pose : Pose
            Where the robot is.
        path : Waypoints
            Path to follow.
        along : float
            How far along [m] the robot has come; 0 at first.

        Returns
        -------
        PursuitCommand
            What to do, and how far along it is now.

        Examples
        --------
        See :class:`PurePursuit`.

        """
        x, y = float(pose.x), float(pose.y)
        along = path.nearest(x, y, along, along + 2.0 * self.lookahead)
        end_x, end_y = path.at(math.inf)
        left = path.length - along
        distance = max(left, math.hypot(end_x - x, end_y - y))
        if distance <= self.limits.distance_tolerance:
            return PursuitCommand(SteeringCommand(STILL, distance, 0.0, True), along)
        to_x, to_y = path.at(along + self.lookahead)
        bearing = wrap_angle(math.atan2(to_y - y, to_x - x) - float(pose.theta))
        if abs(bearing) >= 0.5 * math.pi:
            twist = self.limits.scaled(0.0, self.heading_gain * bearing)
        else:
            speed = min(self.distance_gain * distance, self.limits.max_speed)
            curvature = 2.0 * math.sin(bearing) / math.hypot(to_x - x, to_y - y)
            twist = self.limits.scaled(speed, speed * curvature)
        return PursuitCommand(SteeringCommand(twist, distance, bearing, False), along)
