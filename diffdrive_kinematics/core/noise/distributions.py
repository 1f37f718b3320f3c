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
Distributions of noise (LaValle, Mobile Robotics, sec. 2.4), all of one variance.

====================  ============================================  ======================
name                  density of the unit draw                      bound of the unit draw
====================  ============================================  ======================
``gaussian``          normal                                        none
``truncated_gaussian``  normal within +-2 of its own sigma, rescaled  2.274
``triangular``        symmetric triangle about 0                    sqrt(6) = 2.449
``uniform``           constant                                      sqrt(3) = 1.732
====================  ============================================  ======================

Every draw has mean 0 and variance 1, so a law of variance keeps its meaning whatever the
distribution; the bound is what a nondeterministic disturbance set W(u) (2.34) is made of.  Sums
of independent draws tend to a Gaussian: a path of many steps shows the variance, not the shape.

numpy.random is named in quotes, since numpy imports it where it is first used.
"""

import math
from typing import Optional, Tuple, Union

from diffdrive_kinematics.core.kinematics import (
    check_finite, check_non_negative, Scalar, wrap_angle)
import numpy as np

DISTRIBUTIONS = ('gaussian', 'truncated_gaussian', 'triangular', 'uniform')

Shape = Union[int, Tuple[int, ...]]

CUT = 2.0
"""Where the truncated Gaussian is cut, in standard deviations of its parent."""

CUT_SIGMA = math.sqrt(1.0 - CUT * math.sqrt(2.0 / math.pi) * math.exp(-0.5 * CUT**2)
                      / math.erf(CUT / math.sqrt(2.0)))
"""Standard deviation of a unit normal cut at +-CUT: Var = 1 - 2 c phi(c) / (2 Phi(c) - 1)."""

BOUNDS = {
    'gaussian': math.inf, 'truncated_gaussian': CUT / CUT_SIGMA,
    'triangular': math.sqrt(6.0), 'uniform': math.sqrt(3.0)}


def check_distribution(name: str, distribution: str) -> str:
    """
    Return ``distribution``, or raise unless it is one of ``DISTRIBUTIONS``.

    Parameters
    ----------
    name : str
        What the user calls the value; the error names it.
    distribution : str
        Value to check.

    Returns
    -------
    str
        The value.

    Raises
    ------
    ValueError
        If ``distribution`` is none of ``DISTRIBUTIONS``.

    Examples
    --------
    >>> check_distribution('slip_distribution', 'uniform')
    'uniform'

    """
    if distribution not in DISTRIBUTIONS:
        raise ValueError(f"{name} is {distribution!r}, expected one of {', '.join(DISTRIBUTIONS)}")
    return distribution


def unit_bound(distribution: str) -> float:
    """
    Return the least upper bound of ``abs(draw_unit(distribution, ...))``.

    Parameters
    ----------
    distribution : str
        One of ``DISTRIBUTIONS``.

    Returns
    -------
    float
        Bound, in standard deviations; inf for ``gaussian``.

    Raises
    ------
    ValueError
        If ``distribution`` is none of ``DISTRIBUTIONS``.

    Examples
    --------
    >>> unit_bound('gaussian'), round(unit_bound('uniform'), 4)
    (inf, 1.7321)

    """
    return BOUNDS[check_distribution('distribution', distribution)]


def draw_unit(
        distribution: str, generator: 'np.random.Generator',
        shape: Optional[Shape] = None) -> Scalar:
    """
    Return independent draws of mean 0 and variance 1.

    Parameters
    ----------
    distribution : str
        One of ``DISTRIBUTIONS``.
    generator : numpy.random.Generator
        Source of randomness.  An array takes from it what its elements would one by one.
    shape : int or tuple of int, optional
        Shape of the array; a float is returned where it is None.

    Returns
    -------
    float or numpy.ndarray
        The draws.

    Raises
    ------
    ValueError
        If ``distribution`` is none of ``DISTRIBUTIONS``.

    Examples
    --------
    >>> draws = draw_unit('triangular', np.random.default_rng(1), 100000)
    >>> f'{draws.var():.1f}', bool(abs(draws).max() < unit_bound('triangular'))
    ('1.0', True)

    """
    bound = unit_bound(distribution)
    if distribution == 'gaussian':
        return generator.standard_normal(shape)
    if distribution == 'truncated_gaussian':
        return _draw_truncated(generator, shape)
    if distribution == 'triangular':
        return generator.triangular(-bound, 0.0, bound, shape)
    return generator.uniform(-bound, bound, shape)


def _draw_truncated(generator: 'np.random.Generator', shape: Optional[Shape]) -> Scalar:
    """Return normals by rejection of those beyond +-CUT, in the order of the stream."""
    if shape is None:
        return float(_draw_truncated(generator, 1)[0])  # type: ignore[index]
    missing = math.prod(shape) if isinstance(shape, tuple) else shape
    kept = [np.empty(0)]
    while missing:
        normals = generator.standard_normal(missing)
        kept.append(normals[np.abs(normals) <= CUT])
        missing -= len(kept[-1])
    return np.concatenate(kept).reshape(shape) / CUT_SIGMA


def sample_heading(
        mean: float, concentration: float, generator: 'np.random.Generator',
        shape: Optional[Shape] = None) -> Scalar:
    """
    Return headings with the von Mises density (LaValle, Mobile Robotics, eq. 2.38).

    ``p(theta) = exp(kappa cos(theta - mean)) / (2 pi I_0(kappa))``: uniform on the circle for
    kappa = 0, near a normal of variance 1 / kappa for large kappa.

    Parameters
    ----------
    mean : float
        Mean direction [rad].
    concentration : float
        Concentration kappa [1], 0 or above.
    generator : numpy.random.Generator
        Source of randomness.
    shape : int or tuple of int, optional
        Shape of the array; a float is returned where it is None.

    Returns
    -------
    float or numpy.ndarray
        Headings in (-pi, pi] [rad].

    Raises
    ------
    ValueError
        If the mean is not finite, or the concentration is not finite or below 0.

    Examples
    --------
    >>> headings = sample_heading(0.5, 100.0, np.random.default_rng(1), 100000)
    >>> f'{headings.mean():.2f} {headings.var():.2f}'
    '0.50 0.01'

    """
    centre = wrap_angle(check_finite('mean heading', mean))
    kappa = check_non_negative('concentration', concentration)
    return wrap_angle(generator.vonmises(centre, kappa, shape))
