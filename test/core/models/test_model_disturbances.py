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

"""Disturbances on any model: samples lie in the boundaries, and are as others simulate them."""

import math
import random

from diffdrive_kinematics.core.kinematics import Command, Pose, WheelGeometry
from diffdrive_kinematics.core.models import (
    ackermann_car, augmented, bounded, differential_drive, Disturbance, front_drive_tricycle,
    reachable_boundary, rear_wheels_tricycle, sample_paths, transition, tricycle, unicycle)
from diffdrive_kinematics.core.noise import (
    area, reachable_set, sample_paths as sample_paths_of_slip, WheelSlip)
import numpy as np
import pytest

START = (1.0, 2.0, 0.3)
GEOMETRY = WheelGeometry(0.2, 0.05)
TRICYCLE = tricycle(wheel_base=1.0, max_steering=1.2)
TURN = [((1.0, 0.4), 0.5)] * 4
CASES = {
    'inaccurate speed': (TRICYCLE, TURN, bounded([0.1, 0.0])),
    'inaccurate steering': (TRICYCLE, TURN, bounded([0.0, 0.2])),
    'both': (TRICYCLE, TURN, bounded([0.1, 0.2])),
    'there and back': (
        TRICYCLE, [((1.0, 0.4), 0.5), ((1.0, -0.4), 0.8), ((-1.0, 0.2), 0.4)],
        bounded([0.05, 0.1], distribution='triangular')),
    'a stop in the box': (TRICYCLE, [((1.0, 1.15), 0.5)] * 2, bounded([0.1, 0.2])),
    'unicycle': (unicycle(), [((1.0, 0.4), 0.5)] * 3, bounded([0.1, 0.5])),
    'any way round': (unicycle(), [((1.0, 0.4), 1.0)] * 3, bounded([0.3, 2.5])),
    'at rest': (unicycle(), [((0.0, 0.0), 0.5)] * 3, bounded([0.2, 0.8])),
    'wheel rates': (differential_drive(GEOMETRY), [((10.0, 12.0), 0.5)] * 3, bounded([1.0, 1.0])),
    'rear wheels': (
        rear_wheels_tricycle(track=0.5), [((1.0, 0.8), 0.5)] * 3, bounded([0.0] * 2, [0.1] * 2)),
    'front drive': (front_drive_tricycle(wheel_base=0.7), [((1.0, 1.2), 0.5)] * 3,
                    bounded([0.1, 0.3], distribution='truncated_gaussian')),
    'Ackermann': (ackermann_car(wheel_base=2.0, track=1.2, max_steering=0.7),
                  [((3.0, 0.6), 0.5)] * 3, bounded([0.3, 0.3]))}
SMOOTH = {
    'bounded rate of steering': (
        augmented(TRICYCLE, 'phi', bound=2.0), (0.2,), [((1.0, 0.3), 0.5)] * 3,
        bounded([0.1, 0.4]), 0.15),
    'only the rate of steering': (
        augmented(TRICYCLE, 'phi', bound=2.0), (0.0,), [((1.0, 0.0), 0.5)] * 3,
        bounded([0.0, 0.4]), 0.1),
    'to the stop': (
        augmented(TRICYCLE, 'phi', bound=2.0), (0.9,), [((1.0, 0.5), 0.5)] * 3,
        bounded([0.1, 0.4]), 0.5),
    'bounded acceleration': (
        augmented(unicycle(max_speed=1.2), 's', bound=1.0), (0.5,),
        [((0.5, 0.4), 0.5), ((-0.5, -0.4), 0.8)], bounded([0.3, 0.2]), 0.15),
    'bounded jerk': (
        augmented(augmented(unicycle(), 's', bound=1.0), 's_rate', bound=4.0), (0.5, 0.0),
        [((1.0, 0.4), 0.5), ((-2.0, -0.4), 0.5)], bounded([0.5, 0.2]), 0.15),
    'both commands': (
        augmented(augmented(front_drive_tricycle(wheel_base=0.7), 'phi', bound=1.0), 's_w',
                  bound=1.0), (0.3, 1.0), [((0.5, 0.4), 0.5)] * 2, bounded([0.2, 0.3]), 0.4)}
"""The last number: within which part of its size the boundary is near to what is reached."""
smooth = pytest.mark.parametrize(
    ('system', 'held', 'steps', 'disturbance', 'near'), SMOOTH.values(), ids=SMOOTH)
case = pytest.mark.parametrize(('system', 'steps', 'disturbance'), CASES.values(), ids=CASES)


def outside(polygon, points):
    """Return how far points are outside of a polygon [m]; 0 for those inside."""
    begin, end = polygon, np.roll(polygon, -1)
    far = np.zeros(len(points))
    for part in np.array_split(np.arange(len(points)), 50):
        place = points[part][:, None]
        over = (begin.imag > place.imag) != (end.imag > place.imag)
        rise = np.where(end.imag == begin.imag, 1.0, end.imag - begin.imag)
        at = begin.real + (place.imag - begin.imag) * (end.real - begin.real) / rise
        inside = np.count_nonzero(over & (at > place.real), axis=1) % 2 == 1
        unit = (end - begin) / np.abs(end - begin)
        local = (place - begin) * np.conj(unit)
        distance = np.hypot(
            local.real - np.clip(local.real, 0.0, np.abs(end - begin)), local.imag).min(axis=1)
        far[part] = np.where(inside, 0.0, distance)
    return far


