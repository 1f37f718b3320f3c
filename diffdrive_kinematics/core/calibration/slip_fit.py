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
Windows count as independent: those that overlap need weights, and noise at a shared end counts
twice.
"""

import math
from typing import List, Optional, Sequence

from diffdrive_kinematics.core.calibration.calibration_parameters import Estimate
from diffdrive_kinematics.core.calibration.slip_result import NOTHING, ReferenceNoise, SlipFit
from diffdrive_kinematics.core.calibration.slip_stack import (
    noise_covariance, slip_covariance, slip_parts, stacked_windows)
from diffdrive_kinematics.core.calibration.slip_window import SlipWindow
from diffdrive_kinematics.core.calibration.variance_components import Components, fit_components
from diffdrive_kinematics.core.calibration.window_weights import least_noise
from diffdrive_kinematics.core.kinematics import Array
from diffdrive_kinematics.core.noise import BodySlip, NO_BODY_SLIP
import numpy as np
from numpy.typing import ArrayLike

FEWEST_WINDOWS = 5
FINEST = 1e-8
"""Least variance of a reference's position [m^2] and heading [rad^2]: 0.1 mm and 0.1 mrad."""
SHARE = 0.1
"""Share of the noise that a calibration assumes at least: more of it would take slip away."""


def fit_slip(
        windows: Sequence[SlipWindow], *, equal: bool = True,
        noise: Optional[ReferenceNoise] = None, terms: Sequence[str] = ('wheels',),
        weights: Optional[ArrayLike] = None) -> SlipFit:
    """
    Return the slip constants of the greatest likelihood, with standard errors.

    Errors are those of the observed information (the curvature of the log likelihood), or of
    the expected one where an estimate lies on its bound.  They hold for independent windows.

    Parameters
    ----------
    windows : sequence of SlipWindow
        At least 5 that do not overlap; without ``noise``, of different lengths, as the noise of
        the reference shows in short windows and slip in long ones.
    equal : bool
        Fit one k for both wheels instead of one each.
    noise : ReferenceNoise, optional
        Noise of the reference where it is known; fitted as well where it is not, with a floor
        (a hundredth of the variance of short windows; 0.1 mm and 0.1 mrad), as no reference is
        perfect.
    terms : sequence of str
        What slip is made of: some of ``SLIP_TERMS``, in their order.
    weights : array_like, shape (n,), optional
        How many windows each one counts as: below 1 for windows that overlap.

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

    >>> from diffdrive_kinematics.core.calibration import NO_NOISE, slip_window
    >>> from diffdrive_kinematics.core.kinematics import Pose, WheelGeometry
    >>> from diffdrive_kinematics.core.noise import propagate, WheelSlip
    >>> geometry, slip = WheelGeometry(0.5, 0.125), WheelSlip(variance=1e-4)
    >>> ends = propagate(Pose(*np.zeros((3, 400))), 1.0, 1.0, geometry, slip, slip, seed=1)
    >>> k = fit_slip([slip_window(geometry, [[1.0, 1.0]], Pose(0.0, 0.0, 0.0), Pose(*end))
    ...               for end in zip(*ends)], noise=NO_NOISE).k_left
    >>> abs(k.value - 1e-4) < 3.0 * k.error < 0.2e-4
    True

    """
    stack = stacked_windows(windows, FEWEST_WINDOWS)
    counts = None if weights is None else np.asarray(weights, dtype=np.float64)
    slip = slip_parts(stack, terms, equal=equal)
    if noise is None:
        fit = fit_components(
            stack.error, np.stack([*slip, *_noise_parts(stack)]),
            np.zeros_like(stack.left), weights=counts,
            least=np.append(np.zeros(len(slip)), _floor(stack)))
    else:
        fit = fit_components(
            stack.error, np.stack(slip), noise_covariance(stack, noise), weights=counts)
    found = dict(zip(_constants(terms, equal), map(Estimate, fit.values, fit.errors)))
    k_left = found.get('k_left', NOTHING)
    position, heading, time = _sigmas(fit, len(slip), noise)
    return SlipFit(
        k_left, found.get('k_right', k_left), position, heading, fit.log_likelihood, fit.nees,
        len(windows), found.get('linear', NOTHING), found.get('turn', NOTHING),
        found.get('heading', NOTHING), tuple(terms), time)


