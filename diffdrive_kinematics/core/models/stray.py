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

"""How far a robot strays from arcs where its commands change on the way."""

from typing import NamedTuple, Tuple

from diffdrive_kinematics.core.models.rolling import Rolling
import numpy as np

Interval = Tuple[float, float]
Box = Tuple[Interval, ...]

GRID = 17
"""Values of each command at which the changes of the twist are looked at."""


class Piece(NamedTuple):
    """
    A part of a step, over which the means of a robot's commands are in a box.

    Parameters
    ----------
    box : tuple of (low, high)
        Interval of each command.
    drift : tuple of float
        By how much each command changes at most on the way.
    duration : float
        How long it takes [s].

    Examples
    --------
    See :func:`stray`.

    """

    box: Box
    drift: Tuple[float, ...]
    duration: float


class Stray(NamedTuple):
    """
    How far a robot strays from an arc on a piece, at most.

    Parameters
    ----------
    distance : float
        From the length of the arcs of the box [m].
    turn : float
        From their turn [rad].
    place : float
        From the end of the arc of its own length and turn [m].

    Examples
    --------
    See :func:`stray`.

    """

    distance: float
    turn: float
    place: float


def stray(robot: Rolling, piece: Piece) -> Stray:
    """
    Return how far a robot strays from the arcs of the box of a piece, by changes on the way.

    The mean of a twist is that of the mean command but for half its second derivatives times the
    variance, at most a quarter of the squared drift.  A twist that changes by (dv, dw) leads at
    most ``T^2 / 4 (|v| dw + |w| dv)`` away from the end of the arc of its means.

    Parameters
    ----------
    robot : Rolling
        What moves.
    piece : Piece
        Box and drift of its commands.

    Returns
    -------
    Stray
        Bounds.

    Examples
    --------
    >>> from diffdrive_kinematics.core.models import unicycle
    >>> piece = Piece(box=((1.0, 1.0), (0.0, 0.0)), drift=(0.0, 0.25), duration=2.0)
    >>> round(float(stray(unicycle(), piece).place), 9)
    0.25

    """
    if not any(piece.drift):
        return Stray(0.0, 0.0, 0.0)
    axes = [np.linspace(np.clip(low - drift, each.low, each.high),
                        np.clip(high + drift, each.low, each.high), GRID)
            for (low, high), drift, each in zip(piece.box, piece.drift, robot.commands)]
    grids = [np.broadcast_to(value, (GRID, GRID)) for value in robot.twist(
        (axes[0][:, None], axes[1][None, :]))]
    scale = [drift / (axis[1] - axis[0]) if axis[1] > axis[0] else 0.0
             for axis, drift in zip(axes, piece.drift)]
    bends, changes = [], []
    for grid in grids:
        second = [[scale[i] * scale[j] * float(np.abs(np.diff(np.diff(
            grid, axis=i), axis=j)).max()) for j in (0, 1)] for i in (0, 1)]
        bends.append(0.125 * sum(map(sum, second)))
        changes.append(sum(
            scale[i] * float(np.abs(np.diff(grid, axis=i)).max()) + second[i][i] for i in (0, 1)))
    v, w = (float(np.abs(grid).max()) for grid in grids)
    time = abs(piece.duration)
    return Stray(time * bends[0], time * bends[1],
                 0.25 * time * time * (v * changes[1] + w * changes[0]))
