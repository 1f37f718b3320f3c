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
Maximum likelihood of slip constants, from windows of wheel travel between reference poses.

A window is a stretch of wheel travel with a reference pose (motion capture, a tracker) at its
start and its end.  In the frame of its start, its error is the reference's relative pose minus
that of wheel odometry.  If the systematic errors have been calibrated away, it is Gaussian with

``P = k_l A_l + k_r A_r + s_p^2 N_p + s_h^2 N_h``,

where ``A_w`` is the covariance of the package for ``k_w = 1`` (see :mod:`.covariance`), and s_p
and s_h are the white noise of the reference's position (each axis) and heading.  Both ends
carry it: ``N_p = diag(2, 2, 0)``, and ``N_h = j j^T + diag(0, 0, 1)`` with ``j = (y, -x, -1)``,
as an error of the heading at the start swings the whole displacement (x, y).

P is linear in the four variances, so the derivatives of the likelihood are those of a model of
variance components (Harville 1977, J. Am. Stat. Assoc. 72(358), eqs. 2.3 to 2.6).  Windows count
as independent: they must not overlap, and noise at a shared end counts twice.
"""

from dataclasses import dataclass
import math
from typing import List, NamedTuple, Optional, Sequence, Tuple

from diffdrive_kinematics.core.calibration.estimate import Estimate
from diffdrive_kinematics.core.kinematics import (
    between, check_non_negative, Pose, WheelGeometry, wrap_angle)
from diffdrive_kinematics.core.noise import covariance_along
import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = [
    'NO_NOISE', 'Estimate', 'ReferenceNoise', 'SlipFit', 'SlipWindow', 'fit_reference_noise',
    'fit_slip', 'nees_per_dof', 'slip_window']

Array = NDArray[np.float64]

FEWEST_WINDOWS = 5
DISTINCT = 1e-7
"""Smallest eigenvalue of the information's correlation matrix that counts as identified."""
VANISHED = 1e-7
"""Share of the errors below which a variance component is put to 0."""


class ReferenceNoise(NamedTuple):
    """
    White noise of reference poses.

    Parameters
    ----------
    sigma_position : float
        Standard deviation of x and of y [m].
    sigma_heading : float
        Standard deviation of theta [rad].

    Examples
    --------
    >>> ReferenceNoise(sigma_position=0.002, sigma_heading=0.005)
    ReferenceNoise(sigma_position=0.002, sigma_heading=0.005)

    """

    sigma_position: float
    sigma_heading: float


NO_NOISE = ReferenceNoise(0.0, 0.0)


@dataclass(frozen=True)
class SlipWindow:
    """
    One window: its error, and what each unit of variance adds to the error's covariance.

    Arrays are in the frame of the window's start; covariances are of (x [m], y [m], theta [rad]).

    Parameters
    ----------
    error : numpy.ndarray, shape (3,)
        Relative pose of the reference minus that of wheel odometry, theta wrapped.
    left, right : numpy.ndarray, shape (3, 3)
        A_l and A_r: covariance for a slip constant of 1 m.
    position, heading : numpy.ndarray, shape (3, 3)
        N_p and N_h: covariance for a reference noise of 1 m^2 and 1 rad^2.

    Examples
    --------
    See :func:`slip_window`.

    """

    error: Array
    left: Array
    right: Array
    position: Array
    heading: Array


@dataclass(frozen=True)
class SlipFit:
    """
    Slip constants of the greatest likelihood, and how well they fit.

    Parameters
    ----------
    k_left, k_right : Estimate
        Slip variance per metre of travel [m]; the same numbers if one k was fitted for both.
    sigma_position, sigma_heading : Estimate
        Noise of the reference [m], [rad].
    log_likelihood : float
        Natural logarithm, without the constant of the normal density.
    nees_per_dof : float
        Mean over the windows, near 1 by construction.
    windows : int
        How many there were.

    Examples
    --------
    See :func:`fit_slip`.

    """

    k_left: Estimate
    k_right: Estimate
    sigma_position: Estimate
    sigma_heading: Estimate
    log_likelihood: float
    nees_per_dof: float
    windows: int

    @property
    def noise(self) -> ReferenceNoise:
        """Noise of the reference, without its errors."""
        return ReferenceNoise(self.sigma_position.value, self.sigma_heading.value)


