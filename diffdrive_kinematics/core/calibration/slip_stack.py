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
Slip windows stacked into arrays, and the covariances that slip and noise give their errors.

With these :func:`nees_per_dof` tells whether known slip constants predict the errors.
"""

from typing import List, Sequence

from diffdrive_kinematics.core.calibration.slip_result import NO_NOISE, ReferenceNoise
from diffdrive_kinematics.core.calibration.slip_window import SlipWindow
from diffdrive_kinematics.core.calibration.variance_components import likelihood
from diffdrive_kinematics.core.kinematics import Array, check_non_negative
from diffdrive_kinematics.core.noise import BodySlip, NO_BODY_SLIP
import numpy as np

BODY_TERMS = ('linear', 'turn', 'heading')
SLIP_TERMS = ('wheels', *BODY_TERMS)
"""What slip may be made of: the wheels, and the constants of :class:`.BodySlip`."""


def stacked_windows(windows: Sequence[SlipWindow], fewest: int) -> SlipWindow:
    """
    Return the windows as one, whose arrays have a leading axis.

    Parameters
    ----------
    windows : sequence of SlipWindow
        The n windows.
    fewest : int
        How many are expected at least.

    Returns
    -------
    SlipWindow
        Errors of shape (n, 3), covariances of shape (n, 3, 3), those of the body (n, 3, 3, 3).

    Raises
    ------
    ValueError
        If there are too few windows, or a number is not finite.

    Examples
    --------
    >>> from diffdrive_kinematics.core.calibration import slip_window
    >>> from diffdrive_kinematics.core.kinematics import Pose, WheelGeometry
    >>> window = slip_window(WheelGeometry(0.5, 0.125), [[1.0, 1.0]],
    ...                      Pose(0.0, 0.0, 0.0), Pose(1.0, 0.0, 0.03))
    >>> stack = stacked_windows([window, window], fewest=1)
    >>> stack.left.shape, len(slip_parts(stack, ('wheels', 'turn'), equal=False))
    ((2, 3, 3), 3)
    >>> covariance = (slip_covariance(stack, 1e-4, 1e-4, BodySlip())
    ...               + noise_covariance(stack, ReferenceNoise(0.001, 0.0)))
    >>> f'{covariance[0, 0, 0]:.6f} {covariance[0, 2, 2]:.6f}'
    '0.000052 0.000800'

    """
    if len(windows) < fewest:
        raise ValueError(f'there are {len(windows)} windows, expected at least {fewest}')
    stack = SlipWindow(*(np.stack([getattr(window, name) for window in windows])
                         for name in SlipWindow.__dataclass_fields__))
    for name in SlipWindow.__dataclass_fields__:
        if not np.isfinite(getattr(stack, name)).all():
            raise ValueError(f'a window has a {name} that is not finite, expected finite numbers')
    return stack


def slip_parts(stack: SlipWindow, terms: Sequence[str], *, equal: bool) -> List[Array]:
    """
    Return the covariances for slip constants of 1.

    Parameters
    ----------
    stack : SlipWindow
        As of :func:`stacked_windows`.
    terms : sequence of str
        Some of ``SLIP_TERMS``, in their order.
    equal : bool
        The wheels have one constant, instead of one each.

    Returns
    -------
    list of numpy.ndarray, shape (n, 3, 3)
        One for each constant.

    Raises
    ------
    ValueError
        If a term is another one, or not in order.

    Examples
    --------
    See :func:`stacked_windows`.

    """
    if tuple(terms) != tuple(term for term in SLIP_TERMS if term in terms):
        raise ValueError(
            f'terms is {tuple(terms)!r}, expected some of {SLIP_TERMS!r} in that order')
    parts = []
    if 'wheels' in terms:
        parts += [stack.left + stack.right] if equal else [stack.left, stack.right]
    return parts + [stack.body[:, number] for number, term in enumerate(BODY_TERMS)
                    if term in terms]


def slip_covariance(stack: SlipWindow, k_left: float, k_right: float, body: BodySlip) -> Array:
    """
    Return what known slip gives the errors.

    Parameters
    ----------
    stack : SlipWindow
        As of :func:`stacked_windows`.
    k_left, k_right : float
        Slip variance of the wheels per metre of travel [m].
    body : BodySlip
        Slip of the body.

    Returns
    -------
    numpy.ndarray, shape (n, 3, 3)
        Covariances.

    Raises
    ------
    ValueError
        If a constant is not finite or below 0.

    Examples
    --------
    See :func:`stacked_windows`.

    """
    constants = np.array([body.linear_variance, body.turn_variance, body.heading_variance])
    found: Array = (check_non_negative('k_left', k_left) * stack.left
                    + check_non_negative('k_right', k_right) * stack.right
                    + np.tensordot(stack.body, constants, (1, 0)))
    return found


def noise_covariance(stack: SlipWindow, noise: ReferenceNoise) -> Array:
    """
    Return what the noise of the reference gives the errors.

    Parameters
    ----------
    stack : SlipWindow
        As of :func:`stacked_windows`.
    noise : ReferenceNoise
        The noise.

    Returns
    -------
    numpy.ndarray, shape (n, 3, 3)
        Covariances.

    Raises
    ------
    ValueError
        If a standard deviation is not finite or below 0.

    Examples
    --------
    See :func:`stacked_windows`.

    """
    return (check_non_negative('sigma_position', noise.sigma_position)**2 * stack.position
            + check_non_negative('sigma_heading', noise.sigma_heading)**2 * stack.heading
            + check_non_negative('sigma_time', noise.sigma_time)**2 * stack.time)


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
