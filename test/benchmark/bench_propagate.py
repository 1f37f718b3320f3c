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

These take turns, so that whatever else the machine does falls on all of them alike:

``numpy``
    ``propagate``: float64, one noisy step, three normals a pose.
``amcl_type``
    Odometry sampling as in AMCL, in C (``amcl_type.c``).
``same_maths``
    The arithmetic of ``propagate`` in scalar C (``same_maths.c``).
``numba``
    The same in Python, compiled by numba, where it is installed.
``copy``
    The pose arrays alone, read and written: the limit.

The C is compiled with ``gcc -O3 -march=native`` into a temporary directory.  Everything writes
into memory at hand, as a particle filter does (``out=``).  What counts is processor time, user and
system.  ``NPY_DISABLE_CPU_FEATURES='X86_V4 AVX512_ICL AVX512_SPR'`` makes a processor without
AVX-512 of one that has it, for numpy alone.
"""

import argparse
import ctypes
import json
import math
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


def like(poses):
    return Pose(*map(np.copy, poses))


def runner_of_numpy(poses):
    steps, out = iter(range(10**9)), like(poses)
    return lambda: propagate(
        poses, D_LEFT, D_RIGHT, GEOMETRY, SLIP, SLIP, seed=(1, next(steps)), out=out)


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
    moved = like(poses)
    step = doubles(*arguments_of_step())

    def run():
        library.same_maths(
            *map(address, poses), *map(address, moved), ctypes.c_size_t(len(poses.x)), *step)
        return moved
    return run


def runner_of_numba(poses):
    """Return the loop of ``same_maths.c`` in Python, compiled; None without numba."""
    try:
        from numba import njit
    except ImportError:
        return None

    @njit
    def loop(x, y, theta, x_out, y_out, theta_out, generator, d_left, d_right, separation,
             sigma_left, sigma_right, sigma_lateral):
        for i in range(len(x)):
            left = d_left + sigma_left * generator.standard_normal()
            right = d_right + sigma_right * generator.standard_normal()
            lateral = sigma_lateral * generator.standard_normal()
            half = (right - left) / (2.0 * separation)
            chord = 0.5 * (left + right) * (1.0 if half == 0.0 else math.sin(half) / half)
            direction = theta[i] + half
            cosine, sine = math.cos(direction), math.sin(direction)
            x_out[i] = x[i] + chord * cosine - lateral * sine
            y_out[i] = y[i] + chord * sine + lateral * cosine
            theta_out[i] = direction + half

    moved, generator = like(poses), np.random.Generator(np.random.SFC64(1))

    def run():
        loop(*poses, *moved, generator, *arguments_of_step())
        return moved
    return run


def arguments_of_step():
    noise = step_noise(D_LEFT, D_RIGHT, GEOMETRY, SLIP, SLIP)
    mean, double = 1.0 + SLIP.bias, 2.0 * GEOMETRY.separation
    return (mean * D_LEFT, mean * D_RIGHT, GEOMETRY.separation, double * noise.left,
            double * noise.right, float(np.hypot(noise.lateral_left, noise.lateral_right)))


def runner_of_copy(poses):
    moved = like(poses)
    return lambda: [np.copyto(*columns) for columns in zip(moved, poses)]


def check_alike(poses, runners):
    """Stop unless all loops move the poses alike: the mean and spread of the change."""
    moments = []
    for name in runners.keys() & {'numpy', 'same_maths', 'numba'}:
        moved = runners[name]()
        half = 0.5 * (moved.theta - poses.theta)
        direction = poses.theta + half
        x, y = moved.x - poses.x, moved.y - poses.y
        along = x * np.cos(direction) + y * np.sin(direction)
        across = y * np.cos(direction) - x * np.sin(direction)
        moments.append([f(v) for v in (half, along, across) for f in (np.mean, np.std)])
    spread = np.repeat([moments[0][1], moments[0][3], moments[0][5]], 2)
    if np.any(np.ptp(moments, axis=0) > 8.0 * spread / np.sqrt(len(poses.x))):
        raise SystemExit(f'numpy and compiled loops differ in mean and spread: {moments}')


def measured(runners, repeats):
    """Return {name: seconds of each repeat}, taken in turns after one round to warm up."""
    seconds = {name: [] for name in runners}
    for turn in range(repeats + 1):
        for name, run in runners.items():
            begin = time.process_time()
            run()
            elapsed = time.process_time() - begin
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
            'copy': runner_of_copy(poses)}
        if (numba := runner_of_numba(poses)):
            runners['numba'] = numba
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
