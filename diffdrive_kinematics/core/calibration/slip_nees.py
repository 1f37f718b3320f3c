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

"""Whether slip constants and noise that are known predict the errors of windows."""

from typing import Sequence

from diffdrive_kinematics.core.calibration.slip_result import NO_NOISE, ReferenceNoise
from diffdrive_kinematics.core.calibration.slip_stack import (
    noise_covariance, slip_covariance, stacked_windows)
from diffdrive_kinematics.core.calibration.slip_window import SlipWindow
from diffdrive_kinematics.core.calibration.variance_components import likelihood
from diffdrive_kinematics.core.kinematics import Array
from diffdrive_kinematics.core.noise import BodySlip, NO_BODY_SLIP


def nees_per_dof(
        windows: Sequence[SlipWindow], k_left: float, k_right: float,
        noise: ReferenceNoise = NO_NOISE, body: BodySlip = NO_BODY_SLIP) -> Array:
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
    body : BodySlip
        Slip of the body.

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
    stack = stacked_windows(windows, fewest=1)
    covariance = slip_covariance(stack, k_left, k_right, body) + noise_covariance(stack, noise)
    _, quadratic = likelihood(stack.error, covariance)
    return quadratic / 3.0
