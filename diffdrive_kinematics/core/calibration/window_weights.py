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
Windows weighed by how large their errors are, beside slip and the noise of the reference.

The covariance of a window's error is ``P = q_1 A_1 + q_2 N_p + q_3 N_h`` (see
:mod:`.slip_window`).  The three variances q are those of greatest likelihood, found by the
iteration of Zhou, Hu, Zhou & Lange (2019, J. Comput. Graph. Stat. 28(2), "MM algorithms for
variance components models"), ``q_a <- q_a sqrt(sum e^T P^-1 A_a P^-1 e / sum tr(P^-1 A_a))``,
which keeps them positive; what the fit of the parameters has taken out of the errors is allowed
for.
"""

from typing import NamedTuple, Sequence

from diffdrive_kinematics.core.calibration.window_residuals import WindowResiduals
from diffdrive_kinematics.core.kinematics import Array
import numpy as np

REJECTED, CREDIBLE = 12.0, 4.0
"""Distances from which a window counts nothing at all, and up to which it tells variances."""
MEDIAN = 1.5382
"""Median of the distance of a Gaussian error of three components: sqrt of 2.366."""
SHARE = 0.1
"""Share of the errors of short windows that is noise of the reference at least."""


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
    >>> Variances(slip=1e-6, position=1e-6, heading=1e-5).slip**0.5
    0.001

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
    See :func:`updated_variances`.

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
        How many steps to take (Zhou et al. 2019).

    Returns
    -------
    Variances
        The variances after the steps.

    Examples
    --------
    The noise of a reference, found from windows of 1 s of a straight drive:

    >>> from dataclasses import replace
    >>> from diffdrive_kinematics.core.calibration import (
    ...     CalibrationParameters, drive_from_rates, linearised, odometry_at, windows_between)
    >>> from diffdrive_kinematics.core.kinematics import WheelGeometry
    >>> geometry, stamps = WheelGeometry(0.5, 0.125), np.arange(500.0)
    >>> bare = drive_from_rates(stamps, np.full((500, 2), 8.0), stamps, np.zeros((500, 3)))
    >>> noise = np.random.default_rng(1).normal(0.0, 0.01, (500, 3))
    >>> drive = replace(
    ...     bare, reference=odometry_at(geometry, bare, CalibrationParameters()) + noise)
    >>> windows = windows_between(drive, (1.0,), every=1.0, tolerance=0.1)
    >>> part = linearised(geometry, drive, windows, CalibrationParameters())
    >>> covariance = window_covariance(part, START_VARIANCES)
    >>> nothing = np.zeros_like(covariance)  # no parameter has been fitted
    >>> found = updated_variances(
    ...     [part], distance(part.error, 1e3 * covariance), nothing, START_VARIANCES, steps=20)
    >>> f'{found.position**0.5:.2f} m, {found.heading**0.5:.2f} rad'
    '0.01 m, 0.01 rad'

    """
    weights = np.clip(0.5 * (CREDIBLE + 2.0 - distances), 0.0, 1.0)
    error = np.concatenate([part.error for part in parts])
    noise = np.concatenate([part.noise() for part in parts], axis=1)
    stack = np.concatenate([np.concatenate([part.slip for part in parts])[None], noise])
    values = np.array(variances)
    least = np.array([FLOOR.slip, *least_noise(error, stack[0])])
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


def least_noise(error: Array, slip: Array) -> Array:
    """
    Return the least noise of a reference: a tenth of the errors of short windows.

    Without it P may come out nearly singular, where a reference is perfect or windows are few;
    then errors that are a little different are called impossible.

    Parameters
    ----------
    error : numpy.ndarray, shape (w, 3)
        Errors of windows (x [m], y [m], theta [rad]).
    slip : numpy.ndarray, shape (w, 3, 3)
        Covariances of slip; medians are of the half of the windows in which it turns least.

    Returns
    -------
    numpy.ndarray, shape (2,)
        Variances of x and y [m^2], and of the heading [rad^2].

    Examples
    --------
    >>> error = np.random.default_rng(1).normal(0.0, 0.01, (1000, 3))
    >>> least_noise(error, np.ones((1000, 3, 3))).round(6)
    array([5.e-06, 5.e-06])

    """
    short = slip[:, 2, 2] <= np.median(slip[:, 2, 2])
    x, y, heading = np.median(error[short]**2, axis=0) / 0.455  # of chi square, 1 degree
    return np.maximum(
        [FLOOR.position, FLOOR.heading], [0.25 * SHARE * (x + y), 0.5 * SHARE * heading])
