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
Variance components of the greatest likelihood: what the covariances of errors are made of.

``P = given + sum of q_a parts_a`` is linear in q: a model of variance components (Harville 1977,
J. Am. Stat. Assoc. 72(358), eqs. 2.3 to 2.6).  With ``M P M^T = 1`` all of it is sums over the
white errors ``z = M e`` and parts ``C_a = M A_a M^T`` (:mod:`.white_errors`).
"""

from typing import List, NamedTuple, Optional, Tuple

from diffdrive_kinematics.core.calibration.white_errors import entries_of, TIMES, whitened
from diffdrive_kinematics.core.kinematics import Array
import numpy as np

DISTINCT = 1e-7  # least eigenvalue of the information's correlation that counts as identified
VANISHED = 1e-7  # share of the errors below which a variance component is put to 0


class Components(NamedTuple):
    """
    Fitted variances and their standard errors.

    Parameters
    ----------
    values, errors : list of float
        One for each part.
    log_likelihood : float
        Natural logarithm, without the constant of the normal density.
    nees : float
        Mean of ``e^T P^-1 e / 3``.

    Examples
    --------
    See :func:`fit_components`.

    """

    values: List[float]
    errors: List[float]
    log_likelihood: float
    nees: float


def likelihood(error: Array, covariance: Array) -> Tuple[Array, Array]:
    """
    Return ``log det P`` and ``e^T P^-1 e`` of each error.

    Parameters
    ----------
    error : numpy.ndarray, shape (n, 3)
        Errors e.
    covariance : numpy.ndarray, shape (n, 3, 3)
        Their covariances P.

    Returns
    -------
    log_det : numpy.ndarray, shape (n,)
        Term of the log likelihood that does not depend on the errors.
    quadratic : numpy.ndarray, shape (n,)
        Term that does.

    Raises
    ------
    ValueError
        If a covariance is singular.

    Examples
    --------
    >>> likelihood(np.array([[2.0, 0.0, 0.0]]), np.eye(3)[None])[1]
    array([4.])

    """
    white, log_det, _ = whitened(error.T, entries_of(covariance))
    return log_det, (white**2).sum(axis=0)


def fit_components(
        error: Array, parts: Array, given: Array, *, weights: Optional[Array] = None,
        least: Optional[Array] = None) -> Components:
    """
    Fit ``P = given + sum of q_a parts_a``, q >= 0.

    The likelihood may have several maxima: the search starts where all parts share the errors, and
    where each one has nearly all.  A component that shrinks below ``VANISHED`` of what would
    explain the errors alone is on its bound.

    Parameters
    ----------
    error : numpy.ndarray, shape (n, 3)
        Errors e, independent.
    parts : numpy.ndarray, shape (p, n, 3, 3)
        Covariance of each error for a variance of 1 of each part.
    given : numpy.ndarray, shape (n, 3, 3)
        The part that is known.
    weights : numpy.ndarray, shape (n,), optional
        How many errors each one stands for [1]; 1 without.
    least : numpy.ndarray, shape (p,), optional
        Least variances; 0 without.

    Returns
    -------
    Components
        The variances q with their errors.

    Raises
    ------
    ValueError
        If all errors are 0, a covariance is singular, or the parts cannot be told apart.

    Examples
    --------
    >>> error = np.random.default_rng(1).normal(0.0, 2.0, (500, 3))
    >>> unit = np.broadcast_to(np.eye(3), (500, 3, 3))
    >>> found = fit_components(error, unit[None], 0.0 * unit)
    >>> round(found.values[0]), round(found.nees, 6)
    (4, 1.0)

    """
    data = _Data.of(error, parts, given, np.ones(len(error)) if weights is None else weights)
    scale = _scales(error, parts)
    bound = np.zeros(len(scale)) if least is None else least
    found = [_scored(data, start, np.maximum(1e-2 * VANISHED * scale, bound))
             for start in np.maximum(_shares(len(scale)) * scale, bound)]
    values = min(found, key=lambda each: each[1])[0]
    return _summary(
        data, np.maximum(np.where(values < VANISHED * scale, 0.0, values), bound), bound)


class _Data(NamedTuple):
    """What is given: errors (3, n), entries of parts (p, 6, n) and of what is known (6, n)."""

    error: Array
    parts: Array
    given: Array
    weights: Array

    @classmethod
    def of(cls, error: Array, parts: Array, given: Array, weights: Array) -> '_Data':
        """Return errors (n, 3) with matrices (p, n, 3, 3) and (n, 3, 3)."""
        return cls(error.T.copy(), entries_of(parts), entries_of(given), weights)

    def covariance(self, values: Array) -> Array:
        """Return the entries of P, shape (6, n)."""
        found: Array = self.given + np.tensordot(values, self.parts, 1)
        return found

    def cost(self, values: Array) -> float:
        """Return the negative log likelihood, without its constant."""
        white, log_det, _ = whitened(self.error, self.covariance(values))
        return 0.5 * float(self.weights @ (log_det + (white**2).sum(axis=0)))


def _shares(parts: int) -> Array:
    """Return the share of the errors of each part where a search starts, shape (k, parts)."""
    return np.vstack([np.full((1, parts), 1.0 / parts), 1e-3 + np.eye(parts)])


def _scored(data: _Data, values: Array, least: Array) -> Tuple[Array, float]:
    """Return where damped Fisher scoring on log q ends, and the cost there."""
    cost, damping = data.cost(values), 1e-6
    gradient, expected = _derivatives(data, values)
    for _ in range(300):
        normal = expected * np.outer(values, values)
        normal += damping * np.diag(np.diag(normal)) + 1e-12 * np.eye(len(values))
        step = np.clip(-np.linalg.solve(normal, gradient * values), -2.0, 2.0)
        trial = np.maximum(values * np.exp(step), least)
        trial_cost = data.cost(trial)
        if trial_cost > cost:
            damping = 10.0 * max(damping, 1e-3)
            if damping > 1e9:
                break
            continue
        done = cost - trial_cost < 1e-10 and float(np.abs(trial / values - 1.0).max()) < 1e-5
        values, cost, damping = trial, trial_cost, 0.1 * damping
        if done:
            break
        gradient, expected = _derivatives(data, values)
    return values, cost


def _scales(error: Array, parts: Array) -> Array:
    """Return for each part the variance that would explain the errors alone, roughly."""
    squares = (error**2).sum(axis=0)
    sums = np.einsum('pnii->pi', parts)
    with np.errstate(divide='ignore', invalid='ignore'):
        scale: Array = np.nanmax(np.where(sums > 0.0, squares / sums, np.nan), axis=1)
    scale = np.where(scale == 0.0, VANISHED * scale.max(), scale)  # errors elsewhere tell nothing
    if not (scale > 0.0).all():
        raise ValueError('all errors are 0, expected windows with errors of slip or noise')
    return scale


def _derivatives(data: _Data, values: Array) -> Tuple[Array, Array]:
    """
    Return the gradient of the cost, and the expected information.

    ``g_a = (tr C_a - z^T C_a z) / 2`` and ``I_ab = tr(C_a C_b) / 2`` (Harville 1977).
    """
    (x, y, theta), _, parts = whitened(data.error, data.covariance(values), data.parts)
    squares = np.stack([
        1.0 - x * x, -x * y, -x * theta, 1.0 - y * y, -y * theta, 1.0 - theta * theta])
    counted = data.weights * TIMES
    flat = parts.reshape(len(parts), -1)
    gradient: Array = 0.5 * flat @ (counted * squares).ravel()
    expected: Array = 0.5 * (parts * counted).reshape(len(parts), -1) @ flat.T
    return gradient, expected


def _summary(data: _Data, values: Array, least: Array) -> Components:
    _, expected = _derivatives(data, values)
    _refuse_confounded(expected)
    (x, y, theta), _, parts = whitened(data.error, data.covariance(values), data.parts)
    xx, xy, xt, yy, yt, tt = parts.transpose(1, 0, 2)  # pulls: C_a z
    pulls = np.concatenate([xx * x + xy * y + xt * theta, xy * x + yy * y + yt * theta,
                            xt * x + yt * y + tt * theta], axis=1)
    observed = (pulls * np.tile(data.weights, 3)) @ pulls.T - expected
    inside = bool((values > least).all()) and bool((np.linalg.eigvalsh(observed) > 0.0).all())
    errors = np.sqrt(np.diag(np.linalg.inv(observed if inside else expected)))
    nees = float((x * x + y * y + theta * theta).mean()) / 3.0
    return Components(values.tolist(), errors.tolist(), -data.cost(values), nees)


def _refuse_confounded(information: Array) -> None:
    """Raise where one parameter could be exchanged for others without changing any window."""
    size = np.sqrt(np.diag(information))
    if np.linalg.eigvalsh(information / np.outer(size, size))[0] < DISTINCT:
        raise ValueError('the windows cannot tell slip and noise of the reference apart, expected '
                         'windows of different lengths and courses, or a given noise')
