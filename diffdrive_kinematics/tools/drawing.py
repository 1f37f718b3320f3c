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

"""The picture of a course under slip: sample paths, covariance ellipses, what can be reached."""

import io
from typing import Any, List, NamedTuple, Sequence, Tuple

from diffdrive_kinematics.core.kinematics import Array, Pose
from diffdrive_kinematics.core.noise import PoseCovariance
import numpy as np
from numpy.typing import NDArray

MISSING = "matplotlib, which is missing: pip install '.[plot]' or apt install python3-matplotlib"
"""What a picture needs, where :func:`new_figure` finds it not."""

CHI_SQUARE_95 = 5.991
"""What holds 95 % of a chi-square with 2 degrees of freedom."""

AROUND = np.linspace(0.0, 2.0 * np.pi, 73)
PATHS, MEAN, ELLIPSE, REACH = '#4477aa', 'black', '#cc3311', '#117733'
LONG_SIDE, SHORT_SIDE = 9.0, 4.5
ARC_RAD = 0.02  # turn between two points of an arc that is drawn

Outline = Tuple[Array, Array]


class Picture(NamedTuple):
    """
    What is to be seen, in metres.

    ``paths`` (n may be 0) and ``mean`` have arrays of shape (k + 1, n) and (k + 1,); ``beliefs``
    are means with covariances, ``boundaries`` the outlines of what can be reached; both after
    each command.  ``travels`` (k,) is how far the centre goes in each step, to draw arcs; without
    it, lines lead from pose to pose.
    """

    paths: Pose
    mean: Pose
    beliefs: List[Tuple[Pose, PoseCovariance]]
    boundaries: List[Outline]
    title: str
    travels: Sequence[float] = ()


def along_arcs(poses: Pose, travels: Sequence[float]) -> Pose:
    """
    Return poses with others between them, on arcs that end in the poses.

    Each step turns as its poses tell, and goes as far as ``travels``; what slip adds to that is
    spread evenly over the step.  A pose without slip is exact.

    Parameters
    ----------
    poses : Pose
        Of arrays, shape (k + 1,) or (k + 1, n).
    travels : sequence of float
        Nominal travel of the centre in each step [m]; none: the poses as they are.

    Returns
    -------
    Pose
        Of arrays, shape (m,) or (m, n), m at least k + 1.

    """
    points, headings = [poses.x[:1] + 1j * poses.y[:1]], [poses.theta[:1]]
    for step, travel in enumerate(travels):
        start, end = (poses.x[i] + 1j * poses.y[i] for i in (step, step + 1))
        heading, turn = poses.theta[step], poses.theta[step + 1] - poses.theta[step]
        count = 1 + int(np.max(np.abs(turn)) / ARC_RAD)
        part = (np.arange(1, count + 1) / count).reshape(-1, *np.ndim(turn) * (1,))

        def way(part: Array) -> NDArray[np.complex128]:
            half = 0.5 * part * turn
            return travel * part * np.sinc(half / np.pi) * np.exp(1j * (heading + half))

        points.append(start + way(part) + part * (end - start - way(np.float64(1.0))))
        headings.append(heading + part * turn)
    if not len(travels):
        return poses
    line = np.concatenate(points)
    return Pose(line.real, line.imag, np.concatenate(headings))


def ellipse(mean: Pose, covariance: PoseCovariance) -> Outline:
    """Return the outline [m] that holds the position with a probability of 95 %."""
    values, vectors = np.linalg.eigh(covariance.matrix()[:2, :2])
    radii = np.sqrt(CHI_SQUARE_95 * np.maximum(values, 0.0))
    points = vectors @ (radii[:, None] * np.stack([np.cos(AROUND), np.sin(AROUND)]))
    return mean.x + points[0], mean.y + points[1]


