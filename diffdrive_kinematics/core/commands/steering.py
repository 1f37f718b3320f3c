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

"""
Steering laws: from where the robot is and where it shall be to a twist.

A law is a value without memory.  Limits scale both parts of the twist by one factor, so that
they change how fast a path is driven and not the path.  Every law slows down in proportion to
the way that is left.

===================  ========================================================================
law                  what it does
===================  ========================================================================
`HeadingRegulator`   looks at the goal and goes there: ``w = k wrap(theta_d - theta)``
`PointForward`       draws a point ahead of the axle straight to the goal, backward where that
                     is nearer (feedback linearisation)
`PoseController`     comes to the goal with the yaw that is asked for, on a curve
===================  ========================================================================
"""

from dataclasses import dataclass
from typing import NamedTuple, Protocol

from diffdrive_kinematics.core.commands.wheel_command import Twist
from diffdrive_kinematics.core.kinematics import check_positive, LARGEST, Pose


class SteeringCommand(NamedTuple):
    """
    What to do, and what is left to do.

    Parameters
    ----------
    twist : Twist
        Twist to drive.
    distance : float
        Way that is left [m].
    turn : float
        Turn that is left [rad], 0 where it does not count.
    arrived : bool
        Whether that is all.

    Examples
    --------
    >>> SteeringCommand(Twist(0.0, 0.0), 0.01, 0.0, True).arrived
    True

    """

    twist: Twist
    distance: float
    turn: float
    arrived: bool


@dataclass(frozen=True)
class SteeringLimits:
    """
    How fast to steer, and how near is there.

    Parameters
    ----------
    max_speed : float
        Bound of v [m/s], either way.
    max_yaw_rate : float
        Bound of w [rad/s], either way.
    distance_tolerance : float
        Distance to the goal [m] that is near enough.
    yaw_tolerance : float
        Yaw off the goal [rad] that is near enough.

    Raises
    ------
    ValueError
        If a value is not finite and above 0.

    Examples
    --------
    >>> SteeringLimits(max_speed=0.2, max_yaw_rate=1.0).scaled(0.1, 2.0)
    Twist(v=0.05, w=1.0)

    """

    max_speed: float = 0.2
    max_yaw_rate: float = 1.0
    distance_tolerance: float = 0.02
    yaw_tolerance: float = 0.05

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            check_positive(name, value)

    def scaled(self, v: float, w: float) -> Twist:
        """
        Return the twist, made smaller by one factor where a part is too large.

        Parameters
        ----------
        v : float
            Speed [m/s].
        w : float
            Yaw rate [rad/s].

        Returns
        -------
        Twist
            Twist within the bounds, of the same curvature.

        Examples
        --------
        See :class:`SteeringLimits`.

        """
        v, w = (max(-LARGEST, min(value, LARGEST)) for value in (v, w))
        factor = max(1.0, abs(v) / self.max_speed, abs(w) / self.max_yaw_rate)
        return Twist(v / factor, w / factor)


class Law(Protocol):
    """
    What steers a robot from any pose to a goal.

    Parameters
    ----------
    *args, **kwargs
        What a protocol takes: nothing.

    Examples
    --------
    >>> from diffdrive_kinematics.core.commands import HeadingRegulator
    >>> law: Law = HeadingRegulator()
    >>> law.steer(Pose(0.0, 0.0, 0.0), Pose(0.1, 0.0, 0.0)).twist
    Twist(v=0.1, w=0.0)

    """

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
        See :class:`Law`.

        """


class Progress(NamedTuple):
    """
    How near the robot has come so far, and since when [ns] it has come no nearer.

    Parameters
    ----------
    distance : float
        Least way that was left so far [m].
    turn : float
        Least turn that was left so far [rad].
    since_ns : int
        Since when [ns] it has come no nearer.

    Examples
    --------
    >>> steered = SteeringCommand(Twist(0.0, 0.0), 0.5, 0.0, False)
    >>> Progress(1.0, 0.0, 0).updated(steered, 7)
    Progress(distance=0.5, turn=0.0, since_ns=7)

    """

    distance: float
    turn: float
    since_ns: int

    def updated(self, steered: SteeringCommand, now_ns: int) -> 'Progress':
        """
        Return the approach after a look: nearer by a millimetre or a hundredth of a radian.

        Parameters
        ----------
        steered : SteeringCommand
            What is left now.
        now_ns : int
            Time of the look [ns].

        Returns
        -------
        Progress
            With the least of before and now.

        Examples
        --------
        See :class:`Progress`.

        """
        distance, turn = steered.distance, abs(steered.turn)
        if distance < self.distance - 1e-3 or turn < self.turn - 1e-2:
            return Progress(min(distance, self.distance), min(turn, self.turn), now_ns)
        return self
