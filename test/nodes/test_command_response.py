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

"""A robot that follows its commands as it likes, and a controller that knows how."""

import math

from diffdrive_kinematics.core.commands import CommandResponse
from diffdrive_kinematics.nodes.diff_drive_controller import (
    build as build_controller, DiffDriveController)
from diffdrive_kinematics.nodes.wheel_noise import build as build_noise
from diffdrive_kinematics.ros.parameters.tables import DIFF_DRIVE_CONTROLLER, WHEEL_NOISE
import pytest
from support.graph import KHEPERA
from support.inside import inside
from support.true_run import driven

RESPONSE = {
    'response_max_speed': 0.5, 'response_max_yaw_rate': 2.0, 'response_speed_gain': 1.03,
    'response_yaw_rate_gain': 0.9, 'response_veer': 0.1, 'response_turn_loss': 0.18,
    'response_curvatures': [0.0, 0.1], 'response_shares': [0.95, 1.0], 'response_delay': 0.25}
SIDE = [(0.2, 0.0, 5.0), (0.1, math.pi / 8.0, 4.0)]  # times on the grid of the clock
BIAS = {'left_bias': 0.001, 'right_bias': -0.001}


def end_of(diffdrive, noise, controller):
    """Drive a square with round corners; return where the robot is at its end."""
    _, truth = driven(
        diffdrive, 4 * SIDE, 0.05, wheel_noise=noise, diff_drive_controller=controller)
    return truth.pose.pose.position.x, truth.pose.pose.position.y


@pytest.mark.slow
@pytest.mark.ros
def test_without_slip_the_inverse_drives_the_square_that_was_wanted(diffdrive):
    wanted = end_of(diffdrive, {}, {})
    assert math.hypot(*wanted) < 1e-6
    assert math.hypot(*end_of(diffdrive, RESPONSE, {})) > 0.05
    inverse = end_of(diffdrive, RESPONSE, {**RESPONSE, 'use_response': True})
    assert math.dist(inverse, wanted) < 1e-6


@pytest.mark.ros
def test_a_commanded_robot_that_is_known_errs_as_one_with_encoders(diffdrive):
    encoders = math.hypot(*end_of(diffdrive, BIAS, {}))
    known = math.hypot(*end_of(
        diffdrive, {**BIAS, **RESPONSE}, {**RESPONSE, 'use_response': True}))
    assert known == pytest.approx(encoders, rel=0.2)


@pytest.mark.parametrize('given', [{}, {**RESPONSE, 'use_response': True}])
def test_a_controller_says_that_its_wheel_rates_are_not_what_is_driven(capfd, given):
    with inside(DiffDriveController, {**KHEPERA, **given}):
        assert ('needs the output of a wheel_noise' in capfd.readouterr().err) is bool(given)


def values_of(table, **given):
    """Return the values of a table with some given."""
    return {**{entry.name: entry.default for entry in table}, **KHEPERA, **given}


def test_parameters_make_the_response_that_they_name():
    settings = build_controller(values_of(
        DIFF_DRIVE_CONTROLLER, **{**RESPONSE, 'use_response': True})).drive
    assert settings.response == CommandResponse(
        0.5, 2.0, speed_gain=1.03, yaw_rate_gain=0.9, veer=0.1, turn_loss=0.18,
        curvatures=[0.0, 0.1], shares=[0.95, 1.0], delay=0.25)
    assert build_controller(values_of(DIFF_DRIVE_CONTROLLER, **RESPONSE)).drive.response is None
    assert build_noise(values_of(WHEEL_NOISE)).response is None
    assert build_noise(values_of(WHEEL_NOISE, **RESPONSE)).response.delay_ns == 250_000_000


@pytest.mark.parametrize('wrong, message', [
    ({'response_turn_loss_order': 3}, 'response_turn_loss_order is 3'),
    ({'response_max_yaw_rate': 0.0}, 'response_max_yaw_rate is 0.0'),
    ({'response_shares': [1.0]}, 'response_curvatures are'),
    ({'response_max_speed': 0.0, 'use_response': True}, 'response_max_speed 0.0, expected')])
def test_a_response_that_is_none_is_refused_by_its_parameter(wrong, message):
    with pytest.raises(ValueError, match=message):
        build_controller(values_of(
            DIFF_DRIVE_CONTROLLER, **{**RESPONSE, 'use_response': True, **wrong}))


def test_a_response_that_is_none_is_refused_before_it_is_used():
    with pytest.raises(ValueError, match='response_turn_loss_order is 3'):
        build_controller(values_of(
            DIFF_DRIVE_CONTROLLER, **{**RESPONSE, 'response_turn_loss_order': 3}))


@pytest.mark.parametrize('table', [DIFF_DRIVE_CONTROLLER, WHEEL_NOISE])
def test_lists_are_set_at_the_start_only_as_an_empty_one_has_no_type(table):
    assert all(entry.read_only for entry in table if isinstance(entry.default, list))
