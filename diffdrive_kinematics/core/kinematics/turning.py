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

"""The circle on which two wheels move the robot."""

import math
from typing import Tuple

from diffdrive_kinematics.core.kinematics.checks import check_finite
from diffdrive_kinematics.core.kinematics.geometry import WheelGeometry
from diffdrive_kinematics.core.kinematics.pose import Pose


def turning_radius(geometry: WheelGeometry, d_left: float, d_right: float) -> float:
    """
    Return the signed radius of the circle that the robot's centre follows.

    ``r_c = L (d_l + d_r) / (2 (d_r - d_l))`` (LaValle, Mobile Robotics, eq. 2.7).

    Parameters
    ----------
    geometry : WheelGeometry
        Size and spacing of the wheels.
    d_left, d_right : float
        Wheel travel [m] or, equally, wheel speeds [m/s].

    Returns
    -------
    float
        Radius r_c [m]; positive where the centre of the circle lies to the left, ``inf`` for
        parallel travel.

    Raises
    ------
    ValueError
        If a travel is not finite, or both are 0: a wheel pair at rest has no turning radius.

    Examples
    --------
    >>> geometry = WheelGeometry(0.5, 0.125)
    >>> turning_radius(geometry, 0.25, 0.5), turning_radius(geometry, -0.1, 0.1)
    (0.75, 0.0)

    """
    check_finite('d_left', d_left)
    check_finite('d_right', d_right)
    if d_left == d_right == 0.0:
        raise ValueError('d_left and d_right are 0, expected travel of at least one wheel')
    if d_left == d_right:
        return math.inf
    return geometry.separation * (0.5 * d_left + 0.5 * d_right) / (d_right - d_left)


def turning_centre(
        geometry: WheelGeometry, pose: Pose, d_left: float, d_right: float) -> Tuple[float, float]:
    """
    Return the point about which the robot turns.

    It lies ``turning_radius`` to the left of the robot's centre, on the wheels' common axis
    (LaValle, Mobile Robotics, sec. 2.1).

    Parameters
    ----------
    geometry : WheelGeometry
        Size and spacing of the wheels.
    pose : Pose
        Pose of the robot; floats.
    d_left, d_right : float
        Wheel travel [m] or, equally, wheel speeds [m/s].

    Returns
    -------
    x : float
        Of the point [m], in the frame of ``pose``; infinite for parallel travel.
    y : float
        Of the point [m], likewise.

    Raises
    ------
    ValueError
        As :func:`turning_radius`.

    Examples
    --------
    >>> turning_centre(WheelGeometry(0.5, 0.125), Pose(1.0, 2.0, 0.0), 0.25, 0.5)
    (1.0, 2.75)

    """
    radius = turning_radius(geometry, d_left, d_right)
    theta = float(pose.theta)
    sine, cosine = math.sin(theta), math.cos(theta)
    if math.isinf(radius):
        return -math.copysign(math.inf, sine), math.copysign(math.inf, cosine)
    return float(pose.x) - radius * sine, float(pose.y) + radius * cosine
