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
Windows between reference poses: their errors, and what moves these to the first order.

The error of a window is the relative pose of the robot's centre as the reference has it minus
that of wheel odometry, in the frame of the window's start (as in :mod:`.slip_fit`).  A window
begins and ends at samples of the reference, and the odometry is read there: a sample's noise
is then in one place, and no pose is made up in a gap.

A wheel that travels an element more at (x, y, theta) on the way moves the end (x_e, y_e) by
``M_e a``, ``a_{l,r} = (cos(theta) / 2 -+ y / L, sin(theta) / 2 +- x / L, -+1 / L)``,
``M_e = [[1, 0, -y_e], [0, 1, x_e], [0, 0, 1]]``.  As ``a`` does not depend on the window, the
derivatives with respect to radii and separation, and the slip covariances A_l and A_r, of all
windows are differences of a few cumulative sums.
"""

from dataclasses import dataclass
from typing import NamedTuple, Sequence, Tuple

from diffdrive_kinematics.core.calibration.recording import RecordedDrive
from diffdrive_kinematics.core.kinematics import WheelGeometry, wrap_angle
from diffdrive_kinematics.core.noise import pose_jacobians, rotations
import numpy as np
from numpy.typing import NDArray

__all__ = [
    'CalibrationParameters', 'WindowResiduals', 'WindowSet', 'linearised', 'odometry_at',
    'windows_between']

Array = NDArray[np.float64]
Indices = NDArray[np.intp]


class CalibrationParameters(NamedTuple):
    """
    What is systematic about one drive.

    Parameters
    ----------
    left, right, separation : float
        Factors on both radii and the separation [1].
    x, y : float
        Position of the reference's frame on the robot [m].
    yaw : float
        Its heading on the robot [rad].
    offset : float
        Part of ``reference stamp = wheel stamp + offset + drift (stamp - middle of the
        drive)`` [s].  A delay with which commands are followed is an offset.
    drift : float
        Rate of the two clocks against each other [s/s].

    Examples
    --------
    >>> CalibrationParameters(separation=1.02).left
    1.0

    """

    left: float = 1.0
    right: float = 1.0
    separation: float = 1.0
    x: float = 0.0
    y: float = 0.0
    yaw: float = 0.0
    offset: float = 0.0
    drift: float = 0.0


class WindowSet(NamedTuple):
    """
    Rows of the reference at which windows start and end.

    Parameters
    ----------
    start, end : numpy.ndarray of int, shape (w,)
        Rows of the reference.
    in_gaps : int
        Windows that were lost to gaps.

    Examples
    --------
    See :func:`windows_between`.

    """

    start: Indices
    end: Indices
    in_gaps: int


@dataclass(frozen=True)
class WindowResiduals:
    """
    Errors of the windows of a drive, and what moves them; w windows, n - 1 wheel intervals.

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
    elements : numpy.ndarray, shape (n - 1, 2, 3)
        The a of each interval and wheel (see the head of this module).
    travel : numpy.ndarray, shape (n - 1, 2)
        Travel of each interval and wheel [m].
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
    elements: Array
    travel: Array
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


class _Nodes(NamedTuple):
    """Odometry at the samples of the reference."""

    pose: Array  # (m, 3)
    twist: Array  # (m, 3): its derivative with respect to time
    interval: Indices  # (m,)
    fraction: Array  # (m,): of the interval, that has passed


