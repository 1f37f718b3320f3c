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

"""Exact moments of the pose after an arc with a small turn; the equations: :mod:`.arc_moments`."""

import math
from typing import NamedTuple, Tuple

from diffdrive_kinematics.core.noise.heading_moments import GAUSSIAN
from diffdrive_kinematics.core.noise.pose_covariance import PoseCovariance
from diffdrive_kinematics.core.noise.pose_moments import PoseMoments


class _Rule(NamedTuple):
    """Gauss-Legendre quadrature over [0, 1], up to a turn + 4 V of ``reach``."""

    reach: float
    nodes: Tuple[Tuple[float, float], ...]  # (t, weight)
    exponential: Tuple[float, ...]  # of (e^z - 1) / z, the highest power first


def _exponential(terms: int) -> Tuple[float, ...]:
    return tuple(1.0 / math.factorial(n) for n in range(terms, 0, -1))


THIRD = math.sqrt(0.15)
RULES = (
    _Rule(0.005, ((0.5 - THIRD, 5 / 18), (0.5, 4 / 9), (0.5 + THIRD, 5 / 18)), _exponential(7)),
    _Rule(0.15, (
        (0.06943184420297371, 0.17392742256872693), (0.33000947820757187, 0.3260725774312731),
        (0.6699905217924281, 0.3260725774312731), (0.9305681557970263, 0.17392742256872693)),
        _exponential(9)),
    _Rule(0.4, (
        (0.04691007703066800, 0.11846344252809454), (0.23076534494715845, 0.23931433524968324),
        (0.5, 0.28444444444444444), (0.7692346550528415, 0.23931433524968324),
        (0.9530899229693320, 0.11846344252809454)), _exponential(12)))
REACH = RULES[-1].reach


def integrated_moments(
        distance: float, turn: float, slip: Tuple[float, float, float], *,
        swings: bool) -> PoseMoments:
    """
    Return the moments that an arc makes of a pose that is known, in the frame of its start.

    By Gauss-Legendre quadrature with 3 to 5 nodes, which keeps its digits whatever the arc.

    Parameters
    ----------
    distance : float
        Length s of the arc [m], negative in reverse.
    turn : float
        Change of the heading Delta [rad]; ``|Delta| + 4 V`` is up to ``REACH``.
    slip : tuple of float
        Q [m^2], C [m rad] and V [rad^2] of the arc.
    swings : bool
        Whether to find the swings; they are NaN otherwise.

    Returns
    -------
    PoseMoments
        Of its end.

    Examples
    --------
    On a straight the mean falls short by about ``V s / 4``:

    >>> moments = integrated_moments(20.0, 0.0, (0.0, 0.0, 0.01), swings=False)
    >>> round(moments.mean_error.real, 3)
    -0.05

    """
    q, c, v = slip
    reach = abs(turn) + 4.0 * v
    short, medium, long = RULES
    _, nodes, exponential = (
        short if reach <= short.reach else medium if reach <= medium.reach else long)
    xx = xy = xt = yy = yt = x_of_sin = x_of_cos = y_of_sin = y_of_cos = 0.0
    mean = 0j
    drive = complex(distance, 0.5 * c)
    rate: complex = complex(-0.5 * v, turn) if turn else -0.5 * v  # floats are faster
    end = math.exp(-0.5 * v)
    for t, weight in nodes:
        rest = 1.0 - t
        z = rate * rest
        power: complex = 0.0
        for coefficient in exponential:
            power = power * z + coefficient
        cosine, sine = math.cos(turn * t), math.sin(turn * t)
        left = complex(cosine, sine)
        rho = left * drive * (rest * power)
        loss = -math.expm1(-0.5 * v * t)
        damping = 1.0 - loss
        across, along = -rho.imag, rho.real
        with_x, with_y = c * cosine + v * across, c * sine + v * along
        node_xx = q * cosine * cosine + across * (c * cosine + with_x)
        node_yy = q * sine * sine + along * (c * sine + with_y)
        node_xy = cosine * (q * sine + c * along) + across * with_y
        sine_square = -0.5 * math.expm1(-2.0 * v * t)
        swung = (node_xx - node_yy) * sine_square
        xx += weight * (node_xx - swung)
        yy += weight * (node_yy + swung)
        xy += weight * node_xy * (1.0 - 2.0 * sine_square)
        xt += weight * with_x * damping
        yt += weight * with_y * damping
        mean += weight * left * complex(-distance * loss, 0.5 * c * damping)
        if swings:
            left_over = weight * end / damping
            with_x *= left_over
            with_y *= left_over
            x_of_sin += with_x * (1.0 - sine_square)
            x_of_cos += with_y * sine_square
            y_of_sin += with_y * (1.0 - sine_square)
            y_of_cos -= with_x * sine_square
    if not swings:
        x_of_sin = y_of_sin = x_of_cos = y_of_cos = math.nan
    return PoseMoments(
        PoseCovariance(xx, xy, xt, yy, yt, v), mean, complex(x_of_cos, x_of_sin),
        complex(y_of_cos, y_of_sin), GAUSSIAN)
