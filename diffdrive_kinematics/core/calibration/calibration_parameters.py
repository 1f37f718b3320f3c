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
What a calibration finds of a drive, and how far an estimate may be off.

A standard error that comes from few runs is multiplied by Student's t.
"""

import math
from typing import Dict, NamedTuple


class CalibrationParameters(NamedTuple):
    """
    What is systematic about one drive.

    Parameters
    ----------
    left, right, separation : float
        Factors on both radii and the separation [1].
    x, y : float
        Position of the reference's frame on the robot [m].
    yaw : float
        Its heading on the robot [rad].
    offset : float
        Part of ``reference stamp = wheel stamp + offset + drift (stamp - middle of the
        drive)`` [s].  A delay with which commands are followed is an offset.
    drift : float
        Rate of the two clocks against each other [s/s].

    Examples
    --------
    >>> CalibrationParameters(separation=1.02).left
    1.0

    """

    left: float = 1.0
    right: float = 1.0
    separation: float = 1.0
    x: float = 0.0
    y: float = 0.0
    yaw: float = 0.0
    offset: float = 0.0
    drift: float = 0.0


FIELDS = CalibrationParameters._fields
WHEELS = ('left', 'right', 'separation')
FRAME = ('x', 'y', 'yaw')
NAMES: Dict[str, str] = {
    'left': 'left_wheel_radius_multiplier', 'right': 'right_wheel_radius_multiplier',
    'separation': 'wheel_separation_multiplier',
    'x': 'frame_x', 'y': 'frame_y', 'yaw': 'frame_yaw', 'offset': 'offset', 'drift': 'drift'}
"""What the user calls a field."""


class Estimate(NamedTuple):
    """
    An estimated value with its standard error.

    Parameters
    ----------
    value : float
        What was estimated, or given.
    error : float
        Its standard error, in the same unit; 0 where the value was given.

    Examples
    --------
    >>> f'{Estimate(0.2013, 0.0004).value:.3f} m'
    '0.201 m'

    """

    value: float
    error: float


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
