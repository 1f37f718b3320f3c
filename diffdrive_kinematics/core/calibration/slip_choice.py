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
Which terms slip is made of: a term stays only if it pays.

Of all sets of terms the best one minimises ``-2 log L + 6.63 n`` with n slip
constants: each constant has to raise twice the log likelihood by 6.63, which one that is 0 in
truth does in less than 1 % of all cases (likelihood ratio, Wilks 1938).  Akaike's criterion
(1974) is the same with 2 in place of 6.63, and takes up a needless constant in one case of 12.
The wheels alone, the law of robots with encoders, stay unless another set is better by 6.63.
Windows that overlap need weights, as without them the same errors count several times.
"""

from dataclasses import replace
from itertools import combinations
import math
from typing import List, Optional, Sequence

from diffdrive_kinematics.core.calibration.clock_choice import LEAST_RATIO
from diffdrive_kinematics.core.calibration.slip_fit import fit_slip
from diffdrive_kinematics.core.calibration.slip_result import SlipFit, SlipModel
from diffdrive_kinematics.core.calibration.slip_stack import SLIP_TERMS
from diffdrive_kinematics.core.calibration.slip_window import SlipWindow
from numpy.typing import ArrayLike


def choose_slip(
        windows: Sequence[SlipWindow], *, equal: bool = True,
        weights: Optional[ArrayLike] = None) -> SlipFit:
    """
    Return the fit of the terms of slip that pay; one term stays in any case.

    Parameters
    ----------
    windows : sequence of SlipWindow
        As of :func:`.fit_slip`, without a known noise.
    equal : bool
        The wheels have one k, instead of one each.
    weights : array_like, shape (n,), optional
        As of :func:`.fit_slip`.

    Returns
    -------
    SlipFit
        The best fit, with the sets of terms that could have paid as its rivals.

    Raises
    ------
    ValueError
        As :func:`.fit_slip`, if no set of terms can be fitted.

    Examples
    --------
    A body that turns too much or too little, by wheels that do not slip:

    >>> import numpy as np
    >>> from diffdrive_kinematics.core.calibration import slip_window
    >>> from diffdrive_kinematics.core.kinematics import Pose, WheelGeometry
    >>> generator, windows = np.random.default_rng(1), []
    >>> for turn in 50 * [0.1, 2.0]:
    ...     x, y, theta = generator.normal(0.0, [0.001, 0.001, np.hypot(0.002, 0.1 * turn**0.5)])
    ...     windows.append(slip_window(
    ...         WheelGeometry(0.5, 0.125), [[-0.25 * turn, 0.25 * turn]],
    ...         Pose(0.0, 0.0, 0.0), Pose(x, y, turn + theta)))
    >>> fit = choose_slip(windows)
    >>> fit.terms, f'{fit.turn.value:.2f} rad', len(fit.rivals)
    (('turn',), '0.01 rad', 3)

    """
    there = [term for number, term in enumerate(SLIP_TERMS)
             if number == 0 or any(window.body[number - 1].any() for window in windows)]

    def fits(size: int) -> List[SlipFit]:
        found = []
        for terms in combinations(there, size):
            try:
                found.append(fit_slip(windows, equal=equal, terms=terms, weights=weights))
            except ValueError:  # these terms cannot be told apart; others may
                continue
        return found

    found = fits(len(there))
    highest = found[0].log_likelihood if found else math.inf  # no set is likelier than all terms
    best = math.inf
    for size in range(1, len(there)):
        if best <= LEAST_RATIO * size - 2.0 * highest:
            break  # nor can larger sets pay
        found += fits(size)
        best = min([penalised(_model(fit, equal)) for fit in found], default=math.inf)
    if not found:
        return fit_slip(windows, equal=equal, terms=('wheels',), weights=weights)
    found.sort(key=lambda fit: penalised(_model(fit, equal)))
    return replace(found[0], rivals=tuple(_model(fit, equal) for fit in found))


def penalised(model: SlipModel) -> float:
    """
    Return ``-2 log L + 6.63 n``, less 6.63 for the wheels alone: the best set makes it least.

    Parameters
    ----------
    model : SlipModel
        A set of terms.

    Returns
    -------
    float
        What is to be least [1].

    Examples
    --------
    >>> penalised(SlipModel(('wheels',), 1, log_likelihood=100.0))
    -200.0

    """
    constants = model.constants - int(model.terms == ('wheels',))
    return -2.0 * model.log_likelihood + LEAST_RATIO * constants


def _model(fit: SlipFit, equal: bool) -> SlipModel:
    constants = len(fit.terms) + int('wheels' in fit.terms and not equal)
    return SlipModel(fit.terms, constants, fit.log_likelihood)
