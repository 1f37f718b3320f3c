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

"""The response to commands: what is fitted is what was driven."""

from dataclasses import replace

from diffdrive_kinematics.core.calibration import (
    CalibrationParameters, drive_from_commands, fit_form, fit_heading, fit_response, FORMS,
    odometry_at, responded, response_errors, Windows)
from diffdrive_kinematics.core.calibration.response_choice import simplest
from diffdrive_kinematics.core.commands import CommandResponse
from diffdrive_kinematics.core.kinematics import WheelGeometry
import numpy as np
import pytest

GEOMETRY = WheelGeometry(0.3, 0.05)
FRAME = np.array([0.05, -0.03, 0.1])
TRUTHS = {
    'gains': CommandResponse(0.2, 0.5, speed_gain=0.9, yaw_rate_gain=1.1, veer=0.1, delay=0.3),
    'turn loss': CommandResponse(
        0.2, 0.5, speed_gain=1.03, turn_loss=0.18, yaw_rate_gain=0.95, delay=0.25),
    'turn loss in proportion': CommandResponse(
        0.2, 0.5, turn_loss=0.12, turn_loss_order=1, delay=0.1)}


def commanded_drive(truth, seconds=120.0, noise=2e-4):
    """Return the drive of a robot that follows its commands as the truth has it."""
    generator = np.random.default_rng(1)
    stamps = np.arange(0.0, seconds, 0.2)
    change = np.repeat(generator.uniform(-1.0, 1.0, (len(stamps) // 10 + 1, 2)), 10, axis=0)
    change = change[:len(stamps)]
    commands = np.stack([0.15 + 0.05 * change[:, 0],
                         np.where(np.abs(change[:, 1]) < 0.3, 0.0, 0.5 * change[:, 1])], axis=1)
    bare = drive_from_commands(
        stamps, commands, stamps, np.zeros((len(stamps), 3)), geometry=GEOMETRY)
    centre = odometry_at(GEOMETRY, responded(GEOMETRY, bare, truth), CalibrationParameters())
    x, y, theta = centre.T
    seen = np.stack([x + np.cos(theta) * FRAME[0] - np.sin(theta) * FRAME[1],
                     y + np.sin(theta) * FRAME[0] + np.cos(theta) * FRAME[1],
                     theta + FRAME[2]], axis=1)
    return replace(bare, reference=seen + noise * generator.standard_normal(seen.shape))


@pytest.mark.slow
@pytest.mark.parametrize('form', TRUTHS)
def test_the_response_that_was_driven_is_found_in_its_form(form):
    truth, drive = TRUTHS[form], commanded_drive(TRUTHS[form])
    fit = fit_response(GEOMETRY, [drive])
    assert fit.form == form
    for name in ('speed_gain', 'yaw_rate_gain', 'veer', 'turn_loss', 'delay'):
        assert getattr(fit.response, name) == pytest.approx(getattr(truth, name), abs=0.01), name
    assert fit.frame == pytest.approx(FRAME, abs=0.01)
    assert [each.form for each in fit.predictions] == list(FORMS)
    assert fit.prediction().position < 3e-3


def test_a_form_that_is_better_by_no_more_than_noise_is_not_taken():
    generator, taken = np.random.default_rng(1), {0.0: 0, 1e-3: 0, 4e-3: 0}
    for better in taken:
        for _ in range(400):
            shared = 0.03 + np.repeat(0.02 * generator.standard_normal(20), 8)
            own = np.repeat(4e-3 * generator.standard_normal(20), 8)
            taken[better] += simplest({'gains': shared, 'table': shared + own - better}) == 'table'
    assert taken[0.0] < 400 * 0.2 and taken[4e-3] > 400 * 0.95  # the error is 0.9 mm
    assert 400 * 0.35 < taken[1e-3] < 400 * 0.75


def test_a_window_that_no_form_knows_does_not_choose():
    steady = {'gains': np.full(160, 0.03), 'table': np.full(160, 0.02)}
    wild = {form: np.append(each, np.full(8, 9.0 + each[0])) for form, each in steady.items()}
    assert simplest(steady) == simplest(wild) == 'table'


@pytest.mark.slow
def test_straights_that_are_unlike_the_widest_curves_are_part_of_the_turn_loss():
    truth = replace(TRUTHS['turn loss'], curvatures=(0.0, 0.1), shares=(0.9, 1.0))
    fit = fit_response(GEOMETRY, [commanded_drive(truth)])
    assert fit.form == 'turn loss'
    assert fit.response.shares[0] == pytest.approx(0.9, abs=0.02)
    assert fit.response.turn_loss == pytest.approx(truth.turn_loss, abs=0.01)


def test_no_form_of_the_speed_changes_what_is_found_of_the_heading():
    drive = commanded_drive(TRUTHS['turn loss'], noise=0.01)
    heading = fit_heading(GEOMETRY, [drive])
    for form in FORMS:
        found = fit_form(GEOMETRY, [drive], heading, form).response
        assert (found.yaw_rate_gain, found.veer, found.delay) == (
            heading.yaw_rate_gain, heading.veer, heading.delay)


def test_a_table_follows_a_loss_that_it_does_not_know():
    truth = TRUTHS['turn loss']
    drive = commanded_drive(truth)
    found = fit_form(GEOMETRY, [drive], fit_heading(GEOMETRY, [drive]), 'table')
    errors = response_errors(GEOMETRY, [drive], found, Windows((10.0,), every=2.5))
    assert np.median(np.hypot(*errors[:, :2].T)) < 0.02


def test_forms_that_cannot_be_compared_are_not_chosen_from():
    drive = commanded_drive(TRUTHS['turn loss'], seconds=90.0)
    seen = drive.reference_time % 23.0 < 11.2
    torn = replace(
        drive, reference_time=drive.reference_time[seen], reference=drive.reference[seen])
    with pytest.raises(ValueError, match='windows of 10 s in a part .*, expected 3'):
        fit_response(GEOMETRY, [torn])


def test_a_drive_that_is_too_short_or_never_turns_is_refused():
    with pytest.raises(ValueError, match='expected 80 s'):
        fit_response(GEOMETRY, [commanded_drive(TRUTHS['gains'], seconds=60.0)])
    drive = commanded_drive(TRUTHS['gains'])
    straight = replace(drive, angles=np.stack([drive.time, drive.time], axis=1))
    with pytest.raises(ValueError, match='0 rad/s, expected a drive'):
        fit_response(GEOMETRY, [straight])
