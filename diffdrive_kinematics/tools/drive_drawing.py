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

"""The picture of a drive in plan view: belief, truth, and how far the belief can be off."""

from array import array
import math
from typing import Any, Dict, Sequence, Tuple

from diffdrive_kinematics.core.kinematics import Pose
from diffdrive_kinematics.core.noise import NO_COVARIANCE
from diffdrive_kinematics.tools.drawing import ellipse, file_of, in_plan, MISSING, new_figure
from diffdrive_kinematics.tools.output_files import beside, check_writable, free_path, write_files
from diffdrive_kinematics.tools.robots import Moment
import numpy as np

BELIEF, TRUTH, ELLIPSE = '#4477aa', 'black', '#cc3311'
MOVED_M = 1e-3
"""A point is drawn where the robot has moved by this much [m] since the one before."""
ELLIPSES = 10
WIDTH = 7.0  # [inch]
UNKNOWN = Pose(math.nan, math.nan, math.nan)

Positions = Tuple[float, float, float, float]


class DrivePicture:
    """
    The picture of the ways of robots.

    Parameters
    ----------
    path : str
        Of the file, ``.png`` or ``.svg``.
    overwrite : bool
        Whether a file that is there may be replaced.

    Raises
    ------
    ValueError
        If no file can be written there, or matplotlib is missing.

    """

    def __init__(self, path: str, *, overwrite: bool) -> None:
        check_writable(path, name='picture', overwrite=overwrite, regular=True)
        try:
            self._figure = new_figure(figsize=(WIDTH, WIDTH))
        except ImportError as error:
            raise ValueError(f'picture is {path!r}, which needs {MISSING} ({error})') from error
        self._path, self._overwrite = path, overwrite
        self._ways: Dict[str, _Way] = {}

    def note(self, moments: Sequence[Moment]) -> None:
        """Add where the robots are."""
        for moment in moments:
            self._ways.setdefault(moment.namespace, _Way(moment)).add(moment)

    def close(self) -> str:
        """Draw and write the picture, and return a line that says so; ``ValueError`` if not."""
        axes = self._figure.add_subplot()
        for way in self._ways.values():
            way.draw(axes)
        in_plan(axes)
        axes.set_title('\n'.join(map(str, self._ways.values())), fontsize='medium')
        handles, labels = axes.get_legend_handles_labels()
        first = [handles[labels.index(label)] for label in dict.fromkeys(labels)]
        self._figure.legend(handles=first, loc='outside lower center', ncols=4, fontsize='small',
                            frameon=False)
        content = file_of(self._figure, self._path.rpartition('.')[2])
        path = free_path(self._path, overwrite=self._overwrite)
        write_files({path: content}, overwrite=self._overwrite)
        return f'wrote {beside(self._path, path)}'

    def discard(self) -> None:
        """Have nothing to take back."""


class _Way:
    """What is drawn of the way of one robot."""

    def __init__(self, start: Moment) -> None:
        self._start = self._last = start
        self._drawn = (math.inf,) * 4
        self._points = array('d')  # x, y of belief and truth, and xx, xy, yy of the covariance

    def __str__(self) -> str:
        seconds = (self._last.time_ns - self._start.time_ns) / 1e9
        words = ' '.join([self._start.namespace, f'{seconds:.1f} s of driving']).strip()
        x, y, true_x, true_y = _positions(self._last)
        drift = math.hypot(true_x - x, true_y - y)
        return words if math.isnan(drift) else f'{words}, drift {1e3 * drift:.1f} mm'

    def add(self, moment: Moment) -> None:
        self._last = moment
        if not _distance(self._drawn, _positions(moment)) < MOVED_M:
            self._put(moment)

    def _put(self, moment: Moment) -> None:
        self._drawn, covariance = _positions(moment), moment.covariance
        self._points.extend((*self._drawn, covariance.xx, covariance.xy, covariance.yy))

    def draw(self, axes: Any) -> None:
        self._put(self._last)
        points = np.array(self._points).reshape(-1, 7)
        x, y, true_x, true_y = points.T[:4]
        axes.plot(x, y, color=BELIEF, lw=1.4, label='belief')
        axes.plot(x[0], y[0], 'o', color=BELIEF, ms=5, label='start')
        _draw_robot(axes, self._last.belief.pose, BELIEF)
        if self._last.truth is not None:
            axes.plot(true_x, true_y, color=TRUTH, lw=1.4, label='truth')
            _draw_robot(axes, self._last.truth, TRUTH)
        for believed_x, believed_y, _, _, xx, xy, yy in _spread_out(points):
            if xx + yy:
                outline = ellipse(Pose(believed_x, believed_y, 0.0),
                                  NO_COVARIANCE._replace(xx=xx, xy=xy, yy=yy))
                axes.plot(*outline, color=ELLIPSE, lw=1.0, label='95 % ellipse of the belief')


def _positions(moment: Moment) -> Positions:
    x, y, _ = moment.belief.pose
    true_x, true_y, _ = moment.truth or UNKNOWN
    return float(x), float(y), float(true_x), float(true_y)


def _distance(one: Positions, other: Positions) -> float:
    """Return how far [m] belief or truth, whichever is further, is between two times."""
    ways = math.dist(one[:2], other[:2]), math.dist(one[2:], other[2:])
    return max(way for way in ways if not math.isnan(way))


def _spread_out(points: 'np.ndarray') -> 'np.ndarray':
    """Return points that are equally far apart along the way of the belief, the last included."""
    way = np.append(0.0, np.cumsum(np.hypot(*np.diff(points[:, :2], axis=0).T)))
    at = np.searchsorted(way, way[-1] * np.arange(1, ELLIPSES + 1) / ELLIPSES)
    return points[np.unique(np.minimum(at, len(points) - 1))]


def _draw_robot(axes: Any, pose: Pose, colour: str) -> None:
    axes.plot(*pose[:2], marker=(3, 0, math.degrees(pose.theta) - 90.0), ms=11, color=colour)
