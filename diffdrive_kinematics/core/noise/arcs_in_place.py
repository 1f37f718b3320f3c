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

"""Noise and arcs of a chunk of poses, in place: its buffers stay in the processor's cache."""

from typing import NamedTuple, Tuple

from diffdrive_kinematics.core.kinematics import sinc, WheelGeometry
from diffdrive_kinematics.core.noise.body_slip import BodyNoise
from diffdrive_kinematics.core.noise.box_muller import fill_normals
from diffdrive_kinematics.core.noise.distributions import draw_unit
from diffdrive_kinematics.core.noise.step_noise import StepNoise
import numpy as np
from numpy.typing import NDArray

__all__ = ['Columns', 'move_arcs', 'move_chunk', 'moved_arcs']

Array = NDArray[np.float64]

TINY = 1e-300


class Columns(NamedTuple):
    """
    Poses as three arrays.

    Parameters
    ----------
    x, y : numpy.ndarray, shape (N,)
        Positions [m].
    theta : numpy.ndarray, shape (N,)
        Headings [rad], not wrapped.

    Examples
    --------
    >>> Columns(*np.zeros((3, 1000))).theta.shape
    (1000,)

    """

    x: Array
    y: Array
    theta: Array


def move_chunk(
        poses: Columns, moved: Columns, geometry: WheelGeometry, noise: StepNoise,
        bits: 'np.random.SFC64', buffer: Array, distributions: Tuple[str, str]) -> None:
    """
    Move the poses of one chunk into ``moved``, in place on the work buffer.

    Parameters
    ----------
    poses : Columns
        Where they are, shape (n,) each; not written.
    moved : Columns
        Where they come to lie; overwritten.
    geometry : WheelGeometry
        Distance of the wheels.
    noise : StepNoise
        Of the step.
    bits : numpy.random.SFC64
        Source of randomness.
    buffer : numpy.ndarray, shape (6 n + 2,) or more, twice that where the body slips
        Work space; overwritten.
    distributions : pair of str
        Of the slip of the wheels (left, right).

    Examples
    --------
    Without slip it is the arc of :func:`.advance`:

    >>> from diffdrive_kinematics.core.noise import step_noise, WheelSlip
    >>> moved, geometry = Columns(*np.zeros((3, 1))), WheelGeometry(0.5, 0.125)
    >>> noise = step_noise(1.0, 1.0, geometry, WheelSlip(), WheelSlip())
    >>> move_chunk(Columns(*np.zeros((3, 1))), moved, geometry, noise, np.random.SFC64(1),
    ...            np.empty(8), ('gaussian', 'gaussian'))
    >>> round(float(moved.x[0]), 9)
    1.0

    """
    rows = len(moved.x)
    left, right, lateral = _drawn(rows, noise, bits, buffer, distributions)
    distance, scratch = buffer[-2 * rows:].reshape(2, rows)
    np.add(left, right, out=distance)
    distance *= geometry.separation
    distance += noise.distance
    right -= left
    right += noise.half_turn
    if noise.body:
        _disturb(noise.body, bits, buffer[3 * rows + 1:-2 * rows], distance, right, lateral)
    move_arcs(poses, moved, right, distance, lateral, left, scratch)


def _drawn(
        rows: int, noise: StepNoise, bits: 'np.random.SFC64', buffer: Array,
        distributions: Tuple[str, str]) -> Tuple[Array, Array, Array]:
    """Return the errors: of the half turn by either wheel [rad], and to the side [m]."""
    if distributions != ('gaussian', 'gaussian'):
        generator = np.random.Generator(bits)
        (left, side_left), (right, side_right) = (
            np.asarray(draw_unit(name, generator, (2, rows))) for name in distributions)
        return (left * noise.left, right * noise.right,
                side_left * noise.lateral_left + side_right * noise.lateral_right)
    pairs = (3 * rows + 1) // 2
    drawn = buffer[:2 * pairs]
    fill_normals(bits, drawn, buffer[-2 * pairs:].reshape(2, pairs))
    left, right, lateral = drawn[:3 * rows].reshape(3, rows)
    left *= noise.left
    right *= noise.right
    lateral *= np.sqrt(noise.lateral_left**2 + noise.lateral_right**2)
    return left, right, lateral


