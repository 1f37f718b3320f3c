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
The outer boundary of what a set of line segments encloses.

Points are complex numbers x + i y [m]; a polygon is an array of them, counter-clockwise, not
closed.
"""

from typing import List, Tuple

from diffdrive_kinematics.core.kinematics import Array
from diffdrive_kinematics.core.noise.polygons import Pairs, Points, ranges, segment_distances
import numpy as np

JITTER = 1e-9
"""Of the size: moves points into general position, where no two segments overlap."""

ATTEMPTS = 4
BLOCK = 128
CANDIDATES = 65536
"""Pairs of segments that are compared at once: what they take stays in the cache."""


def outer_boundary(points: Points, segments: Pairs) -> Points:
    """
    Return the polygon around all segments, which must hang together.

    Walk from the leftmost point, at every point or crossing along the rightmost way.  Holes are
    filled.  Points are moved by 1e-9 of the size of the whole, at random but reproducibly.

    Parameters
    ----------
    points : numpy.ndarray of complex, shape (p,)
        Ends of the segments [m].
    segments : numpy.ndarray of int, shape (s, 2)
        Indices of the ends.

    Returns
    -------
    numpy.ndarray of complex, shape (n,)
        Vertices [m], counter-clockwise, not closed.

    Raises
    ------
    RuntimeError
        If the walk does not come back in any of four attempts.

    Examples
    --------
    A square with its diagonals, which cross:

    >>> from diffdrive_kinematics.core.noise.polygons import area
    >>> corners = np.array([0.0, 1.0, 1.0 + 1.0j, 1.0j])
    >>> sides = np.array([[0, 1], [1, 2], [2, 3], [3, 0], [0, 2], [1, 3]])
    >>> boundary = outer_boundary(corners, sides)
    >>> len(boundary), round(area(boundary), 6)
    (4, 1.0)

    """
    size = float(np.max(np.abs(points - points[0]))) or 1.0
    used, flat = np.unique(_snapped(points, size)[segments], return_inverse=True)
    representative = np.zeros(len(used), np.complex128)
    representative[flat.reshape(-1)] = points[segments].reshape(-1)
    ends = np.sort(flat.reshape(-1, 2), axis=1)
    numbers = np.unique(ends[:, 0] * len(used) + ends[:, 1])
    pairs = np.stack(np.divmod(numbers, len(used)), axis=1)
    pairs = pairs[pairs[:, 0] != pairs[:, 1]]
    for attempt in range(ATTEMPTS):
        generator = np.random.default_rng(attempt)
        moved = representative + size * JITTER * (
            generator.uniform(-1.0, 1.0, len(used))
            + 1j * generator.uniform(-1.0, 1.0, len(used)))
        polygon = _walked(*_split(moved, pairs))
        if len(polygon) > 2 and _encloses(polygon, moved, 1e-6 * size):
            return polygon
    raise RuntimeError('the outline of the reachable set does not close')


def _snapped(points: Points, size: float) -> Pairs:
    """Return a number for each point, equal for points that are equal but for rounding."""
    grid = np.round((points - points[0]) / (1e-12 * size))
    return np.asarray(np.unique(grid, return_inverse=True)[1]).reshape(-1)


def _cross(a: Points, b: Points) -> Array:
    return np.asarray(a.real * b.imag - a.imag * b.real)


def _split(points: Points, pairs: Pairs) -> Tuple[Points, Pairs, Array]:
    """Return points, pieces of segments that meet in points only, and their directions."""
    first, second, t, u = _crossings(points, pairs)
    begin, end = points[pairs[:, 0]], points[pairs[:, 1]]
    crossing = begin[first] + t * (end[first] - begin[first])
    number = len(points) + np.arange(len(first))
    every = np.arange(len(pairs))
    segment = np.concatenate([first, second, every, every])
    place = np.concatenate([t, u, np.zeros(len(pairs)), np.ones(len(pairs))])
    node = np.concatenate([number, number, pairs[:, 0], pairs[:, 1]])
    order = np.argsort(place, kind='stable')
    order = order[_order(segment[order])]
    segment, node = segment[order], node[order]
    same = segment[:-1] == segment[1:]
    pieces = np.stack([node[:-1], node[1:]], axis=1)[same]
    return np.concatenate([points, crossing]), pieces, np.angle(end - begin)[segment[:-1][same]]


def _walked(points: Points, pieces: Pairs, directions: Array) -> Points:
    """Walk around the pieces, the outside on the right; nothing where it does not come back."""
    at_ends, others = pieces.reshape(-1), pieces[:, ::-1].reshape(-1)
    order = _order(at_ends)
    first_way = np.searchsorted(at_ends[order], np.arange(len(points) + 1)).tolist()
    ways = np.stack([directions, directions + np.pi], axis=1).reshape(-1)[order]
    leads_to = others[order]
    start = at = int(pieces.flat[np.argmin(points.real[pieces])])
    back, first = np.pi, None
    path: List[int] = []
    for _ in range(2 * len(pieces) + 1):
        here = slice(first_way[at], first_way[at + 1])
        direction, to = min(
            zip(ways[here].tolist(), leads_to[here].tolist()),
            key=lambda way: (way[0] - back - 1e-13) % (2.0 * np.pi))
        if at == start and (direction, to) == first:
            return points[path]
        first = first or (direction, to)
        path.append(at)
        at, back = to, direction + np.pi
    return points[:0]


def _order(numbers: Pairs) -> Pairs:
    """Return the stable order of numbers that are not negative, by one sort of values."""
    bits = len(numbers).bit_length()
    return np.sort(numbers << bits | np.arange(len(numbers))) & (1 << bits) - 1


def _encloses(polygon: Points, points: Points, tolerance: float) -> bool:
    """Tell whether the points are inside of the polygon, or as near to it as ``tolerance``."""
    begin, end = polygon, np.roll(polygon, -1)
    order = np.argsort(points.imag)
    low, high = np.searchsorted(points.imag[order], np.sort([begin.imag, end.imag], axis=0))
    edge, place = ranges(low, high)
    point, rise = order[place], (end - begin)[edge]
    slope = rise.real / rise.imag  # not 0 where a point is between the ends
    right = begin.real[edge] + (points.imag[point] - begin.imag[edge]) * slope > points.real[point]
    inside = np.bincount(point[right], minlength=len(points)) % 2 == 1
    strays = points[~inside]
    strays = strays[~np.isin(strays, polygon)]
    return all(
        bool((segment_distances(part[:, None], begin, end).min(axis=1) <= tolerance).all())
        for part in np.array_split(strays, 1 + len(strays) // BLOCK) if len(part))


def _crossings(points: Points, pairs: Pairs) -> Tuple[Pairs, Pairs, Array, Array]:
    """Return (i, j, t, u): segment i at its fraction t crosses segment j at its fraction u."""
    begin, end = points[pairs[:, 0]], points[pairs[:, 1]]
    first, second = _near(begin, end)
    along = end - begin
    gap, r, s = begin[second] - begin[first], along[first], along[second]
    cross, t = _cross(r, s), _cross(gap, s)
    within = (cross != 0.0) & (t * cross >= 0.0) & (np.abs(t) <= np.abs(cross))
    first, second, cross = first[within], second[within], cross[within]
    t, u = t[within] / cross, _cross(gap[within], r[within]) / cross
    (a, b), (c, d) = pairs.T[:, first], pairs.T[:, second]
    hit = (u >= 0.0) & (u <= 1.0) & (a != c) & (a != d) & (b != c) & (b != d)
    return first[hit], second[hit], t[hit], u[hit]


def _near(begin: Points, end: Points) -> Tuple[Pairs, Pairs]:
    """
    Return (i, j), i < j, in order, of the segments whose boxes overlap.

    In the order in which the boxes begin, those that overlap one follow it until it ends: along x
    or y, whichever leaves fewer to compare.
    """
    ends = np.stack([begin, end])
    sides = [(part.min(axis=0), part.max(axis=0)) for part in (ends.real, ends.imag)]
    after, order, across = min(
        ((*_followers(*along), across) for along, across in zip(sides, sides[::-1])),
        key=lambda found: int(found[0].sum()))
    low, high = (edge[order] for edge in across)
    every = np.arange(len(order))
    counts = np.cumsum(after - every - 1)
    parts = np.searchsorted(counts, np.arange(0, counts[-1] + 1 + CANDIDATES, CANDIDATES))
    found = []
    for rows in map(slice, parts[:-1], parts[1:]):
        which, j = ranges(every[rows] + 1, after[rows])
        i = every[rows][which]
        near = (low[j] <= high[rows][which]) & (high[j] >= low[rows][which])
        found.append((order[i[near]], order[j[near]]))
    one, other = (np.concatenate(ends) for ends in zip(*found))
    number = np.sort(np.minimum(one, other) * len(order) + np.maximum(one, other))
    first = number // len(order)
    return first, number - first * len(order)


def _followers(low: Array, high: Array) -> Tuple[Pairs, Pairs]:
    """Return up to where, in the order in which intervals begin, others begin within each."""
    order = np.argsort(low, kind='stable')
    return np.searchsorted(low[order], high[order], side='right'), order
