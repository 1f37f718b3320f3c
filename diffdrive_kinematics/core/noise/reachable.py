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
Forward projection of a set: where the robot can be under bounded disturbances (LaValle 2.34).

W(u) is a box: in each stage the travel of the left and of the right wheel is off by at most its
bound, the robot may be displaced sideways by at most the lateral bound, and where the body slips
travel and turn may be off by more than the wheels make of it, each constant over the stage (the
same model that ``projection`` samples).  The forward
projection over several stages (2.35) is computed from the last stage to the first, as a set of
positions in the frame of the robot at the start of the stage: ::

    R_i = union over w in W(u_i) of  c(w) + rotation(2 h(w)) R_(i+1),    R_(k+1) = {0}

All motions of the union are rigid, so errors do not grow from stage to stage, and the set is
planar, as the bounds do not depend on the heading.  For a fixed half turn h it is a Minkowski sum
of a polygon and a rectangle (distance times displacement to the side); over h the boundary of
that sum sweeps a mesh of triangles.  The outer boundary of the mesh runs along edges whose
triangles lie on one side, and is found by walking around those.

The polygon is an outer approximation: what the chords of the mesh and the simplification cut off
is added as a margin in every stage, together below 1 % of the area.  Sets as thin as a curve,
such as that of a robot with one wheel at rest, get wider margins relative to their area, and so
do those of bounds that turn the robot by radians: up to a third of it.
Holes (a robot that may turn all around) are filled.  The cost is that of finding the crossings
among some hundred to some thousand segments: 2 to 20 ms a stage.  Stages in which one wheel rests
keep the robot on a circle about it, and are one stage together.
"""

import math
from typing import Sequence, Tuple, Union

from diffdrive_kinematics.core.kinematics import (
    Array, check_count, check_finite, check_non_negative, Pose, WheelGeometry)
from diffdrive_kinematics.core.noise.body_slip import BodySlip, NO_BODY_SLIP
from diffdrive_kinematics.core.noise.noise import WheelSlip
from diffdrive_kinematics.core.noise.outline import outer_boundary
from diffdrive_kinematics.core.noise.polygons import area, perimeter, Points, simplified
from diffdrive_kinematics.core.noise.reach_mesh import (
    mesh_of, slices_of, turn_errors, turned_edges)
from diffdrive_kinematics.core.noise.stage import Stage, stage_from_slip, with_pivots_joined
import numpy as np

Bounds = Union[float, Sequence[float]]

SHARE = 0.006
"""Of the area over the perimeter: the margins of all stages together."""

FLOAT32 = 2.0**-24
"""What rounding to float32 moves a coordinate by, relative to it."""

LEAST = 1e-8
"""Least margin [m] of a stage, so that a set without disturbances has an inside."""

THINNEST = 2e-6
"""Least margin of a stage, relative to the length of the set."""

MOST_FOLDS = 600
"""How many segments inside of a mesh are worth a finer one: a set like a curve folds all over."""

FEWEST_SLICES, MOST_SLICES = 6, 128


def reachable_set_from_slip(
        pose: Pose, travels: Sequence[Tuple[float, float]], geometry: WheelGeometry,
        left_slip: WheelSlip, right_slip: WheelSlip, *, most_vertices: int = 1000,
        body: BodySlip = NO_BODY_SLIP) -> Tuple[Array, Array]:
    """
    Return the boundary that holds every sample of bounded slip; see :func:`reachable_set`.

    Parameters
    ----------
    pose : Pose
        The start, floats.
    travels : sequence of (d_left, d_right)
        Nominal travel [m] of the wheels in each of the k stages, at least one.
    geometry : WheelGeometry
        Distance of the wheels.
    left_slip, right_slip : WheelSlip
        Of the wheels: bias, bounds and the lateral part come from them.
    most_vertices : int
        Bound of the number of vertices, 64 or above; a wider margin makes up for a small one.
    body : BodySlip
        What slips beside the wheels.

    Returns
    -------
    x : numpy.ndarray, shape (v,)
        Of the vertices [m], counter-clockwise, not closed.
    y : numpy.ndarray, shape (v,)
        Of the vertices [m], likewise.

    Raises
    ------
    ValueError
        If there are no travels, a value is not finite, a slip that is not 0 has an unbounded
        distribution, or ``most_vertices`` is below 64.

    Examples
    --------
    >>> slip = WheelSlip(variance=1e-4, distribution='uniform')
    >>> x, y = reachable_set_from_slip(
    ...     Pose(0.0, 0.0, 0.0), [(1.0, 1.0)], WheelGeometry(0.5, 0.125), slip, slip)
    >>> f'{x.min():.2f} m to {x.max():.2f} m'  # 1 m, give or take sqrt(3) * 1 cm
    '0.98 m to 1.02 m'

    """
    stages = [
        stage_from_slip(*travel, geometry, left_slip, right_slip, body) for travel in travels]
    return _reachable(pose, stages, geometry, most_vertices)


def reachable_set(
        pose: Pose, travels: Sequence[Tuple[float, float]], geometry: WheelGeometry,
        left_bound: Bounds, right_bound: Bounds, lateral_bound: Bounds = 0.0,
        distance_bound: Bounds = 0.0, turn_bound: Bounds = 0.0, *, most_vertices: int = 1000
) -> Tuple[Array, Array]:
    """
    Return the boundary of the nondeterministic forward projection (LaValle 2.34, 2.35).

    Parameters
    ----------
    pose : Pose
        The start, floats.
    travels : sequence of (d_left, d_right)
        Mean travel [m] of the wheels in each of the k stages, at least one.
    geometry : WheelGeometry
        Distance of the wheels.
    left_bound, right_bound, lateral_bound, distance_bound : float or sequence of float
        Bounds [m] of the disturbances, of all stages or of each, as in :class:`.Stage`.
    turn_bound : float or sequence of float
        Likewise [rad].
    most_vertices : int
        Bound of the number of vertices, 64 or above; a wider margin makes up for a small one.

    Returns
    -------
    x : numpy.ndarray, shape (v,)
        Of the vertices [m], counter-clockwise, not closed: the last is not the first again.
    y : numpy.ndarray, shape (v,)
        Of the vertices [m], likewise.

    Raises
    ------
    ValueError
        If there are no travels, a value is not finite, a bound is negative or of another
        number, or ``most_vertices`` is below 64.

    Examples
    --------
    Wheels that are off by at most 1 cm turn the robot by at most 0.04 rad on 1 m, so that it ends
    up to 2 cm to the side:

    >>> x, y = reachable_set(Pose(0.0, 0.0, 0.0), [(1.0, 1.0)], WheelGeometry(0.5, 0.125),
    ...                      left_bound=0.01, right_bound=0.01)
    >>> f'{x.min():.2f} m to {x.max():.2f} m, {y.min():.2f} m to {y.max():.2f} m'
    '0.99 m to 1.01 m, -0.02 m to 0.02 m'

    """
    bounds = [_per_stage(name, bound, len(travels)) for name, bound in (
        ('left_bound', left_bound), ('right_bound', right_bound),
        ('lateral_bound', lateral_bound), ('distance_bound', distance_bound),
        ('turn_bound', turn_bound))]
    stages = [
        Stage(check_finite('d_left', d_left), check_finite('d_right', d_right), *bound)
        for (d_left, d_right), *bound in zip(travels, *bounds)]
    return _reachable(pose, stages, geometry, most_vertices)


def _reachable(
        pose: Pose, stages: Sequence[Stage], geometry: WheelGeometry, most_vertices: int
) -> Tuple[Array, Array]:
    x, y, theta = (check_finite(name, value) for name, value in zip(  # type: ignore[arg-type]
        ('x', 'y', 'theta'), pose))
    if not stages:
        raise ValueError('travels is empty, expected at least one stage (d_left, d_right)')
    check_count('most_vertices', most_vertices, 64)
    stages, margin = with_pivots_joined(stages, geometry)
    share = SHARE / (len(stages) + 1)
    polygon = np.zeros(1, np.complex128)
    for stage in reversed(stages):
        polygon, margin = _before(polygon, margin, stage, geometry, share, most_vertices // 2)
    margin += FLOAT32 * float(np.max(np.abs(polygon)) + math.hypot(x, y))
    ring = slices_of(polygon, np.zeros(1), (np.zeros(1), np.zeros(1)), 0.0, margin)
    widened = outer_boundary(ring.reshape(-1), turned_edges(ring))
    placed = complex(x, y) + complex(math.cos(theta), math.sin(theta)) * widened
    return placed.real.copy(), placed.imag.copy()


def _before(
        polygon: Points, margin: float, stage: Stage, geometry: WheelGeometry, share: float,
        most: int) -> Tuple[Points, float]:
    """
    Return the set one stage earlier, and how far the true one may reach beyond it [m].

    The margin that its area allows is about that which the set given does.
    """
    radius, slices, tolerance = float(np.max(np.abs(polygon))), FEWEST_SLICES, math.inf
    if (guess := _tolerance(polygon, share)) > THINNEST * radius:
        tolerance = guess
    while True:
        nodes, sagitta = turn_errors(stage, geometry, radius, slices)
        mesh = mesh_of(polygon, margin + sagitta + LEAST, stage, geometry, nodes)
        turned = turned_edges(mesh)
        finest = len(turned) > 2 * len(mesh) + MOST_FOLDS or slices >= MOST_SLICES
        if sagitta <= tolerance or finest:  # a guess, or that of a coarser mesh
            outline = outer_boundary(mesh.reshape(-1), turned)
            size = float(np.max(np.abs(outline - outline[0])))
            tolerance = max(_tolerance(outline, share), THINNEST * size, LEAST)
            if sagitta <= tolerance or finest:
                break
        slices *= 2
    tolerance = max(tolerance, sagitta)
    smaller = simplified(outline, tolerance)
    while len(smaller) > most:
        tolerance *= 1.5
        smaller = simplified(outline, tolerance)
    return smaller, tolerance


def _tolerance(polygon: Points, share: float) -> float:
    """Return the margin [m] that adds a share to the area."""
    return share * area(polygon) / (perimeter(polygon) or math.inf)


def _per_stage(name: str, bound: Bounds, stages: int) -> Sequence[float]:
    values = [bound] * stages if isinstance(bound, (int, float)) else list(bound)
    if len(values) != stages:
        raise ValueError(f'{name} has {len(values)} values, expected one or {stages}')
    return [check_non_negative(name, value) for value in values]
