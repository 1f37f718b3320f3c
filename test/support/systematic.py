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
Recordings of wheel travel beside reference poses, and their systematic errors by least squares.

What has to be known of a recording before its slip can be: the wheels' effective radii and
separation, where the reference's frame sits on the robot, and how the two clocks are off.
"""

from typing import NamedTuple

from diffdrive_kinematics.core.calibration import (
    Clock, drive_from_positions, fit_trajectory, slip_window)
from diffdrive_kinematics.core.kinematics import Pose, WheelGeometry, wrap_angle
import numpy as np
from support.recorded import RADIUS, SEPARATION, TICKS_PER_TURN

FIT_SECONDS, FIT_EVERY_SECONDS = 5.0, 0.5
POSITION_SIGMA, HEADING_SIGMA = 0.003, 0.008  # their ratio weighs positions against headings
LONGEST_GAP_SECONDS = 0.25
WHEELS, FRAME, CLOCK = ('left', 'right', 'separation'), ('x', 'y', 'yaw'), ('offset', 'rate')
STEPS = {'left': 1e-4, 'right': 1e-4, 'separation': 1e-5, 'x': 1e-4, 'y': 1e-4, 'yaw': 1e-4,
         'offset': 0.02, 'rate': 3e-4}


class Recording(NamedTuple):
    """Wheel travel (left, right) so far [m] at even times [s], reference poses at their own."""

    name: str
    time: np.ndarray
    travel: np.ndarray
    reference_time: np.ndarray
    reference: np.ndarray


class CalibrationParameters(NamedTuple):
    """Multipliers of the wheels' travel, separation [m], frame [m, m, rad], clocks [s, s/s]."""

    left: float
    right: float
    separation: float
    x: float = 0.0
    y: float = 0.0
    yaw: float = 0.0
    offset: float = 0.0
    rate: float = 0.0


def encoder_recording(path):
    """Return the recording of a file with encoder ticks and poses in each row."""
    rows = np.genfromtxt(path, delimiter=',', names=True)
    scale = 2.0 * np.pi * RADIUS / TICKS_PER_TURN
    travel = scale * np.cumsum(np.stack([rows['left_ticks'], rows['right_ticks']], axis=1), axis=0)
    poses = np.stack([rows['x'], rows['y'], rows['yaw']], axis=1)
    return Recording(path.name.split('.')[0], rows['time_sec'], travel, rows['time_sec'], poses)


def odometry(recording, systematic):
    """Return the poses (x, y, theta) of wheel odometry, shape (n, 3)."""
    left, right = effective_travel(recording, systematic).T
    turn, distance = (right - left) / systematic.separation, 0.5 * (left + right)
    theta = np.concatenate([[0.0], np.cumsum(turn)])
    chord, direction = distance * np.sinc(turn / (2.0 * np.pi)), theta[:-1] + 0.5 * turn
    x, y = (np.concatenate([[0.0], np.cumsum(chord * way(direction))])
            for way in (np.cos, np.sin))
    return np.stack([x, y, theta], axis=1)


def effective_travel(recording, systematic):
    """Return the calibrated travel (d_l, d_r) of each interval [m], shape (n - 1, 2)."""
    return np.diff(recording.travel, axis=0) * [systematic.left, systematic.right]


def centre_poses(recording, systematic):
    """Return what the reference says of the robot's centre at the wheels' times; NaN in gaps."""
    middle = 0.5 * (recording.time[0] + recording.time[-1])
    time = recording.time + systematic.offset + systematic.rate * (recording.time - middle)
    stamps = recording.reference_time
    x, y, theta = (np.interp(time, stamps, column) for column in recording.reference.T)
    theta = theta - systematic.yaw
    x = x - np.cos(theta) * systematic.x + np.sin(theta) * systematic.y
    y = y - np.sin(theta) * systematic.x - np.cos(theta) * systematic.y
    after = np.clip(np.searchsorted(stamps, time), 1, len(stamps) - 1)
    covered = ((stamps[after] - stamps[after - 1] < LONGEST_GAP_SECONDS)
               & (time >= stamps[0]) & (time <= stamps[-1]))
    return np.where(covered[:, None], np.stack([x, y, theta], axis=1), np.nan)


def relative(poses, start, end):
    """Return the poses at the rows ``end`` in the frames of the rows ``start``."""
    dx, dy, turn = (poses[end] - poses[start]).T
    cosine, sine = np.cos(poses[start, 2]), np.sin(poses[start, 2])
    return np.stack([cosine * dx + sine * dy, cosine * dy - sine * dx, turn], axis=1)


