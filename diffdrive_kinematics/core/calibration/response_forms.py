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

"""The forms in which the response to commands is fitted: how the speed depends on the curve."""

from dataclasses import replace
from typing import Callable, Sequence, Tuple

from diffdrive_kinematics.core.calibration.recorded_drive import RecordedDrive
from diffdrive_kinematics.core.calibration.response_drive import commands_of
from diffdrive_kinematics.core.commands import CommandResponse
from diffdrive_kinematics.core.kinematics import Array, WheelGeometry
import numpy as np

FORMS = ('gains', 'turn loss in proportion', 'turn loss', 'table')
"""Forms of the share of the speed that is kept, simple ones first.  The turn loss has a share of
its own for straights, drawn to 1: where it is not needed it costs next to nothing."""

GAINS, LOSSES_M, VEERS, DELAYS_S = (0.05, 5.0), (0.0, 5.0), (-2.0, 2.0), (0.0, 3.0)
"""What robots do at all."""

LOSS_M = 0.1  # where the search starts
NODES = (0.0, 0.02, 0.5, 0.75, 1.0)
SMOOTHNESS, HELD = 0.03, 0.01
"""Nodes of the table, of the tightest curvature driven (straights may be unlike the widest curve);
what its bends, and distances from 1, cost against a mean squared error."""


def form_of(
        geometry: WheelGeometry, drives: Sequence[RecordedDrive], heading: CommandResponse,
        form: str) -> Tuple[Array, Array, Callable[[Array], CommandResponse]]:
    """
    Return what a fit of a form needs: a start, a penalty, and the response of its parameters.

    Parameters
    ----------
    geometry : WheelGeometry
        Size and spacing of the wheels, those that the drives were made with.
    drives : sequence of RecordedDrive
        Drives of :func:`.drive_from_commands`.
    heading : CommandResponse
        With gain and veer of the yaw rate, delay and range.
    form : str
        One of ``FORMS``.

    Returns
    -------
    start : numpy.ndarray, shape (p,)
        Parameters of a robot that does as it is told, or loses a little in turns.
    penalty : numpy.ndarray, shape (m, p)
        Rows for :func:`.robust_fit`.
    respond : callable
        Gives the response of p parameters; ``ValueError`` where no robot could do it.

    Examples
    --------
    >>> from diffdrive_kinematics.core.calibration import drive_from_commands
    >>> geometry = WheelGeometry(0.5, 0.125)
    >>> drive = drive_from_commands(
    ...     [0.0, 1.0], [[0.5, 1.0]] * 2, [0.0, 1.0], np.zeros((2, 3)), geometry=geometry)
    >>> start, _, respond = form_of(geometry, [drive], CommandResponse(0.5, 1.0), 'turn loss')
    >>> start, respond(start).turn_loss
    (array([1. , 0.1, 1. ]), 0.1)

    """
    nodes = _widest(geometry, drives, heading) * np.array(NODES)
    table, straights = form == 'table', form == 'turn loss'
    order = 1 if 'proportion' in form else 2

    def respond(values: Array) -> CommandResponse:
        if table:
            return replace(heading, curvatures=tuple(nodes.tolist()),
                           shares=tuple(np.clip(values, *GAINS).tolist()))
        gain, loss, straight = np.append(values, [0.0, 1.0][len(values) - 1:]).tolist()
        return replace(
            heading, speed_gain=within(gain, GAINS), turn_loss=within(loss, LOSSES_M),
            turn_loss_order=order, curvatures=tuple(nodes[:2].tolist()) if straights else (),
            shares=(within(straight, GAINS), 1.0) if straights else ())

    if table:
        bend = np.diff(np.eye(len(nodes)), 2, axis=0)
        return (np.ones(len(nodes)),
                np.vstack([SMOOTHNESS * bend, HELD * np.eye(len(nodes))]), respond)
    start = np.array([1.0, LOSS_M, 1.0])[:3 if straights else 1 if form == 'gains' else 2]
    return start, HELD * np.eye(3)[2:, :len(start)], respond


def _widest(
        geometry: WheelGeometry, drives: Sequence[RecordedDrive], heading: CommandResponse
) -> float:
    """Return the tightest curvature [1/m] that was driven, but for some 2 % and for creeping."""
    v, w = np.concatenate([commands_of(geometry, drive) for drive in drives]).T
    driven = np.abs(v) > 0.05 * heading.max_speed
    return max(float(np.percentile(np.abs(w[driven] / v[driven]), 98.0)), 1e-3)


def within(value: float, bounds: Tuple[float, float]) -> float:
    """
    Return a value, or the bound that it exceeds.

    Parameters
    ----------
    value : float
        The value.
    bounds : pair of float
        Lowest and highest one.

    Returns
    -------
    float
        Within the bounds.

    Examples
    --------
    >>> within(7.0, (0.0, 5.0))
    5.0

    """
    return float(min(max(value, bounds[0]), bounds[1]))
