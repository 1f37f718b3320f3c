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

"""Student's t: how far an estimate may be off whose standard error comes from few runs."""

import math


def share_within(t: float, degrees: int) -> float:
    """
    Return the probability that Student's t is within +-t.

    Parameters
    ----------
    t : float
        Number of standard errors, not negative.
    degrees : int
        Degrees of freedom, at least 1.

    Returns
    -------
    float
        The probability, by the finite sums for whole degrees of freedom (Abramowitz & Stegun,
        Handbook of Mathematical Functions, 26.7.3 and 26.7.4).

    Examples
    --------
    >>> f'{share_within(1.0, 1):.4f} {share_within(1.0, 4):.4f}'
    '0.5000 0.6261'

    """
    angle = math.atan(t / math.sqrt(degrees))
    cosine, first = math.cos(angle), degrees % 2
    term = total = (cosine if degrees > 1 else 0.0) if first else 1.0
    for n in range(2 + first, degrees, 2):
        term *= (n - 1) / n * cosine**2
        total += term
    total *= math.sin(angle)
    return 2.0 / math.pi * (angle + total) if first else total


def student_quantile(share: float, degrees: int) -> float:
    """
    Return the t that Student's t is within +- of with a probability.

    Parameters
    ----------
    share : float
        The probability, above 0 and below 1.
    degrees : int
        Degrees of freedom, at least 1.

    Returns
    -------
    float
        Number of standard errors.

    Examples
    --------
    >>> f'{student_quantile(0.95, 4):.3f} {student_quantile(0.95, 1000):.3f}'
    '2.776 1.962'

    """
    low, high = 0.0, 0.5 * math.pi  # of the angle, as t has no bound
    for _ in range(60):
        middle = 0.5 * (low + high)
        if share_within(math.sqrt(degrees) * math.tan(middle), degrees) < share:
            low = middle
        else:
            high = middle
    return math.sqrt(degrees) * math.tan(low)
