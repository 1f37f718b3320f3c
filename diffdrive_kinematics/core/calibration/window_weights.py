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
Weights of windows by how large their errors are, beside slip and the noise of the reference.

The covariance of a window's error is ``P = q_1 A_1 + q_2 N_p + q_3 N_h`` (see
:mod:`.slip_window`) of three variances q.
"""

from typing import NamedTuple

from diffdrive_kinematics.core.calibration.window_residuals import WindowResiduals
from diffdrive_kinematics.core.kinematics import Array
import numpy as np

REJECTED = 12.0
"""Distance from which a window counts nothing at all."""
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
    >>> Variances(slip=1e-6, position=1e-6, heading=1e-5).slip**0.5
    0.001

    """

    slip: float
    position: float
    heading: float


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
    >>> from diffdrive_kinematics.core.calibration import (
    ...     CalibrationParameters, drive_from_rates, linearised, windows_between)
    >>> from diffdrive_kinematics.core.kinematics import WheelGeometry
    >>> stamps = np.arange(3.0)
    >>> drive = drive_from_rates(stamps, np.full((3, 2), 8.0), stamps, np.zeros((3, 3)))
    >>> windows = windows_between(drive, (1.0,), every=1.0, tolerance=0.1)
    >>> part = linearised(WheelGeometry(0.5, 0.125), drive, windows, CalibrationParameters())
    >>> window_covariance(part, Variances(slip=0.0, position=1e-6, heading=0.0))[:, 0, 0]
    array([2.e-06, 2.e-06])

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
