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
Print how far the covariance is off as the heading becomes uncertain: a Markdown table.

Straight lines of one and of ten wheel separations, the slip variance chosen so that the yaw
reaches a given standard deviation; sampled truth over propagated covariance.  Takes a minute.
"""

import math
from typing import NamedTuple

from diffdrive_kinematics.core.kinematics import (
    advance, Pose, pose_change_from_travel, WheelGeometry)
from diffdrive_kinematics.core.noise import (
    NO_COVARIANCE, propagated_covariance, sample_travel, WheelSlip)
import numpy as np

GEOMETRY = WheelGeometry(wheel_separation=0.4, wheel_radius=0.1)
YAWS = (0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.6)
RUNS, CHUNK, STEPS, SEED = 300_000, 20_000, 50, 1
COLUMNS = (
    'yaw std [rad]', 'Var yaw', 'Var y', 'Var x, 1 L', 'Var x, 10 L', 'bias x, 1 L',
    'bias x, 10 L', 'NEES, 1 L', 'NEES, 10 L')


class Comparison(NamedTuple):
    """Sampled over propagated variances, mean error of x in its sigma, mean NEES."""

    yaw: float
    y: float
    x: float
    bias: float
    nees: float


def sampled(distance: float, slip: WheelSlip, generator: np.random.Generator) -> np.ndarray:
    """Return the ends (x, y, theta) of runs from the origin, shape (CHUNK, 3)."""
    pose = Pose(np.zeros(CHUNK), np.zeros(CHUNK), np.zeros(CHUNK))
    step = np.full(CHUNK, distance / STEPS)
    for _ in range(STEPS):
        travel = (sample_travel(slip, step, generator), sample_travel(slip, step, generator))
        pose = advance(pose, *pose_change_from_travel(GEOMETRY, *travel))
    return np.column_stack(pose)


def compared(distance: float, yaw: float) -> Comparison:
    """Return truth against belief after a straight line [m] with a final yaw sigma [rad]."""
    k = 0.5 * (yaw * GEOMETRY.separation)**2 / distance
    mean, covariance = propagated_covariance(
        NO_COVARIANCE, Pose(0.0, 0.0, 0.0), GEOMETRY, distance, distance, k, k)
    generator = np.random.default_rng(SEED)
    error = np.concatenate([
        sampled(distance, WheelSlip(variance=k), generator)
        for _ in range(RUNS // CHUNK)]) - np.array(mean)
    variance = np.var(error, axis=0)
    inverse = np.linalg.inv(covariance.matrix())
    return Comparison(
        variance[2] / covariance.tt, variance[1] / covariance.yy, variance[0] / covariance.xx,
        float(np.mean(error[:, 0])) / math.sqrt(covariance.xx),
        float(np.mean(np.sum(error @ inverse * error, axis=1))))


def main() -> None:
    """Print the table."""
    print(f"| {' | '.join(COLUMNS)} |\n|{'---|' * len(COLUMNS)}")
    for yaw in YAWS:
        short, long = (compared(n * GEOMETRY.separation, yaw) for n in (1, 10))
        values = (long.yaw, long.y, short.x, long.x, short.bias, long.bias, short.nees, long.nees)
        print(f'| {yaw} | ' + ' | '.join(f'{value:.3f}' for value in values) + ' |')


if __name__ == '__main__':
    main()
