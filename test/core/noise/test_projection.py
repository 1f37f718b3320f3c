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

"""Many poses at once: the law of the slip, how a path is cut, exactness, seeds and memory."""

import math
import os
import subprocess
import sys
import tracemalloc

from diffdrive_kinematics.core.kinematics import (
    advance, Command, Pose, pose_change_from_travel, poses_along, WheelGeometry)
from diffdrive_kinematics.core.noise import DISTRIBUTIONS, slip_covariance, WheelSlip
from diffdrive_kinematics.core.noise.normals import fill_normals
from diffdrive_kinematics.core.noise.projection import (
    MOST_THREADS, propagate, ROWS, sample_paths, travel_of_command)
import numpy as np
import pytest

L = 0.0885
GEOMETRY = WheelGeometry(L, 0.02)
NOISELESS = WheelSlip()
LEFT, RIGHT = WheelSlip(0.02, 4e-6), WheelSlip(-0.01, 6e-6)
FIELDS = ('x', 'y', 'theta')
HALF = 0.3 * L / 2.0  # of the difference of travel that turns by 0.3 rad
COURSES = pytest.mark.parametrize(('d_left', 'd_right'), [
    (0.2, 0.2), (-0.2, -0.2), (0.2 - HALF, 0.2 + HALF), (0.05 + HALF, 0.05 - HALF),
    (-HALF, HALF), (0.0, 2.0 * HALF)],
    ids=['straight', 'reverse', 'arc', 'sharp_arc', 'in_place', 'one_wheel'])


def poses_at(n, x=0.0, y=0.0, theta=0.0):
    return Pose(*(np.full(n, value) for value in (x, y, theta)))


def random_poses(n, seed=1):
    x, y, theta = np.random.default_rng(seed).uniform(-3.0, 3.0, (3, n))
    return Pose(x, y, theta)


def assert_same_bits(a, b):
    for name, left, right in zip(FIELDS, a, b):
        np.testing.assert_array_equal(left, right, err_msg=name)


def in_steps(n, d_left, d_right, steps, slips, seed):
    poses = poses_at(n)
    for step in range(steps):
        poses = propagate(poses, d_left / steps, d_right / steps, GEOMETRY, *slips,
                          seed=(seed, step))
    return poses


def across(poses, direction):
    return poses.y * math.cos(direction) - poses.x * math.sin(direction)


def biased(d_left, d_right, slips):
    return (1.0 + slips[0].bias) * d_left, (1.0 + slips[1].bias) * d_right


@COURSES
@pytest.mark.parametrize('distribution', ['uniform', 'gaussian'])
def test_one_step_has_the_statistics_of_many_within_1_percent(d_left, d_right, distribution):
    """A million samples: the ratio of two variances has a standard deviation of 0.2 %."""
    slips = [WheelSlip(slip.bias, slip.variance, distribution=distribution)
             for slip in (LEFT, RIGHT)]
    n = 10**6 if distribution == 'gaussian' else 400_000
    one = in_steps(n, d_left, d_right, 1, slips, 1)
    many = in_steps(n, d_left, d_right, 8, slips, 2)
    turn = pose_change_from_travel(GEOMETRY, *biased(d_left, d_right, slips))[1]
    assert np.var(one.theta) == pytest.approx(np.var(many.theta), rel=0.01)
    assert np.var(across(one, 0.5 * turn)) == pytest.approx(
        np.var(across(many, 0.5 * turn)), rel=0.01)
    for a, b in zip(one, many):
        assert np.mean(a) == pytest.approx(
            np.mean(b), abs=5.0 * math.sqrt(2.0 / n) * np.std(b) + 2e-5 * abs(np.mean(b)))