def windows_between(
        drive: RecordedDrive, lengths: Sequence[float], every: float, tolerance: float
) -> WindowSet:
    """
    Return windows of some lengths that start at even times.

    Each begins and ends at the reference's sample nearest to where it should.  A window with no
    sample within the tolerance lies in a gap; one in which no wheel turns is left out, too,
    as are those beyond the stamps of the wheels.

    Parameters
    ----------
    drive : RecordedDrive
        Wheels and reference of one drive.
    lengths : sequence of float
        Lengths of the windows [s].
    every : float
        Time from the start of one to that of the next [s].
    tolerance : float
        How far a sample may be from where a window should start or end [s].

    Returns
    -------
    WindowSet
        Windows of the first length, then of the next one.

    Examples
    --------
    >>> from diffdrive_kinematics.core.calibration import drive_from_rates
    >>> stamps = np.arange(5.0)
    >>> drive = drive_from_rates(stamps, np.full((5, 2), 8.0), stamps, np.zeros((5, 3)))
    >>> windows = windows_between(drive, lengths=(2.0,), every=1.0, tolerance=0.1)
    >>> windows.start.tolist(), windows.end.tolist()
    ([0, 1, 2], [2, 3, 4])

    """
    seen = drive.reference_time
    low, high = max(seen[0], drive.time[0]), min(seen[-1], drive.time[-1])
    starts, ends, lost = [], [], 0
    for length in lengths:
        begin = np.arange(low, high - length + 1e-9, every)
        start, end = _nearest(seen, begin), _nearest(seen, begin + length)
        there = ((np.abs(seen[start] - begin) <= tolerance)
                 & (np.abs(seen[end] - begin - length) <= tolerance)
                 & (seen[start] >= low) & (seen[end] <= high) & (end > start))
        lost += int(np.count_nonzero(~there))
        starts.append(start[there])
        ends.append(end[there])
    start, end = np.concatenate(starts), np.concatenate(ends)
    way = np.append(0.0, np.cumsum(np.abs(np.diff(drive.angles, axis=0)).sum(axis=1)))
    so_far = np.interp(seen, drive.time, way)
    moving = so_far[end] > so_far[start]
    return WindowSet(start[moving], end[moving], lost)


def odometry_at(
        geometry: WheelGeometry, drive: RecordedDrive, systematic: CalibrationParameters
) -> Array:
    """
    Return what odometry says at the samples of the reference, from (0, 0, 0).

    Parameters
    ----------
    geometry : WheelGeometry
        Size and spacing of the wheels.
    drive : RecordedDrive
        Wheels, and stamps of the m samples.
    systematic : CalibrationParameters
        Factors on the geometry, and the clocks; the reference's frame does not matter.

    Returns
    -------
    numpy.ndarray, shape (m, 3)
        Poses (x [m], y [m], theta [rad]) of the robot's centre, theta not wrapped.

    Examples
    --------
    >>> from diffdrive_kinematics.core.calibration import drive_from_rates
    >>> stamps = np.arange(5.0)
    >>> drive = drive_from_rates(stamps, np.full((5, 2), 8.0), stamps, np.zeros((5, 3)))
    >>> odometry_at(WheelGeometry(0.5, 0.125), drive, CalibrationParameters())[:, 0].round(6)
    array([0., 1., 2., 3., 4.])

    """
    travel, separation = _travel(geometry, drive, systematic)
    return _at_nodes(drive, systematic, travel, separation, _path(travel, separation)).pose


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

    >>> from diffdrive_kinematics.core.calibration import drive_from_rates
    >>> stamps = np.arange(3.0)
    >>> drive = drive_from_rates(stamps, np.full((3, 2), 8.0), stamps, np.zeros((3, 3)))
    >>> windows = windows_between(drive, (1.0,), every=1.0, tolerance=0.1)
    >>> part = linearised(WheelGeometry(0.5, 0.125), drive, windows, CalibrationParameters())
    >>> part.error[:, 0].round(6), part.noise().shape
    (array([-1., -1.]), (2, 2, 3, 3))

    """
    travel, separation = _travel(geometry, drive, systematic)
    path = _path(travel, separation)
    nodes = _at_nodes(drive, systematic, travel, separation, path)
    start, end = windows.start, windows.end
    elements = _elements(path, separation)
    turn = (travel[:, 1] - travel[:, 0]) / separation
    pivot = 0.5 * separation * (elements[:, 1] - elements[:, 0])
    moves = np.stack([elements[:, 0] * (travel[:, :1] / systematic.left),
                      elements[:, 1] * (travel[:, 1:] / systematic.right),
                      pivot * (-turn / systematic.separation)[:, None]], axis=2)
    spread = np.einsum('nw,nwi,nwj->nij', np.abs(travel), elements, elements)
    along = rotations(-nodes.pose[start, 2]) @ pose_jacobians(*nodes.pose[end, :2].T)
    by_wheels = along @ _sums(moves, nodes, start, end)
    slip = along @ _sums(spread, nodes, start, end) @ along.transpose(0, 2, 1)
    wheels, back = _relative(nodes.pose, start, end)
    by_time = _moved(nodes.twist, nodes.pose, back, wheels, start, end)
    middle = 0.5 * (drive.time[0] + drive.time[-1])
    late = (drive.reference_time - middle)[:, None]
    by_drift = _moved(nodes.twist * late, nodes.pose, back, wheels, start, end)
    seen, by_frame, at_start, at_end = _reference(drive.reference, systematic, start, end)
    error = seen - wheels
    error[:, 2] = wrap_angle(error[:, 2])
    jacobian = np.concatenate(
        [-by_wheels, by_frame, by_time[..., None], by_drift[..., None]], axis=2)
    return WindowResiduals(error, jacobian, slip, at_start, at_end, along, elements, travel,
                           nodes.interval[start], nodes.interval[end])


def _nearest(stamps: Array, wanted: Array) -> Indices:
    after = np.clip(np.searchsorted(stamps, wanted), 1, len(stamps) - 1)
    return after - (wanted - stamps[after - 1] <= stamps[after] - wanted)


def _travel(geometry: WheelGeometry, drive: RecordedDrive, systematic: CalibrationParameters
            ) -> Tuple[Array, float]:
    radii = [geometry.left_radius * systematic.left, geometry.right_radius * systematic.right]
    return (np.diff(drive.angles, axis=0) * radii,
            geometry.separation * systematic.separation)


def _path(travel: Array, separation: float) -> Array:
    """Return the poses at the stamps of the wheels, shape (n, 3), by exact arcs."""
    turn, distance = (travel[:, 1] - travel[:, 0]) / separation, 0.5 * travel.sum(axis=1)
    steps = np.zeros((len(travel) + 1, 3))
    np.cumsum(turn, out=steps[1:, 2])
    chord, way = distance * np.sinc(turn / (2.0 * np.pi)), steps[:-1, 2] + 0.5 * turn
    np.cumsum(chord * np.cos(way), out=steps[1:, 0])
    np.cumsum(chord * np.sin(way), out=steps[1:, 1])
    return steps


def _at_nodes(
        drive: RecordedDrive, systematic: CalibrationParameters, travel: Array,
        separation: float, path: Array) -> _Nodes:
    """Return odometry at the reference's samples: a part of the arc in which each one falls."""
    middle = 0.5 * (drive.time[0] + drive.time[-1])
    time = (drive.reference_time - systematic.offset
            - systematic.drift * (drive.reference_time - middle))
    interval = np.clip(np.searchsorted(drive.time, time, side='right') - 1, 0, len(travel) - 1)
    period = np.diff(drive.time)[interval]
    fraction = (time - drive.time[interval]) / period
    part = travel[interval] / period[:, None]
    speed, rate = 0.5 * part.sum(axis=1), (part[:, 1] - part[:, 0]) / separation
    turn = rate * period * fraction
    chord = speed * period * fraction * np.sinc(turn / (2.0 * np.pi))
    begin = path[interval]
    way, theta = begin[:, 2] + 0.5 * turn, begin[:, 2] + turn
    pose = np.stack([begin[:, 0] + chord * np.cos(way), begin[:, 1] + chord * np.sin(way), theta],
                    axis=1)
    twist = np.stack([speed * np.cos(theta), speed * np.sin(theta), rate], axis=1)
    return _Nodes(pose, twist, interval, fraction)


