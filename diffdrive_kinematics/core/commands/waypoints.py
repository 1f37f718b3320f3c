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

"""A path along straight lines from point to point."""

from dataclasses import dataclass
from functools import cached_property
from typing import Sequence, Tuple

from diffdrive_kinematics.core.kinematics import Array, is_sane, Pose
import numpy as np


@dataclass(frozen=True)
class Waypoints:
    """
    A path along straight lines from point to point (x, y) [m].

    Parameters
    ----------
    points : tuple of (float, float)
        Waypoints (x, y) [m], one or more.

    Raises
    ------
    ValueError
        If there are no points, or a number is not finite or absurdly large.

    Examples
    --------
    >>> path = Waypoints(((0.0, 0.0), (1.0, 0.0), (1.0, 1.0)))
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
        See :class:`Waypoints`.

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
        See :class:`Waypoints`.

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


def waypoints_from_poses(poses: Sequence[Pose]) -> Waypoints:
    """
    Return the path through the positions of poses.

    Parameters
    ----------
    poses : sequence of Pose
        Poses, one or more.

    Returns
    -------
    Waypoints
        Path through them.

    Raises
    ------
    ValueError
        As :class:`Waypoints`.

    Examples
    --------
    >>> waypoints_from_poses([Pose(0.0, 0.0, 0.0), Pose(1.0, 2.0, 3.0)]).points
    ((0.0, 0.0), (1.0, 2.0))

    """
    return Waypoints(tuple((float(pose.x), float(pose.y)) for pose in poses))
