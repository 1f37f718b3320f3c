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
What the systematic errors of odometry do to the end of a square, to first order, and back.

Borenstein & Feng 1996, IEEE Trans. Robotics and Automation 12(6):

====================  =======  ==============================================================
symbol                unit     meaning
====================  =======  ==============================================================
``s``, ``b``          m        side of the square, wheel separation that odometry believes in
``x``, ``y``          m        centre of gravity of the return errors, clockwise (cw) and not
``alpha``, ``beta``   rad      too little turned at each corner, turned left along each side
``E_b``               1        true wheel separation over b
``E_d``               1        right wheel over left wheel, each as true over believed diameter
====================  =======  ==============================================================

To first order in alpha and beta, with turns on the spot,

``x_cw = -2 s (alpha + beta)``, ``y_cw = -2 s (alpha + beta)``,
``x_ccw = -2 s (alpha - beta)``, ``y_ccw = 2 s (alpha - beta)``,

so that x and y each give both angles; the two are averaged.  Corners may be quarter circles of
radius r as well: with the start r behind a corner, y has s - 2 r in place of s, so that the mean
has s - r, and beta is the turn along a quarter of the way, ``p = s - 2 r + pi r / 2``.
"""

import math
from typing import NamedTuple, Tuple

from diffdrive_kinematics.core.calibration.calibration_parameters import Estimate
from diffdrive_kinematics.core.commands import QUARTER
from diffdrive_kinematics.core.kinematics import Array

LARGEST_ANGLE = 0.3
"""Of alpha and beta [rad]: the first-order formulas say nothing beyond."""
LARGEST_U = 1.0 / 3.0
"""Of the share by which a wheel departs from the mean: E_d from 1/2 to 2."""


class SquareAngles(NamedTuple):
    """
    The angles by which a square is off.

    Parameters
    ----------
    alpha : Estimate
        Too little turned at each corner [rad].
    beta : Estimate
        Turned to the left along each side [rad].
    covariance : float
        Covariance of the errors of both [rad^2].

    Examples
    --------
    See :func:`angles_of_runs`.

    """

    alpha: Estimate
    beta: Estimate
    covariance: float


def angles_of_runs(
        side: float, corner_radius: float, clockwise: Array, counterclockwise: Array
) -> SquareAngles:
    """
    Return alpha and beta, the means of their x and y forms.

    They are sum and difference of one mean of each direction, of ``x + y`` and of ``x - y``
    (Borenstein & Feng 1996; see the head of this module).

    Parameters
    ----------
    side, corner_radius : float
        Side of the square and radius of its corners [m].
    clockwise, counterclockwise : numpy.ndarray, shape (n, 2)
        Return errors (x, y) [m], at least 2 runs each.

    Returns
    -------
    SquareAngles
        Both angles with their errors.

    Raises
    ------
    ValueError
        If an angle is larger than the first order can tell.

    Examples
    --------
    A robot that turns too little, seen from both sides:

    >>> import numpy as np
    >>> angles = angles_of_runs(
    ...     4.0, 0.0, np.array(2 * [[-0.16, -0.16]]), np.array(2 * [[-0.16, 0.16]]))
    >>> round(angles.alpha.value, 6), abs(round(angles.beta.value, 6))
    (0.02, 0.0)

    """
    scale = -1.0 / (8.0 * (side - corner_radius))
    cw, ccw = scale * (clockwise @ [1.0, 1.0]), scale * (counterclockwise @ [1.0, -1.0])
    alpha, beta = float(cw.mean() + ccw.mean()), float(cw.mean() - ccw.mean())
    for name, angle in (('alpha', alpha), ('beta', beta)):
        if not abs(angle) <= LARGEST_ANGLE:
            raise ValueError(
                f'{name} is {angle!r} rad, expected within +-{LARGEST_ANGLE} rad: the return '
                'errors are too large for first-order formulas, measure the robot by hand or '
                'drive a smaller square first')
    squares = float(((cw - cw.mean())**2).sum() + ((ccw - ccw.mean())**2).sum())
    pooled = squares / (len(cw) + len(ccw) - 2)
    error = math.sqrt(pooled / len(cw) + pooled / len(ccw))
    return SquareAngles(
        Estimate(alpha, error), Estimate(beta, error), pooled / len(cw) - pooled / len(ccw))


def ratios_of_angles(
        side: float, corner_radius: float, separation: float, angles: SquareAngles
) -> Tuple[Estimate, Estimate]:
    """
    Return E_b and E_d, with errors to first order in those of alpha and beta.

    ``E_b = (pi/2) / (pi/2 - alpha)``; ``E_d = (rho + E_b b/2) / (rho - E_b b/2)``, where
    ``rho = (p/2) / sin(beta/2)`` is the radius of the arc that the robot makes of a side:
    ``E_d = (1 + u) / (1 - u)`` with ``u = E_b b / (2 rho)`` (Borenstein & Feng 1996).

    Parameters
    ----------
    side, corner_radius : float
        Side of the square and radius of its corners [m].
    separation : float
        Wheel separation b that odometry believes in [m].
    angles : SquareAngles
        Angles of the runs.

    Returns
    -------
    e_b : Estimate
        True wheel separation over the one believed in [1].
    e_d : Estimate
        Right wheel over left wheel, each as true over believed diameter [1].

    Raises
    ------
    ValueError
        If E_d is not from 0.5 to 2: no wheels are that different.

    Examples
    --------
    >>> angles = SquareAngles(Estimate(0.02, 0.001), Estimate(0.0, 0.001), covariance=0.0)
    >>> e_b, e_d = ratios_of_angles(4.0, 0.0, 0.5, angles)
    >>> f'{e_b.value:.4f} {e_d.value:.4f}'
    '1.0129 1.0000'

    """
    alpha, beta, covariance = angles
    way = side - 2.0 * corner_radius + QUARTER * corner_radius
    e_b = QUARTER / (QUARTER - alpha.value)
    lean = e_b * separation / way
    u = lean * math.sin(0.5 * beta.value)
    e_d = (1.0 + u) / (1.0 - u) if u < 1.0 else math.inf
    if not abs(u) <= LARGEST_U:
        raise ValueError(
            f'E_d is {e_d!r}, expected from 0.5 to 2: a square of {4.0 * way!r} m is too short '
            f'to distinguish wheels {separation!r} m apart, drive a larger one')
    by_alpha = 2.0 / (1.0 - u)**2 * u * e_b / QUARTER
    by_beta = 2.0 / (1.0 - u)**2 * 0.5 * lean * math.cos(0.5 * beta.value)
    variance = ((by_alpha * alpha.error)**2 + (by_beta * beta.error)**2
                + 2.0 * by_alpha * by_beta * covariance)
    return (Estimate(e_b, e_b**2 / QUARTER * alpha.error),
            Estimate(e_d, math.sqrt(max(variance, 0.0))))
