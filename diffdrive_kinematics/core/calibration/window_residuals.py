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
Errors of windows between reference poses, and what moves these to the first order.

The error of a window is the relative pose of the robot's centre as the reference has it minus
that of wheel odometry, in the frame of the window's start (as in :mod:`.slip_fit`).

A wheel that travels an element more at (x, y, theta) on the way moves the end (x_e, y_e) by
``M_e a``, with ``M_e = [[1, 0, -y_e], [0, 1, x_e], [0, 0, 1]]`` and
``a_{l,r} = (cos(theta) / 2 -+ y / L, sin(theta) / 2 +- x / L, -+1 / L)``, of the middle of an
interval of the wheels.  As ``a`` does not depend on the window, the derivatives with respect to
radii and separation, and the slip covariances A_l and A_r, of all windows are differences of a few
cumulative sums.  A long drive has many times more intervals than samples, so that they are gone
through in blocks that stay in the cache.
"""

from dataclasses import dataclass
from typing import Tuple

from diffdrive_kinematics.core.calibration.calibration_parameters import CalibrationParameters
from diffdrive_kinematics.core.calibration.drive_odometry import (
    calibrated_travel, Nodes, nodes_of, path_of)
from diffdrive_kinematics.core.calibration.recorded_drive import (
    Indices, RecordedDrive, since_middle)
from diffdrive_kinematics.core.calibration.trajectory_windows import WindowSet
from diffdrive_kinematics.core.calibration.white_errors import from_entries
from diffdrive_kinematics.core.kinematics import Array, WheelGeometry, wrap_angle
from diffdrive_kinematics.core.noise import pose_jacobians, rotations
import numpy as np

BLOCK = 8192
"""Intervals that are gone through at a time."""


@dataclass(frozen=True)
class WindowResiduals:
    """
    Errors of the w windows of a drive, and what moves them.

    Parameters
    ----------
    error : numpy.ndarray, shape (w, 3)
        Errors (x [m], y [m], theta [rad]).
    jacobian : numpy.ndarray, shape (w, 3, 8)
        Derivatives with respect to the fields of :class:`CalibrationParameters`.
    slip : numpy.ndarray, shape (w, 3, 3)
        A_l + A_r: covariance for a slip constant of 1 m.
    at_start, at_end : numpy.ndarray, shape (w, 3, 3)
        Derivatives with respect to errors (x, y, yaw) of the reference's samples.
    along : numpy.ndarray, shape (w, 3, 3)
        What maps the sum of the a of a window's travel to its error.
    passed : numpy.ndarray, shape (2, 6, w)
        Spread (see :func:`_interval_sums`) of the intervals before the first one of each window,
        and of those up to its last one.
    first, last : numpy.ndarray of int, shape (w,)
        Intervals in which the windows start and end.

    Examples
    --------
    See :func:`linearised`.

    """

    error: Array
    jacobian: Array
    slip: Array
    at_start: Array
    at_end: Array
    along: Array
    passed: Array
    first: Indices
    last: Indices

    def noise(self) -> Array:
        """
        Return N_p and N_h, the covariances for a noise of the reference of 1 m^2 and 1 rad^2.

        Returns
        -------
        numpy.ndarray, shape (2, w, 3, 3)
            N_p and N_h of each window, for errors (x [m], y [m], theta [rad]).

        Examples
        --------
        See :func:`linearised`.

        """
        ends = np.stack([self.at_start, self.at_end])
        return np.stack([np.einsum('ewij,ewkj->wik', part, part)
                         for part in (ends[..., :2], ends[..., 2:])])


def linearised(
        geometry: WheelGeometry, drive: RecordedDrive, windows: WindowSet,
        systematic: CalibrationParameters) -> WindowResiduals:
    """
    Return the errors of windows and their derivatives, for the systematic errors given.

    Parameters
    ----------
    geometry : WheelGeometry
        Size and spacing of the wheels.
    drive : RecordedDrive
        Wheels and reference of one drive.
    windows : WindowSet
        Its windows.
    systematic : CalibrationParameters
        Where to linearise.

    Returns
    -------
    WindowResiduals
        Errors and derivatives of each window.

    Examples
    --------
    A reference that stands still, while the wheels say 1 m for each window of 1 s:

    >>> from diffdrive_kinematics.core.calibration import drive_from_rates, windows_between
    >>> stamps = np.arange(3.0)
    >>> drive = drive_from_rates(stamps, np.full((3, 2), 8.0), stamps, np.zeros((3, 3)))
    >>> windows = windows_between(drive, (1.0,), every=1.0, tolerance=0.1)
    >>> part = linearised(WheelGeometry(0.5, 0.125), drive, windows, CalibrationParameters())
    >>> part.error[:, 0].round(6), part.noise().shape
    (array([-1., -1.]), (2, 2, 3, 3))

    """
    travel, separation = calibrated_travel(geometry, drive, systematic)
    path = path_of(travel, separation)
    nodes = nodes_of(drive, systematic, travel, separation, path)
    start, end = windows.start, windows.end
    before, within = _interval_sums(nodes, path, travel, separation, systematic)
    until = before + nodes.fraction * within
    sums = until[:, end] - until[:, start]
    along = rotations(-nodes.pose[start, 2]) @ pose_jacobians(*nodes.pose[end, :2].T)
    by_wheels = along @ sums[:9].reshape(3, 3, -1).transpose(2, 0, 1)
    slip = along @ from_entries(sums[9:]) @ along.transpose(0, 2, 1)
    wheels, back = _relative(nodes.pose, start, end)
    by_time = _moved(nodes.twist, back, wheels, start, end)
    late = since_middle(drive)[:, None]
    by_drift = _moved(nodes.twist * late, back, wheels, start, end)
    seen, by_frame, at_start, at_end = _reference(drive.reference, systematic, start, end)
    error = seen - wheels
    error[:, 2] = wrap_angle(error[:, 2])
    jacobian = np.concatenate(
        [-by_wheels, by_frame, by_time[..., None], by_drift[..., None]], axis=2)
    passed = np.stack([before[9:, start], before[9:, end] + within[9:, end]])
    return WindowResiduals(error, jacobian, slip, at_start, at_end, along, passed,
                           nodes.interval[start], nodes.interval[end])


def _relative(poses: Array, start: Indices, end: Indices) -> Tuple[Array, Array]:
    """Return the poses at the ends in the frames of the starts, and the rotations into these."""
    back = rotations(-poses[start, 2])
    found: Array = np.einsum('wij,wj->wi', back, poses[end] - poses[start])
    return found, back


def _moved(change: Array, back: Array, relative: Array, start: Indices, end: Indices) -> Array:
    """Return how relative poses change as both poses change, shape (w, 3)."""
    moved: Array = np.einsum('wij,wj->wi', back, change[end] - change[start])
    moved[:, 0] += relative[:, 1] * change[start, 2]
    moved[:, 1] -= relative[:, 0] * change[start, 2]
    return moved


def _reference(
        reference: Array, systematic: CalibrationParameters, start: Indices, end: Indices
) -> Tuple[Array, Array, Array, Array]:
    """Return relative poses of the centre, and derivatives by frame, start and end."""
    body = reference - [0.0, 0.0, systematic.yaw]
    apart, back = _relative(body, start, end)
    turned = rotations(apart[:, 2])
    offset = np.array([systematic.x, systematic.y])
    frame = np.zeros_like(back)
    frame[:, :2, :2] = np.eye(2) - turned[:, :2, :2]
    frame[:, 0, 2], frame[:, 1, 2] = -apart[:, 1], apart[:, 0]
    lever = np.einsum('wij,j->wi', turned[:, :2, :2], np.array([-offset[1], offset[0]]))
    at_end = back.copy()
    at_end[:, :2, 2] = -lever
    at_start = -back
    at_start[:, 0, 2] = apart[:, 1] + lever[:, 0]
    at_start[:, 1, 2] = -apart[:, 0] + lever[:, 1]
    centre = apart.copy()
    centre[:, :2] += np.einsum('wij,j->wi', frame[:, :2, :2], offset)
    return centre, frame, at_start, at_end


def _interval_sums(
        nodes: Nodes, path: Array, travel: Array, separation: float,
        systematic: CalibrationParameters) -> Tuple[Array, Array]:
    """
    Return the sums over the intervals before that of each sample, and over that, shape (15, m).

    In each column are first the changes of x, y and theta with left, right and separation (row 1:
    of x with right), then the entries xx, xy, xt, yy, yt, tt of ``|travel| a a^T``, the spread,
    summed over both wheels.
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
    return before, within


def _rows(
        path: Array, travel: Array, separation: float, systematic: CalibrationParameters) -> Array:
    """Return the rows of n intervals: path (3, n + 1), travel (2, n)."""
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
