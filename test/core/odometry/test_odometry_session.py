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

"""What lasts a run, in the odometry that counts it and in the stream that has it."""

from dataclasses import replace

from diffdrive_kinematics.core.kinematics import Pose, pose_change_from_travel, WheelGeometry
from diffdrive_kinematics.core.noise import (
    NO_COVARIANCE, NO_SESSION, SessionBelief, SessionError, SessionSpread, travel_in_session,
    WheelSlip)
from diffdrive_kinematics.core.odometry import Odometry, SlipStream, WheelSample
import numpy as np
import pytest

MS = 1_000_000
S = 1000 * MS
GEOMETRY = WheelGeometry(0.4, 0.1, 1.1, 0.9, 1.2)
RADII = GEOMETRY.left_radius, GEOMETRY.right_radius
SPREAD = SessionSpread(scale=0.01, separation=0.02, curvature=0.03)
PLAIN = Odometry.starting_at(
    Pose(1.0, -2.0, 2.5), geometry=GEOMETRY, timeout_ns=S, slip_variances=(3e-7, 5e-7))
START = PLAIN._replace(anchor=PLAIN.anchor.with_session(SPREAD))
LEGS = [
    (0, (5.0, 7.0)), (300 * MS, (-3.0, 4.0)), (900 * MS, (0.0, 6.0)), (1200 * MS, (-2.0, -2.0))]
END = 1500 * MS
SAMPLES = [WheelSample(stamp, rates) for stamp, rates in LEGS]
ERROR = SessionError(scale=0.02, separation=-0.05, curvature=0.1)


def fed(odometry, samples, now_ns=0):
    """Return the odometry after samples that came at their stamps, or at ``now_ns``."""
    for sample in samples:
        odometry, _ = odometry.update(sample, max(now_ns, sample.stamp_ns))
    return odometry


def along(legs, end, heading=2.5, geometry=GEOMETRY):
    """Return what is believed of the session after rates held from stamp to stamp."""
    belief = SessionBelief(SPREAD)
    for (stamp, rates), (until, _) in zip(legs, [*legs[1:], (end, None)]):
        d = (rate * radius * (until - stamp) / 1e9 for rate, radius in zip(
            rates, (geometry.left_radius, geometry.right_radius)))
        distance, turn = pose_change_from_travel(geometry, *d)
        belief = belief.after(heading, distance, turn)
        heading += turn
    return belief.covariance()


def of_session(odometry, plain, time_ns):
    """Return what a session adds to the covariance."""
    return odometry.covariance_at(time_ns).matrix() - plain.covariance_at(time_ns).matrix()


@pytest.mark.parametrize('time_ns', [0, 100 * MS, 700 * MS, END])
def test_the_session_is_on_top_of_the_slip_at_any_time(time_ns):
    legs = [leg for leg in LEGS if leg[0] < time_ns]
    samples = SAMPLES[:len(legs)]
    found = of_session(fed(START, samples), fed(PLAIN, samples), time_ns)
    assert found == pytest.approx(along(legs, time_ns).matrix(), rel=1e-9, abs=1e-15)


def test_a_spread_of_0_leaves_odometry_as_it_is_to_the_bit():
    assert PLAIN.anchor.with_session(NO_SESSION) == PLAIN.anchor
    without = START._replace(anchor=START.anchor.with_session(NO_SESSION))
    assert fed(without, SAMPLES) == fed(PLAIN, SAMPLES)
    assert fed(START, SAMPLES).predict(END) == fed(PLAIN, SAMPLES).predict(END)


def test_a_session_alone_makes_a_covariance():
    still = START._replace(slip_variances=(0.0, 0.0))
    assert still.covariance_at(0) == NO_COVARIANCE
    found = fed(still, SAMPLES).covariance_at(END).matrix()
    assert found == pytest.approx(along(LEGS, END).matrix(), rel=1e-12)


def test_a_message_that_supersedes_what_followed_takes_back_what_it_made_of_the_session():
    repeat, late = WheelSample(250 * MS, LEGS[0][1]), WheelSample(200 * MS, (-1.0, 2.0))
    assert fed(START, [SAMPLES[0], repeat, late], 250 * MS).covariance_at(END) == fed(
        START, [SAMPLES[0], late], 250 * MS).covariance_at(END)


def test_a_pose_that_is_set_does_not_depend_on_the_session_that_goes_on():
    odometry = fed(START, SAMPLES).set_pose(Pose(0.0, 0.0, 1.0), NO_COVARIANCE, END)
    assert odometry.covariance_at(END) == NO_COVARIANCE
    moved, _ = odometry.update(WheelSample(END, (5.0, 7.0)), END)
    plain, _ = PLAIN.set_pose(Pose(0.0, 0.0, 1.0), NO_COVARIANCE, END).update(
        WheelSample(END, (5.0, 7.0)), END)
    assert of_session(moved, plain, END + 500 * MS) == pytest.approx(
        along([(END, (5.0, 7.0))], END + 500 * MS, 1.0).matrix(), rel=1e-9)


