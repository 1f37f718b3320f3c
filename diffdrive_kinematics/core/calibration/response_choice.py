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
Which form of the response describes a robot, chosen by how well it predicts what it has not seen.

Every drive is cut into quarters.  Each form is fitted without one quarter and predicts it.  The
simplest form whose mean error of position is within one standard error of the least one is fitted
to all (Breiman, Friedman, Olshen & Stone 1984, 3.4.3; Hastie, Tibshirani & Friedman 2009, 7.10).
The error is that of the difference, as both predict the same windows, so that windows in which
the robot does what no form knows count little.
"""

from itertools import pairwise
import math
from typing import Callable, Dict, Mapping, NamedTuple, Sequence, Tuple

from diffdrive_kinematics.core.calibration.recorded_drive import RecordedDrive
from diffdrive_kinematics.core.calibration.response_drive import with_commands_joined
from diffdrive_kinematics.core.calibration.response_fit import (
    fit_form, fit_heading, response_errors)
from diffdrive_kinematics.core.calibration.response_forms import FORMS
from diffdrive_kinematics.core.calibration.trajectory_windows import Windows
from diffdrive_kinematics.core.commands import CommandResponse
from diffdrive_kinematics.core.kinematics import Array, WheelGeometry
import numpy as np

PARTS, LEAST_S = 4, 80.0
PREDICTED = Windows((10.0,), every=2.5)
EQUAL_M = 1e-4  # mean errors [m] that are the same
BLOCK = 8  # neighbouring windows, which overlap, count as one


class Prediction(NamedTuple):
    """
    How well a form predicts the quarters that it was not fitted to, over windows of 10 s.

    Parameters
    ----------
    form : str
        The form.
    position : float
        Median error of position [m]; infinite where the form cannot be fitted.
    heading : float
        Median error of heading [rad].
    mean : float
        Mean error of position [m], by which forms are compared; infinite as the median is.

    Examples
    --------
    >>> Prediction('gains', position=0.05, heading=0.06, mean=0.06).position
    0.05

    """

    form: str
    position: float
    heading: float
    mean: float


class ResponseFit(NamedTuple):
    """
    The response that was chosen, and what it was chosen from.

    Parameters
    ----------
    response : CommandResponse
        How the robot follows its commands.
    frame : numpy.ndarray, shape (3,)
        Pose (x [m], y [m], yaw [rad]) of the reference's frame on the robot.
    form : str
        The form that was chosen.
    predictions : tuple of Prediction
        Of all forms, simple ones first; the first one is gains and a delay alone.

    Examples
    --------
    See :func:`fit_response`.

    """

    response: CommandResponse
    frame: Array
    form: str
    predictions: Tuple[Prediction, ...]

    def prediction(self, form: str = '') -> Prediction:
        """
        Return how well a form predicts.

        Parameters
        ----------
        form : str
            The form; empty: the one that was chosen.

        Returns
        -------
        Prediction
            Its errors.

        Examples
        --------
        See :func:`fit_response`.

        """
        return next(each for each in self.predictions if each.form == (form or self.form))


def _nobody(_: str) -> None:
    """Be told which form is tried, and do nothing."""


def fit_response(
        geometry: WheelGeometry, drives: Sequence[RecordedDrive],
        watch: Callable[[str], None] = _nobody) -> ResponseFit:
    """
    Return the response of a robot to its commands, in the simplest form that predicts well.

    Parameters
    ----------
    geometry : WheelGeometry
        Size and spacing of the wheels, those that the drives were made with.
    drives : sequence of RecordedDrive
        Drives of :func:`.drive_from_commands`, with one mounting of the reference.
    watch : callable
        Told the form that is tried; what it raises ends the search.

    Returns
    -------
    ResponseFit
        The response, and how well each form predicts.

    Raises
    ------
    ValueError
        If the drives are shorter than 80 s, have no straights or no turns, or a quarter of them
        has less than three windows of 10 s of the reference, so that forms cannot be compared.

    Examples
    --------
    A robot that loses speed in curves, in commands and in poses:

    >>> from diffdrive_kinematics.core.calibration import (
    ...     CalibrationParameters, drive_from_commands, odometry_at, responded)
    >>> geometry, stamps = WheelGeometry(0.3, 0.05), 0.2 * np.arange(450)
    >>> asked = np.stack([0.1 + 0.05 * np.sin(0.17 * stamps),
    ...                   0.4 * np.sin(0.11 * stamps)**3], axis=1)
    >>> bare = drive_from_commands(stamps, asked, stamps, np.zeros((450, 3)), geometry=geometry)
    >>> truth = CommandResponse(0.15, 0.4, turn_loss=0.15, delay=0.2)
    >>> seen = odometry_at(geometry, responded(geometry, bare, truth), CalibrationParameters())
    >>> drive = drive_from_commands(stamps, asked, stamps, seen, geometry=geometry)
    >>> fit = fit_response(geometry, [drive])
    >>> fit.form, round(fit.response.turn_loss, 2), round(fit.response.delay, 2)
    ('turn loss', 0.15, 0.2)
    >>> fit.prediction().position < 0.1 * fit.prediction('gains').position
    True

    """
    seconds = sum(float(drive.time[-1] - drive.time[0]) for drive in drives)
    if not seconds >= LEAST_S:
        raise ValueError(
            f'the drives take {seconds:.0f} s, expected {LEAST_S:.0f} s or more for a response')
    joined = [with_commands_joined(geometry, drive) for drive in drives]
    quarters = [_quarters(drive) for drive in joined]
    folds = []
    for number in range(PARTS):
        kept = [part for parts in quarters for n, part in enumerate(parts) if n != number]
        folds.append((kept, [parts[number] for parts in quarters], fit_heading(geometry, kept)))

    predictions = []
    distances: Dict[str, Array] = {}
    for form in FORMS:
        watch(form)
        try:
            fits = [fit_form(geometry, kept, heading, form) for kept, _, heading in folds]
        except ValueError:  # no robot does what it fits
            predictions.append(Prediction(form, math.inf, math.inf, math.inf))
            continue
        errors = np.concatenate([response_errors(geometry, left, fit, PREDICTED)
                                 for (_, left, _), fit in zip(folds, fits)])
        far = distances[form] = np.hypot(errors[:, 0], errors[:, 1])
        predictions.append(Prediction(
            form, float(np.median(far)), float(np.median(np.abs(errors[:, 2]))),
            float(np.mean(far))))
    chosen = simplest(distances) if distances else FORMS[0]
    watch(chosen)
    found = fit_form(geometry, joined, fit_heading(geometry, joined), chosen)
    return ResponseFit(found.response, found.frame, chosen, tuple(predictions))


def simplest(distances: Mapping[str, Array]) -> str:
    """
    Return the first form whose mean error is within one standard error of the least one.

    Parameters
    ----------
    distances : mapping of str to numpy.ndarray, shape (w,)
        Errors [m] of the same windows by each form, simple forms first.

    Returns
    -------
    str
        The form.

    Examples
    --------
    The table is better in half of the windows and worse in the others, or better in all:

    >>> gains, table = np.full(16, 0.02), np.repeat([0.01, 0.028], 8)
    >>> simplest({'gains': gains, 'table': table}), simplest({'gains': gains, 'table': gains / 2})
    ('gains', 'table')

    """
    best = min(distances.values(), key=np.mean)
    return next(form for form, each in distances.items()
                if np.mean(each - best) <= max(EQUAL_M, _standard_error(each - best)))


def _standard_error(values: Array) -> float:
    """Return the standard error of a mean of which neighbours belong together."""
    means = [np.mean(block) for block in np.array_split(values, max(len(values) // BLOCK, 2))]
    return float(np.std(means, ddof=1)) / math.sqrt(len(means))


def _quarters(drive: RecordedDrive) -> Sequence[RecordedDrive]:
    edges = np.linspace(drive.time[0], drive.time[-1], PARTS + 1)
    return [drive.between(start, end) for start, end in pairwise(edges)]
