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

"""What runs around a square show: return errors, and the systematic errors behind them."""

from dataclasses import dataclass
import math
from typing import NamedTuple

from diffdrive_kinematics.core.calibration.estimate import Estimate


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