@COURSES
def test_mean_and_covariance_of_a_step_are_those_of_the_law(d_left, d_right):
    n = 500_000
    moved = propagate(poses_at(n, 1.0, 2.0, 0.7), d_left, d_right, GEOMETRY, LEFT, RIGHT, seed=3)
    travel = biased(d_left, d_right, (LEFT, RIGHT))
    distance, turn = pose_change_from_travel(GEOMETRY, *travel)
    mean = advance(Pose(1.0, 2.0, 0.7), distance, turn)
    variance = slip_covariance(
        GEOMETRY, 0.7, *travel, *(s.variance / (1.0 + s.bias) for s in (LEFT, RIGHT)))
    direction = 0.7 + 0.5 * turn
    expected = variance.rotated(-direction)
    along = moved.x * math.cos(direction) + moved.y * math.sin(direction)
    for values, middle, law in (
            (moved.theta, mean.theta, variance.tt),
            (across(moved, direction), across(mean, direction), expected.yy)):
        assert abs(np.mean(values) - middle) < 5.0 * math.sqrt(law / n) + 1e-6
        assert np.var(values) == pytest.approx(law, rel=0.015)
    scale = math.sqrt(variance.tt * expected.yy)
    assert np.cov(moved.theta, across(moved, direction))[0, 1] == pytest.approx(
        expected.yt, abs=0.01 * scale)
    if d_left == d_right:
        assert np.var(along) == pytest.approx(expected.xx, rel=0.015)


@pytest.mark.parametrize(('d_left', 'd_right'), [
    (0.2, 0.2), (-0.1, 0.3), (0.0, 0.0), (0.001, 0.002), (-1.0, 1.0), (4.0, 0.0)])
@pytest.mark.parametrize('size', [1.0, 4.0, 1e3, 1e6])
def test_a_step_is_that_of_five_lines_of_numpy_with_the_same_normals(d_left, d_right, size):
    n = ROWS
    x, y, theta = poses = Pose(*np.random.default_rng(1).uniform(-1.0, 1.0, (3, n)))
    poses = poses._replace(theta=size * theta)
    bits = np.random.SFC64(np.random.SeedSequence((2, 5, 3), spawn_key=(0,)))
    normals = np.empty((3, n))
    fill_normals(np.random.Generator(bits), normals.reshape(-1), np.empty(8 * n, np.float32))
    left, right = (
        (1.0 + slip.bias) * d + math.sqrt(slip.variance * abs(d)) * z
        for slip, d, z in zip((LEFT, RIGHT), (d_left, d_right), normals))
    h, lateral = (right - left) / (2.0 * L), lateral_stddev(d_left, d_right) * normals[2]
    chord, phi = 0.5 * (left + right) * np.sinc(h / np.pi), poses.theta + h
    expected = Pose(x + chord * np.cos(phi) - lateral * np.sin(phi),
                    y + chord * np.sin(phi) + lateral * np.cos(phi), poses.theta + 2.0 * h)
    moved = propagate(poses, d_left, d_right, GEOMETRY, LEFT, RIGHT, seed=(5, 3))
    error = 1e-14 + 2.0 * np.spacing(size)  # that of the heading, which both round
    for found, there in zip(moved, expected):
        np.testing.assert_allclose(found, there, rtol=1e-14, atol=error)


def lateral_stddev(d_left, d_right):
    return math.sqrt(sum(variance * abs(d) * other**2 for variance, d, other in (
        (LEFT.variance, d_left, (1.0 + RIGHT.bias) * d_right),
        (RIGHT.variance, d_right, (1.0 + LEFT.bias) * d_left))) / 12.0) / L


@pytest.mark.slow
def test_the_processor_does_not_change_a_bit_of_the_result():
    """Guard a seed that means other numbers on another machine: hide what this one can do."""
    program = """
import hashlib, numpy as np
from diffdrive_kinematics.core.kinematics import Pose, WheelGeometry
from diffdrive_kinematics.core.noise import BodySlip, DISTRIBUTIONS, propagate, WheelSlip
total = hashlib.sha256()
for distribution in DISTRIBUTIONS:
    for travel in ((0.1, 0.12), (-0.5, 0.5), (4.0, np.linspace(-1.0, 1.0, 20_000))):
        for size in (1.0, 1e9):
            x, y, theta = size * np.random.default_rng(1).uniform(-4.0, 4.0, (3, 20_000))
            slip = WheelSlip(0.01, 1e-4, distribution=distribution)
            for column in propagate(Pose(x, y, theta), *travel, WheelGeometry(0.0885, 0.02), slip,
                                    slip, seed=1, body=BodySlip(1e-4, 0.01, 1e-3)):
                total.update(column)
print(total.hexdigest())
"""
    seen = [subprocess.run(
        [sys.executable, '-c', program], check=True, capture_output=True, text=True,
        env={**os.environ, 'NPY_DISABLE_CPU_FEATURES': hidden}).stdout
        for hidden in ('', ' '.join(dispatched()))]
    assert seen[0] == seen[1] and len(seen[0]) == 65


