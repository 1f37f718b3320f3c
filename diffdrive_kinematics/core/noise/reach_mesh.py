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

"""The mesh that one stage makes of a reachable set: one slice for each error of the turn."""

import math
from typing import Tuple

from diffdrive_kinematics.core.kinematics import (
    Array, pose_change_from_travel, sinc, WheelGeometry)
from diffdrive_kinematics.core.noise.polygons import Pairs, Points
from diffdrive_kinematics.core.noise.stage import Stage
import numpy as np


def turn_errors(
        stage: Stage, geometry: WheelGeometry, radius: float, slices: int) -> Tuple[Array, float]:
    """
    Return errors of the half turn for the slices, and the sagitta between them.

    The second derivative of a point by h is at most 4 (radius + distance + L), and a chord over a
    step misses an eighth of that times its square.

    Parameters
    ----------
    stage : Stage
        Travel and bounds of the stage.
    geometry : WheelGeometry
        Distance of the wheels.
    radius : float
        Of what can be reached before the stage [m].
    slices : int
        Into how many parts to cut the errors.

    Returns
    -------
    nodes : numpy.ndarray, shape (s,)
        Errors of the half turn [rad]: evenly, and where bounds of the distance have corners.
    sagitta : float
        How far what is between two slices may reach beyond the chord [m].

    Examples
    --------
    >>> turn_errors(Stage(1.0, 1.0, 0.25, 0.25), WheelGeometry(0.5, 0.125), 0.0, 4)[0].tolist()
    [-0.5, -0.25, 0.0, 0.25, 0.5]

    """
    wheels = stage.left_bound + stage.right_bound
    of_body, double = 0.5 * stage.turn_bound, 2.0 * geometry.separation
    if (spread := wheels / double + of_body) == 0.0:
        return np.zeros(1), 0.0
    kink = (stage.right_bound - stage.left_bound) / double
    kinks = kink - of_body, kink + of_body, -kink - of_body, -kink + of_body
    nodes = np.linspace(-spread, spread, slices + 1)
    step = 2.0 * spread / slices
    reach = (radius + 0.5 * abs(stage.d_left + stage.d_right) + wheels + stage.lateral_bound
             + stage.distance_bound + geometry.separation)
    return np.unique(np.concatenate([nodes, kinks])), 0.5 * reach * step * step


def mesh_of(
        polygon: Points, margin: float, stage: Stage, geometry: WheelGeometry, nodes: Array
) -> Points:
    """
    Return the boundaries of the sums for each half turn.

    Parameters
    ----------
    polygon : numpy.ndarray of complex, shape (n,)
        What can be reached before the stage [m].
    margin : float
        By how much every sum is widened [m].
    stage : Stage
        Travel and bounds of the stage.
    geometry : WheelGeometry
        Distance of the wheels.
    nodes : numpy.ndarray, shape (s,)
        Errors of the half turn [rad].

    Returns
    -------
    numpy.ndarray of complex, shape (around, s)
        Points [m], one column a slice.

    Examples
    --------
    >>> mesh_of(np.zeros(1, complex), 0.1, Stage(1.0, 1.0, 0.0, 0.0, 0.0),
    ...         WheelGeometry(0.5, 0.125), np.zeros(1)).shape
    (8, 1)

    """
    distance, turn = pose_change_from_travel(geometry, stage.d_left, stage.d_right)
    return slices_of(
        polygon, 0.5 * turn + nodes, _distances(stage, geometry, distance, nodes),
        stage.lateral_bound, margin)


def _distances(
        stage: Stage, geometry: WheelGeometry, distance: float, nodes: Array
) -> Tuple[Array, Array]:
    """Return least and largest distance [m] of the centre that go with an error of h [rad]."""
    of_body, double = 0.5 * stage.turn_bound, 2.0 * geometry.separation
    kink = (stage.right_bound - stage.left_bound) / double
    nearest, opposite = (  # of the errors that the wheels can have where the body has the rest
        geometry.separation * np.clip(each, nodes - of_body, nodes + of_body)
        for each in (kink, -kink))
    low = np.maximum(-stage.left_bound, -stage.right_bound - 2.0 * opposite) + opposite
    high = np.minimum(stage.left_bound, stage.right_bound - 2.0 * nearest) + nearest
    middle = 0.5 * (low + high)
    return (distance + np.minimum(low, middle) - stage.distance_bound,
            distance + np.maximum(high, middle) + stage.distance_bound)


