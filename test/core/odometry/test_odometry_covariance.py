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

"""The covariance that odometry carries: that of the path, whatever messages it came by."""

from itertools import accumulate
import math

from diffdrive_kinematics.core.kinematics import Pose, travel_from_angles, WheelGeometry
from diffdrive_kinematics.core.noise import (
    BodySlip, CERTAIN, NO_BODY_SLIP, NO_COVARIANCE, propagated_moments)
from diffdrive_kinematics.core.odometry import Odometry, WheelSample
import numpy as np
import pytest

MS = 1_000_000
S = 1000 * MS
GEOMETRY = WheelGeometry(0.4, 0.1, 1.1, 0.9, 1.2)
SLIP = (3e-7, 5e-7)
PLAIN = Odometry.starting_at(Pose(1.0, -2.0, 2.5), geometry=GEOMETRY, timeout_ns=S)
START = PLAIN._replace(slip_variances=SLIP)
LEGS = [
    (0, (5.0, 7.0)), (300 * MS, (-3.0, 4.0)), (900 * MS, (0.0, 6.0)), (1200 * MS, (-2.0, -2.0))]
END = 1500 * MS
SAMPLES = [WheelSample(stamp, rates) for stamp, rates in LEGS]


def fed(odometry, samples):
    """Return the odometry after samples that came at their stamps, or when the last one came."""
    for sample, now_ns in zip(samples, accumulate((sample.stamp_ns for sample in samples), max)):
        odometry, _ = odometry.update(sample, now_ns)
    return odometry


def along(legs, end, slip=SLIP, pose=PLAIN.predict(0).pose, moments=CERTAIN, body=NO_BODY_SLIP):
    """Return the moments of rates held from stamp to stamp, leg by leg."""
    for (stamp, rates), (until, _) in zip(legs, [*legs[1:], (end, None)]):
        seconds = (until - stamp) / 1e9
        travel = travel_from_angles(GEOMETRY, *(rate * seconds for rate in rates))
        pose, moments = propagated_moments(moments, pose, GEOMETRY, *travel, *slip, body)
    return moments


def assert_same(covariance, moments, tolerance=1e-12):
    expected = moments.second_moment()
    scale = np.sqrt(np.diag(expected.matrix()))
    assert np.all(np.abs(covariance.matrix() - expected.matrix())
                  <= tolerance * np.outer(scale, scale))


def test_the_covariance_is_that_of_the_path_leg_by_leg():
    assert_same(fed(START, SAMPLES).covariance_at(END), along(LEGS, END))


def test_it_grows_within_a_leg_and_looking_changes_nothing():
    odometry = fed(START, SAMPLES)
    early = odometry.covariance_at(1300 * MS)
    assert_same(early, along(LEGS, 1300 * MS))
    assert odometry.covariance_at(END).tt > early.tt
    assert odometry.covariance_at(1300 * MS) == early


def test_wheels_that_do_not_slip_leave_no_covariance():
    odometry = fed(PLAIN, SAMPLES)
    assert odometry.anchor.moments is CERTAIN
    assert odometry.covariance_at(END) is NO_COVARIANCE


def test_the_pose_is_to_the_bit_what_it_is_without_slip():
    assert fed(START, SAMPLES).predict(END) == fed(PLAIN, SAMPLES).predict(END)


def test_repeats_change_no_bit_of_it():
    repeated = sorted(
        SAMPLES + [WheelSample(stamp + k * 10 * MS, rates) for stamp, rates in LEGS
                   for k in range(1, 30)], key=lambda sample: sample.stamp_ns)
    assert fed(START, repeated).covariance_at(END) == fed(START, SAMPLES).covariance_at(END)


def test_a_message_that_supersedes_what_followed_takes_back_its_covariance():
    repeat = WheelSample(250 * MS, LEGS[0][1])
    late = WheelSample(200 * MS, (-1.0, 2.0))
    assert fed(START, [SAMPLES[0], repeat, late]).covariance_at(END) == fed(
        START, [SAMPLES[0], late]).covariance_at(END)