def dispatched():
    """Return what numpy found of this processor beyond what it takes for granted."""
    return np.show_config(mode='dicts')['SIMD Extensions'].get('found', [])


@pytest.mark.parametrize('travel', [0.2, 30.0])
def test_a_pose_does_not_mind_the_others_of_its_chunk(travel):
    """Guard rules for a whole chunk: turns and headings of any size stand side by side."""
    n = 1000
    poses = random_poses(n)
    other = poses._replace(theta=np.where(np.arange(n) % 2, 1e9, poses.theta))
    other.theta[1::4] = math.nan
    turns = np.where(np.arange(n) % 2, travel, 0.2)
    alone = propagate(poses, 0.1, 0.2, GEOMETRY, LEFT, RIGHT, seed=1)
    beside = propagate(other, np.full(n, 0.1), turns, GEOMETRY, LEFT, RIGHT, seed=1)
    for a, b in zip(alone, beside):
        np.testing.assert_array_equal(a[::2], b[::2])


def test_a_heading_of_millions_of_turns_is_moved_as_its_rounding_allows():
    theta = np.random.default_rng(1).uniform(-1e12, 1e12, 1000)
    moved = propagate(Pose(np.zeros(1000), np.zeros(1000), theta), 1.0, 1.0, GEOMETRY, NOISELESS,
                      NOISELESS, seed=1)
    np.testing.assert_allclose(moved.x, np.cos(theta), rtol=0.0, atol=np.spacing(1e12))
    np.testing.assert_allclose(np.hypot(moved.x, moved.y), 1.0, rtol=1e-15)


@pytest.mark.parametrize('travel', [(0.3, 0.3), (0.3, 0.5), (-0.2, -0.1), (-0.1, 0.1), (0.0, 0.0),
                                    (0.3, 2.0), (1e-9, 2e-9), (-1.0, 1.0)])
@pytest.mark.parametrize('headings', [
    np.linspace(-4.0, 4.0, 2001), np.linspace(-1e3, 1e3, 2001), np.linspace(-1e6, 1e6, 2001),
    math.pi * np.arange(-33.0, 34.0)], ids=['some', '1e3', '1e6', 'multiples_of_pi'])
def test_without_noise_every_pose_follows_the_exact_arc(travel, headings):
    """Chords that point along -x, where tan(phi / 2) has its poles, are among them."""
    distance, turn = pose_change_from_travel(GEOMETRY, *travel)
    exactly = headings - 0.5 * turn
    theta = np.concatenate([exactly, np.nextafter(exactly, 9e9), np.nextafter(exactly, -9e9)])
    poses = Pose(np.full_like(theta, 0.5), np.full_like(theta, -0.25), theta)
    moved = propagate(poses, *travel, GEOMETRY, NOISELESS, NOISELESS, seed=0)
    expected = advance(poses, distance, turn)
    for a, b in zip(moved, expected):
        np.testing.assert_allclose(a, b, rtol=1e-15, atol=2e-15)


def test_equal_travel_of_noisy_wheels_is_no_trap():
    """Guard 0 / 0 in sin(h) / h: no noise on either wheel and parallel travel give h = 0."""
    for slip in (NOISELESS, WheelSlip(0.1)):
        moved = propagate(poses_at(5), 1.0, 1.0, GEOMETRY, slip, slip, seed=1)
        np.testing.assert_allclose(moved.x, 1.0 + slip.bias, rtol=1e-15)
        assert not moved.y.any() and not moved.theta.any()


def test_nothing_moves_without_travel():
    poses = random_poses(100)
    moved = propagate(poses, 0.0, 0.0, GEOMETRY, LEFT, RIGHT, seed=1)
    for a, b in zip(moved, poses):
        np.testing.assert_allclose(a, b, rtol=1e-15)


@pytest.mark.parametrize('distribution', ['gaussian', 'triangular'])
@pytest.mark.parametrize('n', [1, ROWS - 1, ROWS, 3 * ROWS + 17, 8 * ROWS])
def test_the_result_is_the_same_bits_on_any_number_of_threads(n, distribution):
    slip = WheelSlip(0.0, 1e-5, distribution=distribution)
    results = [
        propagate(random_poses(n), 0.1, 0.12, GEOMETRY, slip, slip, seed=7, threads=threads)
        for threads in (1, 2, 3, 2)]
    for other in results[1:]:
        assert_same_bits(results[0], other)


