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
Compare the drift of robots simulated with fitted bias and slip with that of the real ones.

Run by hand: ``python test/benchmark/compare_drifts.py DIRECTORY``.  The directory holds, at any
depth, the files that the docstring of fit_slip.py names.  What is printed is explained in
docs/explanation/calibration_on_real_robots.md.

Drift is where the robot is after 10 s minus where nominal odometry says it is, in the frame of
the start.  The real robot has one drift a window, the simulated one 200, from the same wheel
motion, with the bias of ``wheel_noise``, the separation of the ground truth and the slip that
``calibrate`` writes.
"""

import math
from pathlib import Path
import sys

import numpy as np

TEST = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(TEST.parent), str(TEST), str(TEST / 'benchmark')]

from calibrate_recordings import (  # noqa: E402, I100
    commanded_halves, CREATE, ENCODERS, SESSIONS)
from diffdrive_kinematics.core.calibration import (  # noqa: E402
    CalibrationParameters, Clock, COMMANDED, fit_drive_slip, fit_trajectory, linearised,
    windows_between)
from diffdrive_kinematics.core.kinematics import wrap_angle  # noqa: E402
from support.end_points import encoder_drive  # noqa: E402

WINDOW_S, SEEDS = 10.0, 200
AXES = ('along [mm]', 'across [mm]', 'yaw [mrad]')


def real_drifts(geometry, recorded, systematic):
    """Return the drifts of disjoint windows, shape (w, 3), and the wheel travel of each."""
    windows = windows_between(recorded, (WINDOW_S,), WINDOW_S + 0.1, 0.1)
    frame_only = CalibrationParameters()._replace(
        x=systematic.x, y=systematic.y, yaw=systematic.yaw, offset=systematic.offset,
        drift=systematic.drift)
    error = linearised(geometry, recorded, windows, frame_only).error
    middle = 0.5 * (recorded.time[0] + recorded.time[-1])
    stamps = (recorded.reference_time - systematic.offset
              - systematic.drift * (recorded.reference_time - middle))
    travels = []
    for start, end in zip(windows.start, windows.end):
        inner = recorded.time[(recorded.time > stamps[start]) & (recorded.time < stamps[end])]
        times = np.concatenate([[stamps[start]], inner, [stamps[end]]])
        angles = np.stack([np.interp(times, recorded.time, column)
                           for column in recorded.angles.T], axis=1)
        travels.append(np.diff(angles, axis=0) * geometry.wheel_radius)
    return error, travels


def ends(left, right, separation):
    """Return relative poses after the intervals of each row, shape (..., 3)."""
    turn, distance = (right - left) / separation, 0.5 * (left + right)
    theta = np.cumsum(turn, axis=-1)
    chord, way = distance * np.sinc(turn / (2.0 * np.pi)), theta - 0.5 * turn
    return np.stack([np.sum(chord * np.cos(way), axis=-1), np.sum(chord * np.sin(way), axis=-1),
                     theta[..., -1]], axis=-1)


def simulated_drifts(geometry, travel, fit, slip, generator):
    """Return the drifts of 200 simulated robots on the wheel travel of one window."""
    moved = []
    for column, factor, k in zip(
            travel.T, (fit.left_wheel_radius_multiplier, fit.right_wheel_radius_multiplier),
            (slip.k_left, slip.k_right)):
        sigma = np.sqrt(k.value * np.abs(column))
        moved.append(factor.value * column
                     + sigma * generator.standard_normal((SEEDS, len(column))))
    truth = ends(*moved, geometry.separation * fit.wheel_separation_multiplier.value)
    drift = truth - ends(*travel.T, geometry.separation)
    drift[:, 2] = wrap_angle(drift[:, 2])
    return drift


def kolmogorov_smirnov(first, second):
    """Return the two-sample statistic and its p value, as of the size of the smaller sample."""
    both = np.sort(np.concatenate([first, second]))
    gap = np.max(np.abs(np.searchsorted(np.sort(first), both, side='right') / len(first)
                        - np.searchsorted(np.sort(second), both, side='right') / len(second)))
    number = min(len(first), len(second))
    t = (math.sqrt(number) + 0.12 + 0.11 / math.sqrt(number)) * gap  # Stephens 1970
    if t < 0.3:
        return gap, 1.0
    return gap, min(1.0, max(0.0, 2.0 * sum(
        (-1)**(n - 1) * math.exp(-2.0 * (n * t)**2) for n in range(1, 60))))


def compared(name, geometry, drives, fit, systematics, slip):
    """Print real and simulated drifts of drives."""
    generator = np.random.default_rng(1)
    real, simulated = [], []
    for recorded, systematic in zip(drives, systematics):
        drifts, travels = real_drifts(geometry, recorded, systematic)
        real.append(drifts)
        simulated += [simulated_drifts(geometry, travel, fit, slip, generator)
                      for travel in travels]
    real, simulated = np.concatenate(real), np.concatenate(simulated)
    scale = 1e3
    for axis, label in enumerate(AXES):
        gap, p = kolmogorov_smirnov(real[:, axis], simulated[:, axis])
        print(f'| {name if not axis else ""} | {len(real) if not axis else ""} | {label} | '
              + ' | '.join(f'{scale * np.mean(each[:, axis]):.1f} +- '
                           f'{scale * np.std(each[:, axis]):.1f}' for each in (real, simulated))
              + f' | {gap:.2f} | {p:.2g} |')


def encoders(directory):
    """Compare the robot with encoders: fitted to the 1.7 m squares, other sessions simulated."""
    found = {name: [encoder_drive(path) for path in sorted(directory.rglob(f'{prefix}_run*'))]
             for name, prefix in SESSIONS.items()}
    training = next(iter(found.values()))
    fit = fit_trajectory(ENCODERS, training)
    slip = fit_drive_slip(ENCODERS, training, fit)
    print(f'| slip k {slip.k_left.value:.2e} m |')
    for name, drives in found.items():
        own = fit if drives is training else fit_trajectory(
            fit.corrected(ENCODERS), drives, wheels=False)
        compared(name, ENCODERS, drives, fit,
                 [own.systematic(n) for n in range(len(drives))], slip)


def commands(directory):
    """Compare the robots with commands: fitted to the first half, the second simulated."""
    for path in sorted(directory.rglob('mrclam7_robot*_commands.csv*')):
        _, first, second = commanded_halves(path)
        fit = fit_trajectory(CREATE, [first], clock=Clock.DELAY, windows=COMMANDED,
                             mean_radius=False)
        slip = fit_drive_slip(CREATE, [first], fit)
        print(f'| slip k {slip.k_left.value:.2e} m |')
        compared(path.name[8:14], CREATE, [second], fit, [fit.systematic(0)], slip)


def main():
    """Print both tables."""
    if len(sys.argv) != 2:
        sys.exit('usage: python test/benchmark/compare_drifts.py DIRECTORY')
    print('| what | windows | drift | real | simulated | D | p |\n|---|---|---|---|---|---|---|')
    encoders(Path(sys.argv[1]))
    commands(Path(sys.argv[1]))


if __name__ == '__main__':
    main()
