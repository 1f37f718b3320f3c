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
Errors that last a run: what is the same from its start to its end, and differs between runs.

Tyres are warmer, the load is another, the floor is softer: no calibration of yesterday knows it.
Within a run it is no noise, as it does not average out.  Three numbers tell it: a scale of all
travel s, a separation that is larger by a fraction p, and a curvature c, a heading gained per
metre of travel.  Of a nominal distance ds and turn dtheta a session makes

    ``ds' = (1 + s) ds``,  ``dtheta' = (1 + s) (dtheta / (1 + p) + c ds)``,

whatever steps the path is cut into.  Bias and slip of the wheels come on top.
"""

from dataclasses import dataclass
from typing import NamedTuple, Optional, Tuple

from diffdrive_kinematics.core.kinematics import check_count, check_non_negative, Scalar
import numpy as np

LARGEST_FRACTION = 0.1
STREAM = (0,)  # of the session, beside that of the slip, which has no spawn key


def check_session_fraction(name: str, value: float) -> float:
    """
    Return the standard deviation of a fraction, or raise if it is none of a calibrated robot.

    Parameters
    ----------
    name : str
        What the user calls the value; the error names it.
    value : float
        Standard deviation [1].

    Returns
    -------
    float
        The value.

    Raises
    ------
    ValueError
        If it is not finite, below 0 or above 0.1.

    Examples
    --------
    >>> check_session_fraction('session_scale_stddev', 0.5)
    Traceback (most recent call last):
    ValueError: session_scale_stddev is 0.5, expected 0.1 or below

    """
    if check_non_negative(name, value) > LARGEST_FRACTION:
        raise ValueError(f'{name} is {value!r}, expected {LARGEST_FRACTION:g} or below')
    return float(value)


@dataclass(frozen=True)
class SessionSpread:
    """
    Standard deviations, between runs, of what lasts a run; all independent and Gaussian.

    Parameters
    ----------
    scale : float
        Of the scale s of all travel [1]; from 0 to 0.1.
    separation : float
        Of the fraction p of the separation [1]; from 0 to 0.1.
    curvature : float
        Of the heading gained per metre c [rad/m]; 0 or above.

    Raises
    ------
    ValueError
        If a value is out of its range.

    Examples
    --------
    >>> SessionSpread(scale=0.0005, separation=0.003, curvature=0.0015).separation
    0.003
    >>> bool(SessionSpread())
    False

    """

    scale: float = 0.0
    separation: float = 0.0
    curvature: float = 0.0

    def __post_init__(self) -> None:
        check_session_fraction('session scale stddev', self.scale)
        check_session_fraction('session separation stddev', self.separation)
        check_non_negative('session curvature stddev', self.curvature)

    def __bool__(self) -> bool:
        return bool(self.scale or self.separation or self.curvature)


NO_SESSION = SessionSpread()


class SessionError(NamedTuple):
    """
    What one run has, or each of many runs.

    Parameters
    ----------
    scale : float or numpy.ndarray
        Fraction s of all travel that is gained [1].
    separation : float or numpy.ndarray
        Fraction p by which the separation is larger [1].
    curvature : float or numpy.ndarray
        Heading gained per metre of travel c [rad/m].

    Examples
    --------
    >>> SessionError(scale=0.01, separation=0.0, curvature=0.0).scale
    0.01

    """

    scale: Scalar
    separation: Scalar
    curvature: Scalar


def session_generator(*seed: int) -> 'np.random.Generator':
    """
    Return the source of a session's randomness: drawing from it leaves the slip as it is.

    Parameters
    ----------
    *seed : int
        Seed of the run, one number or several, 0 or above.

    Returns
    -------
    numpy.random.Generator
        Its stream is another one than that of ``numpy.random.default_rng(seed)``.

    Examples
    --------
    >>> session_generator(7).random() == np.random.default_rng(7).random()
    False

    """
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=STREAM))


def draw_session(
        spread: SessionSpread, generator: 'np.random.Generator', runs: Optional[int] = None
) -> SessionError:
    """
    Return what a run has, or each of many runs.

    Parameters
    ----------
    spread : SessionSpread
        Standard deviations.
    generator : numpy.random.Generator
        Source of randomness.  Three normals are drawn for each run, whatever the spread, so that
        twice the spread is twice the error.
    runs : int or None
        Number of runs; None: one, as floats.

    Returns
    -------
    SessionError
        Floats, or arrays of shape (runs,).

    Raises
    ------
    ValueError
        If ``runs`` is no integer, 1 or above.

    Examples
    --------
    >>> error = draw_session(SessionSpread(scale=0.01), np.random.default_rng(1), runs=100000)
    >>> f'{error.scale.std():.3f} {error.curvature.std():.3f}'
    '0.010 0.000'

    """
    if runs is not None:
        check_count('runs', runs)
    drawn = generator.standard_normal(3 if runs is None else (3, runs))
    scale, separation, curvature = (
        stddev * unit for stddev, unit in zip(
            (spread.scale, spread.separation, spread.curvature),
            drawn.tolist() if runs is None else drawn))
    return SessionError(scale, separation, curvature)


def travel_in_session(
        error: SessionError, separation: float, d_left: Scalar, d_right: Scalar
) -> Tuple[Scalar, Scalar]:
    """
    Return the travel that a session makes of a nominal travel; of rates likewise.

    Parameters
    ----------
    error : SessionError
        Of the run; arrays go with arrays of travel.
    separation : float
        Nominal distance L of the wheels [m].
    d_left, d_right : float or numpy.ndarray
        Nominal travel [m] of the wheels.

    Returns
    -------
    d_left : float or numpy.ndarray
        Travel of the left wheel in this session [m].
    d_right : float or numpy.ndarray
        Travel of the right wheel in this session [m].

    Examples
    --------
    A curvature of 0.5 rad per metre, of wheels that are 0.5 m apart:

    >>> travel_in_session(SessionError(0.0, 0.0, 0.5), 0.5, 1.0, 1.0)
    (0.875, 1.125)

    """
    scale, wider, curvature = error
    distance = 0.5 * (d_left + d_right)
    half = 0.5 * ((d_right - d_left) / (1.0 + wider) + separation * curvature * distance)
    return (1.0 + scale) * (distance - half), (1.0 + scale) * (distance + half)
