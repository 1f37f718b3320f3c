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
Least squares by the steps of Gauss and Newton, of bounded length, with a trace of the way.

The solver knows nothing of what is fitted.  A model at some values of its parameters
tells its cost, its normal equations ``H step = -g``, how far one step may go, and what it is
elsewhere.
"""

from typing import Callable, List, NamedTuple, Protocol, Tuple, TypeVar

from diffdrive_kinematics.core.kinematics import Array
import numpy as np

ROUNDS, SETTLED = 100, 1e-2
"""Steps after which the search gives up, and standard errors below which a step ends it."""
NEGLIGIBLE = 1e-3
"""Change of the cost that no estimate feels."""
SHARES = (1.0, 0.5, 0.25, 0.1, 0.02)
"""Shares of a step that are tried until one lowers the cost."""


class Iteration(NamedTuple):
    """
    One step of a search.

    Parameters
    ----------
    cost : float
        Weighted sum of squares before the step [1].
    step : float
        Largest change of a parameter that the step asks for, in standard errors [1].

    Examples
    --------
    >>> Iteration(cost=812.5, step=0.2).cost
    812.5

    """

    cost: float
    step: float


Watch = Callable[[Iteration], None]
"""What is told of each step; what it raises ends the search."""


class NewtonStep(NamedTuple):
    """
    A step towards the least squares.

    Parameters
    ----------
    change : numpy.ndarray, shape (p,)
        What to add to the values, shortened where it is long.
    inverse : numpy.ndarray, shape (p, p)
        ``H^-1``, the covariance of independent errors of variance 1.

    Examples
    --------
    >>> step = NewtonStep(change=np.array([0.2]), inverse=np.array([[0.01]]))
    >>> round(step.size, 6), step.small
    (2.0, False)

    """

    change: Array
    inverse: Array

    @property
    def size(self) -> float:
        """Largest change of a parameter in standard errors [1]."""
        return float(np.max(np.abs(self.change) / np.sqrt(np.diag(self.inverse))))

    @property
    def small(self) -> bool:
        """Whether no parameter moves by more than a fraction of its standard error."""
        return bool((np.abs(self.change) <= SETTLED * np.sqrt(np.diag(self.inverse))).all())


class _Point(Protocol):
    """A model at some values of its p parameters."""

    def cost(self) -> float:
        """Return the weighted sum of squares, which is to be least."""

    def normal_equations(self) -> Tuple[Array, Array]:
        """Return H, shape (p, p), and g, shape (p,): half the derivatives of the cost."""

    def longest_step(self) -> Array:
        """Return how far each parameter may move in one step, shape (p,)."""

    def moved(self: 'Model', change: Array) -> 'Model':
        """Return the model where the values are greater by ``change``, shape (p,)."""


Model = TypeVar('Model', bound=_Point)


def newton_step(point: _Point) -> NewtonStep:
    """
    Return the step of Gauss and Newton, shortened where it is long.

    Parameters
    ----------
    point : model
        Where the search stands.

    Returns
    -------
    NewtonStep
        The step and ``H^-1``.

    Examples
    --------
    See :func:`descend`.

    """
    information, gradient = point.normal_equations()
    inverse = inverse_of(information)
    step = -inverse @ gradient
    longest = np.max(np.abs(step) / point.longest_step())
    return NewtonStep(step / max(longest, 1.0), inverse)


def inverse_of(information: Array) -> Array:
    """
    Return the inverse of a positive definite matrix whose units differ.

    Parameters
    ----------
    information : numpy.ndarray, shape (p, p)
        The matrix.

    Returns
    -------
    numpy.ndarray, shape (p, p)
        Its inverse, the pseudo-inverse where it is singular.

    Examples
    --------
    >>> inverse_of(np.diag([4.0, 1e-12])).round(6)
    array([[2.5e-01, 0.0e+00],
           [0.0e+00, 1.0e+12]])

    """
    size = np.sqrt(np.maximum(np.diag(information), 1e-300))
    scaled = information / np.outer(size, size)
    found: Array = np.linalg.pinv(scaled, rcond=1e-14, hermitian=True) / np.outer(size, size)
    return found


def descend(point: Model, watch: Watch) -> Tuple[Model, List[Iteration]]:
    """
    Return the point of least cost, found by steps that lower the cost.

    A cost that bends (held wheel rates make it do so at each stamp) lets full steps go to and
    fro, so shares of a step are tried as well.

    Parameters
    ----------
    point : model
        Where the search starts.
    watch : callable
        Told of each step.

    Returns
    -------
    point : model
        Where it ends.
    trace : list of Iteration
        The steps on the way.

    Raises
    ------
    ValueError
        If the search does not end.

    Examples
    --------
    The square root of 2, as the x that brings x^2 nearest to it:

    >>> class Root(NamedTuple):
    ...     x: Array
    ...     def cost(self): return float((self.x[0]**2 - 2.0)**2)
    ...     def longest_step(self): return np.array([1.0])
    ...     def moved(self, change): return Root(self.x + change)
    ...     def normal_equations(self):
    ...         slope = 2.0 * self.x
    ...         return np.outer(slope, slope), slope * (self.x**2 - 2.0)
    >>> found, trace = descend(Root(np.array([5.0])), watch=lambda iteration: None)
    >>> round(float(found.x[0]), 1), len(trace) > 2, trace[-1].cost < trace[0].cost
    (1.4, True, True)
    >>> newton_step(found).change.shape
    (1,)

    """
    cost, trace = point.cost(), []
    for _ in range(ROUNDS):
        step = newton_step(point)
        trace.append(Iteration(cost, step.size))
        watch(trace[-1])
        if step.small:
            return point, trace
        for share in SHARES:
            trial = point.moved(share * step.change)
            reached = trial.cost()
            if reached < cost:
                break
        if reached > cost - NEGLIGIBLE:
            return point, trace
        point, cost = trial, reached
    raise ValueError(
        f'the fit did not settle in {ROUNDS} steps, expected a geometry and clocks that are '
        f'nearer to the truth')
