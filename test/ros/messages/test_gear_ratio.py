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

"""Joints that are those of motors: what messages say is on the motor's side of the gear."""

import math

from diffdrive_kinematics.core.kinematics import WheelGeometry
from diffdrive_kinematics.core.odometry import Encoder
from diffdrive_kinematics.ros.messages.plain import JointStateCodec, JointValues
from diffdrive_kinematics.ros.messages.urdf import Shape, urdf_of
from diffdrive_kinematics.ros.messages.wheel_joints import wheel_joints, WheelJoints
from diffdrive_kinematics.ros.messages.wheel_messages import set_points, WheelReader, WheelWriter
from diffdrive_kinematics.ros.parameters.tables import TABLES
from hypothesis import given, strategies as st
import pytest
from rclpy.serialization import deserialize_message
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64MultiArray

NUMBERS = st.floats(-1e9, 1e9)
PAIRS = st.tuples(NUMBERS, NUMBERS)
SIGNS = st.tuples(st.booleans(), st.booleans())
GEARS = st.floats(1e-2, 1e4)
SIDES = (('l',), ('r',))
FOUR = (('fl', 'rl'), ('fr', 'rr'))


def joints_of(gear, inverted=(False, False), names=SIDES):
    return WheelJoints(names, inverted, gear)


def said(message, message_type=JointState):
    return deserialize_message(message, message_type) if isinstance(message, bytes) else message


def message_of(names, position, velocity=(), stamp=1):
    return JointStateCodec().encode(JointValues('', names, stamp, 0, position, velocity))


def read(reader, message):
    from rclpy.serialization import serialize_message
    return reader.read(bytes(serialize_message(message)), int)


@given(gear=GEARS, inverted=SIGNS, rates=PAIRS, angles=PAIRS)
def test_messages_have_the_motion_of_motors(gear, inverted, rates, angles):
    message = said(WheelWriter(joints_of(gear, inverted)).encode(1, rates, angles))
    signs = [-gear if side else gear for side in inverted]
    assert list(message.velocity) == pytest.approx(
        [sign * rate for sign, rate in zip(signs, rates)], rel=1e-15)
    assert list(message.position) == pytest.approx(
        [sign * angle for sign, angle in zip(signs, angles)], rel=1e-15)
    array = said(set_points(joints_of(gear, inverted), rates), Float64MultiArray)
    assert list(array.data) == list(message.velocity)


@given(gear=GEARS, inverted=SIGNS, rates=PAIRS, angles=PAIRS)
def test_what_was_written_is_read_as_it_was(gear, inverted, rates, angles):
    joints = joints_of(gear, inverted, FOUR)
    sample = WheelReader(joints).read(WheelWriter(joints).encode(1, rates, angles), int)
    assert sample.rates == pytest.approx(rates, rel=1e-14, abs=1e-300)
    assert sample.positions == pytest.approx(angles, rel=1e-14, abs=1e-300)


@given(inverted=SIGNS, rates=PAIRS, angles=PAIRS)
def test_a_gear_of_one_changes_no_bit(inverted, rates, angles):
    plain, geared = WheelJoints(SIDES, inverted), joints_of(1.0, inverted)
    assert WheelWriter(plain).encode(1, rates, angles) == WheelWriter(geared).encode(
        1, rates, angles)
    sample = WheelReader(geared).read(WheelWriter(geared).encode(1, rates, angles), int)
    assert (sample.rates, sample.positions) == (rates, angles)


@pytest.mark.parametrize('names', [SIDES, FOUR], ids=['two', 'four'])
def test_the_range_of_encoders_is_that_of_the_motor(names):
    """2.5 turns of the motor a message, of a range of 6: three wraps, a tenth of it the wheel."""
    reader = WheelReader(joints_of(10.0, names=names), encoder_range=6.0)
    writer = WheelWriter(joints_of(10.0, names=names), '', Encoder(period=6.0))
    for number in range(20):
        angle = 0.25 * number
        message = writer.encode(1 + number, None, (angle, -angle))
        assert all(-3.0 <= position < 3.0 for position in said(message).position)
        sample = reader.read(message, int)
        assert sample.positions == pytest.approx((angle, -angle), abs=1e-12)


def test_ticks_are_those_of_the_motor():
    writer = WheelWriter(joints_of(10.0), '', Encoder(resolution=4.0))
    position = said(writer.encode(1, None, (math.radians(10.0), math.radians(-8.0)))).position
    assert list(position) == pytest.approx([math.radians(90.0), math.radians(-90.0)])


def test_wheels_of_a_side_are_compared_by_what_the_wheels_have_gone():
    """Half a turn of a motor with a gear of 100 is no distance: backlash is no broken encoder."""
    reader = WheelReader(joints_of(100.0, names=FOUR))
    for turned in (0.0, 1.0, 2.0, 3.0):
        read(reader, message_of(('fl', 'rl', 'fr', 'rr'), (turned, 0.0, turned, turned)))
    assert reader.gathering.disagreements() == []
    for turned in range(10, 300, 10):
        position = [float(turned), 0.0, float(turned), float(turned)]
        read(reader, message_of(('fl', 'rl', 'fr', 'rr'), position))
    assert 'rl' in reader.gathering.disagreements()[0]


def test_a_wheel_of_the_description_turns_with_its_motor_by_the_gear():
    """Viewers turn the joint of the message, and the wheel follows it."""
    from xml.etree import ElementTree
    root = ElementTree.fromstring(urdf_of(
        WheelGeometry(0.4, 0.1), joints_of(20.0, (False, True)), name='robot', base='base_link',
        shape=Shape(0.0, 0.05)))
    joints = {joint.get('name'): joint for joint in root.findall('joint')}
    assert set(joints) == {'l', 'r', 'l_wheel', 'r_wheel'}
    drawn = {link.get('name') for link in root.findall('link') if link.find('visual') is not None}
    for motor, side in (('l', 1.0), ('r', -1.0)):
        wheel = joints[f'{motor}_wheel']
        mimic = wheel.find('mimic')
        assert (mimic.get('joint'), float(mimic.get('multiplier'))) == (motor, 1.0 / 20.0)
        assert wheel.find('axis').get('xyz') == joints[motor].find('axis').get('xyz')
        assert wheel.find('origin').get('xyz') == joints[motor].find('origin').get('xyz')
        assert joints[motor].find('child').get('link') not in drawn
        assert wheel.find('child').get('link') in drawn


@pytest.mark.parametrize('node', [
    kind for kind, table in TABLES.items()
    if 'left_wheel_names' in {entry.name for entry in table}])
def test_each_node_that_knows_joints_knows_their_gear(node):
    table = {entry.name: entry for entry in TABLES[node]}
    assert len(table) > 6 and table['gear_ratio'].default == 1.0
    values = {name: entry.default for name, entry in table.items()}
    assert wheel_joints({**values, 'gear_ratio': 7.5}).gear_ratio == 7.5
    for bad in (0.0, -1.0, math.inf, math.nan, 1e-9, 1e9):
        with pytest.raises(ValueError, match='gear_ratio is .*expected'):
            table['gear_ratio'].check('gear_ratio', bad)
    with pytest.raises(ValueError, match='left_wheel_inverted'):
        table['gear_ratio'].check('gear_ratio', -30.0)
