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
What the intervals of the wheels add to the errors of windows, summed up to samples.

A wheel that travels an element more at (x, y, theta) moves the end of a window by ``M_e a``, where
``a_{l,r} = (cos(theta) / 2 -+ y / L, sin(theta) / 2 +- x / L, -+1 / L)`` is that of the middle of
the interval, and M_e of the window (see :mod:`.window_residuals`).  A long drive has many times
more intervals than samples, so that they are gone through in blocks that stay in the cache.
"""

from typing import NamedTuple

from diffdrive_kinematics.core.calibration.calibration_parameters import CalibrationParameters
from diffdrive_kinematics.core.calibration.drive_odometry import Nodes
from diffdrive_kinematics.core.kinematics import Array
import numpy as np

BLOCK = 8192
"""Intervals that are gone through at a time."""


class IntervalSums(NamedTuple):
    """
    Sums over intervals, for m samples.

    In each column are first the changes of x, y and theta with left, right and separation (row 1:
    of x with right), then the entries xx, xy, xt, yy, yt, tt of ``|travel| a a^T``, the spread,
    summed over both wheels.

    Parameters
    ----------
    before : numpy.ndarray, shape (15, m)
        Sums over the intervals before that of each sample.
    within : numpy.ndarray, shape (15, m)
        Of the interval in which each sample is.

    Examples
    --------
    See :func:`interval_sums`.

    """

    before: Array
    within: Array


def interval_sums(
        nodes: Nodes, path: Array, travel: Array, separation: float,
        systematic: CalibrationParameters) -> IntervalSums:
    """
    Return what the intervals up to samples add to the errors of windows.

    Parameters
    ----------
    nodes : Nodes
        In which of the intervals the samples are, in order.
    path : numpy.ndarray, shape (n, 3)
        Poses (x [m], y [m], theta [rad]) at the stamps of the wheels.
    travel : numpy.ndarray, shape (n - 1, 2)
        Travel (left, right) of each interval [m].
    separation : float
        Distance between the wheels [m].
    systematic : CalibrationParameters
        Factors on the geometry, which travel and separation have in them.

    Returns
    -------
    IntervalSums
        Sums at each sample.

    Examples
    --------
    A metre straight ahead, with wheels 0.5 m apart: slip of 1 m turns the robot by 8 rad^2.

    >>> from diffdrive_kinematics.core.calibration import drive_from_rates
    >>> from diffdrive_kinematics.core.calibration.drive_odometry import nodes_of, path_of
    >>> from diffdrive_kinematics.core.calibration.white_errors import from_entries
    >>> drive = drive_from_rates([0.0, 1.0], np.full((2, 2), 8.0), [0.0, 1.0], np.zeros((2, 3)))
    >>> systematic, travel = CalibrationParameters(), np.array([[1.0, 1.0]])
    >>> path = path_of(travel, 0.5)
    >>> nodes = nodes_of(drive, systematic, travel, 0.5, path)
    >>> within = interval_sums(nodes, path, travel, 0.5, systematic).within[:, 0]
    >>> within[:9].reshape(3, 3) + 0.0
    array([[ 0.5,  0.5,  0. ],
           [ 1. , -1. ,  0. ],
           [-2. ,  2. ,  0. ]])
    >>> float(from_entries(within[9:, None])[0, 2, 2])
    8.0

    """
    before, within = np.empty((2, 15, len(nodes.interval)))
    carried = np.zeros((15, 1))
    for first in range(0, len(travel), BLOCK):
        rows = _rows(path[first:first + BLOCK + 1].T.copy(), travel[first:first + BLOCK].T.copy(),
                     separation, systematic)
        total = np.concatenate([carried, carried + np.cumsum(rows, axis=1)], axis=1)
        here = slice(*np.searchsorted(nodes.interval, [first, first + BLOCK]))
        at = nodes.interval[here] - first
        total.take(at, axis=1, out=before[:, here], mode='clip')
        rows.take(at, axis=1, out=within[:, here], mode='clip')
        carried = total[:, -1:]
    return IntervalSums(before, within)


def _rows(
        path: Array, travel: Array, separation: float, systematic: CalibrationParameters) -> Array:
    """Return the rows of IntervalSums of n intervals: path (3, n + 1), travel (2, n)."""
    x, y, theta = 0.5 * (path[:, 1:] + path[:, :-1])
    half_x, half_y, turn = 0.5 * np.cos(theta), 0.5 * np.sin(theta), 1.0 / separation
    rows = np.zeros((15, len(x)))
    for wheel, (sign, factor) in enumerate(((-1.0, systematic.left), (1.0, systematic.right))):
        a_x, a_y, a_t = half_x + sign * turn * y, half_y - sign * turn * x, sign * turn
        by_radius, size = travel[wheel] / factor, np.abs(travel[wheel])
        rows[wheel], rows[wheel + 3], rows[wheel + 6] = (
            a_x * by_radius, a_y * by_radius, a_t * by_radius)
        for row, entry in enumerate((
                a_x * a_x, a_x * a_y, a_x * a_t, a_y * a_y, a_y * a_t, a_t * a_t), start=9):
            rows[row] += size * entry
    by_separation = (travel[0] - travel[1]) / (separation * systematic.separation)
    rows[2], rows[5], rows[8] = y * by_separation, -x * by_separation, by_separation
    return rows
