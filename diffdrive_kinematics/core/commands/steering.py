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
import math
from typing import NamedTuple, Protocol

from diffdrive_kinematics.core.commands.drive import STILL, Twist
from diffdrive_kinematics.core.kinematics import (
    check_length, check_positive, LARGEST, Pose, wrap_angle)

__all__ = [
    'Approach', 'HeadingRegulator', 'Law', 'PointForward', 'Steered', 'SteeringLimits']


class Steered(NamedTuple):
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
    >>> Steered(STILL, 0.01, 0.0, True).arrived
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
    >>> law: Law = HeadingRegulator()
    >>> law.steered(Pose(0.0, 0.0, 0.0), Pose(0.1, 0.0, 0.0)).twist
    Twist(v=0.1, w=0.0)

    """

    def steered(self, pose: Pose, goal: Pose) -> Steered:
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
        Steered
            What to do.

        Examples
        --------
        See :class:`Law`.

        """
        ...


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
    >>> twist, distance, turn, arrived = law.steered(Pose(0.0, 0.0, 0.0), Pose(0.0, 1.0, 0.0))
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

    def steered(self, pose: Pose, goal: Pose) -> Steered:
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
        Steered
            What to do.

        Examples
        --------
        See :class:`HeadingRegulator`.

        """
        (x, y, theta), (goal_x, goal_y, _) = map(float, pose), map(float, goal)
        dx, dy = goal_x - x, goal_y - y
        distance = math.hypot(dx, dy)
        if distance <= self.limits.distance_tolerance:
            return Steered(STILL, distance, 0.0, True)
        error = wrap_angle(math.atan2(dy, dx) - theta)
        speed = min(self.distance_gain * distance, self.limits.max_speed)
        return Steered(self.limits.scaled(
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
    >>> PointForward(offset=0.1).steered(Pose(0.0, 0.0, 0.0), Pose(-1.0, 0.0, 0.0)).twist
    Twist(v=-0.2, w=0.0)

    """

    offset: float = 0.1
    distance_gain: float = 1.0
    limits: SteeringLimits = SteeringLimits()

    def __post_init__(self) -> None:
        check_length('offset', self.offset)
        check_positive('distance_gain', self.distance_gain)

    def steered(self, pose: Pose, goal: Pose) -> Steered:
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
        Steered
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
            return Steered(STILL, distance, 0.0, True)
        gain = min(self.distance_gain, self.limits.max_speed / distance)
        return Steered(self.limits.scaled(
            gain * (c * dx + s * dy), gain * (c * dy - s * dx) / self.offset), distance, 0.0,
            False)


class Approach(NamedTuple):
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
    >>> steered = Steered(STILL, 0.5, 0.0, False)
    >>> Approach(1.0, 0.0, 0).looked(steered, 7)
    Approach(distance=0.5, turn=0.0, since_ns=7)

    """

    distance: float
    turn: float
    since_ns: int

    def looked(self, steered: Steered, now_ns: int) -> 'Approach':
        """
        Return the approach after a look: nearer by a millimetre or a hundredth of a radian.

        Parameters
        ----------
        steered : Steered
            What is left now.
        now_ns : int
            Time of the look [ns].

        Returns
        -------
        Approach
            With the least of before and now.

        Examples
        --------
        See :class:`Approach`.

        """
        distance, turn = steered.distance, abs(steered.turn)
        if distance < self.distance - 1e-3 or turn < self.turn - 1e-2:
            return Approach(min(distance, self.distance), min(turn, self.turn), now_ns)
        return self
