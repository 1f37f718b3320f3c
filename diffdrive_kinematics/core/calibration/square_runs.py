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
What runs around a square show: return errors, the systematic errors behind them, and slip.

Systematic errors move the centre of gravity of either direction, slip scatters around it with
the covariance ``k A`` that the package gives the end of the course
(:func:`.propagated_covariance`), A being that for k = 1 m.  Without the degrees of freedom of the
two centres the estimate is ``k = sum (e - m)^T A^-1 (e - m) / (2 (N - 2))`` over the N runs, whose
standard error for normal slip is ``k / sqrt(N - 2)``.  What scatters the measurements by hand
counts as slip as well.
"""

from dataclasses import dataclass
import math
from typing import NamedTuple, Sequence

from diffdrive_kinematics.core.calibration.calibration_parameters import Estimate
from diffdrive_kinematics.core.commands import square_course
from diffdrive_kinematics.core.kinematics import Array, Pose, WheelGeometry
from diffdrive_kinematics.core.noise import NO_COVARIANCE, propagated_covariance, travel_of_command
import numpy as np


class ReturnError(NamedTuple):
    """
    True position minus that of odometry at the end of a run, in the frame of its start.

    Parameters
    ----------
    x, y : float
        The error [m].

    Examples
    --------
    >>> ReturnError(x=0.3, y=-0.4).distance
    0.5

    """

    x: float
    y: float

    @property
    def distance(self) -> float:
        """Length of the error [m]."""
        return math.hypot(self.x, self.y)


@dataclass(frozen=True)
class Umbmark:
    """
    Systematic errors, and the correction that follows from them.

    ``(value - truth) / error`` follows Student's t with ``degrees_of_freedom``: of
    :func:`.fit_squares` always, of :func:`.umbmark` as far as the first order holds, which is
    where the remainder, about ``error_after``, is small beside the scatter.

    Parameters
    ----------
    side : float
        Side of the square [m].
    clockwise, counterclockwise : ReturnError
        Centres of gravity.
    clockwise_after, counterclockwise_after : ReturnError
        The same of the same wheel motion, read with the corrected geometry by its exact
        kinematics: what the first order leaves.  New runs add their own scatter.
    alpha, beta : Estimate
        Errors of a turn and along a side [rad]; see :mod:`.square_errors`.
    separation_ratio, diameter_ratio : Estimate
        E_b and E_d [1].
    error_before : float
        E_max,syst: distance [m] of the farther centre of gravity.
    error_after : float
        The same of the centres after the correction [m].
    degrees_of_freedom : int
        Those of the scatter that the errors come from: the number of runs less 2.

    Examples
    --------
    >>> from diffdrive_kinematics.core.calibration import umbmark
    >>> from diffdrive_kinematics.core.kinematics import WheelGeometry
    >>> found = umbmark(
    ...     WheelGeometry(0.5, 0.125), 4.0, clockwise=2 * [ReturnError(-0.16, -0.16)],
    ...     counterclockwise=2 * [ReturnError(-0.16, 0.16)])
    >>> f'{found.error_before:.3f} m', found.degrees_of_freedom
    ('0.226 m', 2)

    """

    side: float
    clockwise: ReturnError
    counterclockwise: ReturnError
    clockwise_after: ReturnError
    counterclockwise_after: ReturnError
    alpha: Estimate
    beta: Estimate
    separation_ratio: Estimate
    diameter_ratio: Estimate
    error_before: float
    error_after: float
    degrees_of_freedom: int


def slip_from_squares(
        geometry: WheelGeometry, side: float, clockwise: Sequence[ReturnError],
        counterclockwise: Sequence[ReturnError], *, corner_radius: float = 0.0) -> Estimate:
    """
    Return the slip variance k of both wheels.

    Parameters
    ----------
    geometry : WheelGeometry
        Geometry that odometry used.
    side : float
        Side of the square [m], as :func:`.square_course` drives it.
    clockwise, counterclockwise : sequence of ReturnError
        Return errors of the runs, at least 3 in all.
    corner_radius : float
        Radius of the square's corners [m], at most half the side; 0 = turns on the spot.

    Returns
    -------
    Estimate
        Slip variance per metre of travel [m].

    Raises
    ------
    ValueError
        If there are fewer than 3 runs, or a length of the square is out of range.

    Examples
    --------
    >>> one, other = ReturnError(0.02, -0.01), ReturnError(-0.02, 0.01)
    >>> k = slip_from_squares(WheelGeometry(0.5, 0.125), 4.0, [one, other], [one, other])
    >>> f'k = {k.value:.1e} +- {k.error:.1e} m'
    'k = 8.0e-07 +- 5.6e-07 m'

    """
    runs = len(clockwise) + len(counterclockwise)
    if runs < 3:
        raise ValueError(f'there are {runs} runs, expected at least 3 to see a scatter')
    total = 0.0
    for errors, way in ((clockwise, True), (counterclockwise, False)):
        offsets = np.array(errors, dtype=np.float64)
        offsets = offsets - offsets.mean(axis=0)
        covariance = _unit_covariance(geometry, side, corner_radius, way)
        total += float(np.sum(offsets * np.linalg.solve(covariance, offsets.T).T))
    k = total / (2.0 * (runs - 2))
    return Estimate(k, k / math.sqrt(runs - 2))


def _unit_covariance(
        geometry: WheelGeometry, side: float, corner_radius: float, clockwise: bool) -> Array:
    """Return the covariance [m^2] of the position at the end for k = 1 m, shape (2, 2)."""
    pose, covariance = Pose(0.0, 0.0, 0.0), NO_COVARIANCE
    for command in square_course(side=side, speed=1.0, yaw_rate=1.0, clockwise=clockwise,
                                 corner_radius=corner_radius):
        pose, covariance = propagated_covariance(
            covariance, pose, geometry, *travel_of_command(command, geometry), 1.0, 1.0)
    return covariance.matrix()[:2, :2]