def slices_of(
        polygon: Points, half: Array, distances: Tuple[Array, Array], lateral: float,
        margin: float) -> Points:
    """
    Return the boundaries of the sums of the rotated polygon and the rectangle of each half turn.

    It is the convolution of the two boundaries: each vertex, once for the normal of either of
    its edges and at most 45 degrees apart in between, goes with the corner of the rectangle that
    is furthest along the normal.

    Parameters
    ----------
    polygon : numpy.ndarray of complex, shape (n,)
        Counter-clockwise, not closed [m].
    half : numpy.ndarray, shape (s,)
        Half the turns [rad].
    distances : pair of numpy.ndarray, shape (s,)
        Least and largest distances of the centre [m].
    lateral : float
        Largest displacement to the side [m].
    margin : float
        By how much the sum is widened, whatever the arc makes of its length [m].

    Returns
    -------
    numpy.ndarray of complex, shape (around, s)
        Points [m], one column a half turn.

    Examples
    --------
    >>> ends = np.array([0.9]), np.array([1.1])
    >>> round(float(slices_of(np.zeros(1, complex), np.zeros(1), ends, 0.1, 0.0).real.max()), 9)
    1.1

    """
    points, normals = _with_normals(polygon)
    ends = sinc(half) * np.array(distances)
    angle, side = normals[:, None] + half, lateral + margin
    corner = (np.where(np.cos(angle) > 0.0, ends.max(axis=0) + margin, ends.min(axis=0) - margin)
              + 1j * np.where(np.sin(angle) > 0.0, side, -side))
    turned = np.cos(half) + 1j * np.sin(half)
    return np.asarray(turned * (turned * points[:, None] + corner))


def _with_normals(polygon: Points) -> Tuple[Points, Array]:
    """Return vertices with directions [rad] of the outward normal, going around once."""
    if len(polygon) == 1:
        return np.repeat(polygon, 8), np.linspace(0.0, math.tau, 8, endpoint=False) + 0.1
    after = np.angle(np.roll(polygon, -1) - polygon) - 0.5 * math.pi
    before = np.roll(after, 1)
    bend = np.remainder(after - before + math.pi, math.tau) - math.pi
    bend[bend < 1e-9 - math.pi] += math.tau  # a tip turns to the left
    parts = 1 + np.ceil(np.abs(bend) / (0.25 * math.pi)).astype(np.int64)
    which = np.repeat(np.arange(len(polygon)), parts)
    rank = np.arange(len(which)) - np.repeat(np.cumsum(parts) - parts, parts)
    fraction = rank / np.maximum(parts[which] - 1, 1)
    return polygon[which], before[which] + fraction * bend[which]


def turned_edges(mesh: Points) -> Pairs:
    """
    Return the edges of a mesh that its outer boundary can follow.

    Those are the edges of the first and of the last slice, and inner ones whose two triangles
    lie on one side.  The mesh is closed around; points are numbered by rows.

    Parameters
    ----------
    mesh : numpy.ndarray of complex, shape (around, slices)
        Points [m].

    Returns
    -------
    numpy.ndarray of int, shape (e, 2)
        Indices of the ends of the edges.

    Examples
    --------
    >>> turned_edges(np.array([[0.0], [1.0], [1.0j]])).tolist()
    [[0, 1], [1, 2], [2, 0]]

    """
    numbers = np.arange(mesh.size).reshape(mesh.shape)
    following = np.roll(numbers, -1, axis=0)
    rings = np.stack([numbers, following], axis=-1)
    if mesh.shape[1] == 1:
        return rings.reshape(-1, 2)
    lower, upper = _orientations(mesh)
    return np.concatenate([
        rings[:, [0, -1]].reshape(-1, 2),
        rings[:, 1:-1][lower[:, 1:] * upper[:, :-1] <= 0],
        np.stack([numbers[:, :-1], following[:, 1:]], axis=-1)[lower * upper <= 0],
        np.stack([numbers[:, :-1], numbers[:, 1:]], axis=-1)[
            upper * np.roll(lower, 1, axis=0) <= 0]])


def _orientations(mesh: Points) -> Tuple[Pairs, Pairs]:
    """
    Return the signs of the triangles on either side of the diagonals, lower and upper.

    Lower ones are (k, j), (k+1, j), (k+1, j+1), upper ones (k, j), (k+1, j+1), (k, j+1).  A
    triangle with an edge of no length takes the sign of the one before in its strip, as the
    two edges left of it are one.
    """
    a, b = mesh[:, :-1], np.roll(mesh, -1, axis=0)[:, :-1]
    c, d = np.roll(mesh, -1, axis=0)[:, 1:], mesh[:, 1:]
    tiny = 1e-12 * float(np.max(np.abs(mesh - mesh[0, 0])))
    strip = np.stack([_sign(a, c, d, tiny), _sign(a, b, c, tiny)], axis=1)
    flat = strip.reshape(-1, mesh.shape[1] - 1)
    known = np.where(flat != 2, np.arange(len(flat))[:, None], -1)
    last = np.maximum.accumulate(known, axis=0)
    last = np.where(last < 0, last[-1], last)
    filled = np.where(last < 0, 0, np.take_along_axis(flat, np.maximum(last, 0), axis=0))
    return filled[1::2], filled[0::2]


def _sign(a: Points, b: Points, c: Points, tiny: float) -> Pairs:
    """Return the orientations of triangles, 2 for one with an edge of no length."""
    cross = ((b - a) * np.conj(c - a)).imag
    short = np.minimum(np.minimum(np.abs(b - a), np.abs(c - a)), np.abs(c - b)) <= tiny
    return np.where(short, 2, -np.sign(cross)).astype(np.int64)
