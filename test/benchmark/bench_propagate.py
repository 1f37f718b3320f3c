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
Measure the speed of ``propagate`` against C, side by side on one core.

``python test/benchmark/bench_propagate.py [--json FILE] [--poses N] [--repeats N]``

Four things take turns, so that whatever else the machine does falls on all of them alike:

``numpy``
    ``propagate``: float64, one noisy step, three normals a pose.
``amcl_type``
    Odometry sampling as in AMCL, in C (``amcl_type.c``).
``same_maths``
    The arithmetic of ``propagate`` in scalar C (``same_maths.c``).
``copy``
    The in_flight of the pose arrays alone, read and written: the limit.

The C is compiled with ``gcc -O3 -march=native`` into a temporary directory.  Everything writes
into fresh memory, as ``propagate`` does, but for ``amcl_type``, which works in place.
"""

import argparse
import ctypes
import json
import os
from pathlib import Path
import platform
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

from diffdrive_kinematics.core.kinematics import Pose, WheelGeometry
from diffdrive_kinematics.core.noise import propagate, step_noise, WheelSlip
import numpy as np

HERE = Path(__file__).resolve().parent
FLAGS = ('-O3', '-march=native')
GEOMETRY = WheelGeometry(wheel_separation=0.0885, wheel_radius=0.02)
SLIP = WheelSlip(bias=0.01, variance=4e-6)
D_LEFT, D_RIGHT = 0.05, 0.06
ALPHA = (0.2, 0.2, 0.2, 0.2)
TARGETS = {'amcl_type': 4.0, 'same_maths': 1.0}


def compiled(name, directory):
    """Return the library of a C source of this directory."""
    compiler = shutil.which('gcc')
    if compiler is None:
        raise SystemExit('gcc is not on the PATH, expected it: the comparison needs compiled C')
    library = Path(directory, f'{name}.so')
    command = [compiler, *FLAGS, '-std=gnu11', '-shared', '-fPIC', '-o', str(library),
               str(HERE / f'{name}.c'), '-lm']
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(f'{" ".join(command)} failed:\n{done.stderr}')
    return ctypes.CDLL(str(library))


def address(array):
    return array.ctypes.data_as(ctypes.c_void_p)


def doubles(*values):
    return [ctypes.c_double(value) for value in values]


def runner_of_numpy(poses):
    steps = iter(range(10**9))
    return lambda: propagate(
        poses, D_LEFT, D_RIGHT, GEOMETRY, SLIP, SLIP, seed=(1, next(steps)))


def runner_of_amcl_type(poses, directory):
    library = compiled('amcl_type', directory)
    library.seed_amcl_type(ctypes.c_ulong(1))
    rows, alpha = np.stack(poses, axis=1), np.array(ALPHA)
    distance, turn = 0.5 * (D_LEFT + D_RIGHT), (D_RIGHT - D_LEFT) / GEOMETRY.separation
    heading = 0.5 * turn
    step = doubles(0.0, distance * np.cos(heading), distance * np.sin(heading), turn)
    return lambda: library.amcl_type(
        address(rows), ctypes.c_size_t(len(rows)), *step, address(alpha))


def runner_of_same_maths(poses, directory):
    library = compiled('same_maths', directory)
    library.seed_same_maths(ctypes.c_uint64(1))
    noise = step_noise(D_LEFT, D_RIGHT, GEOMETRY, SLIP, SLIP)
    mean, double = 1.0 + SLIP.bias, 2.0 * GEOMETRY.separation
    step = doubles(
        mean * D_LEFT, mean * D_RIGHT, GEOMETRY.separation, double * noise.left,
        double * noise.right, float(np.hypot(noise.lateral_left, noise.lateral_right)))

    def run():
        moved = [np.empty_like(column) for column in poses]
        library.same_maths(
            *map(address, poses), *map(address, moved), ctypes.c_size_t(len(poses.x)), *step)
        return Pose(*moved)
    return run


def check_alike(poses, runners):
    """Stop unless numpy and C move the poses alike: the mean and spread of the change."""
    moments = []
    for name in ('numpy', 'same_maths'):
        moved = runners[name]()
        half = 0.5 * (moved.theta - poses.theta)
        direction = poses.theta + half
        x, y = moved.x - poses.x, moved.y - poses.y
        along = x * np.cos(direction) + y * np.sin(direction)
        across = y * np.cos(direction) - x * np.sin(direction)
        moments.append([f(v) for v in (half, along, across) for f in (np.mean, np.std)])
    spread = np.repeat([moments[0][1], moments[0][3], moments[0][5]], 2)
    if np.any(np.abs(np.subtract(*moments)) > 8.0 * spread / np.sqrt(len(poses.x))):
        raise SystemExit(f'numpy and C differ in mean and spread: {moments}')


def measured(runners, repeats):
    """Return {name: seconds of each repeat}, taken in turns after one round to warm up."""
    seconds = {name: [] for name in runners}
    for turn in range(repeats + 1):
        for name, run in runners.items():
            begin = time.perf_counter()
            run()
            elapsed = time.perf_counter() - begin
            if turn:
                seconds[name].append(elapsed)
    return seconds


def summary(seconds, poses):
    """Return {name: figures}, in ns per pose; the ratio is that of the medians."""
    median = {name: statistics.median(values) for name, values in seconds.items()}
    return {name: {
        'min_ns': 1e9 * min(values) / poses, 'median_ns': 1e9 * median[name] / poses,
        'max_ns': 1e9 * max(values) / poses, 'ratio_to_numpy': median[name] / median['numpy'],
    } for name, values in seconds.items()}


def table(figures):
    lines = [f'{"":12}{"min":>10}{"median":>10}{"max":>10}{"ratio":>10}   [ns per pose]']
    lines += [
        f'{name:12}{row["min_ns"]:10.1f}{row["median_ns"]:10.1f}{row["max_ns"]:10.1f}'
        f'{row["ratio_to_numpy"]:10.2f}' for name, row in figures.items()]
    lines += [
        f'{name} / numpy is {figures[name]["ratio_to_numpy"]:.2f}, target {target:.1f}: '
        f'{"met" if figures[name]["ratio_to_numpy"] >= target else "MISSED"}'
        for name, target in TARGETS.items()]
    return '\n'.join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__.strip().splitlines()[0])
    parser.add_argument('--json', metavar='FILE', help='where to write the figures')
    parser.add_argument('--poses', type=int, default=1_000_000)
    parser.add_argument('--repeats', type=int, default=15)
    arguments = parser.parse_args()
    core = max(os.sched_getaffinity(0))
    os.sched_setaffinity(0, {core})
    generator = np.random.default_rng(1)
    x, y, theta = generator.uniform(-1.0, 1.0, (3, arguments.poses))
    poses = Pose(x, y, np.pi * theta)
    with tempfile.TemporaryDirectory() as directory:
        runners = {
            'numpy': runner_of_numpy(poses),
            'amcl_type': runner_of_amcl_type(poses, directory),
            'same_maths': runner_of_same_maths(poses, directory),
            'copy': lambda: [column.copy() for column in poses]}
        check_alike(poses, runners)
        figures = summary(measured(runners, arguments.repeats), arguments.poses)
    met = all(figures[name]['ratio_to_numpy'] >= target for name, target in TARGETS.items())
    print(table(figures))
    if arguments.json:
        Path(arguments.json).write_text(json.dumps({
            'poses': arguments.poses, 'repeats': arguments.repeats, 'numpy': np.__version__,
            'machine': platform.machine(), 'flags': FLAGS, 'targets': TARGETS, 'met': met,
            'figures': figures}, indent=2) + '\n', encoding='utf-8')
    return 0 if met else 1


if __name__ == '__main__':
    sys.exit(main())
