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
What a belief makes of errors that last a run: parameters that it considers and does not estimate.

The error of a pose is, to first order, its derivatives S by scale s, separation p and curvature c
times the values of this run, so its covariance is ``S diag(sigma^2) S^T`` (consider parameters:
Bierman, Factorization Methods for Discrete Sequential Estimation, ch. VIII), on top of that of
the slip.  With z the published position as a complex number, u = e^{i theta} and w the way of an
arc in the frame of its start, an arc of length ds and turn dtheta makes

    ``z' = z + u w``,  ``w = ds (e^{i dtheta} - 1) / (i dtheta)``,

and with the derivatives of the heading, a_T = sum dtheta by a gain of all turns and a_C = sum ds
by a curvature, those of the position are

    ``T' = T + i a_T u w + dtheta u dw/dtheta``,  ``C' = C + i a_C u w + ds u dw/dtheta``,
    ``dw/dtheta = (ds / 2) e^{i h} (i sin h / h - (sin h / h - cos h) / h)``,  h = dtheta / 2.

A separation that is larger by p turns less by p: its column is -T.  A scale is a gain of all
turns, and moves the position by what it has moved: its column is T + z - z_start.  The parts of
one arc add up to that of the arc, whatever they are.
"""

import math
from typing import NamedTuple

from diffdrive_kinematics.core.noise.arc_means import arc_means
from diffdrive_kinematics.core.noise.pose_covariance import PoseCovariance
from diffdrive_kinematics.core.noise.session_errors import SessionSpread

__all__ = ['SessionBelief']


class SessionBelief(NamedTuple):
    """
    How uncertain a session is, and by how much a pose depends on it since it was known.

    Parameters
    ----------
    spread : SessionSpread
        Standard deviations between runs.
    moved : complex
        Position since the pose was known [m], x + iy in the fixed frame.
    turned, travelled : float
        Heading [rad] and signed distance [m] since then.
    by_turns : complex
        Derivative T of the position by a gain of all turns [m].
    by_curvature : complex
        Derivative C of the position by a curvature [m^2/rad].

    Examples
    --------
    After 2 m straight ahead a curvature has made twice its heading, and as much to the left:

    >>> belief = SessionBelief(SessionSpread(curvature=0.5)).after(0.0, 2.0, 0.0)
    >>> belief.covariance()
    PoseCovariance(xx=0.0, xy=0.0, xt=0.0, yy=1.0, yt=1.0, tt=1.0)
    >>> belief.restarted().covariance().tt
    0.0

    """

    spread: SessionSpread
    moved: complex = 0j
    turned: float = 0.0
    travelled: float = 0.0
    by_turns: complex = 0j
    by_curvature: complex = 0j

    def after(self, heading: float, distance: float, turn: float) -> 'SessionBelief':
        """
        Return what is believed after an arc.

        Parameters
        ----------
        heading : float
            Published heading where it begins [rad].
        distance : float
            Length of the arc [m], negative in reverse.
        turn : float
            Change of the heading [rad].

        Returns
        -------
        SessionBelief
            The belief after it.

        Examples
        --------
        See :class:`SessionBelief`.

        """
        spread, moved, turned, travelled, by_turns, by_curvature = self
        half = 0.5 * turn
        sinc = math.sin(half) / half if half else 1.0
        direction = heading + half
        chord = distance * complex(math.cos(direction), math.sin(direction))
        way = sinc * chord
        bend = 0.5 * chord * complex(-arc_means(half)[0], sinc)
        return SessionBelief(
            spread, moved + way, turned + turn, travelled + distance,
            by_turns + 1j * turned * way + turn * bend,
            by_curvature + 1j * travelled * way + distance * bend)

    def covariance(self) -> PoseCovariance:
        """
        Return the covariance that the session makes of the pose, ``S diag(sigma^2) S^T``.

        Returns
        -------
        PoseCovariance
            In the fixed frame.

        Examples
        --------
        See :class:`SessionBelief`.

        """
        spread, moved, turned, travelled, by_turns, by_curvature = self
        xx = xy = xt = yy = yt = tt = 0.0
        for stddev, position, heading in (
                (spread.scale, moved + by_turns, turned), (spread.separation, by_turns, turned),
                (spread.curvature, by_curvature, travelled)):
            if stddev:
                x, y, theta = stddev * position.real, stddev * position.imag, stddev * heading
                xx += x * x
                xy += x * y
                xt += x * theta
                yy += y * y
                yt += y * theta
                tt += theta * theta
        return PoseCovariance(xx, xy, xt, yy, yt, tt)

    def restarted(self) -> 'SessionBelief':
        """
        Return the belief where the pose is known from elsewhere, and the session goes on.

        Returns
        -------
        SessionBelief
            With nothing gathered: a given pose does not depend on the session.

        Examples
        --------
        See :class:`SessionBelief`.

        """
        return SessionBelief(self.spread)
