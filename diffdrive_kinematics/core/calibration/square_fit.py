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
Calibration from few runs around a square: UMBmark, solved exactly, and what to expect of it.

The equations of Borenstein & Feng 1996 are of the first order; what they leave of E_b and E_d of
1 % is several standard errors of five runs.  Here the same two means of the runs, ``x + y``
clockwise and ``x - y`` counterclockwise, are solved for E_b and E_d with the exact kinematics by
a chord method, from the first-order solution.  Standard errors follow from the scatter of the
runs through the Jacobian at the solution, with the degrees of freedom of that scatter.

New runs end where the correction leaves them, plus what the estimate is off, plus their own
scatter.  ``SquareFit.predicted_error`` counts all three, so it is about right after a correction,
and up to 45 % too large where there was nothing to correct.
"""

from dataclasses import dataclass, replace
from typing import Sequence

from diffdrive_kinematics.core.calibration.calibration_parameters import Estimate, student_quantile
from diffdrive_kinematics.core.calibration.square_runs import ReturnError, Umbmark
from diffdrive_kinematics.core.calibration.umbmark import reread, umbmark, with_ratios
from diffdrive_kinematics.core.commands import square_course
from diffdrive_kinematics.core.kinematics import Array, Pose, pose_after, WheelGeometry
import numpy as np

SHARE = 0.95
"""Confidence beyond which a correction counts as one."""
DRAWS, SEED = 2000, 1996
STEP = 1e-5
"""Of E_b and E_d, for central differences."""
SMALLEST_STEP, MOST_ROUNDS = 1e-10, 50
MEANS = np.array([[1.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, -1.0]])
"""The two means of (x_cw, y_cw, x_ccw, y_ccw) that tell alpha + beta and alpha - beta."""
MIRROR = np.array([1.0, -1.0])


@dataclass(frozen=True)
class SquareFit:
    """
    Systematic errors from runs around a square, and the correction that they justify.

    Parameters
    ----------
    umbmark : Umbmark
        The errors.  ``(value - truth) / error`` of E_b and E_d follows Student's t with
        ``degrees_of_freedom``.  What is left (``*_after``) is that of the same runs.
    geometry : WheelGeometry
        The geometry with what counts of the correction.
    separation_counts, diameters_count : bool
        Whether E_b and E_d differ from 1 by more than their interval of 95 %; if not, the
        geometry keeps what it had.
    quantile : float
        Student's t of 95 %: the interval is +- ``quantile`` standard errors.
    predicted_error : float
        Root mean square [m] of the E_max,syst to expect in as many new runs with ``geometry``.

    Examples
    --------
    See :func:`fit_squares`.

    """

    umbmark: Umbmark
    geometry: WheelGeometry
    separation_counts: bool
    diameters_count: bool
    quantile: float
    predicted_error: float


class _Square:
    """Where runs of both directions end, as seen with other wheels than odometry had."""

    def __init__(self, geometry: WheelGeometry, side: float, corner_radius: float) -> None:
        self.geometry = geometry
        courses = [square_course(side=side, speed=1.0, yaw_rate=1.0, clockwise=way,
                                 corner_radius=corner_radius) for way in (True, False)]
        self.quarters = [course[:len(course) // 4] for course in courses]

    def ends(self, ratios: Array) -> Array:
        """Return (x, y) at the end, clockwise and then counterclockwise, shape (4,)."""
        after, found = with_ratios(self.geometry, *ratios.tolist()), []
        for quarter in self.quarters:
            pose = pose_after(
                Pose(0.0, 0.0, 0.0), [reread(each, self.geometry, after) for each in quarter])
            turn = complex(np.exp(1j * float(pose.theta)))
            end = complex(float(pose.x), float(pose.y)) * (1.0 + turn + turn**2 + turn**3)
            found += [end.real, end.imag]
        return np.array(found)

    def jacobian(self, ratios: Array) -> Array:
        """Return the derivative of the ends by E_b and E_d, shape (4, 2)."""
        return np.stack([(self.ends(ratios + step) - self.ends(ratios - step)) / (2.0 * STEP)
                         for step in STEP * np.eye(2)], axis=1)

    def solution(self, start: Array, centres: Array) -> Array:
        """Return (E_b, E_d) that explain the means of the centres, shape (2,)."""
        ratios: Array = start
        inverse = np.linalg.inv(MEANS @ self.jacobian(start))
        for _ in range(MOST_ROUNDS):
            step = inverse @ MEANS @ (centres - self.ends(ratios))
            ratios = ratios + step
            if not (np.abs(ratios - 1.0) < 0.9).all():
                break
            if np.abs(step).max() < SMALLEST_STEP:
                return ratios
        raise ValueError(
            f'no wheels explain return errors with the centres {centres.round(4).tolist()} m '
            '(clockwise x, y, counterclockwise x, y), expected runs around the square that '
            'square_side and square_corner_radius tell')


def fit_squares(
        geometry: WheelGeometry, side: float, clockwise: Sequence[ReturnError],
        counterclockwise: Sequence[ReturnError], *, corner_radius: float = 0.0) -> SquareFit:
    """
    Return the systematic errors that runs of both directions show, by exact kinematics.

    Parameters
    ----------
    geometry : WheelGeometry
        Geometry that odometry used.
    side : float
        Side of the square [m], as :func:`.square_course` drives it.
    clockwise, counterclockwise : sequence of ReturnError
        At least 2 runs each.
    corner_radius : float
        Radius of the square's corners [m], at most half the side; 0 = turns on the spot.

    Returns
    -------
    SquareFit
        Errors, the geometry with the correction, and what to expect of it.

    Raises
    ------
    ValueError
        As :func:`.umbmark`, or if no wheels explain the runs.

    Examples
    --------
    A robot that turns too little, seen in runs that scatter by half a centimetre:

    >>> runs = [(-0.155, -0.16), (-0.165, -0.16), (-0.16, -0.16)]
    >>> found = fit_squares(
    ...     WheelGeometry(0.5, 0.125), 4.0, clockwise=[ReturnError(x, y) for x, y in runs],
    ...     counterclockwise=[ReturnError(x + 0.03, -y) for x, y in runs])
    >>> found.separation_counts, found.diameters_count
    (True, True)
    >>> f'{found.umbmark.separation_ratio.value:.4f}, {found.geometry.separation:.4f} m'
    '1.0122, 0.5061 m'

    """
    first = umbmark(geometry, side, clockwise, counterclockwise, corner_radius=corner_radius)
    square = _Square(geometry, side, corner_radius)
    centres = np.array([*first.clockwise, *first.counterclockwise])
    ratios = square.solution(
        np.array([first.separation_ratio.value, first.diameter_ratio.value]), centres)
    of_centres = _covariance_of_centres(clockwise, counterclockwise)
    jacobian = square.jacobian(ratios)
    response = np.linalg.solve(MEANS @ jacobian, MEANS)
    errors = np.sqrt(np.maximum(np.diag(response @ of_centres @ response.T), 0.0))
    quantile = student_quantile(SHARE, first.degrees_of_freedom)
    counts = np.abs(ratios - 1.0) > quantile * errors
    separation_counts, diameters_count = counts.tolist()
    applied, at_best = np.where(counts, ratios, 1.0), square.ends(ratios)
    at_geometry = square.ends(applied)
    left = centres - at_geometry
    e_b, e_d = (Estimate(*pair) for pair in zip(ratios.tolist(), errors.tolist()))
    return SquareFit(
        replace(first, separation_ratio=e_b, diameter_ratio=e_d,
                clockwise_after=ReturnError(*left[:2].tolist()),
                counterclockwise_after=ReturnError(*left[2:].tolist()),
                error_after=float(max(np.hypot(*left[:2]), np.hypot(*left[2:])))),
        with_ratios(geometry, *applied.tolist()), separation_counts, diameters_count, quantile,
        _predicted(centres - at_best, at_best - at_geometry, of_centres, jacobian @ response))


def _covariance_of_centres(
        clockwise: Sequence[ReturnError], counterclockwise: Sequence[ReturnError]) -> Array:
    """Return the covariance [m^2] of both centres, from the pooled scatter, shape (4, 4)."""
    offsets = [np.array(runs) - np.mean(runs, axis=0) for runs in (clockwise, counterclockwise)]
    pooled = np.concatenate([offsets[0], offsets[1] * MIRROR])  # one is the other in a mirror
    scatter = pooled.T @ pooled / (len(pooled) - 2)
    covariance = np.zeros((4, 4))
    covariance[:2, :2] = scatter / len(clockwise)
    covariance[2:, 2:] = scatter * np.outer(MIRROR, MIRROR) / len(counterclockwise)
    return covariance


def _predicted(misfit: Array, kept_back: Array, of_centres: Array, spread: Array) -> float:
    """
    Return the root mean square [m] of E_max,syst of new runs.

    ``misfit`` is what no wheels explain of the centres, partly their scatter, which new runs do
    not repeat; ``kept_back`` what a correction that does not count would take away; ``spread``
    (4, 4) tells how errors of the old centres move the ends through the estimate.
    """
    rest = np.eye(4) - spread
    size = float(misfit @ misfit)
    lasting = max(size - float(np.trace(rest @ of_centres @ rest.T)), 0.0)
    shrunk = misfit * np.sqrt(lasting / size) if size else misfit
    values, vectors = np.linalg.eigh(of_centres)
    root = vectors * np.sqrt(np.maximum(values, 0.0))
    old, new = np.random.default_rng(SEED).standard_normal((2, DRAWS, 4)) @ root.T
    ends = (shrunk + kept_back + old @ spread.T + new).reshape(DRAWS, 2, 2)
    return float(np.sqrt((ends**2).sum(axis=2).max(axis=1).mean()))
