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
Maximum likelihood of slip constants, from windows of wheel travel between reference poses.

The covariance of a window's error (:mod:`.slip_window`) is linear in the slip constants and the
variances of the reference, which are fitted as variance components (:mod:`.variance_components`).
Windows count as independent: they must not overlap, and noise at a shared end counts twice.
"""

import math
from typing import Optional, Sequence, Tuple

from diffdrive_kinematics.core.calibration.estimate import Estimate
from diffdrive_kinematics.core.calibration.slip_result import NO_NOISE, ReferenceNoise, SlipFit
from diffdrive_kinematics.core.calibration.slip_window import SlipWindow
from diffdrive_kinematics.core.calibration.variance_components import (
    Components, fit_components, likelihood)
from diffdrive_kinematics.core.kinematics import check_non_negative
import numpy as np
from numpy.typing import NDArray

__all__ = ['Estimate', 'fit_reference_noise', 'fit_slip', 'nees_per_dof']

Array = NDArray[np.float64]

FEWEST_WINDOWS = 5


def fit_slip(
        windows: Sequence[SlipWindow], *, equal: bool = True,
        noise: Optional[ReferenceNoise] = None) -> SlipFit:
    """
    Return the slip constants of the greatest likelihood, with standard errors.

    Errors are those of the observed information (the curvature of the log likelihood), or of
    the expected one where an estimate lies on its bound, 0.  They hold for independent windows.

    Parameters
    ----------
    windows : sequence of SlipWindow
        At least 5 that do not overlap; without ``noise``, of different lengths, as the noise of
        the reference shows in short windows and slip in long ones.
    equal : bool
        Fit one k for both wheels instead of one each.
    noise : ReferenceNoise, optional
        Noise of the reference where it is known; fitted as well where it is not.

    Returns
    -------
    SlipFit
        Slip constants and noise with their errors.

    Raises
    ------
    ValueError
        If there are too few windows, a number is not finite, there are no errors, or the
        windows cannot tell the parameters from one another.

    Examples
    --------
    From 400 simulated metres with k = 1e-4 m of both wheels:

    >>> from diffdrive_kinematics.core.calibration import slip_window
    >>> from diffdrive_kinematics.core.kinematics import Pose, WheelGeometry
    >>> from diffdrive_kinematics.core.noise import propagate, WheelSlip
    >>> geometry, slip = WheelGeometry(0.5, 0.125), WheelSlip(variance=1e-4)
    >>> ends = propagate(Pose(*np.zeros((3, 400))), 1.0, 1.0, geometry, slip, slip, seed=1)
    >>> k = fit_slip([slip_window(geometry, [[1.0, 1.0]], Pose(0.0, 0.0, 0.0), Pose(*end))
    ...               for end in zip(*ends)], noise=NO_NOISE).k_left
    >>> abs(k.value - 1e-4) < 3.0 * k.error < 0.2e-4
    True

    """
    stack = _stacked(windows)
    slip = [stack.left + stack.right] if equal else [stack.left, stack.right]
    if noise is None:
        given, parts = np.zeros_like(stack.left), [*slip, stack.position, stack.heading]
    else:
        given, parts = _noise_covariance(stack, noise), slip
    fit = fit_components(stack.error, np.stack(parts), given)
    k_left = Estimate(fit.values[0], fit.errors[0])
    k_right = k_left if equal else Estimate(fit.values[1], fit.errors[1])
    position, heading = _sigmas(fit, len(slip), noise)
    return SlipFit(
        k_left, k_right, position, heading, fit.log_likelihood, fit.nees, len(windows))


def fit_reference_noise(
        windows: Sequence[SlipWindow], k_left: float, k_right: float) -> SlipFit:
    """
    Return the reference's noise of the greatest likelihood, for known slip constants.

    For the reference of another session: best from short windows, in which slip is small.

    Parameters
    ----------
    windows : sequence of SlipWindow
        At least 5 that do not overlap.
    k_left, k_right : float
        Slip variance per metre of travel [m].

    Returns
    -------
    SlipFit
        Noise with its errors; the slip constants are those given, with errors of 0.

    Raises
    ------
    ValueError
        As :func:`fit_slip`; if a slip constant is not finite or below 0.

    Examples
    --------
    Both ends of a window carry the noise, here of 5 mm and 10 mrad:

    >>> from diffdrive_kinematics.core.calibration import slip_window
    >>> from diffdrive_kinematics.core.kinematics import Pose, WheelGeometry
    >>> errors = 2.0**0.5 * np.random.default_rng(1).normal(0.0, [0.005, 0.005, 0.01], (400, 3))
    >>> windows = [slip_window(WheelGeometry(0.5, 0.125), [[0.01, 0.01]], Pose(0.0, 0.0, 0.0),
    ...                        Pose(0.01 + x, y, theta)) for x, y, theta in errors]
    >>> f'{fit_reference_noise(windows, 1e-6, 1e-6).sigma_position.value:.3f} m'
    '0.005 m'

    """
    stack = _stacked(windows)
    given = _slip_covariance(stack, k_left, k_right)
    fit = fit_components(stack.error, np.stack([stack.position, stack.heading]), given)
    position, heading = _sigmas(fit, 0, None)
    return SlipFit(
        Estimate(k_left, 0.0), Estimate(k_right, 0.0), position, heading, fit.log_likelihood,
        fit.nees, len(windows))


def nees_per_dof(
        windows: Sequence[SlipWindow], k_left: float, k_right: float,
        noise: ReferenceNoise = NO_NOISE) -> Array:
    """
    Return ``e^T P^-1 e / 3`` of each window; its mean is 1 if the model holds.

    The normalised error squared of Bar-Shalom, Li & Kirubarajan (2001, sec. 5.4.2), for slip
    constants and a noise of the reference that may come from other windows.

    Parameters
    ----------
    windows : sequence of SlipWindow
        At least one.
    k_left, k_right : float
        Slip variance per metre of travel [m].
    noise : ReferenceNoise
        Noise of the reference.

    Returns
    -------
    numpy.ndarray, shape (n,)
        One value for each window [1].

    Raises
    ------
    ValueError
        If a constant is not finite or below 0, or the covariance of a window is singular.

    Examples
    --------
    >>> from diffdrive_kinematics.core.calibration import slip_window
    >>> from diffdrive_kinematics.core.kinematics import Pose, WheelGeometry
    >>> window = slip_window(WheelGeometry(0.5, 0.125), [[1.0, 1.0]],
    ...                      Pose(0.0, 0.0, 0.0), Pose(1.0, 0.0, 0.03))
    >>> nees_per_dof([window], k_left=1e-4, k_right=1e-4).round(3)
    array([1.5])

    """
    stack = _stacked(windows, fewest=1)
    covariance = _slip_covariance(stack, k_left, k_right) + _noise_covariance(stack, noise)
    _, quadratic = likelihood(stack.error, covariance)
    return quadratic / 3.0


def _stacked(windows: Sequence[SlipWindow], fewest: int = FEWEST_WINDOWS) -> SlipWindow:
    """Return the windows as one, whose arrays have a leading axis."""
    if len(windows) < fewest:
        raise ValueError(f'there are {len(windows)} windows, expected at least {fewest}')
    stack = SlipWindow(*(np.stack([getattr(window, name) for window in windows])
                         for name in SlipWindow.__dataclass_fields__))
    for name in SlipWindow.__dataclass_fields__:
        if not np.isfinite(getattr(stack, name)).all():
            raise ValueError(f'a window has a {name} that is not finite, expected finite numbers')
    return stack


def _slip_covariance(stack: SlipWindow, k_left: float, k_right: float) -> Array:
    return (check_non_negative('k_left', k_left) * stack.left
            + check_non_negative('k_right', k_right) * stack.right)


def _noise_covariance(stack: SlipWindow, noise: ReferenceNoise) -> Array:
    return (check_non_negative('sigma_position', noise.sigma_position)**2 * stack.position
            + check_non_negative('sigma_heading', noise.sigma_heading)**2 * stack.heading)


def _sigmas(
        fit: Components, first: int, noise: Optional[ReferenceNoise]
) -> Tuple[Estimate, Estimate]:
    """Return standard deviations of the noise; errors by ``d sigma = d variance / (2 sigma)``."""
    if noise is not None:
        return Estimate(noise.sigma_position, 0.0), Estimate(noise.sigma_heading, 0.0)
    position, heading = (
        Estimate(math.sqrt(variance), 0.5 * error / math.sqrt(variance) if variance
                 else math.sqrt(error))
        for variance, error in zip(fit.values[first:], fit.errors[first:]))
    return position, heading
