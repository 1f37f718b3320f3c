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
Forward projection by samples: many poses through the same noisy travel (LaValle, sec. 2.4).

The slip of a wheel is gathered along the way, so a step that puts all of it into one arc has the
right heading but up to 25 % too little variance across the track.  What lacks is the part of the
slip that cancels over the step (a Brownian bridge): it leaves the heading alone and displaces the
robot sideways, along (-sin phi, cos phi) with phi = theta + h the direction of the chord, by
``sigma^2 = (q_r d_l^2 + q_l d_r^2) / (12 L^2)``, ``q = Var e`` of the wheel.  With this third
draw the statistics do not depend on how a path is cut into steps: within 1 % up to 0.3 rad a
step.  The law ``command`` has one error per interval, and no such part.  What the body slips is
drawn likewise (:func:`.body_noise`).
"""

from concurrent.futures import ThreadPoolExecutor
import math
from typing import Optional, Sequence, Tuple, Union

from diffdrive_kinematics.core.kinematics import (
    Array, check_count, check_finite, Command, Pose, Scalar, WheelGeometry)
from diffdrive_kinematics.core.noise.arcs_in_place import move_chunk
from diffdrive_kinematics.core.noise.body_slip import BodySlip, NO_BODY_SLIP
from diffdrive_kinematics.core.noise.columns import (
    checked_columns, checked_out, Columns, described)
from diffdrive_kinematics.core.noise.noise import WheelSlip
from diffdrive_kinematics.core.noise.session_errors import (
    draw_session, NO_SESSION, session_generator, SessionSpread, travel_in_session)
from diffdrive_kinematics.core.noise.step_noise import step_noise, travel_of_command
import numpy as np

Seed = Union[int, Sequence[int]]

ROWS = 16384
"""Poses of one chunk: its work buffers stay in the cache, the cost of a call does not count."""

MOST_THREADS = 8
"""Threads that work at once: bounds the memory of their buffers."""


def propagate(
        poses: Pose, d_left: Scalar, d_right: Scalar, geometry: WheelGeometry,
        left_slip: WheelSlip, right_slip: WheelSlip, *, seed: Seed, threads: int = 1,
        body: BodySlip = NO_BODY_SLIP, out: Optional[Pose] = None) -> Pose:
    """
    Return where N poses are after one noisy step of wheel travel.

    The same arguments and version of numpy give the same result, bit for bit, on any x86-64
    processor and any number of threads: every chunk of poses has a random stream of its own.
    Normals are of float32 (off by less than 1e-6, at most 6.66 times the standard deviation), all
    else is of float64.  Of truncated normals the last bit of those beyond 3.65 may differ where
    the C library or the architecture is another.  Beyond the poses returned the memory does not
    depend on N: 1 to 3 MB for each of up to 8 threads.  Headings may be of any size and are not
    wrapped.
    The last bit of a pose may depend on the others of its call.

    Parameters
    ----------
    poses : Pose
        Arrays of float64, shape (N,), each; not written, unless they are ``out``.
    d_left, d_right : float or numpy.ndarray, shape (N,)
        Nominal travel [m] of the wheels, of all poses or of each.
    geometry : WheelGeometry
        Distance of the wheels.
    left_slip, right_slip : WheelSlip
        Bias and slip of the wheels.
    seed : int or sequence of int
        Seed of the noise.  Another for every step: the same one repeats the same errors.
        ``(run, step)`` is a way to number them.
    threads : int
        How many threads share the work.
    body : BodySlip
        What slips beside the wheels.
    out : Pose, optional
        Arrays of float64, shape (N,), to overwrite with the result.  Each may be that of
        ``poses``, to move poses in place, and shares no memory with other arguments.

    Returns
    -------
    Pose
        New arrays of float64, shape (N,), or those of ``out``.

    Raises
    ------
    ValueError
        If an array has another shape or type, a travel is not finite, ``threads`` or the seed
        is out of range, or ``out`` cannot be written or shares memory.

    Examples
    --------
    The heading of 100000 robots after a straight metre, ``sigma^2 = (k_l + k_r) d / L^2``:

    >>> start, slip = Pose(*np.zeros((3, 100000))), WheelSlip(variance=1e-4)
    >>> after = propagate(start, 1.0, 1.0, WheelGeometry(0.5, 0.125), slip, slip, seed=1)
    >>> f'{after.theta.std():.3f} rad'
    '0.028 rad'

    """
    columns = checked_columns('the poses', poses)
    rows = len(columns.theta)
    d_left = _checked_travel('d_left', d_left, rows)
    d_right = _checked_travel('d_right', d_right, rows)
    check_count('threads', threads)
    numbers = _checked_seed(seed)
    entropy = (len(numbers), *numbers)  # the seeds 1, (1, 0) and (1, 0, 0) are not the same
    if out is None:
        moved = Columns(*(np.empty(rows) for _ in range(3)))
    else:
        moved = checked_out(out, columns, (d_left, d_right))
    starts = range(0, rows, ROWS)
    workers = max(1, min(threads, len(starts), MOST_THREADS))

    def work_on(worker: int) -> None:
        buffer = np.empty(8 * min(rows, ROWS))
        for chunk in range(worker, len(starts), workers):
            part = slice(starts[chunk], starts[chunk] + ROWS)
            noise = step_noise(
                _part(d_left, part), _part(d_right, part), geometry, left_slip, right_slip,
                body)
            bits = np.random.SFC64(np.random.SeedSequence(entropy, spawn_key=(chunk,)))
            place = _cut(moved, part)
            work = buffer[:8 * len(place.x)].reshape(8, -1)
            move_chunk(_cut(columns, part), place, geometry, noise, np.random.Generator(bits),
                       work, (left_slip.distribution, right_slip.distribution))

    if workers == 1:
        work_on(0)
    else:
        with ThreadPoolExecutor(workers) as pool:
            list(pool.map(work_on, range(workers)))
    return Pose(*moved)


def sample_paths(
        pose: Pose, commands: Sequence[Command], geometry: WheelGeometry, left_slip: WheelSlip,
        right_slip: WheelSlip, *, n: int, seed: Seed,
        session: SessionSpread = NO_SESSION, body: BodySlip = NO_BODY_SLIP) -> Pose:
    """
    Return sample paths of a sequence of commands (LaValle, fig. 2.25: 100 of 25 steps).

    Parameters
    ----------
    pose : Pose
        Start of all paths (floats), or of each (arrays, shape (n,)).
    commands : sequence of Command
        The k steps.
    geometry : WheelGeometry
        Distance of the wheels.
    left_slip, right_slip : WheelSlip
        Bias and slip of the wheels.
    n : int
        Number of paths.
    seed : int or sequence of int
        Seed of the noise.
    session : SessionSpread
        What lasts a run: each path has one draw of it.
    body : BodySlip
        What slips beside the wheels.

    Returns
    -------
    Pose
        Arrays of shape (k + 1, n): row i is where the paths are after i commands.  Headings are
        not wrapped.

    Raises
    ------
    ValueError
        If ``n`` is no integer, 1 or above, a start is not finite or has another shape, or the
        seed is out of range.

    Examples
    --------
    >>> slip, course = WheelSlip(variance=1e-4), 25 * [Command(0.2, 0.1, 1.0)]
    >>> paths = sample_paths(
    ...     Pose(0.0, 0.0, 0.0), course, WheelGeometry(0.5, 0.125), slip, slip, n=100, seed=1)
    >>> paths.x.shape
    (26, 100)

    """
    check_count('n', n)
    numbers = _checked_seed(seed)
    at = Pose(*(_start(name, value, n) for name, value in zip(Pose._fields, pose)))
    path = [at]
    error = draw_session(session, session_generator(*numbers), n) if session else None
    for step, command in enumerate(commands):
        travel: Tuple[Scalar, Scalar] = travel_of_command(command, geometry)
        if error:
            travel = travel_in_session(error, geometry.separation, *travel)
        at = propagate(at, *travel, geometry, left_slip, right_slip, seed=(*numbers, step),
                       body=body)
        path.append(at)
    return Pose(*(np.stack(column) for column in zip(*path)))


def _part(value: Scalar, part: slice) -> Scalar:
    return value[part] if isinstance(value, np.ndarray) else value


def _cut(columns: Columns, part: slice) -> Columns:
    return Columns(*(column[part] for column in columns))


def _checked_travel(name: str, travel: Scalar, rows: int) -> Scalar:
    if not isinstance(travel, np.ndarray):
        return check_finite(name, travel)
    if travel.shape != (rows,) or travel.dtype != np.float64:
        raise ValueError(
            f'{name} is {described(travel)}, expected a number or an array of float64 of shape '
            f'({rows},)')
    if not (math.isfinite(travel.min(initial=0.0)) and math.isfinite(travel.max(initial=0.0))):
        raise ValueError(f'{name} has elements that are not finite, expected finite numbers')
    return travel


def _checked_seed(seed: Seed) -> Tuple[int, ...]:
    numbers = tuple(seed) if isinstance(seed, (tuple, list)) else (seed,)
    if not numbers or not all(
            isinstance(number, (int, np.integer)) and not isinstance(number, bool)
            and number >= 0 for number in numbers):
        raise ValueError(f'seed is {seed!r}, expected an integer, 0 or above, or several')
    return tuple(int(number) for number in numbers)


def _start(name: str, value: Scalar, n: int) -> Array:
    start = np.array(np.broadcast_to(value, (n,)), dtype=np.float64)
    if not np.isfinite(start).all():
        raise ValueError(f'{name} of the start is {value!r}, expected finite numbers')
    return start
