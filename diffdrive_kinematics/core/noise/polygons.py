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
Polygons: area, perimeter, and one with fewer vertices.

Points are complex numbers x + i y [m]; a polygon is an array of them, counter-clockwise, not
closed.
"""

from typing import Tuple

from diffdrive_kinematics.core.kinematics import Array
import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.complex128]
Pairs = NDArray[np.int64]


def area(polygon: Points) -> float:
    """
    Return the signed area of a polygon.

    Parameters
    ----------
    polygon : numpy.ndarray of complex, shape (n,)
        Its vertices [m].

    Returns
    -------
    float
        Area [m^2], positive where counter-clockwise.

    Examples
    --------
    >>> area(np.array([0.0, 2.0, 2.0 + 1.0j, 1.0j]))
    2.0

    """
    after = np.roll(polygon, -1)
    return float(0.5 * np.sum(polygon.real * after.imag - polygon.imag * after.real))


def perimeter(polygon: Points) -> float:
    """
    Return the length of the boundary of a polygon.

    Parameters
    ----------
    polygon : numpy.ndarray of complex, shape (n,)
        Its vertices [m].

    Returns
    -------
    float
        Length [m].

    Examples
    --------
    >>> perimeter(np.array([0.0, 2.0, 2.0 + 1.0j, 1.0j]))
    6.0

    """
    return float(np.sum(np.abs(np.roll(polygon, -1) - polygon)))


def simplified(polygon: Points, tolerance: float) -> Points:
    """
    Return some of the vertices, such that no other is further from its edge than a tolerance.

    The method of Douglas & Peucker (1973) on the two halves of the boundary.

    Parameters
    ----------
    polygon : numpy.ndarray of complex, shape (n,)
        Vertices [m].
    tolerance : float
        Largest distance [m] of a vertex that is left out.

    Returns
    -------
    numpy.ndarray of complex, shape (m,)
        The vertices that are kept [m], in their order.

    Examples
    --------
    >>> simplified(np.array([0.0, 1.0 + 0.01j, 2.0, 2.0 + 1.0j, 1.0j]), tolerance=0.1)
    array([0.+0.j, 2.+0.j, 2.+1.j, 0.+1.j])

    """
    far = int(np.argmax(np.abs(polygon - polygon[0])))
    closed = np.append(polygon, polygon[0])
    keep = np.zeros(len(closed), bool)
    keep[[0, far]] = True
    begin, end = np.array([0, far]), np.array([far, len(polygon)])
    while True:
        begin, end = (ends[end - begin > 1] for ends in (begin, end))
        if not len(begin):
            return polygon[keep[:-1]]
        span, inner = ranges(begin + 1, end)
        distance = segment_distances(closed[inner], closed[begin][span], closed[end][span])
        first = np.flatnonzero(np.diff(span, prepend=-1))
        largest = np.maximum.reduceat(distance, first)
        candidates = np.flatnonzero(distance == largest[span])
        worst = inner[candidates[np.unique(span[candidates], return_index=True)[1]]]
        over = largest > tolerance
        middle = worst[over]
        keep[middle] = True
        begin, end = np.append(begin[over], middle), np.append(middle, end[over])


def ranges(low: Pairs, high: Pairs) -> Tuple[Pairs, Pairs]:
    """
    Return all integers of many ranges, and of which range each is.

    Parameters
    ----------
    low, high : numpy.ndarray of int, shape (n,)
        Ends of the ranges; ``high`` is not of it.

    Returns
    -------
    which : numpy.ndarray of int, shape (k,)
        Numbers of the ranges.
    value : numpy.ndarray of int, shape (k,)
        The integers.

    Examples
    --------
    >>> [each.tolist() for each in ranges(np.array([5, 0]), np.array([7, 1]))]
    [[0, 0, 1], [5, 6, 0]]

    """
    counts = high - low
    which = np.repeat(np.arange(len(low)), counts)
    return which, np.arange(len(which)) + (low - np.cumsum(counts) + counts)[which]


def segment_distances(points: Points, begin: Points, end: Points) -> Array:
    """
    Return the distances of points from segments; shapes broadcast.

    Parameters
    ----------
    points : numpy.ndarray of complex
        Points [m].
    begin, end : numpy.ndarray of complex
        Ends of the segments [m].

    Returns
    -------
    numpy.ndarray
        Distances [m].

    Examples
    --------
    >>> segment_distances(np.array([1.0 + 2.0j, 4.0j]), np.array(0.0), np.array(3.0)).tolist()
    [2.0, 4.0]

    """
    along = end - begin
    length = np.abs(along)
    unit = np.where(length == 0.0, 1.0, along) / np.where(length == 0.0, 1.0, length)
    place = (points - begin) * np.conj(unit)
    beyond = place.real - np.clip(place.real, 0.0, length)
    return np.asarray(np.hypot(beyond, place.imag))
