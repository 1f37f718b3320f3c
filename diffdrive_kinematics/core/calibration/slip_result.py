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

"""What a fit of slip finds: the slip constants, and the noise of the reference."""

from dataclasses import dataclass
from typing import NamedTuple, Tuple

from diffdrive_kinematics.core.calibration.calibration_parameters import Estimate
from diffdrive_kinematics.core.noise import BodySlip


class ReferenceNoise(NamedTuple):
    """
    White noise of reference poses.

    Parameters
    ----------
    sigma_position : float
        Standard deviation of x and of y [m].
    sigma_heading : float
        Standard deviation of theta [rad].
    sigma_time : float
        Standard deviation of the stamps [s].

    Examples
    --------
    >>> ReferenceNoise(sigma_position=0.002, sigma_heading=0.005)
    ReferenceNoise(sigma_position=0.002, sigma_heading=0.005, sigma_time=0.0)

    """

    sigma_position: float
    sigma_heading: float
    sigma_time: float = 0.0


NO_NOISE = ReferenceNoise(0.0, 0.0)
NOTHING = Estimate(0.0, 0.0)


class SlipModel(NamedTuple):
    """
    A set of terms of slip, and how likely it makes the errors of the windows.

    Parameters
    ----------
    terms : tuple of str
        Some of ``SLIP_TERMS``.
    constants : int
        How many slip constants it has.
    log_likelihood : float
        Greatest natural logarithm, without the constant of the normal density.

    Examples
    --------
    >>> SlipModel(('linear', 'turn'), 2, log_likelihood=120.0).constants
    2

    """

    terms: Tuple[str, ...]
    constants: int
    log_likelihood: float


@dataclass(frozen=True)
class SlipFit:
    """
    Slip constants of the greatest likelihood, and how well they fit.

    Parameters
    ----------
    k_left, k_right : Estimate
        Slip variance per metre of travel [m]; the same numbers if one k was fitted for both, 0
        if the wheels are none of the terms.
    sigma_position, sigma_heading : Estimate
        Noise of the reference [m], [rad].
    log_likelihood : float
        Natural logarithm, without the constant of the normal density.
    nees_per_dof : float
        Mean over the windows, near 1 by construction.
    windows : int
        How many there were.
    linear, turn, heading : Estimate
        Slip of the body [m], [rad], [rad^2/m] (see :class:`.BodySlip`); 0 if not fitted.
    terms : tuple of str
        What was fitted: some of ``SLIP_TERMS``.
    sigma_time : Estimate
        Noise of the reference's stamps [s]; 0 where the windows have no twists.
    rivals : tuple of SlipModel
        The sets of terms that the fit was chosen from, best first; empty if it was not.

    Examples
    --------
    >>> slip, noise = Estimate(1e-6, 1e-7), Estimate(0.002, 0.0001)
    >>> fit = SlipFit(slip, slip, noise, noise, log_likelihood=120.0, nees_per_dof=1.0, windows=40)
    >>> fit.noise, fit.body.turn_variance
    (ReferenceNoise(sigma_position=0.002, sigma_heading=0.002, sigma_time=0.0), 0.0)

    """

    k_left: Estimate
    k_right: Estimate
    sigma_position: Estimate
    sigma_heading: Estimate
    log_likelihood: float
    nees_per_dof: float
    windows: int
    linear: Estimate = NOTHING
    turn: Estimate = NOTHING
    heading: Estimate = NOTHING
    terms: Tuple[str, ...] = ('wheels',)
    sigma_time: Estimate = NOTHING
    rivals: Tuple[SlipModel, ...] = ()

    @property
    def body(self) -> BodySlip:
        """Slip of the body, without its errors."""
        return BodySlip(self.linear.value, self.turn.value, self.heading.value)

    @property
    def noise(self) -> ReferenceNoise:
        """Noise of the reference, without its errors."""
        return ReferenceNoise(
            self.sigma_position.value, self.sigma_heading.value, self.sigma_time.value)