def slip_window(
        geometry: WheelGeometry, travel: ArrayLike, before: Pose, after: Pose) -> SlipWindow:
    """
    Return the window of wheel travel between two reference poses.

    Parameters
    ----------
    geometry : WheelGeometry
        Calibrated; only its separation counts.
    travel : array_like, shape (n, 2)
        Calibrated travel (d_l, d_r) [m] of each of n >= 1 intervals, in order.
    before, after : Pose
        Reference poses of the robot's centre (between the wheels) at the start and the end,
        floats, in one fixed frame.

    Returns
    -------
    SlipWindow
        Its error, and the covariances of which that of the error is made.

    Raises
    ------
    ValueError
        If the shape is another one, a number is not finite, or no wheel travelled.

    Examples
    --------
    A straight metre by the wheels, at the end of which a tracker sees the robot 2 mm to the left:

    >>> window = slip_window(
    ...     WheelGeometry(0.5, 0.125), np.full((20, 2), 0.05),
    ...     before=Pose(0.0, 0.0, 0.0), after=Pose(1.0, 0.002, 0.0))
    >>> abs(window.error.round(6))
    array([0.   , 0.002, 0.   ])

    """
    rows = np.asarray(travel, dtype=np.float64)
    if rows.ndim != 2 or rows.shape[1] != 2 or not len(rows):
        raise ValueError(f'travel has shape {rows.shape}, expected (n, 2) with n at least 1')
    if not np.isfinite(rows).all():
        raise ValueError('travel has numbers that are not finite, expected finite ones')
    if not np.isfinite(np.array([before, after], dtype=np.float64)).all():
        raise ValueError(f'reference poses are {before} and {after}, expected finite numbers')
    moving = rows[(rows != 0.0).any(axis=1)]
    if not len(moving):
        raise ValueError('travel is 0 throughout, expected a window in which a wheel turns')
    pose, (left, right) = covariance_along(geometry, moving)
    measured = _relative(before, after)
    odometry = np.array([pose.x, pose.y, pose.theta])
    error = measured - odometry
    error[2] = wrap_angle(float(error[2]))
    return SlipWindow(
        error, left, right, np.diag([2.0, 2.0, 0.0]),
        _heading_noise(float(pose.x), float(pose.y)))


def fit_slip(
        windows: Sequence[SlipWindow], *, equal: bool = True,
        noise: Optional[ReferenceNoise] = None) -> SlipFit:
    """
    Return the slip constants of the greatest likelihood, with standard errors.

    Errors are those of the observed information (the curvature of the log likelihood), or of
    the expected one where an estimate lies on its bound, 0.  They hold for independent windows.

    Parameters
    ----------
    windows : sequence of SlipWindow
        At least 5 that do not overlap; without ``noise``, of different lengths, as the noise of
        the reference shows in short windows and slip in long ones.
    equal : bool
        Fit one k for both wheels instead of one each.
    noise : ReferenceNoise, optional
        Noise of the reference where it is known; fitted as well where it is not.

    Returns
    -------
    SlipFit
        Slip constants and noise with their errors.

    Raises
    ------
    ValueError
        If there are too few windows, a number is not finite, there are no errors, or the
        windows cannot tell the parameters from one another.

    Examples
    --------
    From 400 simulated metres with k = 1e-4 m of both wheels:

    >>> from diffdrive_kinematics.core.noise import WheelSlip
    >>> from diffdrive_kinematics.core.noise import propagate
    >>> geometry, slip = WheelGeometry(0.5, 0.125), WheelSlip(variance=1e-4)
    >>> ends = propagate(Pose(*np.zeros((3, 400))), 1.0, 1.0, geometry, slip, slip, seed=1)
    >>> k = fit_slip([slip_window(geometry, [[1.0, 1.0]], Pose(0.0, 0.0, 0.0), Pose(*end))
    ...               for end in zip(*ends)], noise=NO_NOISE).k_left
    >>> abs(k.value - 1e-4) < 3.0 * k.error < 0.2e-4
    True

    """
    stack = _stacked(windows)
    slip = [stack.left + stack.right] if equal else [stack.left, stack.right]
    if noise is None:
        given, parts = np.zeros_like(stack.left), [*slip, stack.position, stack.heading]
    else:
        given, parts = _noise_covariance(stack, noise), slip
    fit = _components(stack.error, np.stack(parts), given)
    k_left = Estimate(fit.values[0], fit.errors[0])
    k_right = k_left if equal else Estimate(fit.values[1], fit.errors[1])
    position, heading = _sigmas(fit, len(slip), noise)
    return SlipFit(
        k_left, k_right, position, heading, fit.log_likelihood, fit.nees, len(windows))


