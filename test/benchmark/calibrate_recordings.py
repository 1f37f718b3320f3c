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
Calibration of real robots: fitted to one recording, applied to others.

Run by hand: ``python test/benchmark/calibrate_recordings.py DIRECTORY``.  The directory holds, at
any depth, the files that the docstring of fit_slip.py names.  What is printed is explained in
docs/explanation/calibration_on_real_robots.md.  It takes about a minute.
"""

import math
from pathlib import Path
import sys

import numpy as np

TEST = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(TEST.parent), str(TEST)]

from diffdrive_kinematics.core.calibration import (  # noqa: E402, I100
    CalibrationParameters, Clock, COMMANDED, corrected, drive_from_commands, fit_drive_slip,
    fit_sessions, fit_trajectory, linearised, NO_FRAME, ReturnError, umbmark, windows_between)
from diffdrive_kinematics.core.kinematics import WheelGeometry  # noqa: E402, I100
from support.end_points import encoder_drive, predicted_end  # noqa: E402
from support.recorded import RADIUS, SEPARATION  # noqa: E402

SESSIONS = {'1.7 m squares': 'square_231220200029', '0.75 m squares': 'square_230620202042',
            'circles': 'circular_231220200121', 'free paths': 'free_030120210006'}
ENCODERS = WheelGeometry(SEPARATION, RADIUS)
CREATE = WheelGeometry(0.258, 0.033)
SIDE = 1.7


def columns(path, *names):
    """Return columns of a file, shape (n, names)."""
    rows = np.genfromtxt(path, delimiter=',', names=True)
    return np.stack([rows[name] for name in names], axis=1)


def end_error(geometry, frame, drives):
    """Return the mean end-point error [mm]."""
    return 1e3 * np.mean([math.dist(*predicted_end(geometry, frame, each)) for each in drives])


def umbmark_of(drives):
    """Return the geometry that UMBmark gives for runs of a square."""
    ways = {-1.0: [], 1.0: []}
    for recorded in drives:
        theta = recorded.reference[0, 2]
        there, end = predicted_end(ENCODERS, NO_FRAME, recorded)
        c, s = math.cos(theta), math.sin(theta)
        error = np.array([[c, s], [-s, c]]) @ (end - there)
        ways[float(np.sign(recorded.reference[-1, 2]))].append(ReturnError(*error.tolist()))
    return corrected(ENCODERS, umbmark(ENCODERS, SIDE, ways[-1.0], ways[1.0]))


def described(fit):
    """Return the wheels and the frame in words."""
    scales = (('left_wheel_radius_multiplier', 1.0), ('right_wheel_radius_multiplier', 1.0),
              ('wheel_separation_multiplier', 1.0), ('frame_x', 1e3), ('frame_y', 1e3),
              ('frame_yaw', 1e3))
    return ', '.join(f'{scale * getattr(fit, name).value:.5g} +- '
                     f'{scale * getattr(fit, name).error:.2g}' for name, scale in scales)


def encoders(directory):
    """Print end-point errors of each session, by what was fitted to what."""
    found = {name: [encoder_drive(path) for path in sorted(directory.rglob(f'{prefix}_run*'))]
             for name, prefix in SESSIONS.items()}
    names = list(found)
    print('OptiOdom, mean end-point error [mm] on:', ', '.join(names))

    def row(what, geometry, frame=NO_FRAME):
        print(f'  {what:42s}', ' '.join(
            f'{end_error(geometry, frame, each):7.1f}' for each in found.values()))

    row('nominal', ENCODERS)
    try:
        row('UMBmark on 1.7 m squares', umbmark_of(found[names[0]]))
    except ValueError as error:
        print('  UMBmark:', error)
    for name, drives in found.items():
        for clock in (Clock.OFFSETS, Clock.DRIFTS, Clock.AUTO):
            try:
                fit = fit_trajectory(ENCODERS, drives, clock=clock)
            except ValueError as error:
                print(f'  fitted to {name}, {clock.name}: {error}')
                continue
            row(f'fitted to {name}, {clock.name}', fit.corrected(ENCODERS), fit.frame)
            row('  the same wheels, no frame', fit.corrected(ENCODERS))
            row('  nominal wheels, the same frame', ENCODERS, fit.frame)
            print('    ', described(fit))
            print(f'     before {fit.before}, after {fit.after}; {fit.windows} windows, '
                  f'{fit.in_gaps} in gaps, {fit.outliers} outliers')
            if name == names[0]:
                print('     left out one by one:', jackknifed(drives, clock))
                slip = fit_drive_slip(ENCODERS, drives, fit)
                print(f'     slip k {slip.k_left.value:.2e} +- {slip.k_left.error:.1e} m')
    between_sessions(found)


def between_sessions(found):
    """Print what differs between sessions, and between the runs of each, beyond their errors."""
    groups = {'sessions': list(found.values()), **{
        f'runs of {name}': [[each] for each in drives] for name, drives in found.items()}}
    print('  Standard deviations of scale [%], separation [%], curvature [mrad/m] between')
    for what, group in groups.items():
        drives = [each for session in group for each in session]
        fit = fit_trajectory(ENCODERS, drives, clock=Clock.AUTO)
        spread = fit_sessions(ENCODERS, group, fit, clock=Clock.AUTO)
        print(f'    {what:24s}', 'too few' if spread is None else ', '.join(
            f'{factor * each.value:.2f} +- {factor * each.error:.2f}'
            for factor, each in zip((100.0, 100.0, 1000.0), spread)))


def jackknifed(drives, clock):
    """Return standard errors of the wheels and the frame by leaving runs out, in words."""
    parts = [fit_trajectory(ENCODERS, drives[:n] + drives[n + 1:], clock=clock)
             for n in range(len(drives))]
    values = [[part.left_wheel_radius_multiplier.value, part.right_wheel_radius_multiplier.value,
               part.wheel_separation_multiplier.value, *(1e3 * np.array(part.frame))]
              for part in parts]
    return ', '.join(f'{each:.2g}' for each in math.sqrt(len(parts) - 1.0) * np.std(values, 0))


def window_errors(recorded, systematic):
    """Return median errors over 10 s: distance [mm] and yaw [mrad]."""
    error = linearised(CREATE, recorded, windows_between(recorded, (10.0,), 2.5, 0.1),
                       systematic).error
    return 1e3 * np.array([np.median(np.hypot(error[:, 0], error[:, 1])),
                           np.median(np.abs(error[:, 2]))])


def commanded_halves(path):
    """Return the drive of a file with commands, and its first and second half."""
    truth = path.with_name(path.name.replace('commands', 'truth'))
    time, *rest = columns(path, 'time_sec', 'linear_x', 'angular_z').T
    seen, *pose = columns(truth, 'time_sec', 'x', 'y', 'yaw').T
    whole = drive_from_commands(
        time, np.stack(rest, axis=1), seen, np.stack(pose, axis=1), geometry=CREATE)
    middle = 0.5 * (whole.time[0] + whole.time[-1])
    return whole, whole.between(-math.inf, middle), whole.between(middle, math.inf)


def commands(directory):
    """Print errors of the second half of each robot, calibrated on its first."""
    print('UTIAS MRCLAM: position [mm], yaw [mrad] over 10 s: nominal; with delay; fitted; '
          'mean radius too')
    ratios = []
    for path in sorted(directory.rglob('mrclam7_robot*_commands.csv*')):
        whole, first, second = commanded_halves(path)
        fit, free = (fit_trajectory(
            CREATE, [first], clock=Clock.DELAY, windows=COMMANDED, mean_radius=mean_radius)
            for mean_radius in (False, True))
        delay = fit.offsets[0]
        cells = [window_errors(second, each) for each in (
            CalibrationParameters(), CalibrationParameters(offset=delay.value),
            fit.systematic(0), free.systematic(0))]
        ratios.append([*(cells[2] / cells[0]), *(cells[2] / cells[1]), *(cells[3] / cells[0])])
        print(f'  {path.name[8:14]} duplicates {whole.duplicates}, delay {delay.value:.3f} +- '
              f'{delay.error:.3f};', '; '.join(f'{p:.1f} {y:.1f}' for p, y in cells),
              f'; ratios {np.round(ratios[-1], 3)};', described(fit))
    if ratios:
        print('  medians of the ratios to nominal, to nominal with delay, mean radius too:',
              np.median(ratios, axis=0).round(3))


def main():
    """Print everything."""
    if len(sys.argv) != 2:
        sys.exit('usage: python test/benchmark/calibrate_recordings.py DIRECTORY')
    directory = Path(sys.argv[1])
    encoders(directory)
    commands(directory)


if __name__ == '__main__':
    main()
