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

"""Moments of the error of a pose, and what becomes of them on the way; see :mod:`.arc_moments`."""

import math
from typing import NamedTuple, Tuple

from diffdrive_kinematics.core.noise.heading_moments import (
    GAUSSIAN, HeadingMoments, von_mises_moments)
from diffdrive_kinematics.core.noise.pose_covariance import NO_COVARIANCE, PoseCovariance


class PoseMoments(NamedTuple):
    """
    What is known of the error of a pose: true minus published, in the fixed frame.

    Parameters
    ----------
    spread : PoseCovariance
        Covariance about the mean.
    mean_error : complex
        Mean of x + iy [m]; that of the heading is 0.
    x_swing, y_swing : complex
        Covariance of x and of y with ``e^{i phi}`` [m].
    start : HeadingMoments
        Of the heading at the start, where it was not Gaussian.

    Examples
    --------
    >>> CERTAIN.second_moment() == NO_COVARIANCE
    True

    """

    spread: PoseCovariance
    mean_error: complex
    x_swing: complex
    y_swing: complex
    start: HeadingMoments

    def second_moment(self) -> PoseCovariance:
        """
        Return the second moment of the error about the published pose.

        Returns
        -------
        PoseCovariance
            The covariance about the mean, and the square of the mean.

        Examples
        --------
        >>> CERTAIN._replace(mean_error=3.0 + 1.0j).second_moment().xx
        9.0

        """
        xx, xy, xt, yy, yt, tt = self.spread
        x, y = self.mean_error.real, self.mean_error.imag
        return PoseCovariance(xx + x * x, xy + x * y, xt, yy + y * y, yt, tt)


CERTAIN = PoseMoments(NO_COVARIANCE, 0j, 0j, 0j, GAUSSIAN)


def gaussian_moments(covariance: PoseCovariance) -> PoseMoments:
    """
    Return the moments of a Gaussian error of the pose.

    Parameters
    ----------
    covariance : PoseCovariance
        Of x, y and theta, in the fixed frame.

    Returns
    -------
    PoseMoments
        With mean 0.

    Examples
    --------
    >>> gaussian_moments(NO_COVARIANCE) is CERTAIN
    True

    """
    if covariance == NO_COVARIANCE:
        return CERTAIN
    damped = 1j * math.exp(-0.5 * covariance.tt)
    return PoseMoments(covariance, 0j, damped * covariance.xt, damped * covariance.yt, GAUSSIAN)


def heading_moments(concentration: float) -> PoseMoments:
    """
    Return the moments of a known position with a von Mises heading.

    Parameters
    ----------
    concentration : float
        Concentration kappa of the heading [1], 0 or above; NaN: the heading is known, too.

    Returns
    -------
    PoseMoments
        Only those of the heading are not 0.

    Raises
    ------
    ValueError
        If the concentration is infinite or below 0.

    Examples
    --------
    >>> round(heading_moments(100.0).spread.tt, 4)
    0.0101

    """
    if math.isnan(concentration):
        return CERTAIN
    start = von_mises_moments(concentration)
    return CERTAIN._replace(spread=NO_COVARIANCE._replace(tt=start.variance), start=start)


def followed(before: PoseMoments, heading: float, way: complex, arc: PoseMoments) -> PoseMoments:
    """
    Return the moments of a pose after an arc.

    Parameters
    ----------
    before : PoseMoments
        Of the pose before, in the fixed frame.
    heading : float
        Published heading before [rad].
    way : complex
        By how much the published position changes, dx + i dy [m], in the fixed frame.
    arc : PoseMoments
        What the arc makes of a known pose, in the frame of its start.

    Returns
    -------
    PoseMoments
        Of the pose after, in the fixed frame.

    Examples
    --------
    A heading that is known to 0.1 rad makes 0.5 m across 5 m straight ahead:

    >>> start = gaussian_moments(NO_COVARIANCE._replace(tt=0.1**2))
    >>> round(math.sqrt(followed(start, 0.0, 5.0 + 0.0j, CERTAIN).second_moment().yy), 3)
    0.498

    """
    spread, mean, (damping, cosine_variance, sine_square) = _after(before, heading, way, arc)
    turned = complex(math.cos(heading), math.sin(heading))
    moved = way + turned * arc.mean_error
    dx, dy = moved.real, moved.imag
    along = turned.real - sine_square * turned
    across = turned.imag + 1j * sine_square * turned
    return PoseMoments(
        spread, mean,
        damping * (before.x_swing + complex(dx * cosine_variance, -dy * sine_square))
        + along * arc.x_swing - across * arc.y_swing,
        damping * (before.y_swing + complex(dy * cosine_variance, dx * sine_square))
        + across * arc.x_swing + along * arc.y_swing,
        before.start)