def fit_reference_noise(
        windows: Sequence[SlipWindow], k_left: float, k_right: float) -> SlipFit:
    """
    Return the reference's noise of the greatest likelihood, for known slip constants.

    For the reference of another session: best from short windows, in which slip is small.

    Parameters
    ----------
    windows : sequence of SlipWindow
        At least 5 that do not overlap.
    k_left, k_right : float
        Slip variance per metre of travel [m].

    Returns
    -------
    SlipFit
        Noise with its errors; the slip constants are those given, with errors of 0.

    Raises
    ------
    ValueError
        As :func:`fit_slip`; if a slip constant is not finite or below 0.

    Examples
    --------
    Both ends of a window carry the noise, here of 5 mm and 10 mrad:

    >>> errors = 2.0**0.5 * np.random.default_rng(1).normal(0.0, [0.005, 0.005, 0.01], (400, 3))
    >>> windows = [slip_window(WheelGeometry(0.5, 0.125), [[0.01, 0.01]], Pose(0.0, 0.0, 0.0),
    ...                        Pose(0.01 + x, y, theta)) for x, y, theta in errors]
    >>> f'{fit_reference_noise(windows, 1e-6, 1e-6).sigma_position.value:.3f} m'
    '0.005 m'

    """
    stack = _stacked(windows)
    given = _slip_covariance(stack, k_left, k_right)
    fit = _components(stack.error, np.stack([stack.position, stack.heading]), given)
    position, heading = _sigmas(fit, 0, None)
    return SlipFit(
        Estimate(k_left, 0.0), Estimate(k_right, 0.0), position, heading, fit.log_likelihood,
        fit.nees, len(windows))


def nees_per_dof(
        windows: Sequence[SlipWindow], k_left: float, k_right: float,
        noise: ReferenceNoise = NO_NOISE) -> Array:
    """
    Return ``e^T P^-1 e / 3`` of each window; its mean is 1 if the model holds.

    The normalised error squared of Bar-Shalom, Li & Kirubarajan (2001, sec. 5.4.2), for slip
    constants and a noise of the reference that may come from other windows.

    Parameters
    ----------
    windows : sequence of SlipWindow
        At least one.
    k_left, k_right : float
        Slip variance per metre of travel [m].
    noise : ReferenceNoise
        Noise of the reference.

    Returns
    -------
    numpy.ndarray, shape (n,)
        One value for each window [1].

    Raises
    ------
    ValueError
        If a constant is not finite or below 0, or the covariance of a window is singular.

    Examples
    --------
    >>> window = slip_window(WheelGeometry(0.5, 0.125), [[1.0, 1.0]],
    ...                      Pose(0.0, 0.0, 0.0), Pose(1.0, 0.0, 0.03))
    >>> nees_per_dof([window], k_left=1e-4, k_right=1e-4).round(3)
    array([1.5])

    """
    stack = _stacked(windows, fewest=1)
    covariance = _slip_covariance(stack, k_left, k_right) + _noise_covariance(stack, noise)
    _, quadratic = _likelihood(stack.error, covariance)
    return quadratic / 3.0


