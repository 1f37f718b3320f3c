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

"""What a trajectory fit finds, and how well it is known."""

from dataclasses import dataclass, replace
from typing import NamedTuple, Optional, Tuple

from diffdrive_kinematics.core.calibration.calibration_parameters import (
    CalibrationParameters, Estimate, FRAME, NAMES, WHEELS)
from diffdrive_kinematics.core.calibration.gauss_newton import Iteration
from diffdrive_kinematics.core.calibration.window_weights import Variances
from diffdrive_kinematics.core.kinematics import Array, Pose, WheelGeometry


class Residual(NamedTuple):
    """
    Root mean square of the errors of windows.

    Parameters
    ----------
    position : float
        Of the distance [m].
    heading : float
        Of the heading [rad].

    Examples
    --------
    >>> Residual(position=0.012, heading=0.003).position
    0.012

    """

    position: float
    heading: float


@dataclass(frozen=True)
class TrajectoryFit:
    """
    Systematic errors of one robot, and how well they are known.

    Parameters
    ----------
    left_wheel_radius_multiplier : Estimate
        Factor on that of the geometry that the fit started from [1].
    right_wheel_radius_multiplier : Estimate
        Factor on that of the geometry [1].
    wheel_separation_multiplier : Estimate
        Factor on that of the geometry [1].
    frame_x, frame_y, frame_yaw : Estimate
        Pose of the reference's frame on the robot [m], [m], [rad].
    offsets, drifts : tuple of Estimate
        Those of each drive: ``reference stamp = wheel stamp + offset + drift (stamp - middle
        of the drive)`` [s], [s/s]; all offsets are the same for a delay.
    names : tuple of str
        Names of the p parameters that were fitted.
    covariance : numpy.ndarray, shape (p, p)
        Their covariance.
    variances : Variances
        Slip constant [m] and variances of the reference [m^2], [rad^2] that the errors of the
        windows amount to, systematic errors that are left included.
    before, after : Residual
        Residual of the windows, outliers aside: with the wheels as given but frame and clocks
        fitted, and with all fitted.
    windows, in_gaps, outliers : int
        How many windows were fitted, had an end in a gap, or (of those fitted) count nothing.
    trace : tuple of Iteration
        The steps of the search; weights and variances change with each of the first ones.
    drift_ratios : tuple of float or None
        Likelihood ratio of the drift of each drive's clock (see :func:`.drift_pays`); None
        where none was tried.

    Examples
    --------
    The wheels are 0.51 m apart instead of 0.5 m, and the reference is at the robot's centre:

    >>> import numpy as np
    >>> from diffdrive_kinematics.core.calibration import (
    ...     CalibrationParameters, Clock, drive_from_rates, fit_trajectory, NO_FRAME, odometry_at)
    >>> geometry, stamps = WheelGeometry(0.5, 0.125), np.arange(0.0, 60.0, 0.5)
    >>> rates = 8.0 + 4.0 * np.stack([np.sin(stamps), np.cos(0.7 * stamps)], axis=1)
    >>> bare = drive_from_rates(stamps, rates, stamps, np.zeros((120, 3)))
    >>> truth = odometry_at(WheelGeometry(0.51, 0.125), bare, CalibrationParameters())
    >>> fit = fit_trajectory(
    ...     geometry, [replace(bare, reference=truth)], frame=NO_FRAME, clock=Clock.NONE)
    >>> f'{fit.systematic(0).separation:.3f}, {fit.corrected(geometry).separation:.3f} m'
    '1.020, 0.510 m'

    """

    left_wheel_radius_multiplier: Estimate
    right_wheel_radius_multiplier: Estimate
    wheel_separation_multiplier: Estimate
    frame_x: Estimate
    frame_y: Estimate
    frame_yaw: Estimate
    offsets: Tuple[Estimate, ...]
    drifts: Tuple[Estimate, ...]
    names: Tuple[str, ...]
    covariance: Array
    variances: Variances
    before: Residual
    after: Residual
    windows: int
    in_gaps: int
    outliers: int
    trace: Tuple[Iteration, ...]
    drift_ratios: Tuple[Optional[float], ...] = ()

    @property
    def frame(self) -> Pose:
        """Pose of the reference's frame on the robot."""
        return Pose(self.frame_x.value, self.frame_y.value, self.frame_yaw.value)

    def corrected(self, geometry: WheelGeometry) -> WheelGeometry:
        """
        Return the geometry with the fitted factors on its multipliers.

        Parameters
        ----------
        geometry : WheelGeometry
            Geometry that the fit started from.

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
        See :class:`TrajectoryFit`.

        """
        return replace(
            geometry,
            **{NAMES[field]: getattr(geometry, NAMES[field]) * getattr(self, NAMES[field]).value
               for field in WHEELS})

    def systematic(self, drive: int) -> CalibrationParameters:
        """
        Return what is systematic about a drive, relative to the geometry of the fit.

        Parameters
        ----------
        drive : int
            Index of the drive, from 0.

        Returns
        -------
        CalibrationParameters
            Factors, frame and clock, without errors.

        Examples
        --------
        See :class:`TrajectoryFit`.

        """
        values = {field: getattr(self, NAMES[field]).value for field in (*WHEELS, *FRAME)}
        return CalibrationParameters(
            **values, offset=self.offsets[drive].value, drift=self.drifts[drive].value)
