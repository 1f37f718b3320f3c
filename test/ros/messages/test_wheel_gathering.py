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

"""What wheels say becomes the motion of two sides."""

import math

from diffdrive_kinematics.core.odometry import JointMessage
from diffdrive_kinematics.ros.messages.wheel_gathering import Gathering
from diffdrive_kinematics.ros.messages.wheel_joints import WheelJoints
from diffdrive_kinematics.ros.messages.wheel_messages import WheelReader, WheelWriter
from hypothesis import given, strategies as st
import pytest

MS = 10**6
TWO = WheelJoints((('l',), ('r',)))
FOUR = WheelJoints((('a', 'b'), ('c', 'd')))


def test_wheels_whose_rates_are_missing_for_a_while_do_not_disagree():
    gathering = Gathering(FOUR, 0.0)
    for step in range(400):
        rates = (math.nan if step % 20 < 10 else 1.0, 1.0, 1.0, 1.0)
        gathering.after(JointMessage('', (0, 1, 2, 3), 1 + step, 20 * MS * step, rates=rates),
                        20 * MS * step)
        assert not gathering.disagreements()


@pytest.mark.parametrize('down', [5, 15, 24, 40])
def test_what_a_restarted_driver_tells_before_it_is_believed_is_not_lost(down):
    """It counts from 0; what was driven while nothing was told is all that is lost."""
    gathering, gathered = Gathering(TWO, 0.0), []
    for step in range(400):
        if 100 <= step < 100 + down:
            continue
        since = step if step < 100 else step - 100 - down
        received = JointMessage('', (0, 1), 1 + since, 20 * MS * step, (0.1 * since,) * 2)
        gathered.append(gathering.after(received, received.now_ns))
    way = gathered[-1].positions[0] - gathered[0].positions[0]
    assert way == pytest.approx(0.1 * (399 - 1 - down), abs=1e-9)
    assert not gathering.sources.contested(received.now_ns)


def test_what_the_publisher_told_that_takes_the_place_of_a_rival_is_not_counted_twice():
    gathering, gathered = Gathering(TWO, 0.0), []
    for step in range(400):
        told = [JointMessage(
            '', (0, 1), 5001 + step, 20 * MS * step + 9 * MS, (0.1 * step + 3.0,) * 2)]
        if step < 100:
            told.insert(0, JointMessage('', (0, 1), 1 + step, 20 * MS * step, (0.1 * step,) * 2))
        gathered += filter(None, [gathering.after(received, received.now_ns) for received in told])
    assert gathered[99].positions == pytest.approx((9.9, 9.9))
    assert 9.9 <= gathered[100].positions[0] < 10.5


@given(
    st.lists(st.tuples(st.sampled_from([1, 1, 9]), st.booleans(), st.booleans()), min_size=3),
    st.booleans())
def test_lost_messages_cost_no_way_wherever_positions_begin(steps, numbered):
    """A reader that takes the usual message as it is says what one says that is always careful."""
    quick, careful = WheelReader(TWO), WheelReader(TWO)
    careful._plain = False
    number = 0
    for ahead, measured, turning in steps:
        number += ahead
        positions = (0.02 * number, 0.04 * number) if measured else None
        told = WheelWriter(TWO).encode(
            20 * MS * number, (1.0 * turning, 2.0 * turning), positions)
        samples = [reader.read(told, lambda: 20 * MS * number, number if numbered else 0)
                   for reader in (quick, careful)]
        assert samples[0] == samples[1]
        assert samples[0].positions == positions


@pytest.mark.parametrize('apart_ms', [0, 200, 50_000])
def test_by_how_much_stamps_of_joints_are_apart_is_told_whatever_the_period(apart_ms):
    """One that comes half a period after the other has the same clock."""
    gathering = Gathering(TWO, 0.0)
    assert gathering.delays() is None
    for step in range(5):
        at_ns = 1000 * MS * step
        gathering.after(JointMessage('', (0,), 1 + step, at_ns, (0.0,)), at_ns - 5 * MS)
        gathering.after(
            JointMessage('', (1,), 1 + step, at_ns + 500 * MS, (0.0,)),
            at_ns + (495 - apart_ms) * MS)
    assert gathering.delays() == {'l': 5 * MS, 'r': (5 + apart_ms) * MS}
    assert gathering.delays() is None
