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
Slip constants of real robots, and how well they predict other recordings.

Run by hand: ``python test/benchmark/fit_slip.py DIRECTORY``.  The directory holds, at any depth,
files in the format of test/data (columns and units: test/data/README.md), of which

* ``square_231220200029_runNN.csv.gz`` is the session that everything is fitted to, and
  ``square_230620202042_``, ``circular_231220200121_`` and ``free_030120210006_runNN.csv.gz``
  are the sessions to predict (OptiOdom);
* ``mrclam7_robotN_commands.csv.gz`` (``time_sec,linear_x,angular_z``) and
  ``mrclam7_robotN_truth.csv.gz`` (``time_sec,x,y,yaw``) are dataset 7 of UTIAS MRCLAM: the first
  half of each robot predicts its second.  Left out where the files are not there.

What is printed is explained in docs/explanation/slip_on_real_robots.md.  It takes some minutes.
"""

from itertools import chain
from pathlib import Path
import sys

import numpy as np

TEST = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(TEST.parent), str(TEST)]

from diffdrive_kinematics.core.calibration import (  # noqa: E402, I100
    fit_reference_noise, fit_slip, nees_per_dof)
from support.systematic import (  # noqa: E402
    CalibrationParameters, CLOCK, encoder_recording, fitted, FRAME, NOMINAL, Recording, WHEELS,
    windows_of)

TRAINING = 'square_231220200029'
OTHERS = ('square_230620202042', 'circular_231220200121', 'free_030120210006')
SHORT, LONG = 2.0, 10.0  # lengths [s] of the windows for the fit
SPANS = (5.0, 10.0, 20.0)  # lengths [s] of the windows to predict
EVERY = 1.0  # starts of windows [s] in the fit
PHASES = 4  # starts of the disjoint windows over which NEES is averaged
MRCLAM_SEPARATION, PERIOD = 0.258, 0.05


def session(directory, name):
    """Return the recordings of a session."""
    found = [encoder_recording(path) for path in sorted(directory.rglob(f'{name}_run*.csv*'))]
    if not found:
        sys.exit(f'no file {name}_run*.csv* below {directory}')
    return found


def overlapping(recordings, systematics, seconds):
    """Return windows of each length that start every second, a list for each recording."""
    return [list(chain.from_iterable(
        windows_of(recording, each, (length,), every_seconds=EVERY) for length in seconds))
        for recording, each in zip(recordings, systematics)]


def crossed(recordings, own):
    """Return systematic errors of the runs one way round, fitted to those the other way."""
    turns = [np.ptp(recording.reference[:, 2]) * np.sign(recording.reference[-1, 2])
             for recording in recordings]
    clockwise = [turn < 0.0 for turn in turns]
    found = [None] * len(recordings)
    for way in (True, False):
        here = [n for n, each in enumerate(clockwise) if each == way]
        there = [n for n, each in enumerate(clockwise) if each != way]
        wheels = fitted([recordings[n] for n in there], [NOMINAL] * len(there),
                        WHEELS + FRAME, own)[0]._replace(offset=0.0, rate=0.0)
        for n in here:
            found[n] = fitted([recordings[n]], [wheels], (), own)[0]
    return found


def jackknifed(windows, **options):
    """Return the fit to all windows, and errors of k (left, right) by leaving a run out."""
    whole = fit_slip(list(chain.from_iterable(windows)), **options)
    parts = [fit_slip([w for n, run in enumerate(windows) if n != left_out for w in run],
                      **options) for left_out in range(len(windows))]
    factor = np.sqrt(len(parts) - 1.0)
    return whole, [factor * np.std([getattr(part, name).value for part in parts])
                   for name in ('k_left', 'k_right')]


def nees(recordings, systematics, seconds, k, noise):
    """Return NEES per dof by start of the disjoint windows, and windows per start."""
    means, numbers = [], []
    for phase in range(PHASES):
        windows = []
        for recording, each in zip(recordings, systematics):
            start = round(phase * seconds / PHASES / PERIOD)
            windows += windows_of(recording, each, (seconds,), start)
        means.append(float(np.mean(nees_per_dof(windows, k[0], k[1], noise))))
        numbers.append(len(windows))
    return np.array(means), np.array(numbers)


def print_nees(name, recordings, systematics, k, noise):
    """Print one line of the table."""
    found = [nees(recordings, systematics, seconds, k, noise) for seconds in SPANS]
    cells = [f'{means.mean():5.2f} [{means.min():4.2f}, {means.max():4.2f}] ({numbers[0]:3d})'
             for means, numbers in found]
    (five, n_five), (ten, n_ten) = found[:2]
    pooled = (five @ n_five + ten @ n_ten) / (n_five.sum() + n_ten.sum())
    print(f'    {name:22s} {pooled:5.2f}   ', '   '.join(cells),
          f'  {1e3 * noise.sigma_position:.2f} mm {1e3 * noise.sigma_heading:.1f} mrad')


def encoders(directory):
    """Print constants and predictions of the robot with encoders."""
    training = session(directory, TRAINING)
    others = {name: session(directory, name) for name in OTHERS}
    for own in (CLOCK, CLOCK[:1]):
        print(f'\nOptiOdom, clock of each run: {" and ".join(own)}')
        shared = fitted(training, [NOMINAL] * len(training), WHEELS + FRAME, own)
        print('  training:', described(shared[0]), 'clocks', clocks(shared))
        held_out = crossed(training, own)
        k, noise = print_constants(training, held_out, own == CLOCK)
        print('  NEES per dof: pooled over 5 and 10 s, then 5, 10 and 20 s: mean over starts'
              ' [least, most] (windows)')
        print('   training session, calibrated on the other direction')
        print_nees(TRAINING, training, held_out, k, noise)
        for frame in (True, False):
            print('   frame of the reference:', 'of each session' if frame else 'of training')
            for name, recordings in others.items():
                start = [shared[0]._replace(offset=0.0, rate=0.0)] * len(recordings)
                each = fitted(recordings, start, FRAME if frame else (), own)
                if frame:
                    print(f'    {name:22s}', described(each[0]), 'clocks', clocks(each))
                short = chain.from_iterable(overlapping(recordings, each, (SHORT,)))
                print_nees(name, recordings, each, k,
                           fit_reference_noise(list(short), *k).noise)
                print_nees('  noise of training', recordings, each, k, noise)


def print_constants(recordings, systematics, thorough):
    """Print slip constants by wheels and lengths of windows; return k and noise."""
    chosen = overlapping(recordings, systematics, (SHORT, LONG))
    fit, error = jackknifed(chosen)
    print(f'  one k {fit.k_left.value:.2e} +- {error[0]:.1e} m, sqrt '
          f'{np.sqrt(fit.k_left.value):.1e} sqrt(m); noise {1e3 * fit.sigma_position.value:.2f} '
          f'mm {1e3 * fit.sigma_heading.value:.1f} mrad; {fit.windows} windows')
    if thorough:
        two, errors = jackknifed(chosen, equal=False)
        print(f'  two k: left {two.k_left.value:.2e} +- {errors[0]:.1e}, right '
              f'{two.k_right.value:.2e} +- {errors[1]:.1e} m; log likelihood '
              f'{two.log_likelihood - fit.log_likelihood:+.2f}')
        for lengths in ((1.0, 10.0), (2.0, 5.0), (5.0, 10.0), (2.0, 20.0), (2.0, 5.0, 10.0, 20.0)):
            other, its = jackknifed(overlapping(recordings, systematics, lengths))
            print(f'    from windows of {lengths} s: one k {other.k_left.value:.2e} +- '
                  f'{its[0]:.1e} m')
    return (fit.k_left.value, fit.k_right.value), fit.noise


def described(systematic):
    """Return the wheels and the frame in words."""
    each = systematic
    return (f'radii {each.left:.5f} {each.right:.5f}, separation {1e3 * each.separation:.2f} mm, '
            f'frame {1e3 * each.x:.2f} {1e3 * each.y:.2f} mm {1e3 * each.yaw:.1f} mrad')


def clocks(systematics):
    """Return offsets and drifts of the clocks in words."""
    return ', '.join(f'{each.offset:+.3f}{60.0 * each.rate:+.3f}/min' for each in systematics)


def commanded_recording(commands_path, truth_path):
    """Return the wheel travel that the commands ask for, held between them, on even times."""
    commands = np.genfromtxt(commands_path, delimiter=',', names=True)
    last = np.append(np.diff(commands['time_sec']) > 0.0, True)  # of equal stamps the last
    stamps, v, w = (commands[name][last] for name in ('time_sec', 'linear_x', 'angular_z'))
    time = np.arange(stamps[0], stamps[-1], PERIOD)
    half = 0.5 * MRCLAM_SEPARATION * w
    travel = [np.interp(time, stamps, np.concatenate(
        [[0.0], np.cumsum(speed[:-1] * np.diff(stamps))])) for speed in (v - half, v + half)]
    truth = np.genfromtxt(truth_path, delimiter=',', names=True)
    poses = np.stack([truth['x'], truth['y'], np.unwrap(truth['yaw'])], axis=1)
    name = commands_path.name.split('_commands')[0]
    return Recording(name, time, np.stack(travel, axis=1), truth['time_sec'], poses)


def commands(directory):
    """Print constants and predictions of the robots with commands."""
    paths = sorted(directory.rglob('mrclam7_robot*_commands.csv*'))
    print('\nUTIAS MRCLAM, dataset 7: first half of each robot, NEES of its second half')
    for path in paths:
        whole = commanded_recording(
            path, path.with_name(path.name.replace('commands', 'truth')))
        middle = len(whole.time) // 2
        first, second = (whole._replace(time=whole.time[part], travel=whole.travel[part])
                         for part in (slice(middle), slice(middle, None)))
        start = CalibrationParameters(1.0, 1.0, MRCLAM_SEPARATION, offset=0.2)
        systematic = fitted([first], [start], WHEELS + FRAME, ('offset',))
        fit = fit_slip(list(chain.from_iterable(
            overlapping([first], systematic, (SHORT, LONG)))))
        k = (fit.k_left.value, fit.k_right.value)
        print(f'  {whole.name}: {described(systematic[0])}, delay {systematic[0].offset:.2f} s, '
              f'k {k[0]:.2e} m, sqrt {np.sqrt(k[0]):.1e} sqrt(m)')
        print_nees('first half', [first], systematic, k, fit.noise)
        print_nees('second half', [second], systematic, k, fit.noise)


def main():
    """Print everything."""
    if len(sys.argv) != 2:
        sys.exit('usage: python test/benchmark/fit_slip.py DIRECTORY')
    directory = Path(sys.argv[1])
    encoders(directory)
    commands(directory)


if __name__ == '__main__':
    main()
