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

"""Sample paths of any model under disturbances of its commands (LaValle 2.35, 2.39)."""

from typing import List, Sequence, Tuple

from diffdrive_kinematics.core.kinematics import Array, check_count, Scalar
from diffdrive_kinematics.core.models.disturbance import Disturbance, disturbed, Step
from diffdrive_kinematics.core.models.system import ControlSystem, Vector
from diffdrive_kinematics.core.models.transitions import transition
import numpy as np


def sample_paths(
        system: ControlSystem, start: Vector, steps: Sequence[Step], disturbance: Disturbance, *,
        n: int, generator: 'np.random.Generator') -> Tuple[Array, ...]:
    """
    Return n sample paths: the forward projection over one and many steps (2.35, 2.39).

    Row 1 of each array is the one-step projection of ``start``, row k that of k steps.  For the
    differential drive with slip, :func:`diffdrive_kinematics.core.noise.sample_paths` is
    the fast one.

    Parameters
    ----------
    system : ControlSystem
        What moves.
    start : tuple
        State of all paths (floats), or of each (arrays, shape (n,)).
    steps : sequence of (command, duration)
        The k commands, and for how long [s] each is held.
    disturbance : Disturbance
        Of the commands, drawn anew for each step.
    n : int
        Number of paths.
    generator : numpy.random.Generator
        Source of randomness.

    Returns
    -------
    tuple of arrays, shape (k + 1, n)
        One for each state.

    Raises
    ------
    ValueError
        If ``n`` is no integer, 1 or above, or the disturbance has not one number for each
        command.

    Examples
    --------
    >>> from diffdrive_kinematics.core.models import bounded, unicycle
    >>> x, y, theta = sample_paths(
    ...     unicycle(), (0.0, 0.0, 0.0), [((1.0, 0.1), 0.5)] * 4, bounded([0.1, 0.0]), n=50,
    ...     generator=np.random.default_rng(1))
    >>> x.shape, bool(abs(theta[-1] - 0.2).max() < 1e-12)
    ((5, 50), True)

    """
    check_count('n', n)
    state: Vector = tuple(np.array(np.broadcast_to(value, (n,)), np.float64) for value in start)
    path: List[Sequence[Scalar]] = [state]
    for command, duration in steps:
        state = transition(
            system, state, disturbed(command, disturbance, n=n, generator=generator), duration)
        path.append(state)
    return tuple(np.stack(np.broadcast_arrays(*column)) for column in zip(*path))