def extremes(system, steps, disturbance, generator, n=10_000, start=START):
    """Return where errors lead of which most are as large as they can be."""
    state = tuple(np.full(n, value) for value in start)
    for command, duration in steps:
        disturbed = []
        for u, bound in zip(command, disturbance.bounds(command)):
            part = generator.uniform(-1.0, 1.0, n)
            part = np.where(generator.random(n) < 0.8, np.sign(part), part)
            disturbed.append(u + bound * part)
        state = transition(system, state, tuple(disturbed), duration)
    return state[0] + 1j * state[1]


@case
def test_ten_thousand_samples_and_as_many_extremes_lie_inside_of_the_boundary(
        system, steps, disturbance):
    x, y = reachable_boundary(system, START, steps, disturbance)
    generator = np.random.default_rng(1)
    paths = sample_paths(system, START, steps, disturbance, n=10_000, generator=generator)
    assert outside(x + 1j * y, paths[0][-1] + 1j * paths[1][-1]).max() < 1e-6
    assert outside(x + 1j * y, extremes(system, steps, disturbance, generator)).max() < 1e-6


@case
def test_what_a_step_can_reach_comes_near_to_every_vertex_of_its_boundary(
        system, steps, disturbance):
    command, duration = steps[0]
    x, y = reachable_boundary(system, START, steps[:1], disturbance)
    first, second = (u + bound * np.linspace(-1.0, 1.0, 301)
                     for u, bound in zip(command, disturbance.bounds(command)))
    at = transition(system, START, tuple(
        each.ravel() for each in np.meshgrid(first, second)), duration)
    reached = at[0] + 1j * at[1]
    size = abs(reached - reached[0]).max()
    assert max(abs(reached - vertex).min() for vertex in x + 1j * y) < 0.02 * size
    assert abs(outside(x + 1j * y, reached)).max() < 1e-6


@smooth
def test_ten_thousand_samples_of_augmented_systems_and_as_many_extremes_lie_inside(
        system, held, steps, disturbance, near):
    start = (*START, *held)
    x, y = reachable_boundary(system, start, steps, disturbance)
    generator = np.random.default_rng(1)
    paths = sample_paths(system, start, steps, disturbance, n=10_000, generator=generator)
    assert outside(x + 1j * y, paths[0][-1] + 1j * paths[1][-1]).max() < 1e-6
    ends = extremes(system, steps, disturbance, generator, start=start)
    assert outside(x + 1j * y, ends).max() < 1e-6


@pytest.mark.slow
@smooth
def test_what_augmented_systems_can_reach_comes_near_to_every_vertex(
        system, held, steps, disturbance, near):
    """Not all of it: errors that are constant over a step are fewer than it counts with."""
    start = (*START, *held)
    x, y = reachable_boundary(system, start, steps, disturbance)
    reached = extremes(
        system, steps, disturbance, np.random.default_rng(1), n=20_000, start=start)
    size = abs(reached - reached.mean()).max()
    assert max(abs(reached - vertex).min() for vertex in x + 1j * y) < near * size


def test_a_rate_without_errors_bounds_what_a_state_can_do():
    """Without errors the set is a point: where the system goes."""
    system, steps = augmented(TRICYCLE, 'phi', bound=2.0), [((1.0, 0.5), 0.5)] * 3
    x, y = reachable_boundary(system, (*START, 0.1), steps, bounded([0.0, 0.0]))
    state = (*START, 0.1)
    for command, duration in steps:
        state = transition(system, state, command, duration)
    assert abs(x + 1j * y - (state[0] + 1j * state[1])).max() < 0.005


def test_the_boundary_of_the_differential_drive_is_that_of_its_own_projection():
    steps = [((10.0, 12.0), 0.5), ((12.0, 10.0), 0.5), ((9.0, 9.0), 0.4)]
    x, y = reachable_boundary(differential_drive(GEOMETRY), START, steps, bounded([1.0, 0.6]))
    travels = [(0.05 * left * time, 0.05 * right * time) for (left, right), time in steps]
    bounds = ([0.05 * bound * time for _, time in steps] for bound in (1.0, 0.6))
    own_x, own_y = reachable_set(Pose(*START), travels, GEOMETRY, *bounds)
    ours, own = x + 1j * y, own_x + 1j * own_y
    assert area(ours) == pytest.approx(area(own), rel=0.02)
    size = abs(own - own[0]).max()
    assert outside(own, ours).max() < 0.005 * size and outside(ours, own).max() < 0.005 * size


