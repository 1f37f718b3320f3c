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
What a rolling robot can reach under bounded disturbances (LaValle 2.34, 2.35, figure 2.23).

As for the differential drive (``reachable``) the set is computed
from the last step to the first, in the frame of the robot at the start of the step: ::

    R_i = union over w in W(u_i) of  c(u_i + w) + rotation(turn(u_i + w)) R_(i+1),  R_(k+1) = {0}

For one turn that is the sum of a polygon and a line, from the least to the largest distance that
goes with the turn.  Over the turns its edges sweep a mesh of triangles; the outer boundary of the
mesh runs along edges all of whose triangles lie on one side.  What chords cut off is added as a
margin in every step: the polygon is an outer one.  Holes are filled.

Where a command became a state (:func:`augmented`), ``pieces`` cuts the steps until the robot
nearly moves along arcs on each piece, and what it strays from them is added as well.
"""

from typing import NamedTuple, Sequence, Tuple

from diffdrive_kinematics.core.kinematics import Array
from diffdrive_kinematics.core.models.disturbance import Disturbance, Step
from diffdrive_kinematics.core.models.mesh import Points, swept, widened
from diffdrive_kinematics.core.models.pieces import pieces_of
from diffdrive_kinematics.core.models.rolling import Rolling
from diffdrive_kinematics.core.models.stray import Piece, stray
from diffdrive_kinematics.core.models.system import ControlSystem, Vector
from diffdrive_kinematics.core.noise import area, perimeter, simplified
import numpy as np

LINES = 33
"""Lines either way through the box of a step's commands."""

FEWEST_SLICES, MOST_SLICES = 4, 16
"""Turns to look at, for each edge of the box."""

SHARE = 0.004
"""Of the area over the perimeter: the margins of all steps together."""

LEAST, THINNEST = 1e-8, 5e-4
"""Least margin [m] of a set, and over its length: a curve has to have an inside."""


class _Motions(NamedTuple):
    """
    Lines through the (distance [m], turn [rad]) of a step, end by end, and what they miss.

    ``edges`` are the turns along the four edges of the box, shape (4, LINES).
    """

    distance: Array
    turn: Array
    edges: Array
    missed_distance: float
    missed_turn: float
    missed_place: float


def reachable_boundary(
        system: ControlSystem, start: Vector, steps: Sequence[Step], disturbance: Disturbance
) -> Tuple[Array, Array]:
    """
    Return the boundary of the many-step forward projection of a bounded disturbance (2.35).

    Parameters
    ----------
    system : ControlSystem
        Robot with two commands that moves along arcs, or such a one :func:`augmented`.
    start : tuple of float
        State: x [m], y [m], theta [rad], and the commands that became states.
    steps : sequence of (command, duration)
        Commands, and for how long [s] each is held; at least one.
    disturbance : Disturbance
        Of a bounded distribution.

    Returns
    -------
    x : numpy.ndarray
        Of the vertices [m], shape (v,), counter-clockwise, not closed.
    y : numpy.ndarray
        Of the vertices [m], shape (v,).

    Raises
    ------
    ValueError
        If there are no steps, the system has no arcs, or the disturbance no bounds.

    Examples
    --------
    >>> from diffdrive_kinematics.core.models import bounded, unicycle
    >>> x, y = reachable_boundary(
    ...     unicycle(), (0.0, 0.0, 0.0), [((1.0, 0.0), 1.0)], bounded([0.1, 0.2]))
    >>> round(float(x.max()), 2), round(float(y.max()), 2)
    (1.1, 0.11)

    """
    if not steps:
        raise ValueError('steps is empty, expected at least one (command, duration)')
    robot, pieces = pieces_of(system, start, steps, disturbance)
    polygon, margin = np.zeros(1, np.complex128), 0.0
    for piece in reversed(pieces):
        polygon, margin = _before(
            polygon, margin, _motions(robot, piece), SHARE / (len(pieces) + 1))
    x, y, theta = map(float, start[:3])
    placed = complex(x, y) + np.exp(1j * theta) * widened(polygon, margin + LEAST)
    return placed.real.copy(), placed.imag.copy()


