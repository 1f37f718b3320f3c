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

"""The recorded drives of a real robot in test/data, and what they amount to offline."""

import csv
import gzip
import math
from pathlib import Path

from diffdrive_kinematics.core.kinematics import advance, Pose

RADIUS, SEPARATION, TICKS_PER_TURN = 0.042, 0.2, 2796.8
RUNS = sorted((Path(__file__).parents[1] / 'data' / 'optiodom').glob('square_*.csv.gz'))


def load(path):
    """Return the rows of a run as dicts of floats."""
    with gzip.open(path, 'rt') as file:
        return [{name: float(value) for name, value in row.items()}
                for row in csv.DictReader(file)]


def travel(rows):
    """Return what the wheels travelled, (left, right) [m], up to each row but the first."""
    scale = math.tau * RADIUS / TICKS_PER_TURN
    return [(row['left_ticks'] * scale, row['right_ticks'] * scale) for row in rows[1:]]


def wheel_positions(rows):
    """Return the accumulated wheel angles (left, right) [rad] at each row."""
    scale = math.tau / TICKS_PER_TURN
    left = right = 0.0
    positions = []
    for row in rows:
        left, right = left + row['left_ticks'], right + row['right_ticks']
        positions.append((left * scale, right * scale))
    return positions


def offline_pose(rows):
    """Return the pose after all rows, from arcs that are composed one by one."""
    pose = Pose(0.0, 0.0, 0.0)
    for left, right in travel(rows):
        pose = advance(pose, 0.5 * (left + right), (right - left) / SEPARATION)
    return pose


def implied_commands(rows):
    """Return (time [s], v, w) at the start of each interval, and zero at the end."""
    commands = []
    for before, after, (left, right) in zip(rows, rows[1:], travel(rows)):
        seconds = after['time_sec'] - before['time_sec']
        commands.append((before['time_sec'], 0.5 * (left + right) / seconds,
                         (right - left) / SEPARATION / seconds))
    return [*commands, (rows[-1]['time_sec'], 0.0, 0.0)]


def end_error(pose, rows):
    """Return the distance [m] between a pose and the motion capture at the end of a run."""
    return math.hypot(pose.x - rows[-1]['x'], pose.y - rows[-1]['y'])
