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

"""Messages that carry one wheel each make samples of all."""

import math

from diffdrive_kinematics.core.odometry.joint_assembly import Assembly, JointReading, MOST_EARLIER
from hypothesis import given, strategies
import pytest

MS = 10**6


def assembled(messages, joints=2):
    """Return the samples that messages (joint, stamp [ms], position) make."""
    assembly, samples = Assembly.of(joints), []
    for joint, stamp_ms, position in messages:
        assembly, sample = assembly.after(
            {joint: JointReading(stamp_ms * MS, position, 2.0 * position)})
        samples += [sample] if sample else []
    return samples


def test_two_messages_of_one_measurement_make_one_sample_as_they_are():
    samples = assembled([(0, 10, 1.0), (1, 10, -1.0), (1, 30, -1.5), (0, 30, 2.0)])
    assert [sample.stamp_ns for sample in samples] == [10 * MS, 30 * MS]
    assert samples[1].positions == (2.0, -1.5) and samples[1].rates == (4.0, -3.0)


@given(strategies.lists(strategies.tuples(
    strategies.integers(0, 2), strategies.integers(1, 50)), max_size=80))
def test_joints_that_turn_steadily_are_where_they_were_at_the_stamp(steps):
    """Whoever comes when, and however often: stamps go up, and the angles are those of then."""
    stamp_ms, messages, rates = 0, [(joint, 0, 0.0) for joint in range(3)], (1.0, -0.5, 3.0)
    for joint, step in steps:
        stamp_ms += step
        messages.append((joint, stamp_ms, rates[joint] * stamp_ms))
    samples = assembled(messages, 3)
    stamps = [sample.stamp_ns for sample in samples]
    assert stamps == sorted(set(stamps))
    for sample in samples:
        for position, rate in zip(sample.positions, rates):
            assert position / rate == pytest.approx(sample.stamp_ns / MS, abs=1e-6)
    received = {joint: max(at for who, at, _ in messages if who == joint) for joint in range(3)}
    assert not samples or stamps[-1] <= min(received.values()) * MS


def test_of_joints_that_take_turns_none_is_ahead_of_the_others():
    messages = [(step % 2, 10 * step, 0.1 * step) for step in range(100)]
    samples = assembled(messages)
    assert len(samples) == 50
    for sample in samples[1:]:
        assert sample.positions[0] == pytest.approx(sample.positions[1], abs=1e-9)
        assert sample.positions[0] == pytest.approx(sample.stamp_ns / MS / 100, abs=1e-9)


@pytest.mark.parametrize('late_ms', [0, 10, 30, 60, 100, 400])
@pytest.mark.parametrize('period_ms', [1, 5, 20])
def test_messages_that_come_late_with_the_right_stamp_turn_nothing(late_ms, period_ms):
    """Two boards of a robot that speeds up straight ahead."""
    messages = []
    for stamp_ms in range(0, 2000, period_ms):
        way = 0.5 * (stamp_ms / 1e3) ** 2
        messages.append((stamp_ms, (0, stamp_ms, way)))
        messages.append((stamp_ms + late_ms + 0.5, (1, stamp_ms, way)))
    samples = assembled([message for _, message in sorted(messages)])
    assert len(samples) >= (2000 - late_ms) // period_ms - 1
    for sample in samples[1:]:
        left, right = sample.positions
        assert left == pytest.approx(right, abs=1e-9)
        assert sample.rates[0] == pytest.approx(sample.rates[1], abs=1e-9)


@pytest.mark.parametrize('apart_ms', [-50_000, 50_000])
def test_joints_with_clocks_of_their_own_go_on_all_the_same(apart_ms):
    messages = []
    for step in range(200):
        messages.append((0, 60_000 + 20 * step, 0.1 * step))
        messages.append((1, 60_000 + apart_ms + 20 * step, 0.1 * step))
    samples = assembled(messages)
    assert len(samples) == 200
    for step, sample in enumerate(samples):
        assert sample.positions == pytest.approx((0.1 * step,) * 2, abs=0.11)


def test_what_is_kept_of_a_joint_is_little_however_long_another_one_is_silent():
    assembly, _ = Assembly.of(2).after({0: JointReading(0, 0.0), 1: JointReading(0, 0.0)})
    for step in range(1, 5000):
        assembly, _ = assembly.after({0: JointReading(step * MS, 1.0 * step)})
        assert len(assembly.earlier[0]) <= MOST_EARLIER
    _, sample = assembly.after({1: JointReading(4800 * MS, 7.0)})
    assert sample.positions == pytest.approx((4800.0, 7.0))


def test_a_joint_that_is_silent_holds_up_the_others_and_loses_nothing():
    messages = [(0, 0, 0.0), (1, 0, 0.0), (0, 20, 1.0), (0, 40, 2.0), (0, 60, 3.0), (1, 60, 3.0)]
    samples = assembled(messages)
    assert [sample.positions for sample in samples] == [(0.0, 0.0), (3.0, 3.0)]


def test_what_is_not_newer_is_dropped_and_a_step_back_of_the_clock_begins_anew():
    messages = [(0, 5000, 1.0), (1, 5000, 1.0), (0, 4900, 9.0), (1, 5020, 2.0), (0, 5020, 2.0),
                (0, 10, 3.0), (1, 10, 3.0), (0, 10, 9.0), (0, 30, 4.0), (1, 30, 4.0)]
    samples = assembled(messages)
    assert [sample.positions[0] for sample in samples] == [1.0, 2.0, 3.0, 4.0]


def test_a_joint_that_tells_no_position_has_none():
    _, sample = Assembly.of(1).after({0: JointReading(5, rate=1.0)})
    assert math.isnan(sample.positions[0]) and sample.rates == (1.0,)


def test_joints_of_another_run_are_forgotten_and_the_others_are_not():
    assembly, _ = Assembly.of(2).after({0: JointReading(5, 1.0), 1: JointReading(5, 2.0)})
    assembly, _ = assembly.after({0: JointReading(15, 7.0)})
    _, sample = assembly.without((1,)).after({1: JointReading(10, 9.0)})
    assert (sample.stamp_ns, sample.positions) == (10, (4.0, 9.0))
