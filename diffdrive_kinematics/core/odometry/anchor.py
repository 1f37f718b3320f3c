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

"""The pose at the anchor, with compensated sums, so that a day of driving loses no digits."""

import math
from typing import NamedTuple

from diffdrive_kinematics.core.kinematics import (
    check_finite, displacement, Pose, RunningSum, wrap_angle)
from diffdrive_kinematics.core.noise import CERTAIN, PoseMoments

__all__ = ['Anchor']


class Anchor(NamedTuple):
    """
    A pose and the moments of its error; a value: :meth:`moved` returns a new one.

    Parameters
    ----------
    x, y, theta : RunningSum
        The pose [m, m, rad]; theta is not wrapped.
    moments : PoseMoments
        Of the error of the pose, in the fixed frame.

    Examples
    --------
    A metre ahead, and then a turn on the spot:

    >>> anchor = Anchor.at(Pose(1.0, 0.0, 0.0)).moved(1.0, 0.0, CERTAIN)
    >>> anchor.pose_after(0.0, 0.5)
    Pose(x=2.0, y=0.0, theta=0.5)

    """

    x: RunningSum
    y: RunningSum
    theta: RunningSum
    moments: PoseMoments

    @staticmethod
    def at(pose: Pose, moments: PoseMoments = CERTAIN) -> 'Anchor':
        """
        Return the anchor at a pose.

        Parameters
        ----------
        pose : Pose
            The pose; scalars.
        moments : PoseMoments
            Of the error of the pose, in the fixed frame.

        Returns
        -------
        Anchor
            The anchor.

        Raises
        ------
        ValueError
            If a coordinate is not finite.

        Examples
        --------
        See :class:`Anchor`.

        """
        x, y, theta = (RunningSum(check_finite(f'{name} of the pose', float(value)))
                       for name, value in zip(('x', 'y', 'yaw'), pose))
        return Anchor(x, y, theta, moments)

    @property
    def heading(self) -> float:
        """Return the heading [rad], within a turn."""
        return _heading(self.theta)

    def pose_after(self, distance: float, turn: float) -> Pose:
        """
        Return the pose at the end of an arc.

        Parameters
        ----------
        distance : float
            Length of the arc [m], negative in reverse.
        turn : float
            Change of the heading [rad].

        Returns
        -------
        Pose
            The pose, theta in (-pi, pi].

        Examples
        --------
        See :class:`Anchor`.

        """
        x, y, theta, _ = self
        dx, dy = displacement(_heading(theta), distance, turn)
        return Pose(x.value_with(dx), y.value_with(dy), wrap_angle(theta.value_with(turn)))

    def moved(self, distance: float, turn: float, moments: PoseMoments) -> 'Anchor':
        """
        Return the anchor at the end of an arc.

        Parameters
        ----------
        distance : float
            Length of the arc [m], negative in reverse.
        turn : float
            Change of the heading [rad].
        moments : PoseMoments
            Of the error there, in the fixed frame.

        Returns
        -------
        Anchor
            The anchor there.

        Examples
        --------
        See :class:`Anchor`.

        """
        x, y, theta, _ = self
        dx, dy = displacement(_heading(theta), distance, turn)
        return Anchor(x.plus(dx), y.plus(dy), theta.plus(turn), moments)


def _heading(theta: RunningSum) -> float:
    high, low = theta
    return math.remainder(high, math.tau) + low
