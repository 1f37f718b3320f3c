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

"""The file of runs around a square: where each ended, and of what square and robot it was."""

import math
from typing import Any, List, Mapping, Sequence, Tuple

from diffdrive_kinematics.core.calibration import ReturnError
from diffdrive_kinematics.core.kinematics import WheelGeometry
from diffdrive_kinematics.tools.recordings import check_columns, Header, read_chosen

SQUARE_COLUMNS = ('clockwise', 'true_x', 'true_y', 'odom_x', 'odom_y')
SETTING_COLUMNS = (
    'square_side', 'square_corner_radius', 'left_radius', 'right_radius', 'separation')
"""The square, and the wheels by which odometry counted, multipliers included; all in metres."""
SAME = 1e-9

NO_SETTINGS: Mapping[str, float] = {}


def settings_of(values: Mapping[str, Any], geometry: WheelGeometry) -> Mapping[str, float]:
    """Return the settings of runs by their columns, from parameters and the robot's geometry."""
    return dict(zip(SETTING_COLUMNS, (
        values['square_side'], values['square_corner_radius'], geometry.left_radius,
        geometry.right_radius, geometry.separation)))


def read_square_runs(
        path: str, side: float, settings: Mapping[str, float] = NO_SETTINGS
) -> Tuple[List[ReturnError], List[ReturnError]]:
    """
    Return the return errors (clockwise, counterclockwise) of a CSV file of runs.

    Parameters
    ----------
    path : str
        The file.
    side : float
        Side of the square [m].
    settings : mapping
        What all runs have to be of, by the columns that the file may have on it.

    Returns
    -------
    tuple of list of ReturnError
        Those of the runs each way.

    Raises
    ------
    ValueError
        If the file cannot be read or has no runs, ``clockwise`` is neither 0 nor 1, an error is
        larger than the side of the square, or a run is of other settings.

    """
    def chosen(header: Header) -> Sequence[str]:
        found = check_columns(path, header, SQUARE_COLUMNS)
        return *found, *(name for name in settings if name in header)

    found: Tuple[List[ReturnError], List[ReturnError]] = ([], [])
    header, rows = read_chosen(path, chosen)
    if not len(rows):
        raise ValueError(f'{path} has no rows, expected one for each run')
    expected = {name: value for name, value in settings.items() if name in header}
    for number, (clockwise, true_x, true_y, odom_x, odom_y, *others) in enumerate(
            rows.tolist(), start=1):
        if clockwise not in (0.0, 1.0):
            raise ValueError(
                f'{path}, row {number}: clockwise is {clockwise!r}, expected 1, or 0 for '
                'counterclockwise')
        error = ReturnError(true_x - odom_x, true_y - odom_y)
        if not math.hypot(*error) <= side:  # NaN is not
            raise ValueError(
                f'{path}, row {number}: true_x, true_y are {true_x:g}, {true_y:g} and odom_x, '
                f'odom_y {odom_x:g}, {odom_y:g}, which is too large an error on a square of '
                f'{side:g} m, expected metres')
        for (name, value), other in zip(expected.items(), others):
            if not math.isclose(other, value, rel_tol=SAME, abs_tol=SAME):
                raise ValueError(
                    f'{path}, row {number}: {name} is {other:.9g} m and now {value:.9g} m, '
                    'expected runs of one square and one geometry (multipliers included) in a '
                    'file: take a new one')
        found[0 if clockwise else 1].append(error)
    return found
