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

"""Where a robot may be after some commands: samples as rows for a message, and their boundary."""

import math
from typing import NamedTuple, Optional, Sequence, Tuple

from diffdrive_kinematics.core.kinematics import Array, check_finite, Command, Pose, WheelGeometry
from diffdrive_kinematics.core.noise.body_slip import BodySlip, NO_BODY_SLIP
from diffdrive_kinematics.core.noise.noise import WheelSlip
from diffdrive_kinematics.core.noise.projection import propagate
from diffdrive_kinematics.core.noise.reachable import reachable_set_from_slip
from diffdrive_kinematics.core.noise.step_noise import travel_of_command
import numpy as np


class Projected(NamedTuple):
    """
    What was asked for; what was not is None.

    Parameters
    ----------
    rows : numpy.ndarray, shape (N, 7), or None
        The samples: x, y, z [m] and the quaternion x, y, z, w [1].
    boundary : pair of numpy.ndarray, or None
        Coordinates x and y [m] of the vertices, shape (v,) each, counter-clockwise, not closed.

    Examples
    --------
    See :func:`projected`.

    """

    rows: Optional[Array]
    boundary: Optional[Tuple[Array, Array]]


def projected(
        pose: Pose, commands: Sequence[Command], geometry: WheelGeometry,
        slips: Tuple[WheelSlip, WheelSlip], samples: int, seed: int,
        with_boundary: bool, body: BodySlip = NO_BODY_SLIP) -> Projected:
    """
    Return where a robot may be that starts at a pose and carries out commands.

    Parameters
    ----------
    pose : Pose
        The start, floats.
    commands : sequence of Command
        The stages.
    geometry : WheelGeometry
        Distance of the wheels.
    slips : pair of WheelSlip
        Of the wheels (left, right).
    samples : int
        How many poses to draw, as ``sample_paths`` draws them; 0: none.
    seed : int
        Of the samples.
    with_boundary : bool
        Whether to compute the boundary of all that can be reached.
    body : BodySlip
        What slips beside the wheels.

    Returns
    -------
    Projected
        The samples and the boundary, each None where it was not asked for.

    Raises
    ------
    ValueError
        If a coordinate is not finite, or the boundary of unbounded slip is asked for.

    Examples
    --------
    >>> slip = WheelSlip(variance=1e-4, distribution='uniform')
    >>> result = projected(
    ...     Pose(0.0, 0.0, 0.0), [Command(0.5, 0.0, duration=2.0)],
    ...     WheelGeometry(0.5, 0.125), (slip, slip), samples=100, seed=1, with_boundary=True)
    >>> result.rows.shape, [len(each.shape) for each in result.boundary]
    ((100, 7), [1, 1])
    >>> bool(result.rows[:, 0].max() < result.boundary[0].max())
    True

    """
    travels = [travel_of_command(command, geometry) for command in commands]
    rows = _rows(pose, travels, geometry, slips, samples, seed, body) if samples else None
    boundary = reachable_set_from_slip(
        pose, travels, geometry, *slips, body=body) if with_boundary else None
    return Projected(rows, boundary)


def _rows(
        pose: Pose, travels: Sequence[Tuple[float, float]], geometry: WheelGeometry,
        slips: Tuple[WheelSlip, WheelSlip], samples: int, seed: int, body: BodySlip) -> Array:
    at = Pose(*(
        np.full(samples, check_finite(f'{name} of the start', float(value)))
        for name, value in zip(Pose._fields, pose)))
    for step, travel in enumerate(travels):
        at = propagate(at, *travel, geometry, *slips, seed=(seed, step), body=body)
    rows = np.zeros((samples, 7))
    rows[:, 0], rows[:, 1] = at.x, at.y
    half = (0.5 * np.asarray(at.theta)).tolist()
    rows[:, 5], rows[:, 6] = list(map(math.sin, half)), list(map(math.cos, half))
    return rows
