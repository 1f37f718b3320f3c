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
UMBmark: systematic errors of odometry from runs around a square, in both directions.

Borenstein & Feng, "Measurement and correction of systematic odometry errors in mobile robots",
IEEE Trans. Robotics and Automation 12(6), 1996, and their report UM-MEAM-94-22.  A wrong wheel
separation (their type A) makes every turn of the robot wrong, unequal wheels (type B) turn it
along every side; driven in one direction only, one can hide the other.  The equations, see
:mod:`.square_errors`, are of the first order, and what that leaves vanishes over a few passes:
correct, drive again, correct again; :mod:`.square_fit` solves them exactly in one.
"""

from dataclasses import replace
from typing import Sequence

from diffdrive_kinematics.core.calibration.square_errors import angles_of_runs, ratios_of_angles
from diffdrive_kinematics.core.calibration.square_runs import ReturnError, Umbmark
from diffdrive_kinematics.core.commands import square_course
from diffdrive_kinematics.core.kinematics import (
    Array, Command, is_sane, LARGEST, Pose, pose_after, twist_from_wheel_rates,
    wheel_rates_from_twist, WheelGeometry)
import numpy as np

FEWEST_RUNS = 2
"""Runs each way that are needed: the scatter tells the standard errors."""


def umbmark(
        geometry: WheelGeometry, side: float, clockwise: Sequence[ReturnError],
        counterclockwise: Sequence[ReturnError], *, corner_radius: float = 0.0) -> Umbmark:
    """
    Return the systematic errors that return errors of both directions show.

    The two directions may have different numbers of runs.  Their scatter is pooled: seen in a
    mirror one direction is the other, so they scatter alike if the wheels slip alike.

    Parameters
    ----------
    geometry : WheelGeometry
        Geometry that odometry used.
    side : float
        Side of the square [m], as :func:`.square_course` drives it.  Up to 12 wheel separations
        two passes are enough for errors of 1 % and 2 % of E_d and E_b; longer ones need more.
    clockwise, counterclockwise : sequence of ReturnError
        At least 2 runs each.
    corner_radius : float
        Radius of the square's corners [m], at most half the side; 0 = turns on the spot.

    Returns
    -------
    Umbmark
        Errors of separation and diameters, and what they leave.

    Raises
    ------
    ValueError
        If the side or radius is out of range, there are too few runs, an error is not finite,
        or the errors are too large: for the first order, or to tell E_d.

    Examples
    --------
    A robot that turns too little, since its wheels are farther apart than it believes:

    >>> geometry = WheelGeometry(0.5, 0.125)
    >>> found = umbmark(geometry, 4.0, clockwise=2 * [ReturnError(-0.16, -0.16)],
    ...                 counterclockwise=2 * [ReturnError(-0.16, 0.16)])
    >>> f'E_b = {found.separation_ratio.value:.4f}, E_d = {found.diameter_ratio.value:.4f}'
    'E_b = 1.0129, E_d = 1.0000'
    >>> f'{corrected(geometry, found).separation:.4f} m'
    '0.5064 m'

    """
    courses = [
        square_course(side=side, speed=1.0, yaw_rate=1.0, clockwise=way,
                      corner_radius=corner_radius) for way in (True, False)]
    runs_cw = _checked('clockwise', clockwise)
    runs_ccw = _checked('counterclockwise', counterclockwise)
    angles = angles_of_runs(side, corner_radius, runs_cw, runs_ccw)
    e_b, e_d = ratios_of_angles(side, corner_radius, geometry.separation, angles)
    centre_cw, centre_ccw = (
        ReturnError(*runs.mean(axis=0).tolist()) for runs in (runs_cw, runs_ccw))
    after = with_ratios(geometry, e_b.value, e_d.value)
    left_cw, left_ccw = (
        _remainder(course, geometry, after, centre)
        for course, centre in zip(courses, (centre_cw, centre_ccw)))
    return Umbmark(
        side, centre_cw, centre_ccw, left_cw, left_ccw, angles.alpha, angles.beta, e_b, e_d,
        error_before=max(centre_cw.distance, centre_ccw.distance),
        error_after=max(left_cw.distance, left_ccw.distance),
        degrees_of_freedom=len(runs_cw) + len(runs_ccw) - 2)


def corrected(geometry: WheelGeometry, result: Umbmark) -> WheelGeometry:
    """
    Return the geometry with the correction, for the geometry that odometry used.

    The existing multipliers are multiplied, so passes compose: the separation's by E_b, the
    radii's by c_L and ``c_R = E_d c_L`` that leave the mean radius as it is; of radii so far
    equal, the paper's ``c_L = 2 / (E_d + 1)``, ``c_R = 2 / (1 / E_d + 1)``.  The mean radius
    has to be measured by itself, along a straight line.

    Parameters
    ----------
    geometry : WheelGeometry
        Geometry that odometry used in the runs.
    result : Umbmark
        What the runs have shown.

    Returns
    -------
    WheelGeometry
        The same nominal lengths with other multipliers.

    Raises
    ------
    ValueError
        If a corrected length is out of range.

    Examples
    --------
    See :func:`umbmark`.

    """
    return with_ratios(geometry, result.separation_ratio.value, result.diameter_ratio.value)


def _checked(name: str, runs: Sequence[ReturnError]) -> Array:
    """Return the return errors of one direction, shape (n, 2)."""
    if len(runs) < FEWEST_RUNS:
        raise ValueError(
            f'there are {len(runs)} {name} runs, expected at least {FEWEST_RUNS} in either '
            'direction: one direction alone cannot tell the separation from the wheels')
    for number, run in enumerate(runs, start=1):
        if not is_sane(*run):
            raise ValueError(
                f'{name} run {number} has the return error {tuple(run)}, expected two finite '
                f'numbers, within +-{LARGEST:g} m')
    return np.array(runs, dtype=np.float64)


def with_ratios(geometry: WheelGeometry, e_b: float, e_d: float) -> WheelGeometry:
    """
    Return the geometry with E_b and E_d on top of its multipliers.

    Parameters
    ----------
    geometry : WheelGeometry
        Geometry that odometry used.
    e_b, e_d : float
        True separation over that of the geometry, and right wheel over left wheel [1].

    Returns
    -------
    WheelGeometry
        The same nominal lengths and mean radius with other multipliers.

    Examples
    --------
    >>> with_ratios(WheelGeometry(0.5, 0.125), 1.02, 1.0).separation
    0.51

    """
    left, right = geometry.left_wheel_radius_multiplier, geometry.right_wheel_radius_multiplier
    c_left = (left + right) / (left + e_d * right)
    return replace(
        geometry,
        wheel_separation_multiplier=geometry.wheel_separation_multiplier * e_b,
        left_wheel_radius_multiplier=left * c_left,
        right_wheel_radius_multiplier=right * c_left * e_d)


def _remainder(
        course: Sequence[Command], before: WheelGeometry, after: WheelGeometry,
        centre: ReturnError) -> ReturnError:
    """Return the error that is left if the wheel motion of a run is read with ``after``."""
    end = pose_after(Pose(0.0, 0.0, 0.0), [reread(each, before, after) for each in course])
    return ReturnError(centre.x - float(end.x), centre.y - float(end.y))


def reread(command: Command, before: WheelGeometry, after: WheelGeometry) -> Command:
    """
    Return a command of ``before`` as ``after`` reads the wheel rates that it makes.

    Parameters
    ----------
    command : Command
        Motion as odometry saw it.
    before, after : WheelGeometry
        Geometry that odometry used, and another one.

    Returns
    -------
    Command
        The motion of the same wheels with the other geometry.

    Examples
    --------
    >>> reread(Command(0.0, 1.0, 2.0), WheelGeometry(0.5, 0.125), WheelGeometry(1.0, 0.125))
    Command(v=0.0, w=0.5, duration=2.0)

    """
    left, right = wheel_rates_from_twist(before, command.v, command.w)
    return Command(*twist_from_wheel_rates(after, left, right), command.duration)
