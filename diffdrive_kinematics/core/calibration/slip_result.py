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
from typing import NamedTuple

from diffdrive_kinematics.core.calibration.estimate import Estimate

__all__ = ['NO_NOISE', 'ReferenceNoise', 'SlipFit']


class ReferenceNoise(NamedTuple):
    """
    White noise of reference poses.

    Parameters
    ----------
    sigma_position : float
        Standard deviation of x and of y [m].
    sigma_heading : float
        Standard deviation of theta [rad].

    Examples
    --------
    >>> ReferenceNoise(sigma_position=0.002, sigma_heading=0.005)
    ReferenceNoise(sigma_position=0.002, sigma_heading=0.005)

    """

    sigma_position: float
    sigma_heading: float


NO_NOISE = ReferenceNoise(0.0, 0.0)


@dataclass(frozen=True)
class SlipFit:
    """
    Slip constants of the greatest likelihood, and how well they fit.

    Parameters
    ----------
    k_left, k_right : Estimate
        Slip variance per metre of travel [m]; the same numbers if one k was fitted for both.
    sigma_position, sigma_heading : Estimate
        Noise of the reference [m], [rad].
    log_likelihood : float
        Natural logarithm, without the constant of the normal density.
    nees_per_dof : float
        Mean over the windows, near 1 by construction.
    windows : int
        How many there were.

    Examples
    --------
    >>> slip, noise = Estimate(1e-6, 1e-7), Estimate(0.002, 0.0001)
    >>> fit = SlipFit(slip, slip, noise, noise, log_likelihood=120.0, nees_per_dof=1.0, windows=40)
    >>> fit.noise
    ReferenceNoise(sigma_position=0.002, sigma_heading=0.002)

    """

    k_left: Estimate
    k_right: Estimate
    sigma_position: Estimate
    sigma_heading: Estimate
    log_likelihood: float
    nees_per_dof: float
    windows: int

    @property
    def noise(self) -> ReferenceNoise:
        """Noise of the reference, without its errors."""
        return ReferenceNoise(self.sigma_position.value, self.sigma_heading.value)
