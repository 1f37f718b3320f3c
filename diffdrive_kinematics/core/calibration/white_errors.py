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
Errors of three components made white: of covariance 1, by the root of their own covariances.

``M P M^T = 1`` with M the inverse of the lower root of P (Cholesky).  Symmetric matrices are kept
as their entries xx, xy, xt, yy, yt, tt, each for all errors at once, which is many times faster
than a stack of 3x3 matrices.
"""

from typing import Tuple

from diffdrive_kinematics.core.kinematics import Array
import numpy as np

TIMES = np.array([[1.0], [2.0], [2.0], [1.0], [2.0], [1.0]])
"""How often each entry is in its matrix."""
NO_PARTS = np.zeros((0, 6, 1))


def entries_of(matrices: Array) -> Array:
    """
    Return the entries of symmetric matrices.

    Parameters
    ----------
    matrices : numpy.ndarray, shape (..., n, 3, 3)
        The matrices.

    Returns
    -------
    numpy.ndarray, shape (..., 6, n)
        Their entries xx, xy, xt, yy, yt, tt.

    Examples
    --------
    >>> entries_of(np.diag([1.0, 2.0, 3.0])[None])[:, 0]
    array([1., 0., 0., 2., 0., 3.])

    """
    rows, columns = (0, 0, 0, 1, 1, 2), (0, 1, 2, 1, 2, 2)
    found: Array = np.ascontiguousarray(np.swapaxes(matrices[..., rows, columns], -1, -2))
    return found


def from_entries(rows: Array) -> Array:
    """
    Return symmetric matrices.

    Parameters
    ----------
    rows : numpy.ndarray, shape (6, n)
        Their entries xx, xy, xt, yy, yt, tt.

    Returns
    -------
    numpy.ndarray, shape (n, 3, 3)
        One matrix for each column.

    Examples
    --------
    >>> from_entries(np.arange(6.0)[:, None])
    array([[[0., 1., 2.],
            [1., 3., 4.],
            [2., 4., 5.]]])

    """
    found: Array = rows[[0, 1, 2, 1, 3, 4, 2, 4, 5]].T.reshape(-1, 3, 3)
    return found


def whitened(
        error: Array, covariance: Array, parts: Array = NO_PARTS) -> Tuple[Array, Array, Array]:
    """
    Return errors, and parts of their covariances, where the covariances are 1.

    Parameters
    ----------
    error : numpy.ndarray, shape (3, n)
        Errors e.
    covariance : numpy.ndarray, shape (6, n)
        Entries of their covariances P.
    parts : numpy.ndarray, shape (p, 6, n)
        Entries of matrices A.

    Returns
    -------
    white : numpy.ndarray, shape (3, n)
        ``M e``; the sum of its squares is ``e^T P^-1 e``.
    log_det : numpy.ndarray, shape (n,)
        ``log det P``.
    parts : numpy.ndarray, shape (p, 6, n)
        Entries of ``M A M^T``, whose trace is that of ``P^-1 A``.

    Raises
    ------
    ValueError
        If a covariance is singular.

    Examples
    --------
    >>> four = 4.0 * entries_of(np.eye(3)[None])
    >>> white, log_det, parts = whitened(np.array([[2.0], [0.0], [0.0]]), four, four[None])
    >>> white[0], log_det.round(6), parts[0, :, 0]
    (array([1.]), array([4.158883]), array([1., 0., 0., 1., 0., 1.]))

    """
    xx, xy, xt, yy, yt, tt = covariance
    with np.errstate(all='ignore'):  # what comes of it is judged
        a = 1.0 / np.sqrt(xx)
        l_yx, l_tx = xy * a, xt * a
        b = 1.0 / np.sqrt(yy - l_yx * l_yx)
        l_ty = (yt - l_tx * l_yx) * b
        c = 1.0 / np.sqrt(tt - l_tx * l_tx - l_ty * l_ty)
        log_det = -2.0 * np.log(a * b * c)
    if not np.isfinite(log_det).all():
        worst = int(np.argmin(np.isfinite(log_det)))
        raise ValueError(
            f'the covariance of window {worst} is singular, expected slip or a noise of the '
            f'reference that moves x, y and theta')
    d, f = -l_yx * a * b, -l_ty * b * c  # M is ((a, 0, 0), (d, b, 0), (e, f, c))
    e = -(l_tx * a + l_ty * d) * c
    x, y, theta = error
    white = np.stack([a * x, d * x + b * y, e * x + f * y + c * theta])
    xx, xy, xt, yy, yt, tt = parts.transpose(1, 0, 2)
    y_x, y_y = d * xx + b * xy, d * xy + b * yy  # of rows of M A
    t_x, t_y = e * xx + f * xy + c * xt, e * xy + f * yy + c * yt
    t_t = e * xt + f * yt + c * tt
    found = np.stack([a * a * xx, a * y_x, a * t_x, d * y_x + b * y_y, d * t_x + b * t_y,
                      e * t_x + f * t_y + c * t_t], axis=1)
    return white, log_det, found