def _elements(path: Array, separation: float) -> Array:
    """Return a of each interval and wheel, shape (n - 1, 2, 3), at the middle of the interval."""
    x, y, theta = (0.5 * (path[1:] + path[:-1])).T
    half, lever = 0.5 * np.stack([np.cos(theta), np.sin(theta)]), np.stack([y, -x]) / separation
    turn = np.full(len(x), 1.0 / separation)
    return np.stack([np.vstack([half - lever, -turn]).T, np.vstack([half + lever, turn]).T], 1)


def _sums(rows: Array, nodes: _Nodes, start: Indices, end: Indices) -> Array:
    """Return the sums of rows of intervals over each window, with parts of the outer ones."""
    total = np.concatenate([np.zeros((1, *rows.shape[1:])), np.cumsum(rows, axis=0)])
    part = nodes.fraction.reshape(-1, *(1,) * (rows.ndim - 1))
    at_nodes = total[nodes.interval] + part * rows[nodes.interval]
    windows: Array = at_nodes[end] - at_nodes[start]
    return windows


def _relative(poses: Array, start: Indices, end: Indices) -> Tuple[Array, Array]:
    """Return the poses at the ends in the frames of the starts, and the rotations into these."""
    back = rotations(-poses[start, 2])
    found: Array = np.einsum('wij,wj->wi', back, poses[end] - poses[start])
    return found, back


def _moved(
        change: Array, pose: Array, back: Array, relative: Array, start: Indices, end: Indices
) -> Array:
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