def fit_reference_noise(
        windows: Sequence[SlipWindow], k_left: float, k_right: float,
        body: BodySlip = NO_BODY_SLIP) -> SlipFit:
    """
    Return the reference's noise of the greatest likelihood, for known slip constants.

    For the reference of another session: best from short windows, in which slip is small.

    Parameters
    ----------
    windows : sequence of SlipWindow
        At least 5 that do not overlap.
    k_left, k_right : float
        Slip variance per metre of travel [m].
    body : BodySlip
        Slip of the body.

    Returns
    -------
    SlipFit
        Noise with its errors, above the floor of :func:`fit_slip`; the slip constants are those
        given, with errors of 0.

    Raises
    ------
    ValueError
        As :func:`fit_slip`; if a slip constant is not finite or below 0.

    Examples
    --------
    Both ends of a window carry the noise, here of 5 mm and 10 mrad:

    >>> from diffdrive_kinematics.core.calibration import NO_NOISE, slip_window
    >>> from diffdrive_kinematics.core.kinematics import Pose, WheelGeometry
    >>> errors = 2.0**0.5 * np.random.default_rng(1).normal(0.0, [0.005, 0.005, 0.01], (400, 3))
    >>> windows = [slip_window(WheelGeometry(0.5, 0.125), [[0.01, 0.01]], Pose(0.0, 0.0, 0.0),
    ...                        Pose(0.01 + x, y, theta)) for x, y, theta in errors]
    >>> f'{fit_reference_noise(windows, 1e-6, 1e-6).sigma_position.value:.3f} m'
    '0.005 m'

    """
    stack = stacked_windows(windows, FEWEST_WINDOWS)
    fit = fit_components(
        stack.error, np.stack(_noise_parts(stack)),
        slip_covariance(stack, k_left, k_right, body), least=_floor(stack))
    position, heading, time = _sigmas(fit, 0, None)
    return SlipFit(
        Estimate(k_left, 0.0), Estimate(k_right, 0.0), position, heading, fit.log_likelihood,
        fit.nees, len(windows), Estimate(body.linear_variance, 0.0),
        Estimate(body.turn_variance, 0.0), Estimate(body.heading_variance, 0.0), sigma_time=time)


def _floor(stack: SlipWindow) -> Array:
    """Return the least variances of the reference; of its stamps it may be 0."""
    least = np.maximum(SHARE * least_noise(stack.error, stack.left + stack.right), FINEST)
    return np.append(least, 0.0) if stack.time.any() else least


def _noise_parts(stack: SlipWindow) -> List[Array]:
    """Return what the reference's noise is made of: its stamps only where there are twists."""
    stamps = [stack.time] if stack.time.any() else []
    return [stack.position, stack.heading, *stamps]


def _constants(terms: Sequence[str], equal: bool) -> List[str]:
    """Return the fields of the result that the slip constants go to."""
    wheels = ['k_left'] if equal else ['k_left', 'k_right']
    return [name for term in terms for name in (wheels if term == 'wheels' else [term])]


def _sigmas(fit: Components, first: int, noise: Optional[ReferenceNoise]) -> List[Estimate]:
    """Return standard deviations of the noise; errors by ``d sigma = d variance / (2 sigma)``."""
    if noise is not None:
        return [Estimate(sigma, 0.0) for sigma in noise]
    found = [
        Estimate(math.sqrt(variance), 0.5 * error / math.sqrt(variance) if variance
                 else math.sqrt(error))
        for variance, error in zip(fit.values[first:], fit.errors[first:])]
    return (found + [NOTHING])[:3]