def _disturb(
        body: BodyNoise, bits: 'np.random.SFC64', buffer: Array, distance: Array, half: Array,
        lateral: Array) -> None:
    """Add what the body slips to travel, half turn and displacement of every pose."""
    rows = len(half)
    pairs = (3 * rows + 1) // 2
    drawn = buffer[:2 * pairs]
    if body.distribution == 'gaussian':
        fill_normals(bits, drawn, buffer[-2 * pairs:].reshape(2, pairs))
    else:
        drawn[:3 * rows] = draw_unit(body.distribution, np.random.Generator(bits), 3 * rows)
    for place, error, stddev in zip(
            (distance, half, lateral), drawn[:3 * rows].reshape(3, rows), body[:3]):
        error *= stddev
        place += error


def moved_arcs(
        poses: Columns, half: Array, distance: Array, lateral: Array) -> Columns:
    """
    Return poses after arcs and then a displacement sideways: what :func:`move_arcs` computes.

    Parameters
    ----------
    poses : Columns
        Where they are, shape (n,) each.
    half : numpy.ndarray, shape (n,)
        Half the turn of each [rad].
    distance, lateral : numpy.ndarray, shape (n,)
        Length of each arc, and the displacement to its left [m].

    Returns
    -------
    Columns
        Where they come to lie.

    Examples
    --------
    >>> moved = moved_arcs(Columns(*np.zeros((3, 1))), np.zeros(1), np.ones(1), np.ones(1))
    >>> float(moved.x[0]), float(moved.y[0])
    (1.0, 1.0)

    """
    phi, chord = poses.theta + half, distance * sinc(half)
    return Columns(
        poses.x + chord * np.cos(phi) - lateral * np.sin(phi),
        poses.y + chord * np.sin(phi) + lateral * np.cos(phi), phi + half)


def move_arcs(
        poses: Columns, moved: Columns, half: Array, distance: Array, lateral: Array,
        tangent: Array, weight: Array) -> None:
    """
    Move poses along arcs and then sideways; all but ``poses`` are overwritten.

    The same as :func:`moved_arcs`, in place.  One tan, which numpy computes on several elements
    at once, stands for sine and cosine: with t = tan(phi / 2) and w = 1 + t^2 they are 2 t / w
    and (2 - w) / w.  tan stays finite, as no double is an odd multiple of pi / 2; ``TINY`` makes
    sin h / h = 1 of h = 0.

    Parameters
    ----------
    poses, moved : Columns
        Where they are, and where they come to lie, shape (n,) each.
    half : numpy.ndarray, shape (n,)
        Half the turn of each [rad].
    distance, lateral : numpy.ndarray, shape (n,)
        Length of each arc, and the displacement to its left [m].
    tangent, weight : numpy.ndarray, shape (n,)
        Work space.

    Examples
    --------
    >>> moved = Columns(*np.empty((3, 1)))
    >>> move_arcs(Columns(*np.zeros((3, 1))), moved, np.zeros(1), np.ones(1), np.ones(1),
    ...           *np.empty((2, 1)))
    >>> round(float(moved.x[0]), 9), float(moved.y[0])
    (1.0, 1.0)

    """
    x, y, theta = moved
    np.add(poses.theta, half, out=tangent)  # phi
    np.add(tangent, half, out=theta)
    tangent *= 0.5
    np.tan(tangent, out=tangent)
    half += TINY
    distance /= half
    half *= 0.5
    np.tan(half, out=half)
    distance *= half
    half *= half
    half += 1.0
    np.multiply(tangent, tangent, out=weight)
    weight += 1.0
    half *= weight
    distance *= 2.0
    distance /= half  # chord / w
    lateral /= weight
    tangent *= 2.0
    np.subtract(2.0, weight, out=weight)
    np.multiply(distance, weight, out=half)
    half += poses.x
    np.multiply(lateral, tangent, out=x)
    np.subtract(half, x, out=x)
    distance *= tangent
    lateral *= weight
    distance += lateral
    np.add(distance, poses.y, out=y)