def test_another_geometry_counts_from_now_on_and_keeps_what_was_gathered():
    wide = WheelGeometry(0.8, 0.1)
    odometry = fed(START, SAMPLES[:1]).configured(wide, S, 100 * MS)
    before = fed(START, SAMPLES[:1]).covariance_at(100 * MS)
    assert odometry.covariance_at(100 * MS) == before
    assert odometry.anchor.session.travelled == pytest.approx(0.1 * 0.5 * (
        RADII[0] * 5.0 + RADII[1] * 7.0))


@pytest.mark.parametrize('spread', [NO_SESSION, SessionSpread(curvature=0.5)])
def test_what_was_gathered_stays_when_the_spread_changes(spread):
    before = fed(START, SAMPLES).configured(GEOMETRY, S, END)
    after = before._replace(anchor=before.anchor.with_session(spread))
    assert after.covariance_at(END).matrix() == pytest.approx(
        before.covariance_at(END).matrix(), rel=1e-12)


def test_what_was_gathered_swings_on_like_a_pose_that_is_as_uncertain():
    still = START._replace(slip_variances=(0.0, 0.0))
    before = fed(still, SAMPLES).configured(GEOMETRY, S, END)
    pose, covariance = before.predict(END).pose, before.covariance_at(END)
    on = WheelSample(END, (5.0, 7.0))
    found = fed(before._replace(anchor=before.anchor.with_session(NO_SESSION)), [on])  # 1 ns later
    expected = fed(PLAIN._replace(slip_variances=(0.0, 0.0)).set_pose(pose, covariance, END), [on])
    assert found.covariance_at(END + S).matrix() == pytest.approx(
        expected.covariance_at(END + S).matrix(), rel=1e-6)


def streamed(samples, left=WheelSlip(), right=WheelSlip(), session=ERROR):
    """Return what a stream with a session puts out."""
    stream = SlipStream(
        RADII, left, right, None, session=session, separation=GEOMETRY.separation)
    generator, out = np.random.default_rng(1), []
    for sample in samples:
        stream, noisy, _ = stream.apply(sample, generator)
        out.append(noisy)
    return out


def test_a_stream_drives_off_by_what_the_session_has():
    out = streamed([*SAMPLES, WheelSample(END, (0.0, 0.0))])
    travel = np.diff([(0.0, 0.0)] + [sample.positions for sample in out[1:]], axis=0) * RADII
    for (stamp, rates), (until, _), found in zip(LEGS, [*LEGS[1:], (END, None)], travel):
        nominal = (rate * radius * (until - stamp) / 1e9 for rate, radius in zip(rates, RADII))
        distance, turn = pose_change_from_travel(GEOMETRY, *nominal)
        found_distance, found_turn = pose_change_from_travel(GEOMETRY, *found)
        assert found_distance == pytest.approx(1.02 * distance, abs=1e-12)
        assert found_turn == pytest.approx(1.02 * (turn / 0.95 + 0.1 * distance), abs=1e-12)


def test_its_velocities_are_those_of_the_session():
    first, second, *_ = streamed(SAMPLES)
    for sample, (_, rates) in ((first, LEGS[0]), (second, LEGS[1])):
        expected = travel_in_session(ERROR, GEOMETRY.separation, *(
            rate * radius for rate, radius in zip(rates, RADII)))
        assert [rate * radius for rate, radius in zip(sample.rates, RADII)] == pytest.approx(
            expected, rel=1e-12)


def test_slip_and_bias_come_on_top_of_the_session():
    left, right = WheelSlip(bias=0.1, variance=1e-4), WheelSlip(bias=-0.2)
    with_bias = streamed(SAMPLES, replace(left, variance=0.0), right)[-1].positions
    alone = streamed(SAMPLES)[-1].positions
    assert with_bias == pytest.approx((1.1 * alone[0], 0.8 * alone[1]))
    slipping = streamed(SAMPLES, left, right)[-1].positions
    assert slipping[0] != with_bias[0]
    assert slipping[1] == with_bias[1]


def test_without_a_session_the_stream_is_as_it_was_to_the_bit():
    slip = WheelSlip(0.1, 1e-4)
    bare = SlipStream(RADII, slip, slip, None)
    generator, out = np.random.default_rng(1), []
    for sample in SAMPLES:
        bare, noisy, _ = bare.apply(sample, generator)
        out.append(noisy)
    assert streamed(SAMPLES, slip, slip, None) == out
