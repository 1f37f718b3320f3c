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

from diffdrive_kinematics.core.joint_assembly import Assembly, JointReading
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
            ahead = position / rate - sample.stamp_ns / MS
            assert ahead >= -1e-6  # where it has spoken twice since, it is ahead, and not counted
    spoken = {joint: max(at for who, at, _ in messages if who == joint) for joint in range(3)}
    assert not samples or stamps[-1] <= min(spoken.values()) * MS


def test_of_joints_that_take_turns_none_is_ahead_of_the_others():
    messages = [(step % 2, 10 * step, 0.1 * step) for step in range(100)]
    samples = assembled(messages)
    assert len(samples) == 50
    for sample in samples[1:]:
        assert sample.positions[0] == pytest.approx(sample.positions[1], abs=1e-9)
        assert sample.positions[0] == pytest.approx(sample.stamp_ns / MS / 100, abs=1e-9)


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