def second_moment_after(
        before: PoseMoments, heading: float, way: complex, arc: PoseMoments) -> PoseCovariance:
    """
    Return the second moment of the error of a pose after an arc.

    It is that of :func:`followed`, and costs less: nothing has to follow.

    Parameters
    ----------
    before, heading, way, arc : as there
        Arguments of :func:`followed`; the swings of ``arc`` are not looked at.

    Returns
    -------
    PoseCovariance
        About the published pose, in the fixed frame.

    Examples
    --------
    >>> start = gaussian_moments(NO_COVARIANCE._replace(tt=0.1**2))
    >>> round(math.sqrt(second_moment_after(start, 0.0, 5.0 + 0.0j, CERTAIN).yy), 3)
    0.498

    """
    (xx, xy, xt, yy, yt, tt), mean, _ = _after(before, heading, way, arc)
    x, y = mean.real, mean.imag
    return PoseCovariance(xx + x * x, xy + x * y, xt, yy + y * y, yt, tt)


def _after(before: PoseMoments, heading: float, way: complex, arc: PoseMoments) -> Tuple[
        PoseCovariance, complex, Tuple[float, float, float]]:
    """Return covariance and mean after an arc, and of what else the swings are made."""
    (xx, xy, xt, yy, yt, tt), mean, x_swing, y_swing, start = before
    (arc_xx, arc_xy, arc_xt, arc_yy, arc_yt, arc_tt), arc_mean, _, _, _ = arc
    variance, cosine_loss, sine_square, cosine_variance, swing = start
    added = tt - variance
    lost = math.expm1(-0.5 * added)
    damping = 1.0 + lost
    loss, kept, mean_cosine = -lost * (1.0 + damping), 1.0 - 2.0 * sine_square, 1.0 - cosine_loss
    cosine_variance += loss * (sine_square - cosine_variance + 0.5 * kept * loss)
    sine_square += 0.5 * kept * loss * (2.0 - loss)
    swing = damping * (swing + mean_cosine * added)
    cosine_loss -= mean_cosine * lost
    mean_cosine *= damping
    cosine, sine = math.cos(heading), math.sin(heading)
    turned = complex(cosine, sine)
    turned_mean = turned * arc_mean
    moved = way + turned_mean
    dx, dy = moved.real, moved.imag
    with_x, with_y = moved * x_swing, moved * y_swing
    arc_swung = (arc_xx - arc_yy) * sine_square
    arc_xx -= arc_swung
    arc_yy += arc_swung
    arc_xy *= 1.0 - 2.0 * sine_square
    arc_t = mean_cosine * turned * complex(arc_xt, arc_yt)
    ahead, aside, both = cosine * cosine, sine * sine, sine * cosine
    twice, dx_dx, dy_dy = 2.0 * both * arc_xy, dx * dx, dy * dy
    return PoseCovariance(
        xx + 2.0 * with_x.real + dx_dx * cosine_variance + dy_dy * sine_square
        + ahead * arc_xx - twice + aside * arc_yy,
        xy + with_x.imag + with_y.real + dx * dy * (cosine_variance - sine_square)
        + both * (arc_xx - arc_yy) + (ahead - aside) * arc_xy,
        xt - dy * swing + arc_t.real,
        yy + 2.0 * with_y.imag + dy_dy * cosine_variance + dx_dx * sine_square
        + aside * arc_xx + twice + ahead * arc_yy,
        yt + dx * swing + arc_t.imag,
        tt + arc_tt), mean + mean_cosine * turned_mean - cosine_loss * way, (
            math.exp(-0.5 * arc_tt), cosine_variance, sine_square)