class _Components(NamedTuple):
    """Fitted variances and their standard errors."""

    values: List[float]
    errors: List[float]
    log_likelihood: float
    nees: float


def _relative(before: Pose, after: Pose) -> Array:
    """Return the pose ``after`` in the frame of ``before``, shape (3,); theta not wrapped."""
    return np.array(between(Pose(*map(float, before)), Pose(*map(float, after))))


def _heading_noise(x: float, y: float) -> Array:
    lever = np.array([y, -x, -1.0])
    return np.outer(lever, lever) + np.diag([0.0, 0.0, 1.0])


def _stacked(windows: Sequence[SlipWindow], fewest: int = FEWEST_WINDOWS) -> SlipWindow:
    """Return the windows as one, whose arrays have a leading axis."""
    if len(windows) < fewest:
        raise ValueError(f'there are {len(windows)} windows, expected at least {fewest}')
    stack = SlipWindow(*(np.stack([getattr(window, name) for window in windows])
                         for name in SlipWindow.__dataclass_fields__))
    for name in SlipWindow.__dataclass_fields__:
        if not np.isfinite(getattr(stack, name)).all():
            raise ValueError(f'a window has a {name} that is not finite, expected finite numbers')
    return stack


def _slip_covariance(stack: SlipWindow, k_left: float, k_right: float) -> Array:
    return (check_non_negative('k_left', k_left) * stack.left
            + check_non_negative('k_right', k_right) * stack.right)


def _noise_covariance(stack: SlipWindow, noise: ReferenceNoise) -> Array:
    return (check_non_negative('sigma_position', noise.sigma_position)**2 * stack.position
            + check_non_negative('sigma_heading', noise.sigma_heading)**2 * stack.heading)


def _sigmas(
        fit: _Components, first: int, noise: Optional[ReferenceNoise]
) -> Tuple[Estimate, Estimate]:
    """Return standard deviations of the noise; errors by ``d sigma = d variance / (2 sigma)``."""
    if noise is not None:
        return Estimate(noise.sigma_position, 0.0), Estimate(noise.sigma_heading, 0.0)
    position, heading = (
        Estimate(math.sqrt(variance), 0.5 * error / math.sqrt(variance) if variance
                 else math.sqrt(error))
        for variance, error in zip(fit.values[first:], fit.errors[first:]))
    return position, heading


def _likelihood(error: Array, covariance: Array) -> Tuple[Array, Array]:
    """Return ``log det P`` and ``e^T P^-1 e`` of each window."""
    sign, log_det = np.linalg.slogdet(covariance)
    if not ((sign > 0.0) & np.isfinite(log_det)).all():
        worst = int(np.argmin(np.where(np.isfinite(log_det), sign, -1.0)))
        raise ValueError(
            f'the covariance of window {worst} is singular, expected slip or a noise of the '
            f'reference that moves x, y and theta')
    solved = np.linalg.solve(covariance, error[..., None])[..., 0]
    return log_det, np.einsum('ni,ni->n', error, solved)


def _components(error: Array, parts: Array, given: Array) -> _Components:
    """
    Fit ``P = given + sum of q_a parts_a``, q >= 0; ``parts`` has shape (parameters, n, 3, 3).

    The likelihood may have several maxima: the search starts where all parts share the errors,
    and where each one has nearly all of them.  A component that shrinks below ``VANISHED`` of
    what would explain the errors alone is on its bound.
    """
    scale = _scales(error, parts)
    share = np.vstack([np.full(len(scale), 1.0 / len(scale)),
                       np.full((len(scale), len(scale)), 1e-3) + np.eye(len(scale))])
    found = [_scored(error, parts, given, start, 1e-2 * VANISHED * scale)
             for start in share * scale]
    values = min(found, key=lambda each: each[1])[0]
    return _summary(error, parts, given, np.where(values < VANISHED * scale, 0.0, values))


