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

"""What is known of a heading at the start: its moments, and those of its sine and cosine."""

import math
from typing import NamedTuple

from diffdrive_kinematics.core.kinematics import check_non_negative
import numpy as np


class HeadingMoments(NamedTuple):
    """
    Moments of an error phi of the heading whose density is even.

    What is small for a small phi is kept itself, so that no digits are lost.

    Parameters
    ----------
    variance : float
        ``E phi^2`` [rad^2].
    cosine_loss : float
        ``1 - E cos phi`` [1].
    sine_square : float
        ``E sin^2 phi`` [1].
    cosine_variance : float
        ``Var cos phi`` [1].
    swing : float
        ``E phi sin phi`` [rad].

    Examples
    --------
    >>> GAUSSIAN.sine_square
    0.0

    """

    variance: float
    cosine_loss: float
    sine_square: float
    cosine_variance: float
    swing: float


GAUSSIAN = HeadingMoments(0.0, 0.0, 0.0, 0.0, 0.0)
"""Of a start that is known, or Gaussian: then all is in the variance that is added to it."""


def von_mises_moments(concentration: float) -> HeadingMoments:
    """
    Return the moments of a von Mises heading about its mean direction.

    By Gauss-Legendre quadrature of ``exp(kappa cos t) / (2 pi I_0(kappa))`` over (-pi, pi] with
    the peak scaled to 1, as I_0 overflows from kappa = 714.

    Parameters
    ----------
    concentration : float
        Concentration kappa [1], 0 or above.

    Returns
    -------
    HeadingMoments
        Of the deviation wrapped to (-pi, pi].

    Raises
    ------
    ValueError
        If the concentration is not finite or below 0.

    Examples
    --------
    For kappa = 0 every heading is as likely as any other:

    >>> round(von_mises_moments(0.0).cosine_loss, 9)
    1.0

    """
    kappa = check_non_negative('concentration', concentration)
    nodes, weights = np.polynomial.legendre.leggauss(64)  # costs a process memory, once used
    end = min(math.pi, 14.0 / math.sqrt(kappa)) if kappa > 0.0 else math.pi
    angle = 0.5 * end * (nodes + 1.0)
    weight = weights * np.exp(-2.0 * kappa * np.sin(0.5 * angle)**2)
    total = weight.sum()
    loss = 2.0 * np.sin(0.5 * angle)**2
    mean_loss = weight @ loss / total
    return HeadingMoments(*(float(mean) for mean in (
        weight @ angle**2 / total, mean_loss, weight @ np.sin(angle)**2 / total,
        weight @ (loss - mean_loss)**2 / total, weight @ (angle * np.sin(angle)) / total)))


def heading_variance(concentration: float) -> float:
    """
    Return the variance of a von Mises heading about its mean direction.

    It is the linear variance of the deviation wrapped to (-pi, pi], the one a covariance of
    poses starts with, and not the circular variance 1 - I_1 / I_0 (Mardia & Jupp, Directional
    Statistics, sec. 3.5.4): pi^2 / 3 at kappa = 0, and tending to 1 / kappa.

    Parameters
    ----------
    concentration : float
        Concentration kappa [1], 0 or above.

    Returns
    -------
    float
        Variance [rad^2].

    Raises
    ------
    ValueError
        If the concentration is not finite or below 0.

    Examples
    --------
    >>> round(heading_variance(0.0), 6) == round(math.pi**2 / 3.0, 6)
    True
    >>> round(heading_variance(100.0), 4)
    0.0101

    """
    return von_mises_moments(concentration).variance
