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
Disturbances of any model's commands (LaValle 2.28 to 2.41): u + w is done where u was asked for.

The errors w of the commands are independent, each constant over a step.  Their standard
deviation grows with the command, ``absolute + relative |u|``.  With a bounded distribution they
lie in a box W(u) (2.34); with any they have a density p(w|u), of which sample paths are drawn.
"""

from dataclasses import dataclass
from typing import Sequence, Tuple

from diffdrive_kinematics.core.kinematics import check_count, check_non_negative
from diffdrive_kinematics.core.models.system import Vector
from diffdrive_kinematics.core.noise import check_distribution, draw_unit, unit_bound
import numpy as np

Step = Tuple[Vector, float]
"""A command, and the time [s] for which it is held."""


@dataclass(frozen=True)
class Disturbance:
    """
    Errors of the commands: standard deviations ``absolute + relative |u|``, one for each.

    Parameters
    ----------
    absolute, relative : tuple of float
        In the units of the commands, and as fractions of them; 0 or above.
    distribution : str
        One of ``distributions.DISTRIBUTIONS``.

    Raises
    ------
    ValueError
        If a deviation is below 0 or not finite, their numbers differ, or the distribution is
        none.

    Examples
    --------
    >>> errors = Disturbance((0.1, 0.0), (0.0, 0.2), 'triangular')
    >>> errors.deviations((1.0, 0.5))
    (0.1, 0.1)
    >>> [round(bound, 3) for bound in errors.bounds((1.0, 0.5))]
    [0.245, 0.245]

    """

    absolute: Tuple[float, ...]
    relative: Tuple[float, ...]
    distribution: str = 'gaussian'

    def __post_init__(self) -> None:
        check_distribution('distribution', self.distribution)
        if len(self.absolute) != len(self.relative):
            raise ValueError(
                f'absolute and relative are {self.absolute!r} and {self.relative!r}, expected '
                'one of each for every command')
        for value in (*self.absolute, *self.relative):
            check_non_negative('a deviation', value)

    def deviations(self, command: Vector) -> Vector:
        """
        Return the standard deviation of each error.

        Parameters
        ----------
        command : tuple of float or numpy.ndarray
            Command u that is asked for.

        Returns
        -------
        tuple of float or numpy.ndarray
            Standard deviations, in the units of the commands.

        Examples
        --------
        See :class:`Disturbance`.

        """
        return tuple(a + r * abs(u) for a, r, u in zip(  # type: ignore[operator]
            self.absolute, self.relative, command, strict=True))

    def bounds(self, command: Vector) -> Vector:
        """
        Return half the sides of the box W(u), ``inf`` where the distribution has no bound.

        Parameters
        ----------
        command : tuple of float or numpy.ndarray
            Command u that is asked for.

        Returns
        -------
        tuple of float or numpy.ndarray
            Bounds of the errors, in the units of the commands.

        Examples
        --------
        See :class:`Disturbance`.

        """
        bound = unit_bound(self.distribution)
        return tuple(bound * deviation if np.any(deviation) else 0.0
                     for deviation in self.deviations(command))


def bounded(
        absolute: Sequence[float], relative: Sequence[float] = (), *,
        distribution: str = 'uniform') -> Disturbance:
    """
    Return the disturbance of a box W(u) with sides of ``+-(absolute + relative |u|)``.

    Parameters
    ----------
    absolute : sequence of float
        Bounds in the units of the commands.
    relative : sequence of float
        Bounds as fractions of the commands; none: 0.
    distribution : str
        One of the bounded ``distributions.DISTRIBUTIONS``.

    Returns
    -------
    Disturbance
        Errors of these bounds.

    Raises
    ------
    ValueError
        If a bound is below 0 or the distribution has none.

    Examples
    --------
    >>> [round(float(bound), 9) for bound in bounded([0.1, 0.02]).bounds((1.0, 0.5))]
    [0.1, 0.02]

    """
    unit = unit_bound(distribution)
    if np.isinf(unit):
        raise ValueError(f'distribution is {distribution!r}, expected a bounded one')
    relative = relative or [0.0] * len(absolute)
    return Disturbance(tuple(value / unit for value in absolute),
                       tuple(value / unit for value in relative), distribution)


def disturbed(
        command: Vector, disturbance: Disturbance, *, n: int,
        generator: 'np.random.Generator') -> Vector:
    """
    Return n commands u + w, with w from p(w|u) (LaValle 2.36, 2.37).

    Parameters
    ----------
    command : tuple of float or numpy.ndarray
        Command u that is asked for.
    disturbance : Disturbance
        Of the commands.
    n : int
        Number of draws.
    generator : numpy.random.Generator
        Source of randomness.

    Returns
    -------
    tuple of numpy.ndarray
        Commands, an array of shape (n,) for each part.

    Raises
    ------
    ValueError
        If ``n`` is no integer, 1 or above.

    Examples
    --------
    >>> speed, steering = disturbed(
    ...     (1.0, 0.5), bounded([0.1, 0.0]), n=1000, generator=np.random.default_rng(1))
    >>> bool(abs(speed - 1.0).max() <= 0.1), bool((steering == 0.5).all())
    (True, True)

    """
    check_count('n', n)
    return tuple(
        u + deviation * draw_unit(disturbance.distribution, generator, n)
        for u, deviation in zip(command, disturbance.deviations(command)))