def test_a_full_chunk_does_not_depend_on_what_follows_it():
    poses = random_poses(2 * ROWS + 5)
    first = Pose(*(column[:ROWS] for column in poses))
    moved = propagate(poses, 0.1, 0.12, GEOMETRY, LEFT, RIGHT, seed=7)
    alone = propagate(first, 0.1, 0.12, GEOMETRY, LEFT, RIGHT, seed=7)
    assert_same_bits(Pose(*(column[:ROWS] for column in moved)), alone)


def test_chunks_steps_and_seeds_are_independent():
    def errors(seed):
        return propagate(poses_at(2 * ROWS), 0.1, 0.1, GEOMETRY, LEFT, RIGHT, seed=seed).theta
    columns = [part for seed in (1, 2, (1, 0), (1, 1), (0, 1))
               for part in np.split(errors(seed), 2)]
    correlations = np.corrcoef(columns) - np.eye(len(columns))
    assert np.abs(correlations).max() < 4.5 / math.sqrt(ROWS)


def test_travel_of_each_pose_is_like_travel_of_all():
    n = ROWS + 100
    poses = random_poses(n)
    alike = propagate(poses, 0.1, -0.12, GEOMETRY, LEFT, RIGHT, seed=7)
    each = propagate(poses, np.full(n, 0.1), np.full(n, -0.12), GEOMETRY, LEFT, RIGHT, seed=7)
    mixed = propagate(poses, 0.1, np.full(n, -0.12), GEOMETRY, LEFT, RIGHT, seed=7)
    for a, b, c in zip(alike, each, mixed):
        np.testing.assert_allclose(a, b, rtol=1e-14)
        np.testing.assert_allclose(a, c, rtol=1e-14)


def test_each_pose_can_have_a_travel_of_its_own():
    n = 2 * ROWS + 3
    travel = np.linspace(-0.5, 0.5, n)
    moved = propagate(poses_at(n), travel, 2.0 * travel, GEOMETRY, NOISELESS, NOISELESS, seed=1)
    expected = advance(poses_at(n), 1.5 * travel, travel / L)
    for a, b in zip(moved, expected):
        np.testing.assert_allclose(a, b, atol=1e-15)


def test_the_law_of_the_command_has_one_error_and_no_lateral_part():
    slip = WheelSlip(0.0, 1e-4, 'command')
    n = 400_000
    theta = propagate(poses_at(n), 0.2, 0.2, GEOMETRY, slip, slip, seed=1)
    variance = 2.0 * 1e-4 * 0.2**2 / L**2
    assert np.var(theta.theta) == pytest.approx(variance, rel=0.01)
    assert np.var(theta.y) == pytest.approx(0.25 * 0.2**2 * variance, rel=0.01)


def test_arguments_are_not_written_and_results_are_new():
    poses, travel = random_poses(ROWS + 1), np.full(ROWS + 1, 0.1)
    copies = [column.copy() for column in (*poses, travel)]
    moved = propagate(poses, travel, travel, GEOMETRY, LEFT, RIGHT, seed=1)
    for column, copy in zip((*poses, travel), copies):
        np.testing.assert_array_equal(column, copy)
    assert not any(np.shares_memory(a, b) for a in moved for b in (*poses, travel))


@pytest.mark.parametrize('threads', [1, 3])
@pytest.mark.parametrize('distribution', ['gaussian', 'uniform'])
def test_poses_can_be_moved_in_place_or_into_columns_of_rows(threads, distribution):
    n = 2 * ROWS + 17
    poses = random_poses(n)
    slip = WheelSlip(0.01, 1e-5, distribution=distribution)

    def move(poses, out):
        return propagate(poses, 0.1, 0.12, GEOMETRY, slip, slip, seed=1, threads=threads, out=out)
    expected = move(poses, None)
    rows = np.empty((n, 3))
    move(poses, Pose(*rows.T))
    assert_same_bits(Pose(*rows.T), expected)
    assert all(moved is column for moved, column in zip(move(poses, poses), poses))
    assert_same_bits(poses, expected)


def test_a_step_into_arrays_at_hand_takes_no_memory_that_grows_with_the_poses():
    peak = []
    for n in (4 * ROWS, 16 * ROWS):
        poses = poses_at(n)
        tracemalloc.start()
        propagate(poses, 0.1, 0.1, GEOMETRY, LEFT, RIGHT, seed=1, out=poses)
        peak.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    assert peak[1] < peak[0] + 1e5 and peak[1] < 3e6


