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
Compare the drift of robots simulated with what was fitted with that of the real ones.

Run by hand: ``python test/benchmark/compare_drifts.py DIRECTORY``.  The directory holds, at any
depth, the files that the docstring of fit_slip.py names.  What is printed is explained in
docs/explanation/calibration_on_real_robots.md.  It takes some five minutes.

Drift is where the robot is after 10 s minus where nominal odometry says it is, in the frame of
the start.  The real robot has one drift a window, the simulated one 200, from the same wheel
motion or the same commands, with what ``calibrate`` writes: bias and slip of the wheels, slip of
the body, the separation of the ground truth, the response to commands, and what differs between
sessions where the session is another one (one draw for all windows of a simulated robot).  Both
are seen by a reference with the noise that was fitted.

Of the robots with commands, NEES of the halves that were not fitted is printed as well.
"""

import math
from pathlib import Path
import sys
from typing import NamedTuple

import numpy as np

TEST = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(TEST.parent), str(TEST), str(TEST / 'benchmark')]

from calibrate_recordings import (  # noqa: E402, I100
    commanded_halves, CREATE, ENCODERS, SESSIONS)
from diffdrive_kinematics.core.calibration import (  # noqa: E402
    CalibrationParameters, Clock, COMMANDED, fit_drive_slip, fit_response, fit_trajectory,
    linearised, nees_per_dof, RecordedDrive, ReferenceNoise, responded, slip_windows,
    windows_between, without_frozen_poses)
from diffdrive_kinematics.core.calibration.slip_stack import BODY_TERMS  # noqa: E402
from diffdrive_kinematics.core.kinematics import wrap_angle  # noqa: E402
from diffdrive_kinematics.core.noise import (  # noqa: E402
    draw_session, NO_SESSION, session_generator, SessionSpread, travel_in_session)
from predict_sessions import of_session, SPANS  # noqa: E402
from support.end_points import encoder_drive  # noqa: E402

WINDOW_S, SEEDS = 10.0, 200
AXES = ('along [mm]', 'across [mm]', 'yaw [mrad]')


class Robot(NamedTuple):
    """What is simulated: factors of travel (left, right) and of the separation, and noise."""

    geometry: object
    factors: tuple
    slip: object
    noise: ReferenceNoise
    spread: SessionSpread = NO_SESSION


class Driven(NamedTuple):
    """A drive as odometry has it and as it is simulated from, with their clocks and the frame."""

    nominal: RecordedDrive
    believed: CalibrationParameters
    moved: RecordedDrive
    systematic: CalibrationParameters

    def windows(self):
        """Return disjoint windows."""
        return windows_between(self.nominal, (WINDOW_S,), WINDOW_S + 0.1, 0.1)


def real_drifts(geometry, driven):
    """Return the drifts of disjoint windows, shape (w, 3)."""
    frame_only = driven.believed._replace(left=1.0, right=1.0, separation=1.0)
    return linearised(geometry, driven.nominal, driven.windows(), frame_only).error


def wheel_motions(geometry, recorded, systematic, windows):
    """Return the periods, shape (n,), and nominal travel, shape (n, 2), of each window."""
    middle = 0.5 * (recorded.time[0] + recorded.time[-1])
    stamps = (recorded.reference_time - systematic.offset
              - systematic.drift * (recorded.reference_time - middle))
    found = []
    for start, end in zip(windows.start, windows.end):
        inner = recorded.time[(recorded.time > stamps[start]) & (recorded.time < stamps[end])]
        times = np.concatenate([[stamps[start]], inner, [stamps[end]]])
        angles = np.stack([np.interp(times, recorded.time, column)
                           for column in recorded.angles.T], axis=1)
        found.append((np.diff(times), np.diff(angles, axis=0) * geometry.wheel_radius))
    return found


def ends(distance, turn):
    """Return relative poses after the intervals of each row, shape (..., 3)."""
    theta = np.cumsum(turn, axis=-1)
    chord, way = distance * np.sinc(turn / (2.0 * np.pi)), theta - 0.5 * turn
    return np.stack([np.sum(chord * np.cos(way), axis=-1), np.sum(chord * np.sin(way), axis=-1),
                     theta[..., -1]], axis=-1)


def arcs(left, right, separation):
    """Return length and turn of each interval."""
    return 0.5 * (left + right), (right - left) / separation


def simulated_ends(robot, travel, session, generator):
    """Return where 200 simulated robots are after the wheel motion of a window."""
    *radii, separation = robot.factors
    separation *= robot.geometry.separation
    slip, moved = robot.slip, travel_in_session(
        session, separation, *(factor * column for factor, column in zip(radii, travel.T)))

    def noise(variance):
        return np.sqrt(variance) * generator.standard_normal((SEEDS, len(travel)))

    nominal, turned = map(np.abs, arcs(*moved, separation))
    distance, turn = arcs(*(column + noise(k.value * np.abs(column)) for column, k in zip(
        moved, (slip.k_left, slip.k_right))), separation)
    body = slip.body
    return ends(distance + noise(body.linear_variance * nominal), turn + noise(
        body.turn_variance * turned + body.heading_variance * nominal))


def seen(poses, noise, first, last, generator):
    """Return relative poses as a reference sees them that has noise at both ends."""
    measured = []
    for pose, (speed, rate) in ((np.zeros_like(poses), first), (poses, last)):
        x, y, theta = pose.T
        late = noise.sigma_time * generator.standard_normal(len(poses))
        dx, dy, turn = generator.standard_normal((3, len(poses)))
        measured.append((
            x + 1j * y + noise.sigma_position * (dx + 1j * dy)
            + speed * late * np.exp(1j * theta), theta + noise.sigma_heading * turn + rate * late))
    (start, heading), (end, theta) = measured
    apart = (end - start) * np.exp(-1j * heading)
    return np.stack([apart.real, apart.imag, theta - heading], axis=1)


def simulated_drifts(robot, driven, session, generator):
    """Return the drifts of 200 simulated robots in each window, shape (w, 200, 3)."""
    geometry, found = robot.geometry, []
    both = (wheel_motions(geometry, *each, driven.windows()) for each in (driven[:2], driven[2:]))
    for (_, asked), (periods, travel) in zip(*both):
        there = simulated_ends(robot, travel, session, generator)
        twists = np.stack(arcs(*travel.T, geometry.separation), axis=1) / periods[:, None]
        drift = (seen(there, robot.noise, twists[0], twists[-1], generator)
                 - ends(*arcs(*asked.T, geometry.separation)))
        drift[:, 2] = wrap_angle(drift[:, 2])
        found.append(drift)
    return found


def statistic(first, second):
    """Return the two-sample Kolmogorov-Smirnov statistic."""
    both = np.sort(np.concatenate([first, second]))
    return np.max(np.abs(np.searchsorted(np.sort(first), both, side='right') / len(first)
                         - np.searchsorted(np.sort(second), both, side='right') / len(second)))


def probability(gap, number):
    """Return p of a statistic of samples of which the smaller one has this size."""
    t = (math.sqrt(number) + 0.12 + 0.11 / math.sqrt(number)) * gap  # Stephens 1970
    return 1.0 if t < 0.3 else min(1.0, max(0.0, 2.0 * sum(
        (-1)**(n - 1) * math.exp(-2.0 * (n * t)**2) for n in range(1, 60))))


def compared(name, robot, drives):
    """Print real and simulated drifts of drives."""
    generator, session = np.random.default_rng(1), draw_session(
        robot.spread, session_generator(1), SEEDS)
    session = type(session)(*(each[:, None] for each in session))
    real = np.concatenate([real_drifts(robot.geometry, each) for each in drives])
    simulated = np.stack([drift for each in drives for drift in simulated_drifts(
        robot, each, session, generator)])
    for axis, label in enumerate(AXES):
        mine, every = real[:, axis], simulated[:, :, axis]
        gap = statistic(mine, every.ravel())
        as_far = np.mean([statistic(one, every.ravel()) >= gap for one in every.T])
        print(f'| {name if not axis else ""} | {len(real) if not axis else ""} | {label} | '
              + ' | '.join(f'{1e3 * np.mean(each):.1f} +- {1e3 * np.std(each):.1f}'
                           for each in (mine, every))
              + f' | {np.std(every) / np.std(mine):.2f} | {gap:.2f} | '
              f'{probability(gap, len(mine)):.2g} | {as_far:.2g} |', flush=True)


def encoders(directory):
    """Compare the robot with encoders: fitted to the 1.7 m squares, other sessions simulated."""
    found = {name: [encoder_drive(path) for path in sorted(directory.rglob(f'{prefix}_run*'))]
             for name, prefix in SESSIONS.items()}
    training = next(iter(found))
    fit = fit_trajectory(ENCODERS, found[training])
    slip = fit_drive_slip(ENCODERS, found[training], fit)
    factors = tuple(each.value for each in (
        fit.left_wheel_radius_multiplier, fit.right_wheel_radius_multiplier,
        fit.wheel_separation_multiplier))
    for name, drives in found.items():
        own, noise, spread = (fit, slip.noise, (0.0, 0.0, 0.0)) if name == training else (
            of_session(found, name, fit.corrected(ENCODERS), slip.k_left.value))
        clocks = [own.systematic(number) for number in range(len(drives))]
        compared(name, Robot(ENCODERS, factors, slip, noise, SessionSpread(*spread)), [
            Driven(each, clock, each, clock) for each, clock in zip(drives, clocks)])


def commands(directory):
    """Compare the robots with commands: fitted to the first half, the second simulated."""
    rows = []
    for path in sorted(directory.rglob('mrclam7_robot*_commands.csv*')):
        _, *halves = commanded_halves(path)
        first, second = (
            without_frozen_poses(half, wheel_radius=CREATE.wheel_radius) for half in halves)
        response = fit_response(CREATE, [first]).response
        told, moved = (responded(CREATE, half, response) for half in (first, second))
        fit = fit_trajectory(
            CREATE, [told], wheels=False, clock=Clock.DELAY, windows=COMMANDED)
        slip, rest = fit_drive_slip(CREATE, [told], fit), fit.systematic(0)
        name = path.name[8:14]
        compared(f'{name}, second half', Robot(CREATE, (1.0, 1.0, 1.0), slip, slip.noise), [
            Driven(second, rest._replace(offset=rest.offset + response.delay), moved, rest)])
        rows.append(f'| {name} | {slip.k_left.value:.1e} | ' + ' | '.join(
            f'{getattr(slip, each).value:.1e}' for each in BODY_TERMS) + ' | ' + ' | '.join(
                judged(half, rest, slip) for half in (told, moved)) + ' |')
    print('\n| robot | k [m] | k_d [m] | k_t [rad] | k_x [rad^2/m] | first half: median (mean) '
          'of NEES per degree of freedom, 5, 10, 20 s | second half |\n' + 7 * '|---' + '|',
          *rows, sep='\n')


def judged(drive, systematic, slip):
    """Return NEES per degree of freedom of windows that start every quarter, in words."""
    found = [nees_per_dof(
        slip_windows(CREATE, drive, systematic, length, 0.25 * length), slip.k_left.value,
        slip.k_right.value, slip.noise, slip.body) for length in SPANS]
    return ', '.join(f'{np.median(each):.2f} ({np.mean(each):.2f})' for each in found)


def main():
    """Print both tables."""
    if len(sys.argv) != 2:
        sys.exit('usage: python test/benchmark/compare_drifts.py DIRECTORY')
    print('| what | windows | drift | real | simulated | ratio of std | D | p | p of robots |\n'
          + 9 * '|---' + '|')
    encoders(Path(sys.argv[1]))
    commands(Path(sys.argv[1]))


if __name__ == '__main__':
    main()
