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
Covariance that slip gathers along a recorded path, all of its arcs at once.

The same closed form as :func:`.slip_covariance`, on arrays: where a path is known to its end,
each arc's part is swung by all the motion that is left, and the parts are added.
"""

from diffdrive_kinematics.core.kinematics import Array
from diffdrive_kinematics.core.noise.path_arcs import ArcsAlong
import numpy as np


def covariance_along(arcs: ArcsAlong) -> Array:
    """
    Return the covariance of the pose after a path, for a slip variance of 1 m of either wheel.

    Parameters
    ----------
    arcs : ArcsAlong
        The path, as of :func:`.arcs_along`.

    Returns
    -------
    numpy.ndarray, shape (2, 3, 3)
        In the frame of the start, of the slip of the left and of the right wheel: that of both
        is their sum, each times its slip variance per metre [m].

    Examples
    --------
    A straight metre of twenty rows, with k = 1e-4 m of both wheels:

    >>> from diffdrive_kinematics.core.kinematics import WheelGeometry
    >>> from diffdrive_kinematics.core.noise import arcs_along
    >>> left, right = covariance_along(
    ...     arcs_along(WheelGeometry(0.5, 0.125), np.full((20, 2), 0.05)))
    >>> f'Var theta = {(1e-4 * left + 1e-4 * right)[2, 2]:.1e} rad^2'
    'Var theta = 8.0e-04 rad^2'

    """
    e_mean, e_square, sine_square = arcs.means
    separation, travel = arcs.separation, arcs.travel.T
    cosine, sign = np.cos(arcs.half), np.array([[-1.0], [1.0]])
    variance = np.abs(travel)
    lever = -sign * travel[::-1] / (2.0 * separation)
    along = 0.5 * cosine + lever * e_mean
    across = arcs.chord / (2.0 * separation)
    return arcs.gathered((  # what each arc adds, in the axes of its middle direction: (2, n)
        variance * (0.25 * cosine**2 + lever * (cosine * e_mean + lever * e_square)),
        variance * sign * across * along,
        variance * sign * along / separation,
        variance * (across**2 + lever**2 * sine_square),
        variance * across / separation,
        variance / separation**2))
