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
Wheel odometry of a recorded drive, read at the samples of its reference.

The path goes by exact arcs from stamp to stamp of the wheels; a sample of the reference falls
into one of the arcs, of which it takes a part.
"""

from typing import NamedTuple, Tuple

from diffdrive_kinematics.core.calibration.calibration_parameters import CalibrationParameters
from diffdrive_kinematics.core.calibration.recorded_drive import (
    Indices, on_wheel_clock, RecordedDrive)
from diffdrive_kinematics.core.kinematics import Array, WheelGeometry
import numpy as np


class Nodes(NamedTuple):
    """
    Odometry at the samples of a reference.

    Parameters
    ----------
    pose : numpy.ndarray, shape (m, 3)
        Poses (x [m], y [m], theta [rad]), theta not wrapped.
    twist : numpy.ndarray, shape (m, 3)
        Their derivatives with respect to time.
    interval : numpy.ndarray of int, shape (m,)
        Interval of the wheels in which each sample falls.
    fraction : numpy.ndarray, shape (m,)
        Part of the interval that has passed [1].

    Examples
    --------
    See :func:`nodes_of`.

    """

    pose: Array
    twist: Array
    interval: Indices
    fraction: Array


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
    travel, separation = calibrated_travel(geometry, drive, systematic)
    return nodes_of(drive, systematic, travel, separation, path_of(travel, separation)).pose


def calibrated_travel(
        geometry: WheelGeometry, drive: RecordedDrive, systematic: CalibrationParameters
) -> Tuple[Array, float]:
    """
    Return the travel of each interval of the wheels, and their separation.

    Parameters
    ----------
    geometry : WheelGeometry
        Size and spacing of the wheels.
    drive : RecordedDrive
        Angles of the wheels at n stamps.
    systematic : CalibrationParameters
        Factors on the geometry.

    Returns
    -------
    travel : numpy.ndarray, shape (n - 1, 2)
        Travel (left, right) [m].
    separation : float
        Distance between the wheels [m].

    Examples
    --------
    See :func:`nodes_of`.

    """
    radii = [geometry.left_radius * systematic.left, geometry.right_radius * systematic.right]
    return np.diff(drive.angles, axis=0) * radii, geometry.separation * systematic.separation


def path_of(travel: Array, separation: float) -> Array:
    """
    Return the poses at the stamps of the wheels, by exact arcs from (0, 0, 0).

    Parameters
    ----------
    travel : numpy.ndarray, shape (n - 1, 2)
        Travel (left, right) of each interval [m].
    separation : float
        Distance between the wheels [m].

    Returns
    -------
    numpy.ndarray, shape (n, 3)
        Poses (x [m], y [m], theta [rad]), theta not wrapped.

    Examples
    --------
    >>> path_of(np.array([[1.0, 1.0]]), 0.5)[-1]
    array([1., 0., 0.])

    """
    turn, distance = (travel[:, 1] - travel[:, 0]) / separation, 0.5 * travel.sum(axis=1)
    steps = np.zeros((len(travel) + 1, 3))
    np.cumsum(turn, out=steps[1:, 2])
    chord, way = distance * np.sinc(turn / (2.0 * np.pi)), steps[:-1, 2] + 0.5 * turn
    np.cumsum(chord * np.cos(way), out=steps[1:, 0])
    np.cumsum(chord * np.sin(way), out=steps[1:, 1])
    return steps


def nodes_of(
        drive: RecordedDrive, systematic: CalibrationParameters, travel: Array,
        separation: float, path: Array) -> Nodes:
    """
    Return odometry at the samples of the reference.

    Parameters
    ----------
    drive : RecordedDrive
        Stamps of wheels and reference.
    systematic : CalibrationParameters
        Offset and drift of the clocks.
    travel : numpy.ndarray, shape (n - 1, 2)
        Travel (left, right) of each interval [m].
    separation : float
        Distance between the wheels [m].
    path : numpy.ndarray, shape (n, 3)
        Poses at the stamps of the wheels.

    Returns
    -------
    Nodes
        Poses and twists, and in which part of which interval they are.

    Examples
    --------
    A sample in the middle of the second of two intervals:

    >>> from diffdrive_kinematics.core.calibration import drive_from_rates
    >>> drive = drive_from_rates(
    ...     [0.0, 1.0, 2.0], np.full((3, 2), 8.0), [0.0, 1.5], np.zeros((2, 3)))
    >>> systematic = CalibrationParameters()
    >>> travel, separation = calibrated_travel(WheelGeometry(0.5, 0.125), drive, systematic)
    >>> nodes = nodes_of(drive, systematic, travel, separation, path_of(travel, separation))
    >>> nodes.pose[:, 0].round(6), nodes.interval, nodes.fraction
    (array([0. , 1.5]), array([0, 1]), array([0. , 0.5]))

    """
    time = on_wheel_clock(drive, systematic)
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
    return Nodes(pose, twist, interval, fraction)
