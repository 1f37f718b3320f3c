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
from functools import cached_property
import math
from typing import NamedTuple, Sequence, Tuple

from diffdrive_kinematics.core.commands.drive import STILL
from diffdrive_kinematics.core.commands.steering import Steered, SteeringLimits
from diffdrive_kinematics.core.kinematics import (
    check_length, check_positive, is_sane, Pose, wrap_angle)
import numpy as np
from numpy.typing import NDArray

__all__ = ['Points', 'PurePursuit', 'Pursued', 'points_of']

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Points:
    """
    A path along straight lines from point to point (x, y) [m].

    Parameters
    ----------
    points : tuple of (float, float)
        Points (x, y) [m], one or more.

    Raises
    ------
    ValueError
        If there are no points, or a number is not finite or absurdly large.

    Examples
    --------
    >>> path = Points(((0.0, 0.0), (1.0, 0.0), (1.0, 1.0)))
    >>> path.length, path.at(1.5), path.nearest(0.5, 0.2, 0.0, 2.0)
    (2.0, (1.0, 0.5), 0.5)

    """

    points: Tuple[Tuple[float, float], ...]

    def __post_init__(self) -> None:
        if not self.points:
            raise ValueError('the path has no points, expected one or more')
        for point in self.points:
            if not is_sane(*point):
                raise ValueError(f'a point of the path is {point!r}, expected finite numbers')

    @cached_property
    def corners(self) -> Array:
        """Return the points, shape (k, 2)."""
        return np.array(self.points)

    @cached_property
    def along(self) -> Array:
        """Return the way [m] from the first point to each, shape (k,)."""
        steps = np.hypot(*np.diff(self.corners, axis=0).T)
        return np.concatenate([[0.0], np.cumsum(steps)])

    @property
    def length(self) -> float:
        """Return the way [m] from the first to the last point."""
        return float(self.along[-1])

    def at(self, along: float) -> Tuple[float, float]:
        """
        Return the point after a way [m]; the last one where that is longer.

        Parameters
        ----------
        along : float
            Way [m] from the first point.

        Returns
        -------
        x : float
            Of the point [m].
        y : float
            Of the point [m].

        Examples
        --------
        See :class:`Points`.

        """
        x, y = (float(np.interp(along, self.along, column)) for column in self.corners.T)
        return x, y

    def nearest(self, x: float, y: float, least: float, most: float) -> float:
        """
        Return the way [m], from ``least`` to ``most``, to what is nearest to (x, y).

        Parameters
        ----------
        x : float
            Of the place [m].
        y : float
            Of the place [m].
        least : float
            Where to begin to look [m].
        most : float
            Where to end [m].

        Returns
        -------
        float
            Way [m] from the first point.

        Examples
        --------
        See :class:`Points`.

        """
        if len(self.points) == 1:
            return 0.0
        begin, step = self.corners[:-1], np.diff(self.corners, axis=0)
        size = np.diff(self.along)
        unit = step / np.where(size == 0.0, 1.0, size)[:, None]
        place = np.sum((np.array([x, y]) - begin) * unit, axis=1)
        low, high = np.clip(least - self.along[:-1], 0.0, size), np.clip(
            most - self.along[:-1], 0.0, size)
        place = np.clip(place, low, high)
        off = np.hypot(*(begin + place[:, None] * unit - np.array([x, y])).T)
        off[(self.along[1:] < least) | (self.along[:-1] > most)] = np.inf
        best = int(np.argmin(off))
        return float(self.along[best] + place[best])


class Pursued(NamedTuple):
    """
    What to do, and how far along the path the robot is.

    Parameters
    ----------
    steered : Steered
        What to do.
    along : float
        Way [m] from the first point of the path.

    Examples
    --------
    See :class:`PurePursuit`.

    """

    steered: Steered
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
    >>> path = Points(((0.0, 0.0), (1.0, 0.0), (1.0, 1.0)))
    >>> law = PurePursuit(lookahead=0.5)
    >>> pursued: Pursued = law.pursued(Pose(0.8, 0.1, 0.0), path, 0.0)
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

    def pursued(self, pose: Pose, path: Points, along: float) -> Pursued:
        """
        Return what to do at a pose, ``along`` being how far along [m] the robot has come.

        Parameters
        ----------
        pose : Pose
            Where the robot is.
        path : Points
            Path to follow.
        along : float
            How far along [m] the robot has come; 0 at first.

        Returns
        -------
        Pursued
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
            return Pursued(Steered(STILL, distance, 0.0, True), along)
        to_x, to_y = path.at(along + self.lookahead)
        bearing = wrap_angle(math.atan2(to_y - y, to_x - x) - float(pose.theta))
        if abs(bearing) >= 0.5 * math.pi:
            twist = self.limits.scaled(0.0, self.heading_gain * bearing)
        else:
            speed = min(self.distance_gain * distance, self.limits.max_speed)
            curvature = 2.0 * math.sin(bearing) / math.hypot(to_x - x, to_y - y)
            twist = self.limits.scaled(speed, speed * curvature)
        return Pursued(Steered(twist, distance, bearing, False), along)


def points_of(poses: Sequence[Pose]) -> Points:
    """
    Return the path through the positions of poses.

    Parameters
    ----------
    poses : sequence of Pose
        Poses, one or more.

    Returns
    -------
    Points
        Path through them.

    Raises
    ------
    ValueError
        As :class:`Points`.

    Examples
    --------
    >>> points_of([Pose(0.0, 0.0, 0.0), Pose(1.0, 2.0, 3.0)]).points
    ((0.0, 0.0), (1.0, 2.0))

    """
    return Points(tuple((float(pose.x), float(pose.y)) for pose in poses))
