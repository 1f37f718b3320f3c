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

"""Stamps with rows of numbers, as recorded: checked, and of rows with one stamp the last."""

from typing import Tuple

from diffdrive_kinematics.core.kinematics import Array
import numpy as np
from numpy.typing import ArrayLike


def latest_rows(
        time_name: str, time: ArrayLike, name: str, rows: ArrayLike, width: int
) -> Tuple[Array, Array, int]:
    """
    Return stamps and rows without those that a later row replaces, and how many these are.

    Parameters
    ----------
    time_name : str
        What errors call the stamps.
    time : array_like, shape (n,)
        Stamps [s], n >= 2, not falling.
    name : str
        What errors call the rows.
    rows : array_like, shape (n, width)
        Numbers of each stamp.
    width : int
        How many numbers a row has.

    Returns
    -------
    stamps : numpy.ndarray, shape (m,)
        Different stamps [s], m >= 2.
    values : numpy.ndarray, shape (m, width)
        The last row of each.
    replaced : int
        How many rows that is, n - m.

    Raises
    ------
    ValueError
        As :func:`checked_rows`; if fewer than two different stamps are left.

    Examples
    --------
    >>> latest_rows('time', [0.0, 1.0, 1.0], 'x', [[1.0], [2.0], [3.0]], 1)[1:]
    (array([[1.],
           [3.]]), 1)

    """
    stamps, values = checked_rows(time_name, time, name, rows, width)
    last = np.append(np.diff(stamps) > 0.0, True)
    if np.count_nonzero(last) < 2:
        raise ValueError(
            f'{time_name} has {np.count_nonzero(last)} different stamps, expected at least 2')
    return stamps[last], values[last], int(np.count_nonzero(~last))


def checked_rows(
        time_name: str, time: ArrayLike, name: str, rows: ArrayLike, width: int
) -> Tuple[Array, Array]:
    """
    Return new arrays of the stamps and the rows.

    Parameters
    ----------
    time_name : str
        What errors call the stamps.
    time : array_like, shape (n,)
        Stamps [s], n >= 2, not falling.
    name : str
        What errors call the rows.
    rows : array_like, shape (n, width)
        Numbers of each stamp.
    width : int
        How many numbers a row has.

    Returns
    -------
    stamps : numpy.ndarray, shape (n,)
        The stamps [s].
    values : numpy.ndarray, shape (n, width)
        The rows.

    Raises
    ------
    ValueError
        If a shape is another one, a number is not finite, or stamps fall.

    Examples
    --------
    >>> checked_rows('time', [0, 1], 'x', [[1], [2]], 1)[0]
    array([0., 1.])

    """
    stamps, values = np.array(time, dtype=np.float64), np.array(rows, dtype=np.float64)
    if stamps.ndim != 1 or len(stamps) < 2:
        raise ValueError(f'{time_name} has shape {stamps.shape}, expected (n,) with n at least 2')
    if values.shape != (len(stamps), width):
        raise ValueError(
            f'{name} has shape {values.shape}, expected {(len(stamps), width)} as '
            f'{time_name} has {len(stamps)} stamps')
    for what, finite in ((time_name, np.isfinite(stamps)), (name, np.isfinite(values).all(1))):
        if not finite.all():
            row = int(np.argmin(finite))
            value = (stamps if what == time_name else values)[row].tolist()
            raise ValueError(f'{what} is {value} in row {row}, expected finite numbers')
    falls = np.diff(stamps) < 0.0
    if falls.any():
        row = int(np.argmax(falls)) + 1
        raise ValueError(
            f'{time_name} is {stamps[row]} in row {row} after {stamps[row - 1]}, '
            f'expected stamps that do not fall')
    return stamps, values
