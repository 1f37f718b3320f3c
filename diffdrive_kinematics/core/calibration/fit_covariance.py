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
The covariance of fitted parameters, from windows that overlap.

The errors of overlapping windows are not independent; the inverse of the information would be
too small a covariance of what is fitted.  What is independent is the slip of each interval and
the noise of each sample of the reference.  The score ``sum J^T P^-1 e`` is a sum over these too,
so its covariance S is known, and that of the parameters is the sandwich ``H^-1 S H^-1``,
``H = sum J^T P^-1 J`` (Huber 1967; White 1980, Econometrica 48(4)), the model of the package in
its middle.
"""

from diffdrive_kinematics.core.calibration.fit_state import FitState
from diffdrive_kinematics.core.calibration.gauss_newton import inverse_of
from diffdrive_kinematics.core.calibration.white_errors import from_entries
from diffdrive_kinematics.core.kinematics import Array
import numpy as np


def parameter_covariance(state: FitState) -> Array:
    """
    Return the covariance ``H^-1 S H^-1`` of the parameters (Huber 1967; White 1980).

    Parameters
    ----------
    state : FitState
        Where the fit stands.

    Returns
    -------
    numpy.ndarray, shape (p, p)
        Covariance, in the squared units of the parameters.

    Examples
    --------
    >>> from diffdrive_kinematics.core.calibration import (
    ...     Clock, drive_from_rates, Variances, Windows)
    >>> from diffdrive_kinematics.core.calibration.fit_setup import problem_of
    >>> from diffdrive_kinematics.core.kinematics import WheelGeometry
    >>> stamps = np.arange(20.0)
    >>> drive = drive_from_rates(stamps, np.full((20, 2), 8.0), stamps, np.zeros((20, 3)))
    >>> problem = problem_of(
    ...     WheelGeometry(0.5, 0.125), [drive], wheels=False, clock=Clock.DELAY, frame=None,
    ...     windows=Windows())
    >>> windows = len(problem.windows[0].start)
    >>> state = FitState.at(
    ...     problem, problem.initial(), np.ones(windows), Variances(1e-6, 1e-6, 1e-6))
    >>> covariance = parameter_covariance(state)
    >>> covariance.shape, taken_by_fit(state, covariance).shape == (windows, 3, 3)
    ((4, 4), True)

    """
    score = np.zeros((len(state.values), len(state.values)))
    for number, (columns, _, gain) in enumerate(state.gains()):
        score[np.ix_(columns, columns)] += _score_covariance(state, number, gain)
    inverse = inverse_of(state.normal_equations()[0])
    found: Array = inverse @ score @ inverse
    return found


def taken_by_fit(state: FitState, covariance: Array) -> Array:
    """
    Return what the fit takes out of the errors of each window, ``J C J^T``.

    Parameters
    ----------
    state : FitState
        Where the fit stands.
    covariance : numpy.ndarray, shape (p, p)
        Covariance C of the parameters.

    Returns
    -------
    numpy.ndarray, shape (w, 3, 3)
        Covariances of (x [m], y [m], theta [rad]).

    Examples
    --------
    See :func:`parameter_covariance`.

    """
    found = []
    for number, part in enumerate(state.parts):
        columns, fields = state.problem.columns_of(number)
        jacobian = part.jacobian[:, :, fields]
        found.append(jacobian @ covariance[np.ix_(columns, columns)] @ jacobian.transpose(0, 2, 1))
    return np.concatenate(found)


def _score_covariance(state: FitState, number: int, gain: Array) -> Array:
    """Return the part of S of one drive, whose windows have the factors ``J^T P^-1``."""
    part, windows, variances = state.parts[number], state.problem.windows[number], state.variances
    samples = len(state.problem.drives[number].reference)
    size = gain.shape[1]
    pulled = gain @ part.along
    bounds, known, at = np.unique(
        np.concatenate([part.first, part.last + 1]), return_index=True, return_inverse=True)
    change = np.zeros((len(bounds), size, 3))  # constant from one bound to the next
    np.add.at(change, at[:len(pulled)], pulled)
    np.subtract.at(change, at[len(pulled):], pulled)
    carried = np.cumsum(change, axis=0)[:-1]
    spread = from_entries(np.diff(np.concatenate([*part.passed], axis=1)[:, known], axis=1))
    by_sample = np.zeros((samples, size, 3))
    np.add.at(by_sample, windows.start, gain @ part.at_start)
    np.add.at(by_sample, windows.end, gain @ part.at_end)
    noise = np.array([variances.position, variances.position, variances.heading])
    by_slip = np.einsum('bpi,bij,bqj->pq', carried, spread, carried, optimize=True)
    score: Array = (variances.slip * by_slip
                    + np.tensordot(by_sample * noise, by_sample, ((0, 2), (0, 2))))
    return score
