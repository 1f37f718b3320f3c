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
Print how exact moments and first order fare on courses of 20 m, and then with what lasts a run.

The tables are Markdown; with a name of a file it draws a straight.

Usage: ``python docs/measure_uncertainty.py [picture.png]``.  Takes a minute; the picture needs
matplotlib.
"""

import math
import sys
from typing import List, Tuple

from diffdrive_kinematics.core.kinematics import (
    advance, Pose, pose_change_from_travel, WheelGeometry)
from diffdrive_kinematics.core.noise import (
    CERTAIN, draw_session, NO_COVARIANCE, NO_SESSION, PoseCovariance, propagated_covariance,
    propagated_moments, sample_travel, session_generator, SessionBelief, SessionSpread,
    travel_in_session, WheelSlip)
import numpy as np

GEOMETRY = WheelGeometry(wheel_separation=0.2, wheel_radius=0.05)
ORIGIN = Pose(0.0, 0.0, 0.0)
YAWS, RUNS = (0.02, 0.1, 0.2, 0.3), 1_000
SESSION_YAWS, SESSION_SLIP = (0.03, 0.1, 0.2), 1e-6
STEP = 0.1  # of a wheel [m]
QUANTILE = 7.8147  # 95 % of chi-square with 3 degrees of freedom
INSIDE = 5.9915  # the same with 2: of the ellipses

Travel = Tuple[float, float]


def travel_of(distance: float, turn: float) -> Travel:
    """Return the travel of the wheels [m] along an arc."""
    half = 0.5 * turn * GEOMETRY.separation
    return distance - half, distance + half


CORNERS = {sign: travel_of(0.0, sign * 0.5 * math.pi) for sign in (1, -1)}
COURSES = {
    'straight': [travel_of(20.0, 0.0)],
    'slalom': [travel_of(1.0, sign * 1.5) for sign in (1, -1, -1, 1) * 5],
    'circle': [travel_of(10.0, math.pi)] * 2,
    'square': [travel_of(5.0, 0.0), CORNERS[1]] * 4,
    'lawnmower': [leg for sign in (1, -1) * 2 for leg in (
        travel_of(4.0, 0.0), CORNERS[sign], travel_of(1.0, 0.0), CORNERS[sign])]}


def believed(course: List[Travel], k: float) -> Tuple[Pose, PoseCovariance, PoseCovariance]:
    """Return the pose with its exact second moment, and with its covariance to first order."""
    pose = there = ORIGIN
    moments, covariance = CERTAIN, NO_COVARIANCE
    for d in course:
        there, covariance = propagated_covariance(covariance, there, GEOMETRY, *d, k, k)
        pose, moments = propagated_moments(moments, pose, GEOMETRY, *d, k, k)
    return pose, moments.second_moment(), covariance


def sampled(
        course: List[Travel], k: float, runs: int, seed: int,
        spread: SessionSpread = NO_SESSION) -> np.ndarray:
    """Return the ends (x, y, theta) of runs from the origin, shape (runs, 3)."""
    generator, slip = np.random.default_rng(seed), WheelSlip(variance=k)
    session = draw_session(spread, session_generator(seed), runs)
    truth = Pose(*np.zeros((3, runs)))
    for d in course:
        steps = math.ceil(max(map(abs, d)) / STEP)
        ways = travel_in_session(
            session, GEOMETRY.separation, *(np.full(runs, way / steps) for way in d))
        for _ in range(steps):
            truth = advance(truth, *pose_change_from_travel(GEOMETRY, *(
                sample_travel(slip, way, generator) for way in ways)))
    return np.column_stack(truth)


def slip_for(course: List[Travel], yaw: float) -> float:
    """Return the k [m] of both wheels for a final yaw standard deviation [rad]."""
    return (yaw * GEOMETRY.separation)**2 / sum(abs(way) for d in course for way in d)


def table() -> None:
    """Print NEES per degree of freedom and the shares beyond the quantile."""
    print('| course | yaw std [rad] | NEES, first order | NEES, exact | standard error '
          '| beyond 95 %, first order | beyond 95 %, exact |\n|---|---|---|---|---|---|---|')
    for seed, (name, yaw) in enumerate((name, yaw) for name in COURSES for yaw in YAWS):
        course = COURSES[name]
        k = slip_for(course, yaw)
        pose, *both = believed(course, k)
        error = sampled(course, k, RUNS, seed) - np.array(pose)
        exact, first = (
            np.sum(error @ np.linalg.inv(p.matrix()) * error, axis=1) for p in both)
        print(f'| {name} | {yaw} | {first.mean() / 3.0:.2f} | {exact.mean() / 3.0:.2f} '
              f'| {exact.std() / 3.0 / math.sqrt(RUNS):.2f} '
              f'| {100.0 * np.mean(first > QUANTILE):.1f} % '
              f'| {100.0 * np.mean(exact > QUANTILE):.1f} % |')


def session_table() -> None:
    """Print NEES per degree of freedom with and without what lasts a run, beside the slip."""
    print('\n| course | yaw std of the curvature [rad] | NEES, slip alone | NEES, with the '
          'session | standard error |\n|---|---|---|---|---|')
    cases = [(name, yaw) for name in COURSES for yaw in SESSION_YAWS]
    for seed, (name, yaw) in enumerate(cases):
        spread = SessionSpread(0.0005, 0.003, yaw / 20.0)
        belief, heading = SessionBelief(spread), 0.0
        for d in COURSES[name]:
            distance, turn = pose_change_from_travel(GEOMETRY, *d)
            belief, heading = belief.after(heading, distance, turn), heading + turn
        pose, exact, _ = believed(COURSES[name], SESSION_SLIP)
        error = sampled(COURSES[name], SESSION_SLIP, RUNS, seed, spread) - np.array(pose)
        alone, both = (
            np.sum(error @ np.linalg.inv(p.matrix()) * error, axis=1) / 3.0
            for p in (exact, exact.plus(belief.covariance())))
        print(f'| {name} | {yaw} | {alone.mean():.2f} | {both.mean():.2f} '
              f'| {both.std() / math.sqrt(RUNS):.2f} |')


def picture(file: str) -> None:
    """Draw the sampled ends of the straight at 0.1 rad with both 95 % ellipses."""
    from matplotlib.figure import Figure
    course = COURSES['straight']
    k = slip_for(course, 0.1)
    pose, exact, first = believed(course, k)
    ends = sampled(course, k, 3_000, seed=1)
    figure = Figure(figsize=(8.0, 4.5), layout='constrained')
    axes = figure.subplots()
    axes.plot(ends[:, 0], ends[:, 1], '.', markersize=2, color='0.6', label='sampled ends')
    circle = np.exp(1j * np.linspace(0.0, math.tau, 200)) * math.sqrt(INSIDE)
    for covariance, style, label in ((first, 'C1--', 'first order'), (exact, 'C0', 'exact')):
        root = np.linalg.cholesky(covariance.matrix()[:2, :2])
        x, y = root @ np.array([circle.real, circle.imag])
        axes.plot(pose.x + x, pose.y + y, style, label=f'{label}, 95 % ellipse')
    axes.plot(pose.x, pose.y, 'k+', markersize=10, label='published')
    axes.set(xlabel='x [m], along the track', ylabel='y [m], across', title=(
        '20 m straight ahead, wheel separation 0.2 m, final yaw standard deviation 0.1 rad'))
    axes.legend(loc='upper left')
    figure.savefig(file, dpi=100)


if __name__ == '__main__':
    table()
    session_table()
    for path in sys.argv[1:]:
        picture(path)
