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
NEES of sessions of a real robot, predicted from one of them and what differs between the others.

Run by hand: ``python test/benchmark/predict_sessions.py DIRECTORY``, with the OptiOdom files that
the docstring of fit_slip.py names.  What is printed is explained in
docs/explanation/slip_on_real_robots.md.  It takes some minutes.
"""

from pathlib import Path
import sys

import numpy as np

TEST = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(TEST.parent), str(TEST), str(TEST / 'benchmark')]

from calibrate_recordings import ENCODERS, SESSIONS  # noqa: E402, I100
from diffdrive_kinematics.core.calibration import (  # noqa: E402
    Clock, fit_drive_slip, fit_reference_noise, fit_sessions, fit_trajectory, linearised,
    slip_windows, windows_between)
from diffdrive_kinematics.core.calibration.slip_stack import (  # noqa: E402
    noise_covariance, stacked_windows)
from diffdrive_kinematics.core.calibration.variance_components import likelihood  # noqa: E402
from support.end_points import encoder_drive  # noqa: E402

SHORT, SPANS = 2.0, (5.0, 10.0, 20.0)


def nees(geometry, drives, own, k, noise, length, spread):
    """Return NEES per degree of freedom of windows of one length."""
    found = []
    for number, drive in enumerate(drives):
        systematic = own.systematic(number)
        stack = stacked_windows(
            slip_windows(geometry, drive, systematic, length, 0.25 * length), 1)
        jacobian = linearised(geometry, drive, windows_between(
            drive, (length,), 0.25 * length, 0.1), systematic).jacobian
        left, right, separation = (jacobian[:, :, column] for column in range(3))
        session = spread * np.stack(
            [left + right, separation, 0.5 * geometry.separation * (right - left)], axis=2)
        covariance = (k * (stack.left + stack.right) + noise_covariance(stack, noise)
                      + session @ session.transpose(0, 2, 1))
        found.append(likelihood(stack.error, covariance)[1] / 3.0)
    return float(np.mean(np.concatenate(found)))


def of_session(found, name, geometry, k):
    """Return frame and clocks of a session, its noise, and the spread between the others."""
    rest = [drives for other, drives in found.items() if other != name]
    pooled = fit_trajectory(ENCODERS, [drive for drives in rest for drive in drives])
    between = fit_sessions(ENCODERS, rest, pooled, clock=Clock.AUTO)
    own = fit_trajectory(geometry, found[name], wheels=False)
    short = [window for number, drive in enumerate(found[name]) for window in slip_windows(
        geometry, drive, own.systematic(number), SHORT, SHORT + 0.1)]
    return own, fit_reference_noise(short, k, k).noise, np.array(
        [between.scale.value, between.separation.value, between.curvature.value])


def main():
    """Print a line for each session that is predicted."""
    if len(sys.argv) != 2:
        sys.exit('usage: python test/benchmark/predict_sessions.py DIRECTORY')
    found = {name: [encoder_drive(path) for path in sorted(
        Path(sys.argv[1]).rglob(f'{prefix}_run*'))] for name, prefix in SESSIONS.items()}
    first, *others = found
    fit = fit_trajectory(ENCODERS, found[first])
    slip = fit_drive_slip(ENCODERS, found[first], fit)
    k, geometry = slip.k_left.value, fit.corrected(ENCODERS)
    print(f'{first}: {slip.terms}, k {k:.2e} +- {slip.k_left.error:.1e} m, {slip.noise}')
    for name in others:
        own, noise, spread = of_session(found, name, geometry, k)
        for what, size in (('without', 0.0), ('with', 1.0)):
            print(f'{name}, {what} session terms {spread}:', ', '.join(
                f'{nees(geometry, found[name], own, k, noise, length, size * spread):.2f}'
                for length in SPANS))


if __name__ == '__main__':
    main()
