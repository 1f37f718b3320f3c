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

from typing import Tuple

from diffdrive_kinematics.core.kinematics import Array, WheelGeometry
from diffdrive_kinematics.core.noise.columns import Columns
from diffdrive_kinematics.core.noise.distributions import draw_unit
from diffdrive_kinematics.core.noise.half_angles import fill_half_angles, fill_sincs
from diffdrive_kinematics.core.noise.normals import fill_normals
from diffdrive_kinematics.core.noise.step_noise import StepNoise
import numpy as np
from numpy.typing import NDArray


def move_chunk(
        poses: Columns, moved: Columns, geometry: WheelGeometry, noise: StepNoise,
        generator: 'np.random.Generator', work: Array, distributions: Tuple[str, str]) -> None:
    """
    Move the poses of one chunk into ``moved``, in place on the work space.

    Parameters
    ----------
    poses : Columns
        Where they are, shape (n,) each; not written.
    moved : Columns
        Where they come to lie; overwritten.  A column may be that of ``poses``.
    geometry : WheelGeometry
        Distance of the wheels.
    noise : StepNoise
        Of the step.
    generator : numpy.random.Generator
        Source of randomness.
    work : numpy.ndarray, shape (8, n)
        Work space; overwritten.  Its rows follow each other in memory.
    distributions : pair of str
        Of the slip of the wheels (left, right).

    Examples
    --------
    Without slip it is the arc of :func:`.advance`:

    >>> from diffdrive_kinematics.core.noise import step_noise, WheelSlip
    >>> moved, geometry = Columns(*np.zeros((3, 1))), WheelGeometry(0.5, 0.125)
    >>> noise = step_noise(1.0, 1.0, geometry, WheelSlip(), WheelSlip())
    >>> move_chunk(Columns(*np.zeros((3, 1))), moved, geometry, noise, np.random.default_rng(1),
    ...            np.empty((8, 1)), ('gaussian', 'gaussian'))
    >>> round(float(moved.x[0]), 9)
    1.0

    """
    left, right, lateral, distance, spare = work[:5]
    _draw_errors(noise, generator, work, distributions)
    np.add(left, right, out=distance)
    distance *= geometry.separation
    distance += noise.distance
    right -= left
    right += noise.half_turn
    if noise.body:
        for place, stddev in zip((distance, right, lateral), noise.body[:3]):
            _draw(noise.body.distribution, generator, spare, work[5:])
            spare *= stddev
            place += spare
    move_arcs(poses, moved, right, distance, lateral, left, *work[4:6])


def _draw_errors(
        noise: StepNoise, generator: 'np.random.Generator', work: Array,
        distributions: Tuple[str, str]) -> None:
    """Write the errors: of the half turn by either wheel [rad], and to the side [m]."""
    left, right, lateral, side = work[:4]
    if distributions == ('gaussian', 'gaussian'):
        fill_normals(generator, work[:3].reshape(-1), _floats(work[3:]))
        lateral *= np.sqrt(noise.lateral_left**2 + noise.lateral_right**2)
    else:
        for name, error, to_side in zip(distributions, (left, right), (lateral, side)):
            _draw(name, generator, error, work[4:])
            _draw(name, generator, to_side, work[4:])
        lateral *= noise.lateral_left
        side *= noise.lateral_right
        lateral += side
    left *= noise.left
    right *= noise.right


def _draw(
        distribution: str, generator: 'np.random.Generator', draws: Array, work: Array) -> None:
    if distribution == 'gaussian':
        fill_normals(generator, draws, _floats(work))
    else:
        draws[:] = draw_unit(distribution, generator, len(draws))


def _floats(work: Array) -> NDArray[np.float32]:
    """Return the memory of rows as float32."""
    return work.reshape(-1).view(np.float32)


def move_arcs(
        poses: Columns, moved: Columns, half: Array, distance: Array, lateral: Array,
        p: Array, q: Array, work: Array) -> None:
    """
    Move poses along arcs and then sideways; all but ``poses`` are overwritten.

    ``phi = theta + h``, ``c = distance sin(h) / h``, ``x' = x + c cos phi - lateral sin phi``,
    ``y' = y + c sin phi + lateral cos phi``, ``theta' = theta + 2 h``, each within some units of
    the last place.

    Parameters
    ----------
    poses, moved : Columns
        Where they are, and where they come to lie, shape (n,) each; may be the same columns.
    half : numpy.ndarray, shape (n,)
        Half the turn h of each [rad].
    distance, lateral : numpy.ndarray, shape (n,)
        Length of each arc, and the displacement to its left [m].
    p, q, work : numpy.ndarray, shape (n,)
        Work space.

    Examples
    --------
    >>> moved = Columns(*np.empty((3, 1)))
    >>> move_arcs(Columns(*np.zeros((3, 1))), moved, np.zeros(1), np.ones(1), np.ones(1),
    ...           *np.empty((3, 1)))
    >>> round(float(moved.x[0]), 9), round(float(moved.y[0]), 9)
    (1.0, 1.0)

    """
    x, y, theta = moved
    np.add(poses.theta, half, out=p)  # phi
    np.add(p, half, out=theta)
    fill_sincs(half, q, work)
    distance *= q
    fill_half_angles(p, q, work)
    np.multiply(p, q, out=work)
    work *= 2.0  # sin phi, times the length p^2 + q^2
    np.square(p, out=p)
    np.square(q, out=q)
    np.add(p, q, out=half)
    q -= p  # cos phi, likewise
    distance /= half
    lateral /= half
    np.multiply(distance, q, out=p)
    np.multiply(lateral, work, out=half)
    p -= half
    np.add(p, poses.x, out=x)
    distance *= work
    lateral *= q
    distance += lateral
    np.add(distance, poses.y, out=y)
