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

"""The picture of a response to commands: what was measured, and the map."""

from typing import Any, Sequence

from diffdrive_kinematics.core.calibration import (
    commands_of, RecordedDrive, ResponseFit, windows_between)
from diffdrive_kinematics.core.kinematics import WheelGeometry
import numpy as np

MEASURED, MAP = '#cc3311', '#4477aa'
SECONDS, LEAST_SPEED = 1.0, 0.2  # of a point, and of the largest speed, from which one is drawn


def draw_response(
        figure: Any, fit: ResponseFit, geometry: WheelGeometry, drives: Sequence[RecordedDrive]
) -> None:
    """Draw speeds over curvature, and yaw rates over those asked for: measured, and the map."""
    response = fit.response
    asked, moved = (np.concatenate(parts) for parts in zip(*(
        _steady(geometry, drive, response.delay) for drive in drives)))
    fast = np.abs(asked[:, 0]) > LEAST_SPEED * response.max_speed
    v, w = asked[fast].T
    speed, turn = figure.subplots(1, 2)
    speed.plot(w / v, moved[fast, 0] / v, '.', ms=3, color=MEASURED, label='measured, 1 s')
    edge = float(np.percentile(np.abs(w / v), 99.0)) if len(v) else 1.0
    k = np.linspace(-edge, edge, 401)
    speed.plot(k, response.speed_gain * response.share(k), color=MAP, label=f'map: {fit.form}')
    speed.set_xlim(-1.1 * edge, 1.1 * edge)
    speed.set_ylim(0.0, 1.5)
    speed.set_xlabel('curvature asked for [1/m]')
    speed.set_ylabel('speed driven over speed asked for')
    turn.plot(asked[:, 1], moved[:, 1], '.', ms=3, color=MEASURED)
    rate = np.array([-response.max_yaw_rate, response.max_yaw_rate])
    turn.plot(rate, response.yaw_rate_gain * rate, color=MAP)
    turn.set_xlabel('yaw rate asked for [rad/s]')
    turn.set_ylabel('yaw rate turned with [rad/s]')
    for axes in (speed, turn):
        axes.grid(alpha=0.25)
    speed.legend(fontsize='small')


def _steady(geometry: WheelGeometry, drive: RecordedDrive, delay: float) -> Any:
    """Return twists asked for, and driven, of windows in which the command hardly changed."""
    commands = commands_of(geometry, drive)
    start, end, _ = windows_between(drive, (SECONDS,), SECONDS, 0.1)
    times = drive.reference_time - delay
    first, last = (np.clip(np.searchsorted(drive.time, times[rows], side='right') - 1, 0,
                           len(commands) - 1) for rows in (start, end))
    same = np.abs(commands[last] - commands[first]).max(axis=1) < 0.02
    start, end, first = start[same], end[same], first[same]
    seconds = drive.reference_time[end] - drive.reference_time[start]
    apart = drive.reference[end] - drive.reference[start]
    way = drive.reference[start, 2] + 0.5 * apart[:, 2]
    chord = np.cos(way) * apart[:, 0] + np.sin(way) * apart[:, 1]
    moved = np.stack([chord / np.sinc(apart[:, 2] / (2.0 * np.pi)), apart[:, 2]], axis=1)
    return commands[first], moved / seconds[:, None]
