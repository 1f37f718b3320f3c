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
The base at one time: the pose at the anchor, and what is said of the base at any time.

The pose is kept in compensated sums, so that a day of driving loses no digits.
"""

import math
from typing import NamedTuple, Optional, Tuple

from diffdrive_kinematics.core.kinematics import (
    check_finite, displacement, Pose, RunningSum, wrap_angle)
from diffdrive_kinematics.core.noise import (
    CERTAIN, NO_COVARIANCE, NO_SESSION, PoseCovariance, PoseMoments, SessionBelief,
    SessionSpread)
from diffdrive_kinematics.core.odometry.wheel_sample import WheelPair


class Anchor(NamedTuple):
    """
    A pose and the moments of its error; a value: :meth:`moved` returns a new one.

    Parameters
    ----------
    x, y, theta : RunningSum
        The pose [m, m, rad]; theta is not wrapped.
    moments : PoseMoments
        Of the error of the pose, in the fixed frame, without what lasts a run.
    session : SessionBelief or None
        What lasts a run; None: nothing does.

    Examples
    --------
    A metre ahead, and then a turn on the spot:

    >>> anchor = Anchor.at(Pose(1.0, 0.0, 0.0)).moved(1.0, 0.0, CERTAIN)
    >>> anchor.pose_after(0.0, 0.5)
    Pose(x=2.0, y=0.0, theta=0.5)

    A curvature that differs by 0.1 rad/m from run to run counts from where it is set:

    >>> covariance = anchor.with_session(SessionSpread(curvature=0.1)).session_after(2.0, 0.0)
    >>> round(math.sqrt(covariance.tt), 9)
    0.2

    """

    x: RunningSum
    y: RunningSum
    theta: RunningSum
    moments: PoseMoments
    session: Optional[SessionBelief] = None

    @staticmethod
    def at(pose: Pose, moments: PoseMoments = CERTAIN,
           session: Optional[SessionBelief] = None) -> 'Anchor':
        """
        Return the anchor at a pose.

        Parameters
        ----------
        pose : Pose
            The pose; scalars.
        moments : PoseMoments
            Of the error of the pose, in the fixed frame.
        session : SessionBelief or None
            What lasts a run: it lasts, and the pose does not depend on it yet.

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
        return Anchor(x, y, theta, moments, session and session.restarted())

    def with_session(self, spread: SessionSpread) -> 'Anchor':
        """
        Return the anchor with other standard deviations of what lasts a run.

        Parameters
        ----------
        spread : SessionSpread
            Between runs.

        Returns
        -------
        Anchor
            The anchor with them.  They count from here on: what was gathered under others stays
            as it is, part of the moments.

        Examples
        --------
        See :class:`Anchor`.

        """
        before = self.session
        if spread == (before.spread if before else NO_SESSION):
            return self
        return self._replace(
            moments=before.joined(self.moments) if before else self.moments,
            session=SessionBelief(spread) if spread else None)

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
        x, y, theta, _, _ = self
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
        x, y, theta, _, session = self
        heading = _heading(theta)
        dx, dy = displacement(heading, distance, turn)
        if session is not None:
            session = session.after(heading, distance, turn)
        return Anchor(x.plus(dx), y.plus(dy), theta.plus(turn), moments, session)

    def session_after(self, distance: float, turn: float) -> PoseCovariance:
        """
        Return the covariance that what lasts a run makes at the end of an arc.

        Parameters
        ----------
        distance : float
            Length of the arc [m], negative in reverse.
        turn : float
            Change of the heading [rad].

        Returns
        -------
        PoseCovariance
            In the fixed frame.

        Examples
        --------
        See :class:`Anchor`.

        """
        if self.session is None:
            return NO_COVARIANCE
        return self.session.after(self.heading, distance, turn).covariance()


def _heading(theta: RunningSum) -> float:
    high, low = theta
    return math.remainder(high, math.tau) + low


class BaseState(NamedTuple):
    """
    The base at one time.

    Parameters
    ----------
    pose : Pose
        Where it is [m, m, rad]; theta in (-pi, pi].
    twist : pair of float
        Forward speed v [m/s] and yaw rate w [rad/s].
    angles : pair of float
        Wheel angles (left, right) rolled since the start [rad].
    rates : pair of float
        Wheel rates (left, right) [rad/s].

    Examples
    --------
    >>> state = BaseState(Pose(1.0, 0.0, 0.0), (0.5, 0.0), angles=(8.0, 8.0), rates=(4.0, 4.0))
    >>> state.pose.x
    1.0

    """

    pose: Pose
    twist: Tuple[float, float]
    angles: WheelPair
    rates: WheelPair
