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
Pieces of a motion under bounded disturbances, on each of which the robot nearly rolls on arcs.

Of a robot that moves along arcs a step is one piece.  Where a command became a state
(:func:`augmented`) it changes on the way.  Its rate is in an interval, so that the state is
between two ramps, which end at its bounds.  Over a piece the robot's command is in the box of
the means of those ramps.  Errors are taken as independent from piece to piece, of which those
that are constant over a step are a part: the set only becomes larger.  Its far ends, to which
the largest errors lead, stay; between them it is wider, most for robots that turn far.
"""

import math
from typing import List, Sequence, Tuple

from diffdrive_kinematics.core.kinematics import Scalar
from diffdrive_kinematics.core.models.augmentation import Augmented
from diffdrive_kinematics.core.models.disturbance import Disturbance, Step
from diffdrive_kinematics.core.models.quantities import Quantity
from diffdrive_kinematics.core.models.rolling import Rolling
from diffdrive_kinematics.core.models.stray import Box, Piece, stray
from diffdrive_kinematics.core.models.system import ControlSystem, Vector
import numpy as np

MOST_CUTS = 16
"""Into how many pieces a step is cut at most."""

NEAR = 0.02
"""Of the size of what a step can reach: how far the pieces may stray from arcs in sum."""


def pieces_of(
        system: ControlSystem, start: Vector, steps: Sequence[Step], disturbance: Disturbance
) -> Tuple[Rolling, List[Piece]]:
    """
    Return the robot that moves along arcs, and the pieces of its motion.

    Parameters
    ----------
    system : ControlSystem
        Robot with two commands that moves along arcs, or such a one :func:`augmented`.
    start : tuple of float
        State x, in the order of ``states``.
    steps : sequence of (command, duration)
        Commands of the system, and for how long [s] each is held.
    disturbance : Disturbance
        Of a bounded distribution.

    Returns
    -------
    robot : Rolling
        The robot that is augmented.
    pieces : list of Piece
        In order of time.

    Raises
    ------
    ValueError
        If the system has no arcs, the state another number of parts, or the disturbance no
        bounds.

    Examples
    --------
    >>> from diffdrive_kinematics.core.models import augmented, bounded, unicycle
    >>> smooth = augmented(unicycle(), 's', bound=2.0)
    >>> _, pieces = pieces_of(
    ...     smooth, (0.0, 0.0, 0.0, 1.0), [((0.5, 0.0), 1.0)], bounded([0.1, 0.0]))
    >>> [round(float(speed), 9) for speed in pieces[0].box[0]]  # means over a second
    [1.2, 1.3]

    """
    chain: List[Augmented] = []
    robot = system
    while isinstance(robot, Augmented):
        chain.append(robot)
        robot = robot.inner
    if not isinstance(robot, Rolling) or len(robot.commands) != 2:
        raise ValueError(
            f'the system has states {[each.name for each in system.states]} and commands '
            f'{[each.name for each in system.commands]}, expected two commands that decide the '
            'twist, or become states that do')
    if len(start) != len(system.states):
        raise ValueError(
            f'the state has {len(start)} numbers, expected one for each of '
            f'{[each.name for each in system.states]}')
    held: Box = tuple((float(value), float(value)) for value in system.within(start)[3:])
    pieces: List[Piece] = []
    for command, duration in steps:
        box = _box(system, command, disturbance)
        held, cut = _cut(robot, chain, held, box, duration)
        pieces += cut
    return robot, pieces


def _box(system: ControlSystem, command: Vector, disturbance: Disturbance) -> Box:
    """Return what the bounds of the commands leave of u + W(u)."""
    half = disturbance.bounds(command)
    if not all(map(math.isfinite, half)):
        raise ValueError(f'distribution is {disturbance.distribution!r}, expected a bounded one')
    return tuple(
        (_clipped(u - w, each), _clipped(u + w, each))
        for u, w, each in zip(command, half, system.commands))


def _clipped(value: Scalar, bounds: Quantity) -> float:
    return float(np.clip(value, bounds.low, bounds.high))


def _cut(
        robot: Rolling, chain: Sequence[Augmented], held: Box, box: Box, duration: float
) -> Tuple[Box, List[Piece]]:
    """Return the states at the end of a step, and its pieces: as many as it takes."""
    count = 1
    while True:
        after, pieces = held, []
        for _ in range(count):
            after, piece = _piece(chain, after, box, duration / count)
            pieces.append(piece)
        if count >= MOST_CUTS or not chain or _strays_little(robot, pieces):
            return after, pieces
        count *= 2


def _strays_little(robot: Rolling, pieces: Sequence[Piece]) -> bool:
    """Return whether pieces stray little, against what the box of each moves the end by."""
    strayed = sum(stray(robot, piece).place for piece in pieces)
    size = far = 0.0
    for piece in pieces:
        v, w = (np.broadcast_to(value, (2, 2)) * piece.duration for value in robot.twist(
            (np.array(piece.box[0])[:, None], np.array(piece.box[1])[None, :])))
        far += float(np.abs(v).max())
        size += float(np.ptp(v)) + 0.5 * far * float(np.ptp(w))
    return strayed <= max(NEAR * size, 1e-4 * far)


def _piece(chain: Sequence[Augmented], held: Box, box: Box, duration: float) -> Tuple[Box, Piece]:
    """Return the states after a piece, and the piece; the outermost rates come first."""
    after = list(held)
    drift = [0.0] * len(box)
    for place, system in zip(reversed(range(len(held))), chain):
        index, bounds = system.index, system.inner.commands[system.index]
        low, high = held[place]
        down, up = (rate * duration for rate in box[index])
        varied = drift[index] * duration  # of a rate that is a state itself
        ends = [_clipped(low + min(down, up), bounds), _clipped(high + max(down, up), bounds)]
        if varied and not bounds.low <= low + down - varied <= high + up + varied <= bounds.high:
            ends = [_clipped(low + down - varied, bounds), _clipped(high + up + varied, bounds)]
        means = (
            max(bounds.low, low + 0.5 * down - 0.125 * varied) if down < varied
            else 0.5 * (low + ends[0]),
            min(bounds.high, high + 0.5 * up + 0.125 * varied) if up > -varied
            else 0.5 * (high + ends[1]))
        after[place] = (ends[0], ends[1])
        drift[index] = min(max(abs(down), abs(up)) + varied, bounds.high - bounds.low)
        box = (*box[:index], means, *box[index + 1:])
    return tuple(after), Piece(box, tuple(drift), duration)