def strided(memory, n, stride):
    return np.lib.stride_tricks.as_strided(memory[n:], (n,), (stride,))


def test_poses_that_share_a_place_are_moved_apart_and_a_single_one_may_have_any_stride():
    together = Pose(*(np.broadcast_to(value, 3) for value in (1.0, 2.0, 0.5)))
    assert_same_bits(propagate(together, 0.1, 0.1, GEOMETRY, LEFT, RIGHT, seed=1),
                     propagate(poses_at(3, *(c[0] for c in together)), 0.1, 0.1, GEOMETRY, LEFT,
                               RIGHT, seed=1))
    alone, out = poses_at(1), Pose(*(strided(np.zeros(2), 1, 0) for _ in range(3)))
    assert_same_bits(propagate(alone, 0.1, 0.1, GEOMETRY, LEFT, RIGHT, seed=1, out=out),
                     propagate(alone, 0.1, 0.1, GEOMETRY, LEFT, RIGHT, seed=1))


def overlapping(n=4):
    poses, memory = random_poses(n), np.zeros(2 * n)
    return {
        'x of another length': (poses, poses_at(n + 1), '^out has 5 poses, expected 4'),
        'y of out': (poses, Pose(memory[:n], memory[1:n + 1], memory[n:]), '^y of out shares'),
        'another column': (poses, Pose(poses.y, np.zeros(n), np.zeros(n)), '^x of out shares'),
        'reversed': (poses, poses._replace(theta=poses.theta[::-1]), '^theta of out shares'),
        'floats': (poses, Pose(0.0, 0.0, 0.0), '^x of out is 0.0'),
        'read-only': (poses, Pose(*(np.broadcast_to(0.0, n) for _ in range(3))),
                      '^x of out is read-only'),
        'one place for all': (poses, Pose(np.zeros(n), strided(memory, n, 0), np.zeros(n)),
                              '^y of out has several poses in the same memory'),
        'one byte apart': (poses, Pose(np.zeros(n), np.zeros(n), strided(memory, n, -1)),
                           '^theta of out has several poses in the same memory'),
        'poses of one place, moved in place': (
            *[poses._replace(x=strided(memory, n, 0))] * 2, '^x of out has several poses')}


@pytest.mark.parametrize('case', overlapping())
def test_memory_that_cannot_be_the_result_is_refused_before_it_is_written(case):
    poses, out, message = overlapping()[case]
    before = [np.copy(column) for column in (*poses, *out)]
    with pytest.raises(ValueError, match=message):
        propagate(poses, 0.1, 0.1, GEOMETRY, LEFT, RIGHT, seed=1, out=out)
    for column, copy in zip((*poses, *out), before):
        np.testing.assert_array_equal(column, copy)


def test_travel_of_each_pose_cannot_be_the_memory_of_the_result():
    poses = random_poses(4)
    with pytest.raises(ValueError, match='^y of out shares memory'):
        propagate(poses, poses.y, 0.1, GEOMETRY, LEFT, RIGHT, seed=1, out=poses)


@pytest.mark.parametrize('threads', [1, 3])
def test_memory_beyond_the_poses_does_not_grow_with_their_number(threads):
    extra = []
    for n in (10**6, 3 * 10**6):
        poses = poses_at(n)
        tracemalloc.start()
        moved = propagate(poses, 0.1, 0.1, GEOMETRY, LEFT, RIGHT, seed=1, threads=threads)
        extra.append(tracemalloc.get_traced_memory()[1] - sum(c.nbytes for c in moved))
        tracemalloc.stop()
    assert max(extra) < threads * 3e6 < 32e6
    assert extra[1] < extra[0] + 5e5


@pytest.mark.parametrize('distribution', DISTRIBUTIONS)
def test_no_number_of_threads_takes_more_than_32_mb(distribution):
    slip = WheelSlip(0.0, 1e-5, distribution=distribution)
    poses = poses_at(ROWS)
    tracemalloc.start()
    propagate(poses, np.full(ROWS, 0.1), 0.1, GEOMETRY, slip, slip, seed=1)
    of_one_thread = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert of_one_thread * MOST_THREADS < 32e6


