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

"""Drives simulated row by row: slipping wheels, and a noisy reference with gaps and outliers."""

from typing import NamedTuple

from diffdrive_kinematics.core.calibration import drive_from_positions
from diffdrive_kinematics.core.kinematics import WheelGeometry
import numpy as np

GEOMETRY = WheelGeometry(0.2, 0.04)
WHEEL_PERIOD, REFERENCE_PERIOD = 0.04, 0.1


class Truth(NamedTuple):
    """What a simulated robot is, beside its geometry."""

    left: float = 1.012
    right: float = 0.991
    separation: float = 1.03
    x: float = 0.05
    y: float = -0.02
    yaw: float = 0.03
    offset: float = 0.08
    drift: float = 0.0


class Disturbance(NamedTuple):
    """
    What makes errors.

    Slip of the wheels [sqrt(m)], reference noise [m], [rad], share of outliers, gaps (start, end)
    [s], and slip of the body as of BodySlip.
    """

    slip: float = 1e-3
    position: float = 1e-3
    heading: float = 3e-3
    outliers: float = 0.0
    gaps: tuple = ()
    body: tuple = ()


EXACT = Disturbance(0.0, 0.0, 0.0)


def curved_twists(time):
    """Return a course with curves both ways, straights, and changes of speed."""
    v = 0.35 + 0.15 * np.sin(0.4 * time)
    w = 1.2 * np.sin(0.31 * time) * np.abs(np.sin(0.17 * time))
    return np.stack([v, w], axis=1)


def poses_of(travel, separation):
    """Return the poses along exact arcs, shape (n + 1, 3)."""
    turn, distance = (travel[:, 1] - travel[:, 0]) / separation, travel.mean(axis=1)
    theta = np.append(0.0, np.cumsum(turn))
    chord, way = distance * np.sinc(turn / (2.0 * np.pi)), theta[:-1] + 0.5 * turn
    x, y = (np.append(0.0, np.cumsum(chord * part(way))) for part in (np.cos, np.sin))
    return np.stack([x, y, theta], axis=1)


def with_body_slip(travel, separation, constants, generator):
    """Return the travel that wheels would need for the motion of a body that slips."""
    linear, turn, heading = constants
    distance, turned = travel.mean(axis=1), (travel[:, 1] - travel[:, 0]) / separation
    noise = generator.standard_normal((2, len(travel)))
    distance = distance + np.sqrt(linear * np.abs(distance)) * noise[0]
    turned = turned + noise[1] * np.sqrt(
        turn * np.abs(turned) + heading * np.abs(travel.mean(axis=1)))
    half = 0.5 * separation * turned
    return np.stack([distance - half, distance + half], axis=1)


def drive(seed, truth=Truth(), disturbance=Disturbance(), seconds=100.0, twists=curved_twists):
    """Return the drive of a simulated drive."""
    generator = np.random.default_rng(seed)
    time = np.arange(0.0, seconds, WHEEL_PERIOD)
    v, w = twists(time[:-1]).T
    half = 0.5 * GEOMETRY.separation * w
    rolled = WHEEL_PERIOD * np.stack([v - half, v + half], axis=1) / GEOMETRY.wheel_radius
    travel = rolled * GEOMETRY.wheel_radius * [truth.left, truth.right]
    travel += (disturbance.slip * np.sqrt(np.abs(travel))
               * generator.standard_normal(travel.shape))
    separation = GEOMETRY.separation * truth.separation
    if disturbance.body:
        travel = with_body_slip(travel, separation, disturbance.body, generator)
    centre = poses_of(travel, separation)
    seen = np.arange(0.5, seconds - 0.5, REFERENCE_PERIOD) + 0.003
    late = seen - truth.offset - truth.drift * (seen - 0.5 * time[-1])
    x, y, theta = (np.interp(late, time, column) for column in centre.T)
    cosine, sine = np.cos(theta), np.sin(theta)
    reference = np.stack([x + cosine * truth.x - sine * truth.y,
                          y + sine * truth.x + cosine * truth.y, theta + truth.yaw], axis=1)
    reference += generator.standard_normal(reference.shape) * [
        disturbance.position, disturbance.position, disturbance.heading]
    wild = generator.random(len(seen)) < disturbance.outliers
    reference[wild] += generator.uniform(-0.5, 0.5, (np.count_nonzero(wild), 3))
    kept = np.ones(len(seen), dtype=bool)
    for start, end in disturbance.gaps:
        kept &= (seen < start) | (seen > end)
    reference[:, 2] = np.angle(np.exp(1j * reference[:, 2]))
    angles = np.vstack([np.zeros(2), np.cumsum(rolled, axis=0)])
    return drive_from_positions(time, angles, seen[kept], reference[kept])
