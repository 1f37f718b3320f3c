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

"""Steering laws to a place: the regulator of the heading, and the point ahead of the axle."""

from dataclasses import dataclass
import math

from diffdrive_kinematics.core.commands.steering import SteeringCommand, SteeringLimits
from diffdrive_kinematics.core.commands.wheel_command import STILL
from diffdrive_kinematics.core.kinematics import check_length, check_positive, Pose, wrap_angle


@dataclass(frozen=True)
class HeadingRegulator:
    """
    The P-regulator of the heading: ``w = k wrap(theta_d - theta)``, theta_d towards the goal.

    The speed is ``k_v rho max(0, cos(error))``, so that the robot turns on the spot, the short
    way, until the goal is ahead.  The distance never grows, and with ``k > k_v`` the error
    vanishes: ``rho' = -k_v rho cos^2``, ``error' = -k error + k_v sin cos``.

    Parameters
    ----------
    heading_gain : float
        Gain k [1/s].
    distance_gain : float
        Gain k_v [1/s].
    limits : SteeringLimits
        Bounds and tolerances; the yaw of the goal does not count.

    Raises
    ------
    ValueError
        If a gain is not above 0, or k not above k_v.

    Examples
    --------
    >>> law = HeadingRegulator()
    >>> twist, distance, turn, arrived = law.steer(Pose(0.0, 0.0, 0.0), Pose(0.0, 1.0, 0.0))
    >>> round(twist.v, 9), twist.w, distance, arrived
    (0.0, 1.0, 1.0, False)

    """

    heading_gain: float = 2.0
    distance_gain: float = 1.0
    limits: SteeringLimits = SteeringLimits()

    def __post_init__(self) -> None:
        check_positive('distance_gain', self.distance_gain)
        if not check_positive('heading_gain', self.heading_gain) > self.distance_gain:
            raise ValueError(
                f'heading_gain is {self.heading_gain!r}, expected above distance_gain, '
                f'{self.distance_gain!r}')

    def steer(self, pose: Pose, goal: Pose) -> SteeringCommand:
        """
        Return what to do at a pose.

        Parameters
        ----------
        pose : Pose
            Where the robot is.
        goal : Pose
            Where it shall be.

        Returns
        -------
        SteeringCommand
            What to do.

        Examples
        --------
        See :class:`HeadingRegulator`.

        """
        (x, y, theta), (goal_x, goal_y, _) = map(float, pose), map(float, goal)
        dx, dy = goal_x - x, goal_y - y
        distance = math.hypot(dx, dy)
        if distance <= self.limits.distance_tolerance:
            return SteeringCommand(STILL, distance, 0.0, True)
        error = wrap_angle(math.atan2(dy, dx) - theta)
        speed = min(self.distance_gain * distance, self.limits.max_speed)
        return SteeringCommand(self.limits.scaled(
            speed * max(0.0, math.cos(error)), self.heading_gain * error), distance, error, False)


@dataclass(frozen=True)
class PointForward:
    """
    Feedback linearisation of a point ahead of the axle, which goes straight to the goal.

    Its velocity is ``[[cos, -b sin], [sin, b cos]] (v, w)``, which can be inverted for b > 0, so
    that any velocity of the point can be had (Siciliano et al., Robotics, sec. 11.6.1).  It is
    the point that comes to the goal, and the robot backs up where the goal is behind.

    Parameters
    ----------
    offset : float
        Distance b [m] of the point ahead of the axle.
    distance_gain : float
        Of the velocity, over the distance [1/s].
    limits : SteeringLimits
        Bounds and tolerances; the yaw of the goal does not count.

    Raises
    ------
    ValueError
        If the offset is no length, or the gain not above 0.

    Examples
    --------
    >>> PointForward(offset=0.1).steer(Pose(0.0, 0.0, 0.0), Pose(-1.0, 0.0, 0.0)).twist
    Twist(v=-0.2, w=0.0)

    """

    offset: float = 0.1
    distance_gain: float = 1.0
    limits: SteeringLimits = SteeringLimits()

    def __post_init__(self) -> None:
        check_length('offset', self.offset)
        check_positive('distance_gain', self.distance_gain)

    def steer(self, pose: Pose, goal: Pose) -> SteeringCommand:
        """
        Return what to do at a pose.

        Parameters
        ----------
        pose : Pose
            Where the robot is.
        goal : Pose
            Where it shall be.

        Returns
        -------
        SteeringCommand
            What to do.

        Examples
        --------
        See :class:`PointForward`.

        """
        (x, y, theta), (goal_x, goal_y, _) = map(float, pose), map(float, goal)
        c, s = math.cos(theta), math.sin(theta)
        dx, dy = goal_x - x - self.offset * c, goal_y - y - self.offset * s
        distance = math.hypot(dx, dy)
        if distance <= self.limits.distance_tolerance:
            return SteeringCommand(STILL, distance, 0.0, True)
        gain = min(self.distance_gain, self.limits.max_speed / distance)
        return SteeringCommand(self.limits.scaled(
            gain * (c * dx + s * dy), gain * (c * dy - s * dx) / self.offset), distance, 0.0,
            False)
