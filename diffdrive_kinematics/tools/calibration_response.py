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

"""What ``calibrate`` finds of a robot without encoders: how it follows them."""

from typing import Any, Dict, Mapping, Sequence

from diffdrive_kinematics.core.calibration import (
    Clock, COMMANDED, fit_drive_slip, fit_response, fit_trajectory, RecordedDrive, responded,
    without_frozen_poses)
from diffdrive_kinematics.core.commands import CommandResponse
from diffdrive_kinematics.core.kinematics import WheelGeometry
from diffdrive_kinematics.tools.calibration import (
    Calibration, Gain, MULTIPLIERS, of_drives, Row, slip_rows)
from diffdrive_kinematics.tools.calibration_remarks import slip_remark
from diffdrive_kinematics.tools.recordings import nobody, Progress

UNITS = {'max_speed': 'm/s', 'max_yaw_rate': 'rad/s', 'veer': 'rad/m', 'turn_loss': 'm',
         'delay': 's'}


def of_recordings(
        values: Mapping[str, Any], geometry: WheelGeometry, drives: Sequence[RecordedDrive], *,
        clock: str, commands: bool = False, progress: Progress = nobody) -> Calibration:
    """Return the calibration of wheels, or of the response; ``ValueError`` where there is none."""
    if not values['fit_response']:
        return of_drives(
            values, geometry, drives, clock=clock, commands=commands, progress=progress)
    if not commands:
        raise ValueError(
            'fit_response is True, expected recordings of commands: linear_x,angular_z, or Twist')
    return of_commands(
        geometry, [without_frozen_poses(drive, wheel_radius=geometry.wheel_radius)
                   for drive in drives], equal_slip=values['equal_slip'], progress=progress)


def of_commands(
        geometry: WheelGeometry, drives: Sequence[RecordedDrive], *, equal_slip: bool,
        progress: Progress) -> Calibration:
    """Return the calibration by the response; ``ValueError`` where the drives allow none."""
    for name in MULTIPLIERS:
        if getattr(geometry, name) != 1.0:
            raise ValueError(
                f'{name} is {getattr(geometry, name)!r}, expected 1.0 with fit_response, which '
                'says all of how the robot follows')
    fit = fit_response(geometry, drives, lambda form: progress(f'fitting the response: {form}'))
    progress('fitting the slip')
    moved = [responded(geometry, drive, fit.response) for drive in drives]
    rest = fit_trajectory(geometry, moved, wheels=False, clock=Clock.DELAY, windows=COMMANDED)
    slip = fit_drive_slip(geometry, moved, rest, equal=equal_slip)
    parameters = response_parameters(fit.response)
    rows = [
        Row(f"{name} [{UNITS.get(name[len('response_'):], '1')}]", float(value), None)
        for name, value in parameters.items() if not isinstance(value, list)]
    rows += [Row(f'response_shares at {curvature:.3g}/m [1]', share, None)
             for curvature, share in zip(fit.response.curvatures, fit.response.shares)]
    rows += slip_rows(slip)
    gains, chosen = fit.prediction('gains'), fit.prediction()
    seconds = sum(float(drive.time[-1] - drive.time[0]) for drive in drives)
    forms = ', '.join(f'{each.form} {1e3 * each.mean:.1f}' for each in fit.predictions)
    return Calibration(
        'response to commands', geometry, (slip.k_left.value, slip.k_right.value), tuple(rows),
        (Gain('position after 10 s, median [mm]', 1e3 * gains.position, 1e3 * chosen.position),
         Gain('heading after 10 s, median [mrad]', 1e3 * gains.heading, 1e3 * chosen.heading)),
        (f'{len(drives)} drives, {seconds:.1f} s, form: {fit.form}',
         'errors are those of quarters of the drives that were not fitted; mean of position [mm] '
         f'by form: {forms}; the simplest form within one standard error of the best is taken',
         slip_remark(slip)),
        (fit, geometry, drives), ('gains, delay', 'response'), body=slip.body,
        response=parameters)


def response_parameters(response: CommandResponse) -> Dict[str, Any]:
    """Return the parameters that the response amounts to, by their names."""
    fields: Mapping[str, Any] = vars(response)
    return {f'response_{name}': list(value) if isinstance(value, tuple) else value
            for name, value in fields.items()}