def errors(recording, systematic, start, end):
    """Return the errors of windows between rows, shape (n, 3); 0 where the reference is not."""
    error = (relative(centre_poses(recording, systematic), start, end)
             - relative(odometry(recording, systematic), start, end))
    error[:, 2] = wrap_angle(error[:, 2])
    return np.nan_to_num(error)


def windows_of(recording, systematic, seconds, start_row=0, every_seconds=None, gap_rows=4):
    """
    Return the slip windows of a recording that lie fully in the reference.

    ``seconds`` are the lengths, taken in turn, ``gap_rows`` apart so that no two share an end;
    with ``every_seconds`` they start so far apart, and overlap.
    """
    period = recording.time[1] - recording.time[0]
    poses = centre_poses(recording, systematic)
    travel = effective_travel(recording, systematic)
    geometry = WheelGeometry(systematic.separation, 1.0)
    found, start, turn = [], start_row, 0
    while True:
        rows = round(seconds[turn % len(seconds)] / period)
        end, turn = start + rows, turn + 1
        if end >= len(poses):
            return found
        seen = np.isfinite(poses[[start, end]]).all() and np.isfinite(travel[start:end]).all()
        if seen and travel[start:end].any():
            found.append(slip_window(
                geometry, travel[start:end], Pose(*poses[start]), Pose(*poses[end])))
        start = end + gap_rows if every_seconds is None else start + round(every_seconds / period)


def fitted(recordings, given, shared, own):
    """
    Fit systematic errors by Gauss-Newton to windows of 5 s.

    ``given`` has the values to start from, one for each recording; ``shared`` names what all
    recordings have in common, ``own`` what each has for itself.  Return one for each recording.
    """
    names = [*shared, *(name for _ in recordings for name in own)]
    steps = np.array([STEPS[name] for name in names])
    values = np.array([getattr(given[0], name) for name in shared]
                      + [getattr(each, name) for each in given for name in own])

    def unpacked(vector):
        common = dict(zip(shared, vector))
        mine = vector[len(shared):].reshape(len(recordings), len(own))
        return [each._replace(**common, **dict(zip(own, row))) for each, row in zip(given, mine)]

    def residual(vector):
        return np.concatenate([
            _weighted(recording, each) for recording, each in zip(recordings, unpacked(vector))])

    for _ in range(20):
        jacobian = np.stack([
            (residual(values + each) - residual(values - each)) / (2.0 * step)
            for step, each in zip(steps, np.diag(steps))], axis=1)
        change = -np.linalg.lstsq(jacobian, residual(values), rcond=None)[0]
        values = values + change
        if np.max(np.abs(change) / steps) < 1e-3:
            break
    return unpacked(values)


def _weighted(recording, systematic):
    period = recording.time[1] - recording.time[0]
    rows, every = round(FIT_SECONDS / period), round(FIT_EVERY_SECONDS / period)
    start = np.arange(0, len(recording.time) - rows, every)
    error = errors(recording, systematic, start, start + rows)
    return (error / [POSITION_SIGMA, POSITION_SIGMA, HEADING_SIGMA]).ravel()


NOMINAL = CalibrationParameters(1.0, 1.0, SEPARATION)


def calibrated(recordings):
    """Return the systematic errors of one session: wheels and frame shared, a clock each."""
    return _by_core(recordings, NOMINAL, wheels=True, frame=None)


def transferred(recordings, wheels, session_frame=True):
    """Return the systematic errors of another session, with the wheels (and frame) of one."""
    frame = None if session_frame else Pose(wheels.x, wheels.y, wheels.yaw)
    return _by_core(recordings, wheels, wheels=False, frame=frame)


def _by_core(recordings, start, wheels, frame):
    """Return what the trajectory fit of the package finds, one for each recording."""
    geometry = WheelGeometry(start.separation, 1.0, 1.0, start.left, start.right)
    drives = [drive_from_positions(*recording[1:]) for recording in recordings]
    fit = fit_trajectory(geometry, drives, wheels=wheels, clock=Clock.DRIFTS, frame=frame)
    corrected = fit.corrected(geometry)
    return [CalibrationParameters(
        corrected.left_radius, corrected.right_radius, corrected.separation, *fit.frame,
        offset.value, drift.value)
            for offset, drift in zip(fit.offsets, fit.drifts)]
