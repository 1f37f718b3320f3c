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

The error of a pose is its derivatives S by scale s, separation p and curvature c times the values
of this run, so its covariance is ``S diag(sigma^2) S^T`` (consider parameters: Bierman,
Factorization Methods for Discrete Sequential Estimation, ch. VIII), on top of that of the slip.
With z the published position as a complex number, u = e^{i theta} and w the way of an arc in the
frame of its start, an arc of length ds and turn dtheta makes

    ``z' = z + u w``,  ``w = ds (e^{i dtheta} - 1) / (i dtheta)``,

and with the derivatives of the heading, a_T = sum dtheta by a gain of all turns and a_C = sum ds
by a curvature, those of the position are

    ``T' = T + i a_T u w + dtheta u dw/dtheta``,  ``C' = C + i a_C u w + ds u dw/dtheta``,
    ``dw/dtheta = (ds / 2) e^{i h} (i sin h / h - (sin h / h - cos h) / h)``,  h = dtheta / 2.

A separation that is larger by p turns less by p: its column is -T.  A scale is a gain of all
turns, and moves the position by what it has moved: its column is T + z - z_start.  The parts of
one arc add up to that of the arc, whatever they are.

To first order the end of a straight is moved across the track, where really it lies on a bow
behind it.  So the second derivatives by the headings, ``-integral a b e^{i theta} ds`` with a and
b of a_T and a_C along the way, are carried, too.  Of Gaussian parameters with the variances G of
the gain (that of s - p) and K of the curvature they make the second moment

    ``m m^T + (G D_TT)^2 / 2 + (K D_CC)^2 / 2 + G K D_TC^2``,  ``m = (G D_TT + K D_CC) / 2``,

D^2 short for D D^T.  What the swing of the slip makes with that of the session is left out.
"""

import math
from typing import NamedTuple

from diffdrive_kinematics.core.noise.arc_means import arc_means
from diffdrive_kinematics.core.noise.pose_covariance import PoseCovariance
from diffdrive_kinematics.core.noise.pose_moments import gaussian_moments, PoseMoments
from diffdrive_kinematics.core.noise.session_errors import SessionSpread

ROOT_HALF = math.sqrt(0.5)


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
    bow_turns, bow_both, bow_curvature : complex
        Second derivatives D_TT [m], D_TC [m^2/rad] and D_CC [m^3/rad^2].

    Examples
    --------
    After 2 m straight ahead a curvature has made twice its heading, as much to the left, and,
    on average, the way shorter by two thirds of its square:

    >>> belief = SessionBelief(SessionSpread(curvature=0.03)).after(0.0, 2.0, 0.0)
    >>> covariance = belief.covariance()
    >>> round(covariance.tt, 6), round(covariance.yy, 6), round(covariance.xx, 9)
    (0.0036, 0.0036, 4.32e-06)
    >>> belief.restarted().covariance().tt
    0.0

    """

    spread: SessionSpread
    moved: complex = 0j
    turned: float = 0.0
    travelled: float = 0.0
    by_turns: complex = 0j
    by_curvature: complex = 0j
    bow_turns: complex = 0j
    bow_both: complex = 0j
    bow_curvature: complex = 0j

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
        spread, moved, turned, travelled, by_turns, by_curvature, bow_turns, bow_both, bow = self
        half = 0.5 * turn
        sinc = math.sin(half) / half if half else 1.0
        mean = arc_means(half)[0]
        direction = heading + half
        chord = distance * complex(math.cos(direction), math.sin(direction))
        way = sinc * chord
        bend = 0.5 * chord * complex(-mean, sinc)
        late = -1j * bend  # integral of t e^{i theta} ds over the arc, t from 0 to 1
        latest = 0.5 * chord * complex(sinc - (mean / half if half else 1.0 / 3.0), mean)  # t^2
        return SessionBelief(
            spread, moved + way, turned + turn, travelled + distance,
            by_turns + 1j * turned * way + turn * bend,
            by_curvature + 1j * travelled * way + distance * bend,
            bow_turns - turned * (turned * way + 2.0 * turn * late) - turn * turn * latest,
            bow_both - turned * travelled * way - (
                turned * distance + travelled * turn) * late - turn * distance * latest,
            bow - travelled * (travelled * way + 2.0 * distance * late)
            - distance * distance * latest)

    def covariance(self) -> PoseCovariance:
        """
        Return the second moment that the session makes of the error of the pose.

        Returns
        -------
        PoseCovariance
            About the published pose, in the fixed frame.

        Examples
        --------
        See :class:`SessionBelief`.

        """
        spread, moved, turned, travelled, by_turns, by_curvature, *bows = self
        gain, curve = math.hypot(spread.scale, spread.separation), spread.curvature
        bow_turns, bow_both, bow_curvature = (
            size * bow for size, bow in zip((gain * gain, gain * curve, curve * curve), bows))
        xx = xy = xt = yy = yt = tt = 0.0
        for position, theta in (
                (spread.scale * (moved + by_turns), spread.scale * turned),
                (spread.separation * by_turns, spread.separation * turned),
                (curve * by_curvature, curve * travelled),
                (0.5 * (bow_turns + bow_curvature), 0.0), (ROOT_HALF * bow_turns, 0.0),
                (ROOT_HALF * bow_curvature, 0.0), (bow_both, 0.0)):
            x, y = position.real, position.imag
            xx += x * x
            xy += x * y
            xt += x * theta
            yy += y * y
            yt += y * theta
            tt += theta * theta
        return PoseCovariance(xx, xy, xt, yy, yt, tt)

    def joined(self, moments: PoseMoments) -> PoseMoments:
        """
        Return the moments of a pose with what the session has made so far as part of them.

        Parameters
        ----------
        moments : PoseMoments
            Of the error of the pose without the session, in the fixed frame.

        Returns
        -------
        PoseMoments
            Of the sum of that error and an independent Gaussian one of this covariance.

        Examples
        --------
        >>> from diffdrive_kinematics.core.noise import CERTAIN
        >>> belief = SessionBelief(SessionSpread(curvature=0.03)).after(0.0, 2.0, 0.0)
        >>> belief.joined(CERTAIN).second_moment() == belief.covariance()
        True

        """
        made = gaussian_moments(self.covariance())
        known = moments.start
        gaussian = moments.spread.tt - known.variance
        own = (1.0 - known.cosine_loss) * math.exp(-0.5 * gaussian)  # mean cosine of each heading
        other = math.exp(-0.5 * made.spread.tt)
        return moments._replace(
            spread=moments.spread.plus(made.spread),
            x_swing=other * moments.x_swing + own * made.x_swing,
            y_swing=other * moments.y_swing + own * made.y_swing)

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
