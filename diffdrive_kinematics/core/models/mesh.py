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

"""Meshes of triangles in the plane, whose outer boundary is a set that something sweeps."""

import math

from diffdrive_kinematics.core.kinematics import Array, sinc
from diffdrive_kinematics.core.noise import outer_boundary
import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.complex128]
Indices = NDArray[np.int64]

FLAT = 1e-8
"""Over the length of a mesh: a triangle that is not higher lies on neither side of its edge."""

CORNERS = np.exp(0.25j * np.pi * np.arange(8)) / math.cos(0.125 * np.pi)
"""Of an octagon around the unit circle."""


def swept(polygon: Points, turns: Array, low: Array, high: Array) -> Points:
    """
    Return the outer boundary of a polygon moved by all (distance, turn) of the slices.

    Parameters
    ----------
    polygon : numpy.ndarray of complex, shape (n,)
        Its vertices [m].
    turns : numpy.ndarray, shape (k,)
        Turns of the arcs [rad], in order.
    low, high : numpy.ndarray, shape (k,)
        Least and largest length [m] of the arcs that go with each turn.

    Returns
    -------
    numpy.ndarray of complex, shape (m,)
        Vertices [m], counter-clockwise, not closed.

    Examples
    --------
    >>> square = np.array([0.0, 1.0, 1.0 + 1.0j, 1.0j])
    >>> moved = swept(square, turns=np.array([0.0]), low=np.array([1.0]), high=np.array([3.0]))
    >>> round(float(moved.real.min()), 6), round(float(moved.real.max()), 6)
    (1.0, 4.0)

    """
    chord: Points = sinc(0.5 * turns) * np.exp(0.5j * turns)
    moved = np.exp(1j * turns)[:, None] * polygon
    ends = [low] if np.array_equal(low, high) else [low, high]
    mesh = np.stack([moved + (end * chord)[:, None] for end in ends])
    number = np.arange(mesh.size).reshape(mesh.shape)  # which end, which turn, which vertex
    after = np.roll(number, -1, axis=2)
    faces = [_halves(number[0], after[0], number[-1], after[-1])]
    if len(turns) > 1:
        faces += [_whole(number[:, :-1], after[:, :-1], number[:, 1:], after[:, 1:]),
                  _whole(number[0, :-1], number[-1, :-1], number[0, 1:], number[-1, 1:])]
    return _outline(mesh.reshape(-1), np.concatenate(faces))


def widened(polygon: Points, margin: float) -> Points:
    """
    Return a polygon with all that is as near to it as a margin.

    Parameters
    ----------
    polygon : numpy.ndarray of complex, shape (n,)
        Its vertices [m]; one: a point.
    margin : float
        How far [m] to widen it; at the corners by up to 1 / cos(22.5 degrees) of it.

    Returns
    -------
    numpy.ndarray of complex, shape (m,)
        Vertices [m], counter-clockwise, not closed.

    Examples
    --------
    >>> square = np.array([0.0, 1.0, 1.0 + 1.0j, 1.0j])
    >>> bool(widened(square, margin=0.5).real.min() <= -0.5)
    True

    """
    mesh = polygon[:, None] + margin * CORNERS
    if len(polygon) == 1:
        return np.asarray(mesh[0])
    number = np.arange(mesh.size).reshape(mesh.shape)
    following, turned = np.roll(number, -1, axis=0), np.roll(number, -1, axis=1)
    return _outline(mesh.reshape(-1), _halves(
        number, turned, following, np.roll(turned, -1, axis=0)))


def _halves(a: Indices, b: Indices, c: Indices, d: Indices) -> Indices:
    """Return the triangles of quadrilaterals that are parallelograms: a, b and across c, d."""
    return np.concatenate([np.stack(each, axis=-1).reshape(-1, 3) for each in (
        (a, b, d), (a, d, c))])


def _whole(a: Indices, b: Indices, c: Indices, d: Indices) -> Indices:
    """Return triangles that cover all between four points: a surface may be twisted there."""
    return np.concatenate([_halves(a, b, c, d), _halves(b, a, d, c)])


def _outline(points: Points, triangles: Indices) -> Points:
    """Return the outer boundary of triangles: of edges that have none on one of their sides."""
    ends = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    third = np.concatenate([triangles[:, 2], triangles[:, 0], triangles[:, 1]])
    ends = np.sort(ends, axis=1)
    key = ends[:, 0] * len(points) + ends[:, 1]
    edges, which = np.unique(key, return_inverse=True)
    begin, end = np.divmod(edges, len(points))
    along = points[end] - points[begin]
    height = (np.conj(along[which]) * (points[third] - points[begin[which]])).imag
    flat = FLAT * float(np.max(np.abs(points - points[0]))) * np.abs(along[which])
    left, right = np.zeros(len(edges), bool), np.zeros(len(edges), bool)
    left[which[height > flat]] = True
    right[which[height < -flat]] = True
    kept = ~(left & right)
    return outer_boundary(points, np.stack([begin[kept], end[kept]], axis=1))
