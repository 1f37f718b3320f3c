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
Poses in the plane, SE(2): chains of frames, their inverses, and how fast a pose changes.

A pose is (x [m], y [m], theta [rad]) in a fixed frame, theta counter-clockwise from the x axis
(REP-103).  Its fields are floats, or numpy arrays that broadcast: N poses move in one call.
"""

import math
from typing import NamedTuple, Union

from diffdrive_kinematics.core.kinematics.angles import wrap_angle
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Scalar = Union[float, Array]


class Pose(NamedTuple):
    """
    Position and heading of a robot in a fixed frame; one pose, or arrays of poses.

    Parameters
    ----------
    x, y : float or numpy.ndarray
        Position [m].
    theta : float or numpy.ndarray
        Heading [rad], counter-clockwise from the x axis.

    Examples
    --------
    >>> Pose(1.0, 2.0, 0.5)._replace(theta=0.0)
    Pose(x=1.0, y=2.0, theta=0.0)

    """

    x: Scalar
    y: Scalar
    theta: Scalar


def compose(outer: Pose, inner: Pose) -> Pose:
    """
    Return the pose of frame C in A, from that of B in A and that of C in B.

    Parameters
    ----------
    outer : Pose
        Pose of B in A; floats.
    inner : Pose
        Pose of C in B; floats.

    Returns
    -------
    Pose
        Pose of C in A, theta in (-pi, pi].

    Examples
    --------
    One metre ahead of a robot that looks along y:

    >>> found = compose(Pose(1.0, 2.0, 0.5 * math.pi), Pose(1.0, 0.0, 0.0))
    >>> [round(value, 6) for value in found]
    [1.0, 3.0, 1.570796]

    """
    c, s = math.cos(outer.theta), math.sin(outer.theta)
    return Pose(outer.x + c * inner.x - s * inner.y, outer.y + s * inner.x + c * inner.y,
                wrap_angle(outer.theta + inner.theta))


def inverse(pose: Pose) -> Pose:
    """
    Return the pose of frame A in B, from that of B in A.

    Parameters
    ----------
    pose : Pose
        Pose of B in A; floats.

    Returns
    -------
    Pose
        Pose of A in B, theta in (-pi, pi].

    Examples
    --------
    >>> pose = Pose(1.0, 2.0, 0.5)
    >>> [abs(round(value, 9)) for value in compose(pose, inverse(pose))]
    [0.0, 0.0, 0.0]

    """
    c, s = math.cos(pose.theta), math.sin(pose.theta)
    return Pose(-c * pose.x - s * pose.y, s * pose.x - c * pose.y, wrap_angle(-pose.theta))


def between(start: Pose, end: Pose) -> Pose:
    """
    Return the pose of frame C in B, from those of B and of C in A.

    It is ``compose(inverse(start), end)``, from the difference of the positions, which keeps more
    digits where both are far away, and with the whole turn.

    Parameters
    ----------
    start : Pose
        Pose of B in A; floats.
    end : Pose
        Pose of C in A; floats.

    Returns
    -------
    Pose
        Pose of C in B.  The heading is not wrapped: more than a turn stays that.

    Examples
    --------
    What lies along y is ahead of a robot that looks along y:

    >>> found = between(Pose(1.0, 2.0, 0.5 * math.pi), Pose(1.0, 3.0, 0.5 * math.pi))
    >>> [abs(round(value, 9)) for value in found]
    [1.0, 0.0, 0.0]

    """
    dx, dy = end.x - start.x, end.y - start.y
    c, s = math.cos(start.theta), math.sin(start.theta)
    return Pose(c * dx + s * dy, c * dy - s * dx, end.theta - start.theta)


def pose_rate(pose: Pose, v: Scalar, w: Scalar) -> Pose:
    """
    Return how fast a pose changes: (v cos theta, v sin theta, w).

    The configuration transition equation of the differential drive (LaValle, Mobile Robotics,
    sec. 2.1; Planning Algorithms, eq. 13.14).

    Parameters
    ----------
    pose : Pose
        Pose of the robot; floats or arrays.
    v : float or numpy.ndarray
        Forward speed [m/s].
    w : float or numpy.ndarray
        Yaw rate [rad/s].

    Returns
    -------
    Pose
        (dx/dt [m/s], dy/dt [m/s], dtheta/dt [rad/s]).

    Examples
    --------
    >>> pose_rate(Pose(3.0, 1.0, 0.0), v=0.5, w=0.25)
    Pose(x=0.5, y=0.0, theta=0.25)

    """
    if isinstance(pose.theta, np.ndarray):
        return Pose(v * np.cos(pose.theta), v * np.sin(pose.theta), w)
    return Pose(v * math.cos(pose.theta), v * math.sin(pose.theta), w)
