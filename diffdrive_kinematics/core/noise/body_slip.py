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
Slip of the body, beside that of the wheels: what the robot as a whole gains and turns too much.

Along the way that a robot makes, its bias included, of length ds and turn dtheta,

    ``Var ds = k_d |ds|``  and  ``Var dtheta = k_t |dtheta| + k_x |ds|``,

white along the way and independent of each other and of the slip of the wheels.  Like theirs it
adds up over any parts of an arc.  It is the law of robots without encoders, of which only the
commands are known: their wheels, which have a servo each, do not slip alone.
"""

from dataclasses import dataclass
import math
from typing import NamedTuple, Tuple

from diffdrive_kinematics.core.kinematics import check_non_negative, Number, Scalar
from diffdrive_kinematics.core.noise.distributions import check_distribution
import numpy as np


@dataclass(frozen=True)
class BodySlip:
    """
    Slip of the body; what is given is truthy where there is any.

    Parameters
    ----------
    linear_variance : float
        Constant k_d [m]: variance of the travel of the centre per metre; 0 or above.
    turn_variance : float
        Constant k_t [rad]: variance of the heading per radian of turn; 0 or above.
    heading_variance : float
        Constant k_x [rad^2/m]: variance of the heading per metre; 0 or above.
    distribution : str
        One of ``DISTRIBUTIONS``, of the errors.

    Raises
    ------
    ValueError
        If a value is out of its range.

    Examples
    --------
    >>> bool(BodySlip(turn_variance=0.01)), bool(BodySlip())
    (True, False)

    """

    linear_variance: float = 0.0
    turn_variance: float = 0.0
    heading_variance: float = 0.0
    distribution: str = 'gaussian'

    def __post_init__(self) -> None:
        for name in ('linear', 'turn', 'heading'):
            check_non_negative(f'{name} slip variance', getattr(self, f'{name}_variance'))
        check_distribution('slip distribution', self.distribution)

    def __bool__(self) -> bool:
        return bool(self.linear_variance or self.turn_variance or self.heading_variance)


NO_BODY_SLIP = BodySlip()
"""The wheels alone slip."""


def body_variances(body: BodySlip, distance: Number, turn: Number) -> Tuple[Number, Number]:
    """
    Return the variances that the slip of the body adds along an arc.

    Parameters
    ----------
    body : BodySlip
        Slip of the body.
    distance : float or numpy.ndarray
        Length ds of the arc [m], negative in reverse.
    turn : float or numpy.ndarray
        Change dtheta of the heading [rad].

    Returns
    -------
    distance : float or numpy.ndarray
        Variance of the length [m^2].
    heading : float or numpy.ndarray
        Variance of the heading [rad^2].

    Examples
    --------
    >>> body_variances(BodySlip(0.25, turn_variance=0.5, heading_variance=0.125), -2.0, 1.0)
    (0.5, 0.75)

    """
    travelled: Number = abs(distance)
    turned: Number = abs(turn)
    return (body.linear_variance * travelled,
            body.turn_variance * turned + body.heading_variance * travelled)


class BodyNoise(NamedTuple):
    """
    Standard deviations of what the slip of the body adds to one step; floats, or one per pose.

    Parameters
    ----------
    distance : float or numpy.ndarray
        Of the travel of the centre [m].
    half_turn : float or numpy.ndarray
        Of half the turn [rad].
    lateral : float or numpy.ndarray
        Of the lateral displacement [m].
    distribution : str
        Of all three.

    Examples
    --------
    See :func:`body_noise`.

    """

    distance: Scalar
    half_turn: Scalar
    lateral: Scalar
    distribution: str


def body_noise(body: BodySlip, distance: Scalar, turn: Scalar) -> BodyNoise:
    """
    Return the standard deviations of the errors of one step.

    With Q and V of :func:`body_variances`, what cancels over the step displaces the robot
    sideways by ``(V ds^2 + Q dtheta^2) / 12``: an error of the heading swings what is left of the
    step, and one of the distance points along the heading where it is made.

    Parameters
    ----------
    body : BodySlip
        Slip of the body.
    distance : float or numpy.ndarray
        Length ds of the step [m].
    turn : float or numpy.ndarray
        Its turn dtheta [rad].

    Returns
    -------
    BodyNoise
        Of the step.

    Examples
    --------
    >>> body_noise(BodySlip(linear_variance=0.25), 1.0, 0.0)
    BodyNoise(distance=0.5, half_turn=0.0, lateral=0.0, distribution='gaussian')

    """
    along, heading = body_variances(body, distance, turn)  # type: ignore[type-var]
    lateral = (heading * distance * distance + along * turn * turn) / 12.0
    return BodyNoise(root(along), 0.5 * root(heading), root(lateral), body.distribution)


def root(variance: Scalar) -> Scalar:
    """
    Return the standard deviation of a variance.

    Parameters
    ----------
    variance : float or numpy.ndarray
        The variance, 0 or above.

    Returns
    -------
    float or numpy.ndarray
        Its root.

    Examples
    --------
    >>> root(0.25)
    0.5

    """
    return np.sqrt(variance) if isinstance(variance, np.ndarray) else math.sqrt(variance)