def test_sample_paths_of_25_commands_are_those_of_figure_2_25():
    commands = [Command(0.1, 0.4 * math.sin(step), 1.0) for step in range(25)]
    paths = sample_paths(Pose(1.0, 2.0, 0.5), commands, GEOMETRY, LEFT, RIGHT, n=100, seed=1)
    assert all(column.shape == (26, 100) for column in paths)
    assert [set(column[0]) for column in paths] == [{1.0}, {2.0}, {0.5}]
    spread = paths.theta.std(axis=1)
    assert spread[0] == 0.0 and (spread[1:] > 0.0).all() and spread[-1] > 3.0 * spread[1]
    again = sample_paths(Pose(1.0, 2.0, 0.5), commands, GEOMETRY, LEFT, RIGHT, n=100, seed=1)
    other = sample_paths(Pose(1.0, 2.0, 0.5), commands, GEOMETRY, LEFT, RIGHT, n=100, seed=2)
    assert_same_bits(paths, again)
    assert not np.array_equal(paths.x, other.x)
    steps = np.diff(paths.theta, axis=0)
    correlation = np.corrcoef(steps) - np.eye(25)
    assert np.abs(correlation).max() < 4.5 / math.sqrt(100), 'steps repeat their errors'


def test_paths_without_noise_are_the_sequence():
    commands = [Command(0.3, 1.0, 0.5), Command(-0.2, 0.0, 1.0), Command(0.0, -2.0, 2.0)]
    paths = sample_paths(
        Pose(1.0, 2.0, 3.0), commands, GEOMETRY, NOISELESS, NOISELESS, n=3, seed=1)
    expected = np.array(poses_along(Pose(1.0, 2.0, 3.0), commands)).T
    for column, values in zip(paths, expected):
        np.testing.assert_allclose(column, np.repeat(values[:, None], 3, axis=1), atol=1e-12)


def test_the_travel_of_a_command_makes_its_twist():
    d_left, d_right = travel_of_command(Command(0.3, 1.2, 2.0), GEOMETRY)
    assert pose_change_from_travel(GEOMETRY, d_left, d_right) == pytest.approx((0.6, 2.4))


GOOD = {'poses': poses_at(3), 'd_left': 0.1, 'd_right': 0.1}


@pytest.mark.parametrize(('change', 'message'), [
    ({'d_left': math.nan}, '^d_left is nan'), ({'d_right': math.inf}, '^d_right is inf'),
    ({'d_left': np.zeros(4)}, r'^d_left is an array of float64 of shape \(4,\)'),
    ({'d_left': np.array([0.0, math.nan, 0.0])}, '^d_left has elements'),
    ({'d_right': np.array([0.0, math.inf, 0.0])}, '^d_right has elements'),
    ({'threads': 0}, '^threads is 0'), ({'seed': -1}, '^seed is -1'), ({'seed': 0.5}, '^seed is'),
    ({'seed': True}, '^seed is True'), ({'seed': (1, math.nan)}, '^seed is'),
    ({'seed': ()}, '^seed is'), ({'seed': None}, '^seed is None'),
    ({'poses': Pose(0.0, 0.0, 0.0)}, '^x of the poses is 0.0'),
    ({'poses': Pose(np.zeros(3), np.zeros(2), np.zeros(3))}, '^y of the poses'),
    ({'poses': Pose(*np.zeros((3, 2, 2)))}, '^x of the poses'),
    ({'poses': Pose(*np.zeros((3, 3), np.float32))}, '^x of the poses .* float32')])
def test_bad_values_are_refused_by_name(change, message):
    with pytest.raises(ValueError, match=message):
        propagate(**{'geometry': GEOMETRY, 'left_slip': LEFT, 'right_slip': RIGHT, 'seed': 1,
                     **GOOD, **change})


@pytest.mark.parametrize(('start', 'n', 'message'), [
    (Pose(0.0, 0.0, 0.0), 0, '^n is 0'), (Pose(0.0, math.nan, 0.0), 2, '^y of the start is nan')])
def test_bad_paths_are_refused_by_name(start, n, message):
    with pytest.raises(ValueError, match=message):
        sample_paths(start, [Command(0.1, 0.0, 1.0)], GEOMETRY, LEFT, RIGHT, n=n, seed=1)


def test_no_poses_are_moved_to_no_poses():
    moved = propagate(poses_at(0), 0.1, 0.1, GEOMETRY, LEFT, RIGHT, seed=1)
    assert all(column.shape == (0,) for column in moved)
