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
Weights of windows whose errors share slip and reference noise, and the covariance of a fit.

The covariance of a window's error is ``P = q_1 A_1 + q_2 N_p + q_3 N_h`` (see :mod:`.slip_fit`).
The variances q are those of greatest likelihood, found by the iteration of Zhou, Hu, Zhou &
Lange (2019, J. Comput. Graph. Stat. 28(2), "MM algorithms for variance components models"),
``q_a <- q_a sqrt(sum e^T P^-1 A_a P^-1 e / sum tr(P^-1 A_a))``, which keeps them positive; what
the fit of the parameters has taken out of the errors is allowed for.

Windows overlap, so their errors are not independent; the inverse of the information would be too
small a covariance.  What is independent is the slip of each interval and the noise of each
sample of the reference.  The score ``sum J^T P^-1 e`` is a sum over these too, so its covariance
S is known, and that of the parameters is the sandwich ``H^-1 S H^-1``, ``H = sum J^T P^-1 J``
(Huber 1967; White 1980, Econometrica 48(4)), the model of the package in its middle.
"""

from typing import NamedTuple, Sequence

from diffdrive_kinematics.core.calibration.trajectory_windows import WindowResiduals, WindowSet
import numpy as np
from numpy.typing import NDArray

__all__ = [
    'START_VARIANCES', 'Variances', 'distance', 'score_covariance', 'updated_variances',
    'window_covariance', 'window_weights']

Array = NDArray[np.float64]

CREDIBLE, REJECTED = 4.0, 12.0
"""Distances up to which a window tells variances, and from which it counts nothing at all."""
SHARE = 0.1
"""Share of the errors of short windows that is noise of the reference at least."""
MEDIAN = 1.5382
"""Median of the distance of a Gaussian error of three components: sqrt of 2.366."""


class Variances(NamedTuple):
    """
    Variances that the errors of windows are made of.

    Parameters
    ----------
    slip : float
        Slip constant of both wheels [m].
    position : float
        Variance of the reference's x and y [m^2].
    heading : float
        Variance of its heading [rad^2].

    Examples
    --------
    The noise of a reference, found from windows of 1 s of a straight drive:

    >>> from dataclasses import replace
    >>> from diffdrive_kinematics.core.calibration import trajectory_windows as tw
    >>> from diffdrive_kinematics.core.kinematics import WheelGeometry
    >>> from diffdrive_kinematics.core.calibration import drive_from_rates
    >>> geometry, stamps = WheelGeometry(0.5, 0.125), np.arange(500.0)
    >>> bare = drive_from_rates(stamps, np.full((500, 2), 8.0), stamps, np.zeros((500, 3)))
    >>> noise = np.random.default_rng(1).normal(0.0, 0.01, (500, 3))
    >>> drive = replace(
    ...     bare, reference=tw.odometry_at(geometry, bare, tw.CalibrationParameters()) + noise)
    >>> windows = tw.windows_between(drive, (1.0,), every=1.0, tolerance=0.1)
    >>> part = tw.linearised(geometry, drive, windows, tw.CalibrationParameters())
    >>> covariance = window_covariance(part, START_VARIANCES)
    >>> nothing = np.zeros_like(covariance)  # no parameter has been fitted
    >>> found = updated_variances(
    ...     [part], distance(part.error, 1e3 * covariance), nothing, START_VARIANCES, steps=20)
    >>> f'{found.position**0.5:.2f} m, {found.heading**0.5:.2f} rad'
    '0.01 m, 0.01 rad'

    What the separation, third of the fields of CalibrationParameters, makes of the score:

    >>> gain = np.linalg.solve(covariance, part.jacobian[:, :, 2:3]).transpose(0, 2, 1)
    >>> score_covariance(part, windows, gain, found, samples=500).shape
    (1, 1)

    """

    slip: float
    position: float
    heading: float


START_VARIANCES = Variances(1e-6, 1e-6, 1e-5)
FLOOR = Variances(1e-14, 1e-12, 1e-12)
"""Least variances, so that exact data do not make P singular."""


def window_covariance(part: WindowResiduals, variances: Variances) -> Array:
    """
    Return the covariance P of the error of each window.

    Parameters
    ----------
    part : WindowResiduals
        The w windows of one drive.
    variances : Variances
        Slip constant and noise of the reference.

    Returns
    -------
    numpy.ndarray, shape (w, 3, 3)
        Covariances of (x [m], y [m], theta [rad]).

    Examples
    --------
    See :class:`Variances`.

    """
    position, heading = part.noise()
    covariance: Array = (variances.slip * part.slip + variances.position * position
                         + variances.heading * heading)
    return covariance


def distance(error: Array, covariance: Array) -> Array:
    """
    Return ``sqrt(e^T P^-1 e)`` of each window (Mahalanobis 1936).

    Parameters
    ----------
    error : numpy.ndarray, shape (w, 3)
        Errors e of the windows (x [m], y [m], theta [rad]).
    covariance : numpy.ndarray, shape (w, 3, 3)
        Their covariances P.

    Returns
    -------
    numpy.ndarray, shape (w,)
        Distances [1].

    Examples
    --------
    >>> distance(np.array([[0.02, 0.0, 0.0]]), np.diag([1e-4, 1e-4, 1e-4])[None]).round(6)
    array([2.])

    """
    solved = np.linalg.solve(covariance, error[..., None])[..., 0]
    found: Array = np.sqrt(np.einsum('wi,wi->w', error, solved))
    return found


def window_weights(distances: Array, trust: float) -> Array:
    """
    Return weights of windows: 1 up to ``trust``, then as of Huber (1964), 0 for outliers.

    Parameters
    ----------
    distances : numpy.ndarray, shape (w,)
        Distances of the windows, of :func:`distance` [1].
    trust : float
        Distance up to which a window counts in full [1].

    Returns
    -------
    numpy.ndarray, shape (w,)
        Weights from 0 to 1.

    Examples
    --------
    >>> window_weights(np.array([1.0, 8.0, 100.0]), trust=4.0)
    array([1. , 0.5, 0. ])

    """
    huber = trust / np.maximum(distances, trust)
    weights: Array = huber * np.clip(0.5 * (REJECTED - distances), 0.0, 1.0)
    return weights


def updated_variances(
        parts: Sequence[WindowResiduals], distances: Array, taken: Array, variances: Variances,
        steps: int) -> Variances:
    """
    Return the variances after some steps towards those of greatest likelihood.

    The credible windows alone count.  Without ``taken`` the variances would come out too small
    (as without the n - 1 of a sample).  The noise keeps a share of the errors: P that is nearly
    singular, all slip, would trust a few directions without bound.

    Parameters
    ----------
    parts : sequence of WindowResiduals
        Windows of each drive, w in all.
    distances : numpy.ndarray, shape (w,)
        Distances of the windows [1]; they tell which ones are credible.
    taken : numpy.ndarray, shape (w, 3, 3)
        Covariance ``J C J^T`` that the fit of the parameters takes out of the errors.
    variances : Variances
        Where to start.
    steps : int
        How many steps to take (Zhou et al. 2019; see the head of this module).

    Returns
    -------
    Variances
        The variances after the steps.

    Examples
    --------
    See :class:`Variances`.

    """
    weights = np.clip(0.5 * (CREDIBLE + 2.0 - distances), 0.0, 1.0)
    error = np.concatenate([part.error for part in parts])
    noise = np.concatenate([part.noise() for part in parts], axis=1)
    stack = np.concatenate([np.concatenate([part.slip for part in parts])[None], noise])
    values, least = np.array(variances), _least_noise(error, stack[0])
    for _ in range(steps):
        inverse = np.linalg.inv(np.tensordot(values, stack, 1))
        pulled = np.einsum('wij,wj->wi', inverse, error)
        square = np.einsum('w,awij,wi,wj->a', weights, stack, pulled, pulled, optimize=True)
        expected = inverse - inverse @ taken @ inverse
        trace = np.einsum('w,awij,wji->a', weights, stack, inverse, optimize=True)
        left = np.einsum('w,awij,wji->a', weights, stack, expected, optimize=True)
        trace = np.maximum(left, 0.25 * trace)
        values = np.maximum(values * np.sqrt(square / np.maximum(trace, 1e-300)), least)
    return Variances(*values.tolist())


def _least_noise(error: Array, slip: Array) -> Array:
    """Return least variances, from medians over the windows in which slip turns least."""
    short = slip[:, 2, 2] <= np.median(slip[:, 2, 2])
    x, y, heading = np.median(error[short]**2, axis=0) / 0.455  # of chi square, 1 degree
    return np.maximum(FLOOR, [0.0, 0.25 * SHARE * (x + y), 0.5 * SHARE * heading])


def score_covariance(
        part: WindowResiduals, windows: WindowSet, gain: Array, variances: Variances,
        samples: int) -> Array:
    """
    Return the covariance S of the score ``sum J^T P^-1 e`` of one drive.

    Parameters
    ----------
    part : WindowResiduals
        The w windows of the drive.
    windows : WindowSet
        Rows at which they start and end.
    gain : numpy.ndarray, shape (w, p, 3)
        Factor ``J^T P^-1`` of each window, for p parameters.
    variances : Variances
        Slip constant and noise of the reference.
    samples : int
        Number of samples of the reference.

    Returns
    -------
    numpy.ndarray, shape (p, p)
        S, in the inverse squared units of the parameters.

    Examples
    --------
    See :class:`Variances`.

    """
    size = gain.shape[1]
    pulled = gain @ part.along
    change = np.zeros((len(part.travel) + 1, size, 3))
    np.add.at(change, part.first, pulled)
    np.subtract.at(change, part.last + 1, pulled)
    carried = np.cumsum(change, axis=0)[:-1]
    by_slip = np.einsum('npi,nki->nkp', carried, part.elements)
    heavy = np.abs(part.travel)[..., None] * by_slip
    by_sample = np.zeros((samples, size, 3))
    np.add.at(by_sample, windows.start, gain @ part.at_start)
    np.add.at(by_sample, windows.end, gain @ part.at_end)
    noise = np.array([variances.position, variances.position, variances.heading])
    score: Array = (variances.slip * np.tensordot(heavy, by_slip, ((0, 1), (0, 1)))
                    + np.tensordot(by_sample * noise, by_sample, ((0, 2), (0, 2))))
    return score