def drawn(pictures: Sequence[Picture], suffix: str) -> bytes:
    """
    Return pictures of one course side by side as the bytes of a ``png`` or ``svg`` file.

    Raises
    ------
    ImportError
        If matplotlib is missing.

    """
    pictures = [picture._replace(**{
        name: along_arcs(getattr(picture, name), picture.travels) for name in ('paths', 'mean')})
        for picture in pictures]
    figure = new_figure(figsize=_size(pictures))
    shared = figure.subplots(1, len(pictures), sharex=True, sharey=True, squeeze=False)[0]
    for axes, picture in zip(shared, pictures):
        _draw_into(axes, picture)
        axes.set_aspect('equal', adjustable='datalim' if len(pictures) == 1 else 'box')
        axes.set_xlabel('x [m]')
        axes.set_title(picture.title, fontsize='medium')
        axes.grid(alpha=0.25)
    shared[0].set_ylabel('y [m]')
    figure.legend(*shared[0].get_legend_handles_labels(), loc='outside lower center', ncols=2,
                  fontsize='small', frameon=False)
    return file_of(figure, suffix)


def new_figure(*, figsize: Tuple[float, float]) -> Any:
    """Return a figure of matplotlib of a size [inch]; ``ImportError`` where that is missing."""
    from matplotlib.figure import Figure
    return Figure(figsize=figsize, layout='constrained')


def in_plan(axes: Any) -> None:
    """Make the axes of a figure a plan view in metres."""
    axes.set_aspect('equal', adjustable='datalim')
    axes.set_xlabel('x [m]')
    axes.set_ylabel('y [m]')
    axes.grid(alpha=0.25)


def file_of(figure: Any, suffix: str) -> bytes:
    """Return a figure as the bytes of a ``png`` or ``svg`` file."""
    file = io.BytesIO()
    figure.savefig(file, format=suffix, dpi=150)
    return file.getvalue()


def _draw_into(axes: Any, picture: Picture) -> None:
    paths, mean = picture.paths, picture.mean
    count = paths.x.shape[1]
    if count:
        alpha = min(0.6, max(0.05, 25.0 / count))
        axes.plot(paths.x[:, 0], paths.y[:, 0], color=PATHS, lw=0.6, label=f'{count} sample paths')
        axes.plot(paths.x[:, 1:], paths.y[:, 1:], color=PATHS, lw=0.6, alpha=alpha)
        axes.scatter(paths.x[-1], paths.y[-1], color=PATHS, s=5, zorder=3, label='their ends')
    axes.plot(mean.x, mean.y, color=MEAN, lw=1.4, zorder=4, label='mean path' if count else 'path')
    axes.plot(mean.x[0], mean.y[0], 'o', color=MEAN, ms=5, zorder=4, label='start')
    for number, belief in enumerate(picture.beliefs):
        axes.plot(*ellipse(*belief), color=ELLIPSE, lw=1.3, zorder=5,
                  label=None if number else 'covariance after each command, 95 % ellipse')
    for number, (x, y) in enumerate(picture.boundaries):
        axes.fill(x, y, facecolor=REACH, alpha=0.08, zorder=1)
        axes.plot(np.append(x, x[0]), np.append(y, y[0]), color=REACH, lw=1.0, ls='--', zorder=2,
                  label=None if number else 'reachable after each command (bounded errors)')


def _size(pictures: Sequence[Picture]) -> Tuple[float, float]:
    """Return the size [inch] that suits the course, with room for the legend."""
    outlines = [outline for picture in pictures for outline in (
        (picture.mean.x, picture.mean.y), *picture.boundaries,
        *([picture.paths[:2]] if picture.paths.x.size else []))]
    width, height = (
        max(np.max(column) for column in columns) - min(np.min(column) for column in columns)
        for columns in zip(*outlines))
    count = len(pictures)
    scale = LONG_SIDE / max(count * width, height, 1e-9)
    return (max(SHORT_SIDE, scale * width * count),
            max(SHORT_SIDE if count == 1 else 0.5 * SHORT_SIDE, scale * height) + 1.0)