def _scored(
        error: Array, parts: Array, given: Array, values: Array, least: Array
) -> Tuple[Array, float]:
    """Return where damped Fisher scoring on log q ends, and the cost there."""
    cost, damping = _cost(error, parts, given, values), 1e-6
    for _ in range(300):
        gradient, expected, _ = _derivatives(error, parts, given, values)
        normal = expected * np.outer(values, values)
        normal += damping * np.diag(np.diag(normal)) + 1e-12 * np.eye(len(values))
        step = np.clip(-np.linalg.solve(normal, gradient * values), -2.0, 2.0)
        trial = np.maximum(values * np.exp(step), least)
        trial_cost = _cost(error, parts, given, trial)
        if trial_cost > cost:
            damping = 10.0 * max(damping, 1e-3)
            if damping > 1e9:
                break
            continue
        done = cost - trial_cost < 1e-10 and float(np.abs(trial / values - 1.0).max()) < 1e-5
        values, cost, damping = trial, trial_cost, 0.1 * damping
        if done:
            break
    return values, cost


def _scales(error: Array, parts: Array) -> Array:
    """Return for each part the variance that would explain the errors alone, roughly."""
    squares = (error**2).sum(axis=0)
    sums = np.einsum('pnii->pi', parts)
    with np.errstate(divide='ignore', invalid='ignore'):
        scale: Array = np.nanmax(np.where(sums > 0.0, squares / sums, np.nan), axis=1)
    if not (scale > 0.0).all():
        raise ValueError('all errors are 0, expected windows with errors of slip or noise')
    return scale


def _cost(error: Array, parts: Array, given: Array, values: Array) -> float:
    """Return the negative log likelihood, without its constant."""
    log_det, quadratic = _likelihood(error, given + np.tensordot(values, parts, 1))
    return 0.5 * float((log_det + quadratic).sum())


def _derivatives(
        error: Array, parts: Array, given: Array, values: Array) -> Tuple[Array, Array, Array]:
    """
    Return the gradient of the cost, and the expected and the observed information.

    With ``B_a = P^-1 A_a`` and ``w = P^-1 e``: ``g_a = (tr B_a - w^T A_a w) / 2``,
    ``I_ab = tr(B_a B_b) / 2``, ``J_ab = w^T A_a P^-1 A_b w - I_ab`` (Harville 1977).
    """
    covariance = given + np.tensordot(values, parts, 1)
    ratios = np.linalg.solve(covariance, parts)
    weighted = np.linalg.solve(covariance, error[..., None])[..., 0]
    pulls = np.einsum('anij,nj->ani', parts, weighted)
    gradient: Array = 0.5 * (np.einsum('anii->a', ratios)
                             - np.einsum('ni,ani->a', weighted, pulls))
    expected: Array = 0.5 * np.einsum('anij,bnji->ab', ratios, ratios, optimize=True)
    swung = np.linalg.solve(covariance, pulls[..., None])[..., 0]
    observed: Array = np.einsum('ani,bni->ab', pulls, swung) - expected
    return gradient, expected, observed


def _summary(error: Array, parts: Array, given: Array, values: Array) -> _Components:
    _, expected, observed = _derivatives(error, parts, given, values)
    _refuse_confounded(expected)
    inside = bool((values > 0.0).all()) and bool((np.linalg.eigvalsh(observed) > 0.0).all())
    errors = np.sqrt(np.diag(np.linalg.inv(observed if inside else expected)))
    _, quadratic = _likelihood(error, given + np.tensordot(values, parts, 1))
    return _Components(
        values.tolist(), errors.tolist(), -_cost(error, parts, given, values),
        float(quadratic.mean()) / 3.0)


def _refuse_confounded(information: Array) -> None:
    """Raise where one parameter could be exchanged for others without changing any window."""
    size = np.sqrt(np.diag(information))
    if np.linalg.eigvalsh(information / np.outer(size, size))[0] < DISTINCT:
        raise ValueError(
            'the windows cannot tell slip and noise of the reference apart, expected windows '
            'of different lengths and courses, or a given noise')
