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
Bias and slip of a wheel.

Over an interval in which the wheel should travel d the floor feels ``(1 + b) d + e``.  Two laws
for the random part e are known here:

``travel`` (default)
    ``Var e = k |d|``: slip is gathered along the way (Siegwart & Nourbakhsh, sec. 5.2.4; Chong &
    Kleeman 1997).  Independent increments add, so the statistics of a path do not depend on how
    many messages it is cut into.
``command``
    ``sigma of the rate = s |rate|``: noise in proportion to the command, drawn once an interval
    (LaValle, Mobile Robotics, eq. 2.37).  Then ``Var e = s^2 d^2`` per interval, and a path that
    is cut into n intervals has 1/n of the variance: the statistics depend on the message rate.

The variance does not depend on the distribution that e is drawn from (LaValle, sec. 2.4).
Variance and sampling are separate functions that share the law.
"""

from dataclasses import dataclass
import math

from diffdrive_kinematics.core.kinematics import check_above, check_non_negative, Scalar
from diffdrive_kinematics.core.noise.distributions import check_distribution, draw_unit
import numpy as np

SLIP_MODELS = ('travel', 'command')


@dataclass(frozen=True)
class WheelSlip:
    """
    Bias and slip of one wheel.

    Parameters
    ----------
    bias : float
        Fraction b of the travel that is gained (lost where negative) [1]; above -1.
    variance : float
        Constant k [m] of the law ``travel``, or s^2 [1] of the law ``command``; 0 or above.
    model : str
        One of ``SLIP_MODELS``.
    distribution : str
        One of ``DISTRIBUTIONS``, of the random part e.

    Raises
    ------
    ValueError
        If a value is out of its range.

    Examples
    --------
    A wheel that covers 1 % less than it should, give or take 1 mm on the first metre:

    >>> slip = WheelSlip(bias=-0.01, variance=1e-6)
    >>> f'{math.sqrt(travel_variance(slip, 1.0)):.3f} m'
    '0.001 m'

    """

    bias: float = 0.0
    variance: float = 0.0
    model: str = 'travel'
    distribution: str = 'gaussian'

    def __post_init__(self) -> None:
        check_above('bias', self.bias, -1.0)
        check_non_negative('slip variance', self.variance)
        check_slip_model('slip model', self.model)
        check_distribution('slip distribution', self.distribution)


def check_slip_model(name: str, model: str) -> str:
    """
    Return ``model``, or raise unless it is one of ``SLIP_MODELS``.

    Parameters
    ----------
    name : str
        What the user calls the value; the error names it.
    model : str
        Name of the law of the slip.

    Returns
    -------
    str
        The model.

    Raises
    ------
    ValueError
        If ``model`` is none of ``SLIP_MODELS``.

    Examples
    --------
    >>> check_slip_model('slip_model', 'time')
    Traceback (most recent call last):
    ValueError: slip_model is 'time', expected 'travel' or 'command'

    """
    if model not in SLIP_MODELS:
        raise ValueError(f"{name} is {model!r}, expected {' or '.join(map(repr, SLIP_MODELS))}")
    return model


def travel_variance(slip: WheelSlip, travel: Scalar) -> Scalar:
    """
    Return the variance of the random part of a wheel's travel over one interval.

    ``Var e = k |d|`` for the law ``travel`` (Siegwart & Nourbakhsh, sec. 5.2.4), ``s^2 d^2`` for
    the law ``command`` (LaValle, Mobile Robotics, eq. 2.37).

    Parameters
    ----------
    slip : WheelSlip
        Bias and slip of the wheel.
    travel : float or numpy.ndarray
        Nominal travel d [m] of the interval.

    Returns
    -------
    float or numpy.ndarray
        Variance Var e [m^2].

    Examples
    --------
    >>> travel_variance(WheelSlip(variance=1e-6), 4.0)  # 2 mm after 4 m
    4e-06

    """
    distance = np.abs(travel) if isinstance(travel, np.ndarray) else abs(travel)
    return slip.variance * distance * (1.0 if slip.model == 'travel' else distance)


def sample_travel(slip: WheelSlip, travel: Scalar, generator: 'np.random.Generator') -> Scalar:
    """
    Return a sample of the effective travel of a wheel, ``(1 + b) d + e``.

    Parameters
    ----------
    slip : WheelSlip
        Bias and slip of the wheel.
    travel : float or numpy.ndarray
        Nominal travel d [m] of each interval.
    generator : numpy.random.Generator
        Source of randomness.  One unit draw is made for each element, also where the travel is
        0, so that the stream of the generator does not depend on the values.

    Returns
    -------
    float or numpy.ndarray
        Effective travel [m].

    Examples
    --------
    >>> generator = np.random.default_rng(1)
    >>> sample_travel(WheelSlip(bias=0.5), 2.0, generator)
    3.0
    >>> f'{sample_travel(WheelSlip(variance=0.04), np.ones(100000), generator).std():.1f} m'
    '0.2 m'

    """
    mean = (1.0 + slip.bias) * travel
    variance = travel_variance(slip, travel)
    if isinstance(travel, np.ndarray):
        return mean + np.sqrt(variance) * draw_unit(slip.distribution, generator, travel.shape)
    return mean + math.sqrt(variance) * draw_unit(slip.distribution, generator)


def effective_ratio(
        slip: WheelSlip, nominal: float, effective: float, of_body: float = 0.0) -> float:
    """
    Return effective over nominal travel of an interval, ``1 + b`` where nothing moved.

    The ratio also counts as unknown where the interval is so short that the slip's standard
    deviation is more than half the travel (two messages in quick succession): a single such
    sample would give a rate of many times the command.

    Parameters
    ----------
    slip : WheelSlip
        Bias and slip of the wheel.
    nominal : float
        Travel that the wheel should have made [m].
    effective : float
        Travel that it made [m].
    of_body : float
        What the slip of the body adds to the variance of that [m^2].

    Returns
    -------
    float
        Ratio [1] for the velocity that goes with the interval.

    Examples
    --------
    >>> slip = WheelSlip(bias=0.25, variance=1e-6)
    >>> effective_ratio(slip, nominal=0.5, effective=0.75), effective_ratio(slip, 0.0, 0.0)
    (1.5, 1.25)

    """
    if travel_variance(slip, nominal) + of_body >= 0.25 * nominal * nominal:
        return 1.0 + slip.bias
    return effective / nominal
