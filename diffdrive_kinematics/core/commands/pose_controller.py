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

"""To a position with a yaw, on a smooth curve."""

from dataclasses import dataclass
import math

from diffdrive_kinematics.core.commands.steering import SteeringCommand, SteeringLimits
from diffdrive_kinematics.core.commands.wheel_command import STILL
from diffdrive_kinematics.core.kinematics import check_positive, Pose, sinc, wrap_angle


@dataclass(frozen=True)
class PoseController:
    """
    To a position and a yaw on a smooth curve, with a Lyapunov function.

    With rho the distance, alpha the goal's bearing from the robot and beta the bearing from the
    yaw of the goal, ``v = g cos(alpha) rho`` and
    ``w = k alpha + g cos(alpha) sinc(alpha) (alpha + h beta)`` make
    ``V = (rho^2 + alpha^2 + h beta^2) / 2`` fall: ``V' = -g cos^2(alpha) rho^2 - k alpha^2``, from
    every start (Aicardi, Casalino, Bicchi & Balestrino 1995, Closed loop steering of unicycle-like
    vehicles via Lyapunov techniques, IEEE Robotics & Automation Magazine 2(1), eqs. 3 to 8).  A
    common factor of v and w does not change the sign of V'.  At alpha = +-pi it turns away from
    there, so that no error changes its sign.  Within the tolerance it turns on the spot.

    Parameters
    ----------
    distance_gain : float
        Gain g [1/s].
    heading_gain : float
        Gain k [1/s].
    yaw_weight : float
        Weight h; beta vanishes before rho where ``k >= 2 g sqrt(h)`` and h > 1.
    limits : SteeringLimits
        Bounds and tolerances.

    Raises
    ------
    ValueError
        If a gain or the weight is not above 0.

    Examples
    --------
    >>> law = PoseController()
    >>> law.steer(Pose(0.0, 0.0, 0.0), Pose(1.0, 0.0, 0.0)).twist
    Twist(v=0.2, w=0.0)
    >>> law.steer(Pose(1.0, 0.0, 0.3), Pose(1.0, 0.0, 0.0)).twist.v
    0.0

    """

    distance_gain: float = 0.8
    heading_gain: float = 2.4
    yaw_weight: float = 2.0
    limits: SteeringLimits = SteeringLimits()

    def __post_init__(self) -> None:
        for name in ('distance_gain', 'heading_gain', 'yaw_weight'):
            check_positive(name, getattr(self, name))

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
        See :class:`PoseController`.

        """
        (x, y, theta), (goal_x, goal_y, goal_theta) = map(float, pose), map(float, goal)
        dx, dy = goal_x - x, goal_y - y
        distance, turn = math.hypot(dx, dy), wrap_angle(goal_theta - theta)
        if distance <= self.limits.distance_tolerance:
            arrived = abs(turn) <= self.limits.yaw_tolerance
            twist = STILL if arrived else self.limits.scaled(0.0, self.heading_gain * turn)
            return SteeringCommand(twist, distance, turn, arrived)
        bearing = math.atan2(dy, dx)
        alpha, beta = wrap_angle(bearing - theta), wrap_angle(bearing - goal_theta)
        forward = self.distance_gain * math.cos(alpha)
        return SteeringCommand(self.limits.scaled(
            forward * distance,
            self.heading_gain * alpha
            + forward * float(sinc(alpha)) * (alpha + self.yaw_weight * beta)),
            distance, turn, False)