def test_paths_of_the_differential_drive_spread_as_those_of_its_own_projection():
    """Of wheels whose slip is that of their command: sigma in proportion, once a step."""
    steps = [((10.0, 12.0), 0.2)] * 10
    n = 40_000
    paths = sample_paths(
        differential_drive(GEOMETRY), START, steps, Disturbance((0.0, 0.0), (0.1, 0.1)), n=n,
        generator=np.random.default_rng(1))
    slip = WheelSlip(0.0, 0.01, 'command')
    own = sample_paths_of_slip(
        Pose(*START), [Command(0.55, 0.5, 0.2)] * 10, GEOMETRY, slip, slip, n=n, seed=1)
    ours, theirs = (np.stack([column[-1] for column in each]) for each in (paths, own))
    assert_alike(ours, theirs)


def assert_alike(one, other):
    """Compare means and covariances within four standard errors of their samples."""
    n, m = one.shape[1], other.shape[1]
    covariances = np.cov(one), np.cov(other)
    variance = np.diag(covariances[0])
    error = np.abs(one.mean(axis=1) - other.mean(axis=1)) / np.sqrt(variance)
    assert error.max() < 4.0 * math.sqrt(1.0 / n + 1.0 / m)
    scale = np.sqrt(np.outer(variance, variance))
    gap = np.abs(covariances[0] - covariances[1]) / scale
    kurtosis = max(np.mean(((each.T - each.mean(axis=1)) / each.std(axis=1))**4) - 1.0
                   for each in (one, other))
    assert gap.max() < 4.0 * math.sqrt(kurtosis * (1.0 / n + 1.0 / m))


def test_the_cloud_of_figure_2_25_is_that_of_an_independent_simulation():
    """25 steps of the tricycle; simulated anew with plain floats, small steps and dice."""
    dice = random.Random(7)
    ends = []
    for _ in range(4000):
        x, y, theta = 0.0, 0.0, 0.0
        for _ in range(25):
            speed = 1.0 + 0.1 * (2.0 * dice.random() - 1.0)
            steering = 0.1 + 0.05 * (2.0 * dice.random() - 1.0)
            for _ in range(20):  # the midpoint rule
                turn = speed * math.tan(steering) / 1.0 * 0.01
                x += speed * 0.01 * math.cos(theta + 0.5 * turn)
                y += speed * 0.01 * math.sin(theta + 0.5 * turn)
                theta += turn
        ends.append((x, y, theta))
    paths = sample_paths(
        TRICYCLE, (0.0, 0.0, 0.0), [((1.0, 0.1), 0.2)] * 25, bounded([0.1, 0.05]), n=20_000,
        generator=np.random.default_rng(1))
    assert_alike(np.stack([column[-1] for column in paths]), np.array(ends).T)


def test_one_step_of_many_is_the_one_step_projection():
    disturbance = bounded([0.1, 0.2])
    many = sample_paths(TRICYCLE, START, TURN, disturbance, n=50,
                        generator=np.random.default_rng(3))
    one = sample_paths(TRICYCLE, START, TURN[:1], disturbance, n=50,
                       generator=np.random.default_rng(3))
    assert all((a[1] == b[1]).all() for a, b in zip(many, one))
    assert many[0].shape == (5, 50)


def test_paths_of_augmented_systems_keep_the_bounds_of_their_states():
    system = augmented(TRICYCLE, 'phi', bound=2.0)
    paths = sample_paths(system, (0.0, 0.0, 0.0, 0.0), [((1.0, 1.5), 0.5)] * 3, bounded(
        [0.1, 0.5]), n=200, generator=np.random.default_rng(1))
    assert len(paths) == 4 and paths[3].max() == 1.2
    assert np.ptp(paths[3][1]) > 0.3


@pytest.mark.parametrize(('make', 'words'), [
    (lambda: Disturbance((0.1,), (0.1, 0.2)), 'one of each for every command'),
    (lambda: Disturbance((-0.1,), (0.1,)), 'a deviation is -0.1'),
    (lambda: bounded([0.1], distribution='gaussian'), "distribution is 'gaussian'"),
    (lambda: bounded([0.1], distribution='cauchy'), "distribution is 'cauchy'"),
    (lambda: reachable_boundary(TRICYCLE, START, TURN, Disturbance((0.1, 0.0), (0.0, 0.0))),
     "distribution is 'gaussian'"),
    (lambda: reachable_boundary(TRICYCLE, START, [], bounded([0.1, 0.0])), 'steps is empty'),
    (lambda: reachable_boundary(
        augmented(TRICYCLE, 'phi', bound=1.0), START, TURN, bounded([0.1, 0.0])),
     "one for each of ['x', 'y', 'theta', 'phi']"),
    (lambda: sample_paths(TRICYCLE, START, TURN, bounded([0.1, 0.1]), n=0, generator=None),
     'n is 0')])
def test_what_makes_no_sense_is_refused_by_name_and_value(make, words):
    with pytest.raises(ValueError) as error:
        make()
    assert words in str(error.value)