def _motions(robot: Rolling, piece: Piece) -> _Motions:
    """Return the motions of a piece: lines through its box, and what they miss."""
    first, second = (np.linspace(*ends, 2 * LINES - 1) for ends in piece.box)
    v, w = robot.twist((first[:, None], second[None, :]))
    d, t = (piece.duration * np.broadcast_to(value, (len(first), len(second))) for value in (v, w))
    missed = []
    for grid in (d, t):
        chords = [0.5 * (lines[:-2:2] + lines[2::2]) - lines[1::2] for lines in (
            grid[:, ::2], grid[::2].T)]
        missed.append(max(float(np.abs(each).max()) for each in chords))
    d, t = d[::2, ::2], t[::2, ::2]
    ends = [np.stack([np.concatenate([grid[:-1].ravel(), grid[:, :-1].ravel()]),
                      np.concatenate([grid[1:].ravel(), grid[:, 1:].ravel()])]) for grid in (d, t)]
    edges = np.stack([t[0], t[-1], t[:, 0], t[:, -1]])
    strayed = stray(robot, piece)
    return _Motions(ends[0], ends[1], edges, missed[0] + strayed.distance,
                    missed[1] + strayed.turn, strayed.place)


def _before(
        polygon: Points, margin: float, motions: _Motions, share: float) -> Tuple[Points, float]:
    """Return the set one step earlier, and how far the true one may reach beyond it [m]."""
    reach = float(np.max(np.abs(polygon))) + margin
    missed = 2.0 * (motions.missed_distance + motions.missed_turn * (
        reach + float(np.abs(motions.distance).max()))) + motions.missed_place
    slices = FEWEST_SLICES
    while True:
        turns, low, high, sagitta = _slices(motions, reach, slices)
        outline = swept(widened(polygon, margin + missed + sagitta + LEAST), turns, low, high)
        tolerance = max(share * area(outline) / perimeter(outline), LEAST,
                        THINNEST * float(np.max(np.abs(outline - outline[0]))))
        if sagitta <= tolerance or slices >= MOST_SLICES or len(turns) == 1:
            break
        slices *= 2
    return simplified(outline, max(tolerance, sagitta)), max(tolerance, sagitta)


def _slices(motions: _Motions, reach: float, slices: int) -> Tuple[Array, Array, Array, float]:
    """
    Return turns [rad], the distances (low, high) [m] that go with each, and the sagitta [m].

    A point of the sum moves by ``d e(t) + rotation(t) p`` with |e'| <= 1/2 and |e''| <= 1/3.
    """
    least, most = float(motions.turn.min()), float(motions.turn.max())
    if most - least <= 1e-12 * max(abs(least), abs(most)):
        return (np.array([0.5 * (least + most)]), motions.distance.min(keepdims=True)[0, :1],
                motions.distance.max(keepdims=True)[0, :1], 0.5 * (most - least) * reach)
    turns = np.unique(motions.edges[:, ::(LINES - 1) // slices])
    turns = turns[np.append(True, np.diff(turns) > 1e-9 * (most - least))]
    low, high = _spans(motions, turns)
    middle_low, middle_high = _spans(motions, 0.5 * (turns[:-1] + turns[1:]))
    bulge = max(0.0, float(np.max(0.5 * (low[:-1] + low[1:]) - middle_low)),
                float(np.max(middle_high - 0.5 * (high[:-1] + high[1:]))))
    step = np.diff(turns)
    slope = np.maximum(np.abs(np.diff(low)), np.abs(np.diff(high)))
    far = float(np.abs(motions.distance).max())
    return turns, low, high, 1.5 * bulge + float(np.max(
        0.125 * step * (step * (reach + far / 3.0) + slope)))


def _spans(motions: _Motions, turns: Array) -> Tuple[Array, Array]:
    """Return the least and the largest distance [m] on lines that come to each turn."""
    (d0, d1), (t0, t1) = motions.distance, motions.turn
    size = float(np.ptp(motions.turn))
    across = np.where(t1 == t0, 1.0, t1 - t0)
    place = np.where(t1 == t0, 0.0, (turns[:, None] - t0) / across)
    meets = np.where(t1 == t0, np.abs(turns[:, None] - t0) <= 1e-9 * size,
                     (place >= -1e-9) & (place <= 1.0 + 1e-9))
    at = d0 + np.clip(place, 0.0, 1.0) * (d1 - d0)
    flat = np.where(t1 == t0, d1, at)
    return (np.minimum(np.where(meets, at, np.inf), np.where(meets, flat, np.inf)).min(axis=1),
            np.maximum(np.where(meets, at, -np.inf), np.where(meets, flat, -np.inf)).max(axis=1))
