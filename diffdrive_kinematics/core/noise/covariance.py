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
Covariance of the pose and of the twist, from the slip of the wheels.

The slip of a wheel is gathered along its way: ``dq = k |dd|`` is the variance that an element of
its travel adds.  An error of the travel at one point of the arc moves the end of the arc by the
gradient g of the rest of the arc, lever arms included, so the arc adds
``sum over the wheels of k |d| * integral_0^1 g(t) g(t)^T dt``.  Integrated like this the
covariance does not depend on how a path is cut into steps (Chong & Kleeman 1997); the usual form,
one Jacobian per step (Siegwart & Nourbakhsh, eq. 5.9), is 25 % low across a straight step.

All covariances are about the mean, which is the pose that the (biased) travel leads to; they
are of first order in the slip.  A bias is no part of them: pass the travel ``(1 + b) d`` of the
mean, and where k counts by nominal metre ``k / (1 + b)``.
"""

import math
from typing import NamedTuple, Tuple

from diffdrive_kinematics.core.kinematics import (
    advance, check_non_negative, check_positive, Number, Pose, pose_change_from_travel,
    WheelGeometry)
from diffdrive_kinematics.core.noise.distributions import heading_variance
import numpy as np
from numpy.typing import NDArray

__all__ = [
    'E_MEAN', 'E_SQUARE', 'NO_COVARIANCE', 'PoseCovariance', 'SERIES_END', 'SINE_SQUARE',
    'TwistCovariance', 'heading_covariance', 'moved_covariance', 'polynomial',
    'propagated_covariance', 'slip_covariance', 'twist_covariance']


class PoseCovariance(NamedTuple):
    """
    Symmetric covariance of (x, y, theta) in a fixed frame, as six floats.

    Plain floats, as one step of it takes a few microseconds and one of a numpy matrix several
    times that.  ``+`` joins tuples: add with :meth:`plus`.

    Parameters
    ----------
    xx, xy : float
        Var x and Cov(x, y) [m^2].
    xt : float
        Cov(x, theta) [m rad].
    yy : float
        Var y [m^2].
    yt : float
        Cov(y, theta) [m rad].
    tt : float
        Var theta [rad^2].

    Examples
    --------
    >>> covariance = NO_COVARIANCE._replace(xx=0.04, yy=0.01)
    >>> f'{math.sqrt(covariance.xx):.2f} m along x'
    '0.20 m along x'

    """

    xx: float
    xy: float
    xt: float
    yy: float
    yt: float
    tt: float

    def matrix(self) -> NDArray[np.float64]:
        """
        Return the covariance as an array.

        Returns
        -------
        numpy.ndarray, shape (3, 3)
            Rows and columns are (x, y, theta).

        Examples
        --------
        >>> PoseCovariance(4.0, 0.5, 0.0, 1.0, 0.0, 9.0).matrix()
        array([[4. , 0.5, 0. ],
               [0.5, 1. , 0. ],
               [0. , 0. , 9. ]])

        """
        return np.array([[self.xx, self.xy, self.xt],
                         [self.xy, self.yy, self.yt],
                         [self.xt, self.yt, self.tt]])

    @staticmethod
    def from_matrix(matrix: NDArray[np.float64]) -> 'PoseCovariance':
        """
        Return the covariance of a symmetric matrix.

        Parameters
        ----------
        matrix : numpy.ndarray, shape (3, 3)
            Rows and columns are (x, y, theta); its upper triangle counts.

        Returns
        -------
        PoseCovariance
            The same covariance as floats.

        Raises
        ------
        ValueError
            If the shape is another one.

        Examples
        --------
        >>> PoseCovariance.from_matrix(np.diag([4.0, 1.0, 9.0]))
        PoseCovariance(xx=4.0, xy=0.0, xt=0.0, yy=1.0, yt=0.0, tt=9.0)

        """
        if np.shape(matrix) != (3, 3):
            raise ValueError(f'matrix has shape {np.shape(matrix)}, expected (3, 3)')
        return PoseCovariance(*(float(matrix[i][j]) for i in range(3) for j in range(i, 3)))

    def plus(self, other: 'PoseCovariance') -> 'PoseCovariance':
        """
        Return the sum: the covariance of the sum of two independent errors.

        Parameters
        ----------
        other : PoseCovariance
            In the same frame.

        Returns
        -------
        PoseCovariance
            The sum, element by element.

        Examples
        --------
        >>> NO_COVARIANCE._replace(xx=4.0).plus(NO_COVARIANCE._replace(xx=1.0)).xx
        5.0

        """
        return PoseCovariance(
            self.xx + other.xx, self.xy + other.xy, self.xt + other.xt,
            self.yy + other.yy, self.yt + other.yt, self.tt + other.tt)

    def rotated(self, angle: float) -> 'PoseCovariance':
        """
        Return ``R P R^T``: the covariance of the error turned counter-clockwise by ``angle``.

        A covariance in the axes of frame B is, in those of frame A, turned by the heading of B
        in A; from A into the axes of a robot with heading theta it is turned by ``-theta``.

        Parameters
        ----------
        angle : float
            Angle [rad] to turn by.

        Returns
        -------
        PoseCovariance
            In the turned axes; Var theta stays as it is.

        Examples
        --------
        An error along the axis of a robot that looks along y is one in y:

        >>> turned = NO_COVARIANCE._replace(xx=4.0).rotated(0.5 * math.pi)
        >>> round(turned.xx, 9), round(turned.yy, 9)
        (0.0, 4.0)

        """
        c, s = math.cos(angle), math.sin(angle)
        twice = 2.0 * s * c * self.xy
        return PoseCovariance(
            c * c * self.xx - twice + s * s * self.yy,
            s * c * (self.xx - self.yy) + (c * c - s * s) * self.xy,
            c * self.xt - s * self.yt,
            s * s * self.xx + twice + c * c * self.yy,
            s * self.xt + c * self.yt,
            self.tt)


NO_COVARIANCE = PoseCovariance(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def heading_covariance(concentration: float) -> PoseCovariance:
    """
    Return the covariance of a known position with a von Mises heading.

    Parameters
    ----------
    concentration : float
        Concentration kappa of the heading [1], 0 or above; NaN: the heading is known, too.

    Returns
    -------
    PoseCovariance
        Only Var theta, that of :func:`.heading_variance`, is not 0.

    Raises
    ------
    ValueError
        If the concentration is infinite or below 0.

    Examples
    --------
    >>> round(heading_covariance(100.0).tt, 4)
    0.0101

    """
    if math.isnan(concentration):
        return NO_COVARIANCE
    return NO_COVARIANCE._replace(tt=heading_variance(concentration))


class TwistCovariance(NamedTuple):
    """
    Covariance of a twist (v, w).

    Parameters
    ----------
    vv : float
        Var v [m^2/s^2].
    vw : float
        Cov(v, w) [m rad/s^2].
    ww : float
        Var w [rad^2/s^2].

    Examples
    --------
    >>> TwistCovariance(vv=1e-4, vw=0.0, ww=1e-3).vv
    0.0001

    """

    vv: float
    vw: float
    ww: float


def slip_covariance(
        geometry: WheelGeometry, heading: float, d_left: float, d_right: float,
        k_left: float, k_right: float) -> PoseCovariance:
    """
    Return the covariance that slip adds along an arc, in the fixed frame.

    The integral over the arc in closed form.  In the axes of the arc's middle direction, with
    h = turn / 2, s from -1 (start) to 1 (end) and d_o the travel of the other wheel, an error of
    travel at s moves the end by ``g = (cos(h) / 2 -+ d_o / (2 L) e(s), +-(d_l + d_r) sinc(h) /
    (4 L) -+ d_o / (2 L) sin(h s) / h, +-1 / L)``, ``e(s) = (cos(h s) - cos(h)) / h``, upper signs
    for the right wheel: the Jacobian of the arc that is left, written so that nothing is singular
    on the straight line.  Valid for any turn; one arc and its parts give the same.

    Parameters
    ----------
    geometry : WheelGeometry
        Size and spacing of the wheels.
    heading : float
        Heading theta [rad] at the start of the arc.
    d_left, d_right : float
        Travel [m] of the wheels along the arc, the bias included; of any sign.
    k_left, k_right : float
        Slip variance per metre of that travel [m].

    Returns
    -------
    PoseCovariance
        What the arc adds to :func:`moved_covariance`.

    Raises
    ------
    ValueError
        If a slip variance is not finite or below 0.

    Examples
    --------
    After a straight metre, ``Var theta = (k_l + k_r) d / L^2`` and ``Var y`` is d^2 / 3 of it:

    >>> added = slip_covariance(WheelGeometry(0.5, 0.125), 0.0, 1.0, 1.0, 1e-4, 1e-4)
    >>> f'{added.tt:.2e} {added.yy:.2e}'
    '8.00e-04 2.67e-04'

    """
    q_left = check_non_negative('left slip variance', k_left) * abs(d_left)
    q_right = check_non_negative('right slip variance', k_right) * abs(d_right)
    distance, turn = pose_change_from_travel(geometry, d_left, d_right)
    half, per_length = 0.5 * turn, 1.0 / geometry.separation
    e_mean, e_square, sine_square = _arc_means(half)
    cosine = math.cos(half)
    across = 0.5 * per_length * distance * (math.sin(half) / half if half else 1.0)
    lever_left, lever_right = 0.5 * per_length * d_right, -0.5 * per_length * d_left
    along_left = 0.5 * cosine + lever_left * e_mean
    along_right = 0.5 * cosine + lever_right * e_mean
    both = q_left + q_right
    difference = q_right * along_right - q_left * along_left
    middle = PoseCovariance(
        q_left * _mean_square(cosine, lever_left, e_mean, e_square)
        + q_right * _mean_square(cosine, lever_right, e_mean, e_square),
        across * difference,
        per_length * difference,
        across * across * both
        + (q_left * lever_left * lever_left + q_right * lever_right * lever_right) * sine_square,
        across * per_length * both,
        per_length * per_length * both)
    return middle.rotated(heading + half)


def _mean_square(cosine: float, lever: float, e_mean: float, e_square: float) -> float:
    """Return the mean of ``(cosine / 2 + lever e)^2`` along the arc."""
    return 0.25 * cosine * cosine + lever * (cosine * e_mean + lever * e_square)


def _arc_means(half: float) -> Tuple[float, float, float]:
    """
    Return the means of e(s), e(s)^2 and (sin(h s) / h)^2 over s in [-1, 1], h = ``half``.

    The closed forms cancel as 1 / h^4 towards h = 0; the power series in h^2 up to h = 1/2
    leave out less than 1e-17 and the closed forms beyond lose less than 3e-14.
    """
    square = half * half
    if square <= SERIES_END:
        return (half * polynomial(E_MEAN, square), square * polynomial(E_SQUARE, square),
                polynomial(SINE_SQUARE, square))
    cosine, sinc = math.cos(half), math.sin(half) / half
    return ((sinc - cosine) / half,
            (0.5 + cosine * (cosine - 1.5 * sinc)) / square,
            0.5 * (1.0 - cosine * sinc) / square)


def polynomial(coefficients: Tuple[float, ...], variable: Number) -> Number:
    """
    Return the value of a polynomial.

    Parameters
    ----------
    coefficients : tuple of float
        Coefficients, that of the highest power first.
    variable : float or numpy.ndarray
        Where to evaluate it.

    Returns
    -------
    float or numpy.ndarray
        The value, of the shape of ``variable``.

    Examples
    --------
    >>> polynomial((2.0, 0.0, 1.0), 3.0)  # 2 x^2 + 1
    19.0

    """
    total = 0.0 * variable
    for coefficient in coefficients:
        total = total * variable + coefficient
    return total


SERIES_END = 0.25  # of h^2
TERMS = range(9, 0, -1)
E_MEAN = tuple(-(-1.0)**k * 2 * k / math.factorial(2 * k + 1) for k in TERMS)
E_SQUARE = tuple((-4.0)**k * (k - 1) / math.factorial(2 * k + 1) for k in TERMS if k > 1)
SINE_SQUARE = tuple(-0.5 * (-4.0)**k / math.factorial(2 * k + 1) for k in TERMS)


def moved_covariance(
        covariance: PoseCovariance, before: Pose, after: Pose,
        added: PoseCovariance) -> PoseCovariance:
    """
    Return ``F P F^T`` plus what the motion adds.

    ``F = [[1, 0, -(y' - y)], [0, 1, x' - x], [0, 0, 1]]``: an error of the heading before the
    motion swings the whole motion (Smith, Self & Cheeseman 1990).

    Parameters
    ----------
    covariance : PoseCovariance
        P of the pose before, in the fixed frame.
    before, after : Pose
        Mean pose before and after the motion (floats), in the same frame.
    added : PoseCovariance
        Of :func:`slip_covariance`, for the heading before.

    Returns
    -------
    PoseCovariance
        Of the pose after, in the fixed frame.

    Examples
    --------
    A heading that is known to 0.1 rad makes 0.5 m across 5 m straight ahead:

    >>> start = NO_COVARIANCE._replace(tt=0.1**2)
    >>> moved = moved_covariance(start, Pose(0.0, 0.0, 0.0), Pose(5.0, 0.0, 0.0), NO_COVARIANCE)
    >>> round(math.sqrt(moved.yy), 6)
    0.5

    """
    dx, dy = float(after.x) - float(before.x), float(after.y) - float(before.y)
    xx, xy, xt, yy, yt, tt = covariance
    x_with_t, y_with_t = xt - dy * tt, yt + dx * tt
    return PoseCovariance(
        xx - dy * (xt + x_with_t) + added.xx,
        xy - dy * yt + dx * x_with_t + added.xy,
        x_with_t + added.xt,
        yy + dx * (yt + y_with_t) + added.yy,
        y_with_t + added.yt,
        tt + added.tt)


def propagated_covariance(
        covariance: PoseCovariance, pose: Pose, geometry: WheelGeometry, d_left: float,
        d_right: float, k_left: float, k_right: float) -> Tuple[Pose, PoseCovariance]:
    """
    Return the mean pose and its covariance after an arc, both in the frame of ``pose``.

    One step of a travel d and n steps of d/n give the same.

    Parameters
    ----------
    covariance : PoseCovariance
        Of the pose before.
    pose : Pose
        Mean pose before; floats.
    geometry : WheelGeometry
        Size and spacing of the wheels.
    d_left, d_right : float
        Travel [m] of the wheels along the arc, the bias included; of any sign.
    k_left, k_right : float
        Slip variance per metre of that travel [m].

    Returns
    -------
    pose : Pose
        Mean pose after; the heading is not wrapped.
    covariance : PoseCovariance
        Its covariance.

    Raises
    ------
    ValueError
        If a slip variance is not finite or below 0.

    Examples
    --------
    >>> pose, covariance = propagated_covariance(
    ...     NO_COVARIANCE, Pose(0.0, 0.0, 0.0), WheelGeometry(0.5, 0.125), 1.0, 1.0, 1e-4, 1e-4)
    >>> f'x = {pose.x:.1f} m, sigma_theta = {math.sqrt(covariance.tt):.4f} rad'
    'x = 1.0 m, sigma_theta = 0.0283 rad'

    """
    after = advance(pose, *pose_change_from_travel(geometry, d_left, d_right))
    added = slip_covariance(geometry, float(pose.theta), d_left, d_right, k_left, k_right)
    return after, moved_covariance(covariance, pose, after, added)


def twist_covariance(
        geometry: WheelGeometry, rates: Tuple[float, float], k_left: float, k_right: float,
        period: float, floor: float = 1e-9) -> TwistCovariance:
    """
    Return the covariance of the mean twist over a period, as slip disturbs it.

    With ``q = k |u| R T`` the variance of a wheel's travel in the period T,
    ``Var v = (q_l + q_r) / (4 T^2)``, ``Var w = (q_l + q_r) / (L^2 T^2)`` and
    ``Cov(v, w) = (q_r - q_l) / (2 L T^2)``.  It falls with T, so a filter that integrates a twist
    each period gathers the variance of the path whatever the rate.

    Parameters
    ----------
    geometry : WheelGeometry
        Size and spacing of the wheels.
    rates : pair of float
        Wheel rates (left, right) [rad/s].
    k_left, k_right : float
        Slip variance per metre [m].
    period : float
        Time T [s] between two twists.
    floor : float
        Added to both variances, (m/s)^2 and (rad/s)^2, so that a robot at rest reports no zero.

    Returns
    -------
    TwistCovariance
        Of the forward speed and the yaw rate.

    Raises
    ------
    ValueError
        If a slip variance or the floor is not finite or below 0, or the period not above 0.

    Examples
    --------
    At 1 m/s, reported at 10 Hz:

    >>> found = twist_covariance(WheelGeometry(0.5, 0.125), (8.0, 8.0), 1e-4, 1e-4, period=0.1)
    >>> f'{found.vv:.1e} {found.ww:.1e}'
    '5.0e-04 8.0e-03'

    """
    left, right = abs(rates[0]) * geometry.left_radius, abs(rates[1]) * geometry.right_radius
    rate_left = check_non_negative('left slip variance', k_left) * left
    rate_right = check_non_negative('right slip variance', k_right) * right
    scale = 1.0 / check_positive('period', period)
    check_non_negative('floor', floor)
    both, separation = scale * (rate_left + rate_right), geometry.separation
    return TwistCovariance(
        0.25 * both + floor,
        0.5 * scale * (rate_right - rate_left) / separation,
        both / separation**2 + floor)
