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

"""Robust least squares of a few parameters, for errors that have no derivatives at hand."""

from typing import Callable

from diffdrive_kinematics.core.kinematics import Array
import numpy as np

STEP, SMALL, ROUNDS = 1e-6, 1e-5, 40
FAR, MEDIAN = 6.0, (0.6745, 1.1774)  # medians of |e| / sigma in one and in two dimensions


def robust_fit(errors: Callable[[Array], Array], start: Array, penalty: Array) -> Array:
    """
    Return the parameters with the smallest errors, in which far ones count less.

    Errors up to their scale, the median, count in full; beyond it their pull stays the same, and
    those of more than 6 scales count nothing (Huber 1964, as in the trajectory fit).

    Parameters
    ----------
    errors : callable
        Gives errors, shape (w, 1) or (w, 2), for the p parameters, all of the order of 1.
    start : numpy.ndarray, shape (p,)
        Where to start, and what the penalty draws to.
    penalty : numpy.ndarray, shape (m, p)
        Rows r whose ``(r (parameters - start))^2`` count as much as a mean squared error.

    Returns
    -------
    numpy.ndarray, shape (p,)
        The parameters; where the search does not end, those of its last round.

    Examples
    --------
    A slope, with one wild row:

    >>> x, y = np.arange(5.0), np.array([0.0, 2.0, 4.0, 6.0, 80.0])
    >>> robust_fit(lambda p: (y - p[0] * x)[:, None], np.ones(1), np.zeros((0, 1))).round(2)
    array([2.])

    """
    values = start.copy()
    for _ in range(ROUNDS):
        error = errors(values)
        jacobian = np.stack([(errors(values + step) - error) / STEP
                             for step in STEP * np.eye(len(values))], axis=2)
        size = np.sqrt(np.sum(error**2, axis=1))
        scale = max(float(np.median(size)) / MEDIAN[error.shape[1] - 1], 1e-9)
        weight = np.where(size > FAR * scale, 0.0, scale / np.maximum(size, scale)) / scale**2
        rows = np.sqrt(weight.sum() * scale**2) * penalty
        normal = np.einsum('w,wij,wik->jk', weight, jacobian, jacobian) + rows.T @ rows
        slope = np.einsum('w,wij,wi->j', weight, jacobian, error)
        slope += rows.T @ (rows @ (values - start))
        change = np.linalg.lstsq(normal, -slope, rcond=1e-12)[0]
        values = values + change
        if float(np.abs(change).max()) < SMALL:
            break
    return values
