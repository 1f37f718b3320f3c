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
Covariance that the slip of the body gathers along a recorded path, beside that of the wheels.

As :mod:`.covariance_along`, to first order: linear in the constants, which is what a fit needs.
"""

from diffdrive_kinematics.core.kinematics import Array
from diffdrive_kinematics.core.noise.path_arcs import ArcsAlong
import numpy as np


def body_covariance_along(arcs: ArcsAlong) -> Array:
    """
    Return the covariances that the slip of the body makes of a path, for constants of 1.

    In the axes of an arc's middle direction, with h = turn / 2 and s from -1 (start) to 1 (end),
    an error of the distance at s moves the end by ``(cos(h s), sin(h s), 0)``, one of the heading
    by ``(-ds / 2 e(s), ds / 2 (sin(h) - sin(h s)) / h, 1)``, ``e(s) = (cos(h s) - cos(h)) / h``.

    Parameters
    ----------
    arcs : ArcsAlong
        The path, as of :func:`.arcs_along`.

    Returns
    -------
    numpy.ndarray, shape (3, 3, 3)
        Of the pose at the end, in the frame of the start, from the variances of
        :class:`.BodySlip`, in their order: that of all is their sum, each times its constant.

    Examples
    --------
    A straight metre of twenty rows:

    >>> from diffdrive_kinematics.core.kinematics import WheelGeometry
    >>> from diffdrive_kinematics.core.noise import arcs_along
    >>> linear, turn, heading = body_covariance_along(
    ...     arcs_along(WheelGeometry(0.5, 0.125), np.full((20, 2), 0.05)))
    >>> f'{linear[0, 0]:.1f} {turn[2, 2]:.1f} {heading[2, 2]:.1f} {heading[1, 1]:.3f}'
    '1.0 0.0 1.0 0.333'

    """
    e_mean, e_square, sine_square = arcs.means
    distance, half = arcs.distance, arcs.half
    none, one = np.zeros_like(half), np.ones_like(half)
    bow = half * half * sine_square
    middle, across = -0.5 * distance * e_mean, 0.5 * arcs.chord
    of_distance = 1.0 - bow, none, none, bow, none, none
    of_heading = (0.25 * distance**2 * e_square, middle * across, middle,
                  across**2 + 0.25 * distance**2 * sine_square, across, one)
    along, around = np.abs(distance), np.abs(arcs.turn)
    return arcs.gathered(tuple(  # what each arc adds, in the axes of its middle direction: (3, n)
        np.stack([along * a, around * b, along * b]) for a, b in zip(of_distance, of_heading)))