def test_a_base_that_has_fallen_silent_gathers_no_more():
    odometry = fed(START, SAMPLES[:1])
    assert odometry.covariance_at(50 * S) == odometry.covariance_at(S)
    assert_same(odometry.covariance_at(S), along(LEGS[:1], S))


def test_positions_gather_the_same_as_the_rates_that_they_amount_to():
    angles, samples = (0.0, 0.0), []
    for (stamp, rates), (until, _) in zip(LEGS, [*LEGS[1:], (END, None)]):
        samples.append(WheelSample(stamp, None, angles))
        seconds = (until - stamp) / 1e9
        angles = (angles[0] + rates[0] * seconds, angles[1] + rates[1] * seconds)
    odometry = fed(START, [*samples, WheelSample(END, None, angles)])
    assert_same(odometry.covariance_at(END), along(LEGS, END))


def test_another_slip_counts_from_now_on_and_an_old_error_keeps_swinging():
    odometry = fed(START, SAMPLES[:1]).configured(GEOMETRY, S, 100 * MS, (0.0, 0.0))
    first = along(LEGS[:1], 100 * MS)
    assert_same(odometry.covariance_at(100 * MS), first)
    pose = odometry.predict(100 * MS).pose
    assert_same(odometry.covariance_at(400 * MS), along(
        [(100 * MS, LEGS[0][1])], 400 * MS, (0.0, 0.0), pose, first))
    assert odometry.covariance_at(400 * MS).yy != first.second_moment().yy


def test_new_settings_leave_the_slip_as_it_is_where_they_do_not_name_it():
    odometry = fed(START, SAMPLES).configured(GEOMETRY, 2 * S, 1300 * MS)
    assert odometry.slip_variances == SLIP
    assert_same(odometry.covariance_at(END), along(LEGS, END))


def test_it_is_in_the_axes_of_the_fixed_frame():
    """A straight along +y has its variance across, which is along x; to first order."""
    north = Odometry.starting_at(
        Pose(0.0, 0.0, math.pi / 2), geometry=WheelGeometry(0.4, 0.1), timeout_ns=None,
        slip_variances=(1e-17, 1e-17))
    covariance = fed(north, [WheelSample(0, (10.0, 10.0))]).covariance_at(4 * S)
    assert covariance.xx == pytest.approx(2e-17 * 4.0**3 / (3.0 * 0.4**2), rel=1e-12)
    assert covariance.yy == pytest.approx(1e-17 * 4.0 / 2.0, rel=1e-12)
    assert covariance.xt < 0.0


@pytest.mark.parametrize('slip', [(-1e-9, 0.0), (0.0, math.nan), (math.inf, 0.0)])
def test_a_slip_variance_that_cannot_be_is_refused(slip):
    with pytest.raises(ValueError, match='slip variance is'):
        START.configured(GEOMETRY, S, 0, slip)
    with pytest.raises(ValueError, match='slip variance is'):
        Odometry.starting_at(
            Pose(0.0, 0.0, 0.0), geometry=GEOMETRY, timeout_ns=S, slip_variances=slip)


@pytest.mark.parametrize('slip', [SLIP, (0.0, 0.0)])
@pytest.mark.parametrize('every', [10 * MS, 37 * MS, 300 * MS])
def test_slip_of_the_body_counts_along_the_path_whatever_messages_it_came_by(slip, every):
    body = BodySlip(1e-4, 1e-3, 2e-4)
    repeats = [WheelSample(stamp, rates) for (begin, rates), (end, _) in zip(
        LEGS, [*LEGS[1:], (END, None)]) for stamp in range(begin, end, every)]
    odometry = fed(Odometry.starting_at(
        PLAIN.predict(0).pose, geometry=GEOMETRY, timeout_ns=S, slip_variances=slip,
        body_slip=body), repeats)
    assert_same(odometry.covariance_at(END), along(LEGS, END, slip, body=body))
    assert_same(odometry.configured(GEOMETRY, S, END).covariance_at(END),
                along(LEGS, END, slip, body=body))
    assert odometry.configured(GEOMETRY, S, END).body_slip == body
    assert odometry.set_pose(Pose(0.0, 0.0, 0.0), NO_COVARIANCE, END).body_slip == body
