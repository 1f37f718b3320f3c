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
How much better the response to commands predicts five real robots than gains and a delay.

Run by hand: ``python test/benchmark/compare_responses.py DIRECTORY``.  The directory holds, at any
depth, the files of UTIAS MRCLAM that the docstring of fit_slip.py names.  Everything is fitted to
the first half of each robot, the form of the response chosen there too; the second half is only
predicted, over windows of 10 s.  What is printed is explained in
docs/explanation/calibration_on_real_robots.md.  It takes some two minutes.
"""

from pathlib import Path
import sys

import numpy as np

TEST = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(TEST.parent), str(TEST), str(TEST / 'benchmark')]

from calibrate_recordings import commanded_halves, CREATE, window_errors  # noqa: E402, I100
from diffdrive_kinematics.core.calibration import (  # noqa: E402
    Clock, COMMANDED, fit_form, fit_heading, fit_response, fit_trajectory, FittedResponse,
    response_errors, Windows)

WINDOWS = Windows((10.0,), every=2.5)


def medians(drive, fitted):
    """Return median errors over 10 s: distance [mm] and yaw [mrad]."""
    error = response_errors(CREATE, [drive], fitted, WINDOWS)
    return 1e3 * np.array([np.median(np.hypot(error[:, 0], error[:, 1])),
                           np.median(np.abs(error[:, 2]))])


def described(fit):
    """Return the response, and how well each form predicts within the first half, in words."""
    response, gains = fit.response, fit.prediction('gains')
    numbers = (f'c {response.turn_loss:.3f} m' if not response.curvatures
               else f'shares {np.round(response.shares, 2).tolist()}')
    return (f'a {response.speed_gain:.3f}, {numbers}, b {response.yaw_rate_gain:.3f}, '
            f'd {response.veer:+.3f} rad/m, delay {response.delay:.3f} s; within the first half '
            f'{1e3 * gains.position:.1f} -> {1e3 * fit.prediction().position:.1f} mm')


def main():
    """Print a row for each robot."""
    if len(sys.argv) != 2:
        sys.exit('usage: python test/benchmark/compare_responses.py DIRECTORY')
    print('| robot | form | position [mm]: wheels and delay, gains and delay, response | yaw '
          '[mrad]: the same | gains over response |\n|---|---|---|---|---|')
    notes = []
    for path in sorted(Path(sys.argv[1]).rglob('mrclam7_robot*_commands.csv*')):
        _, first, second = commanded_halves(path)
        wheels = fit_trajectory(CREATE, [first], clock=Clock.DELAY, windows=COMMANDED)
        gains = fit_form(CREATE, [first], fit_heading(CREATE, [first]), 'gains')
        fit = fit_response(CREATE, [first])
        cells = [window_errors(second, wheels.systematic(0)), medians(second, gains),
                 medians(second, FittedResponse(fit.response, fit.frame))]
        columns = [', '.join(f'{cell[n]:.1f}' for cell in cells) for n in (0, 1)]
        print(f'| {path.name[13:14]} | {fit.form} | {columns[0]} | {columns[1]} | '
              f'{cells[1][0] / cells[2][0]:.2f} |', flush=True)
        notes.append(f'{path.name[13:14]}: {described(fit)}')
    print(*notes, sep='\n')


if __name__ == '__main__':
    main()
