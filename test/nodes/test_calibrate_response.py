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

"""``calibrate`` on recordings of commands: the response that it writes is the robot's."""

from diffdrive_kinematics.core.calibration import (
    CalibrationParameters, drive_from_commands, odometry_at, responded)
from diffdrive_kinematics.core.commands import CommandResponse
from diffdrive_kinematics.core.kinematics import WheelGeometry
from diffdrive_kinematics.ros.parameters.drive_from_values import command_response
from diffdrive_kinematics.ros.parameters.tables import DIFF_DRIVE_CONTROLLER
import numpy as np
import pytest
import yaml

GEOMETRY = WheelGeometry(0.3, 0.05)
TRUTH = CommandResponse(0.2, 0.5, speed_gain=1.03, turn_loss=0.18, yaw_rate_gain=0.95, delay=0.2)
TURN_SLIP = 1e-4  # [rad]


def recording(path):
    """Write commands, and where a robot is whose body slips where it turns, 0.2 s apart."""
    generator, stamps = np.random.default_rng(1), np.arange(0.0, 90.0, 0.2)
    change = np.repeat(generator.uniform(-1.0, 1.0, (45, 2)), 10, axis=0)
    commands = np.stack([0.15 + 0.05 * change[:, 0], 0.5 * change[:, 1]], axis=1)
    bare = drive_from_commands(stamps, commands, stamps, np.zeros((450, 3)), geometry=GEOMETRY)
    moved = responded(GEOMETRY, bare, TRUTH)
    ratio = GEOMETRY.separation / GEOMETRY.wheel_radius
    turns = np.diff(moved.angles, axis=0) @ [-1.0, 1.0] / ratio
    slip = np.cumsum(np.sqrt(TURN_SLIP * np.abs(turns)) * generator.standard_normal(449))
    moved.angles[1:] += 0.5 * ratio * slip[:, None] * [-1.0, 1.0]
    poses = odometry_at(GEOMETRY, moved, CalibrationParameters())
    np.savetxt(path, np.column_stack([stamps, commands, poses]), delimiter=',', comments='',
               header='time_sec,linear_x,angular_z,x,y,yaw')
    return str(path)


@pytest.fixture
def calibrate(here, tmp_path):
    """Return what calibrates by a recording, with settings, in a directory."""
    return lambda *settings: here('calibrate', ['--ros-args', *(
        part for setting in (
            'wheel_radius:=0.05', 'wheel_separation:=0.3', 'fit_response:=true',
            f"recordings:=[{recording(tmp_path / 'drive.csv')}]",
            f"output:={tmp_path / 'found.yaml'}", f"picture:={tmp_path / 'found.svg'}", *settings)
        for part in ('-p', setting))])


@pytest.mark.slow
def test_the_response_and_the_slip_that_are_written_are_those_of_the_robot(calibrate, tmp_path):
    process = calibrate()
    assert process.wait() == 0, process.output
    sections = yaml.safe_load((tmp_path / 'found.yaml').read_text())
    written = sections['/**/diff_drive_controller']['ros__parameters']
    noise = sections['/**/wheel_noise']['ros__parameters']
    found = {name: value for name, value in written.items() if name.startswith('response_')}
    assert {name: noise[name] for name in found} == found
    response = command_response({
        **{entry.name: entry.default for entry in DIFF_DRIVE_CONTROLLER}, **found})
    for name in ('speed_gain', 'yaw_rate_gain', 'veer', 'turn_loss', 'delay'):
        assert getattr(response, name) == pytest.approx(getattr(TRUTH, name), abs=0.02), name
    slip = sections['/**']['ros__parameters']
    assert 0.5 * TURN_SLIP < slip['turn_slip_variance'] < 2.0 * TURN_SLIP
    assert sections['/**/ground_truth']['ros__parameters']['turn_slip_variance'] == 0.0
    assert 'turn slip variance k_t [rad]' in process.output
    assert (tmp_path / 'found.svg').exists()


def test_wheels_that_are_known_already_are_refused_with_a_response(calibrate, tmp_path):
    process = calibrate('wheel_separation_multiplier:=1.1')
    assert process.wait() == 2
    assert 'wheel_separation_multiplier is 1.1, expected 1.0 with fit_response' in process.output
    assert not (tmp_path / 'found.yaml').exists()
