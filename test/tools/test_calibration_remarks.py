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

"""What is remarked upon: courses that tell little, frozen poses, a reference that looks back."""

from dataclasses import replace
import re

from diffdrive_kinematics.tools.calibration import of_drives, table
from diffdrive_kinematics.tools.calibration_file import params_text
from diffdrive_kinematics.tools.calibration_remarks import course_remarks
import numpy as np
import pytest
from support.drives import curved_twists, Disturbance, drive, GEOMETRY, Truth

VALUES = {'mean_radius': '', 'equal_slip': True}


def spot_and_straight(time):
    """Return straights with turns on the spot between them."""
    turning = np.sin(0.5 * time) > 0.0
    return np.stack([np.where(turning, 0.0, 0.4), np.where(turning, 0.8, 0.0)], axis=1)


def left_only(time):
    """Return a course that curves to the left alone."""
    return np.abs(curved_twists(time))


@pytest.mark.parametrize('twists, words', [
    (spot_and_straight, 'on the spot'), (left_only, 'no curves to the right'),
    (lambda time: left_only(time) * [1.0, -1.0], 'no curves to the left')])
def test_a_course_that_tells_little_is_remarked_upon(twists, words):
    remark, = course_remarks(GEOMETRY, [drive(0, twists=twists)])
    assert words in remark


def test_a_good_course_is_not_remarked_upon():
    assert course_remarks(GEOMETRY, [drive(0)]) == []
    assert course_remarks(GEOMETRY, [drive(0, twists=left_only), drive(
        1, twists=lambda time: left_only(time) * [1.0, -1.0])]) == []


@pytest.mark.slow
def test_frozen_poses_and_a_reference_that_looks_back_are_in_the_report():
    whole = drive(0, Truth(yaw=3.0))
    poses = whole.reference.copy()
    poses[300:420] = poses[300]
    report = table(of_drives(
        VALUES, GEOMETRY, [replace(whole, reference=poses)], clock='offsets'))
    assert 'poses of the reference were left out' in report
    assert 'looks backwards on the robot (yaw 3.00 rad)' in report
    assert 'looks backwards' not in table(of_drives(
        VALUES, GEOMETRY, [drive(0)], clock='offsets'))


@pytest.mark.slow
@pytest.mark.parametrize('drift, words', [
    (2e-3, r'\(drift\)'), (0.0, r'\(offset alone\)')])
def test_the_report_says_what_was_chosen_of_the_clock_and_why(drift, words):
    report = table(of_drives(VALUES, GEOMETRY, [drive(0, Truth(drift=drift))], clock='auto'))
    assert re.search(r'over 6.6 \(1 % by chance\); ratio of drive 1: [0-9.]+ ' + words, report)
    said = re.search(r'clock drift of drive 1 \[s/min\] +(\S+) +(\S+)', report)
    assert float(said[1]) == pytest.approx(60.0 * drift, abs=0.03)
    assert (said[2] == '-') == (drift == 0.0)
    assert 'ratio of drive' not in table(of_drives(
        VALUES, GEOMETRY, [drive(0)], clock='drifts'))


@pytest.mark.slow
@pytest.mark.parametrize('body, said, written', [
    ((), 'slip is that of the wheels: ', 'left_slip_variance: [1-9]'),
    ((1e-4, 2e-3, 0.0), r'slip is that of the body \(linear, turn\): ',
     'turn_slip_variance: 0.00[1-3]')])
def test_the_report_says_what_slips_and_why_and_the_file_has_it(body, said, written):
    found = of_drives(
        VALUES, GEOMETRY, [drive(seed, Truth(), Disturbance(0.0 if body else 1e-3, body=body))
                           for seed in range(2)], clock='auto')
    report, text = table(found), params_text(found, 'calibration.yaml')
    assert re.search(said, report) and 'twice the log likelihood by 6.6' in report
    assert re.search(r'next best: the \w+.*, [0-9.]+ behind', report)
    for_all, truth = text.split('/**/ground_truth')[0], text.split('/**/ground_truth')[1]
    assert re.search(written, for_all)
    assert ('turn_slip_variance: 0.0\n' in truth) == bool(body)
    assert ('linear slip variance k_d [m]' in report) == bool(body)


@pytest.mark.slow
@pytest.mark.parametrize('mean_radius, words', [
    ('', 'both radii and the separation'),
    ('keep', 'the separation and the ratio of the radii; the mean radius is kept')])
def test_the_report_says_which_parameters_are_known(mean_radius, words):
    report = table(of_drives(
        {**VALUES, 'mean_radius': mean_radius}, GEOMETRY, [drive(0)], clock='offsets'))
    assert f'known from the drives: {words}' in report
