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
J. Am. Stat. Assoc. 72(358), eqs. 2.3 to 2.6).
"""

from typing import Any, List, NamedTuple, Optional, Tuple

from diffdrive_kinematics.core.kinematics import Array
import numpy as np
from numpy.typing import NDArray

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
    sign, log_det = np.linalg.slogdet(covariance)
    if not ((sign > 0.0) & np.isfinite(log_det)).all():
        worst = int(np.argmin(np.where(np.isfinite(log_det), sign, -1.0)))
        raise ValueError(
            f'the covariance of window {worst} is singular, expected slip or a noise of the '
            f'reference that moves x, y and theta')
    solved = np.linalg.solve(covariance, error[..., None])[..., 0]
    return log_det, np.einsum('ni,ni->n', error, solved)


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
    data = _Data(error, parts, given, np.ones(len(error)) if weights is None else weights)
    scale = _scales(error, parts)
    bound = np.zeros(len(scale)) if least is None else least
    found = [_scored(data, start, np.maximum(1e-2 * VANISHED * scale, bound))
             for start in np.maximum(_shares(len(scale)) * scale, bound)]
    values = min(found, key=lambda each: each[1])[0]
    return _summary(
        data, np.maximum(np.where(values < VANISHED * scale, 0.0, values), bound), bound)


class _Data(NamedTuple):
    """What is given."""

    error: Array
    parts: Array
    given: Array
    weights: Array

    def covariance(self, values: Array) -> Array:
        found: Array = self.given + np.tensordot(values, self.parts, 1)
        return found

    def cost(self, values: Array) -> float:
        """Return the negative log likelihood, without its constant."""
        return 0.5 * float(self.weights @ sum(likelihood(self.error, self.covariance(values))))


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

    With ``B_a = P^-1 A_a`` and ``w = P^-1 e``: ``g_a = (tr B_a - w^T A_a w) / 2`` and
    ``I_ab = tr(B_a B_b) / 2`` (Harville 1977).
    """
    inverse, weighted, pulls = _pulls(data, values)
    ratios = inverse @ data.parts
    gradient: Array = 0.5 * ((np.trace(ratios, axis1=2, axis2=3)
                              - (weighted * pulls).sum(axis=2)) @ data.weights)
    turned = (data.weights[:, None, None] * ratios).reshape(len(ratios), -1)
    expected: Array = 0.5 * turned @ ratios.transpose(0, 1, 3, 2).reshape(len(ratios), -1).T
    return gradient, expected


def _pulls(data: _Data, values: Array) -> Tuple[NDArray[np.floating[Any]], Array, Array]:
    """Return P^-1, w = P^-1 e, and A_a w of each part."""
    inverse = np.linalg.inv(data.covariance(values))
    weighted = np.einsum('nij,nj->ni', inverse, data.error)
    return inverse, weighted, (data.parts @ weighted[..., None])[..., 0]


def _summary(data: _Data, values: Array, least: Array) -> Components:
    _, expected = _derivatives(data, values)
    _refuse_confounded(expected)
    inverse, _, pulls = _pulls(data, values)  # observed: w^T A_a P^-1 A_b w less the expected
    swung = (inverse @ pulls[..., None])[..., 0] * data.weights[:, None]
    observed = pulls.reshape(len(pulls), -1) @ swung.reshape(len(swung), -1).T - expected
    inside = bool((values > least).all()) and bool((np.linalg.eigvalsh(observed) > 0.0).all())
    errors = np.sqrt(np.diag(np.linalg.inv(observed if inside else expected)))
    quadratic = likelihood(data.error, data.covariance(values))[1]
    return Components(
        values.tolist(), errors.tolist(), -data.cost(values), float(quadratic.mean()) / 3.0)


def _refuse_confounded(information: Array) -> None:
    """Raise where one parameter could be exchanged for others without changing any window."""
    size = np.sqrt(np.diag(information))
    if np.linalg.eigvalsh(information / np.outer(size, size))[0] < DISTINCT:
        raise ValueError('the windows cannot tell slip and noise of the reference apart, expected '
                         'windows of different lengths and courses, or a given noise')
