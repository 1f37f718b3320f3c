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

"""Both codecs, compared with messages that are filled in by hand and with each other."""

from contextlib import contextmanager
import itertools
import math
import struct

from diffdrive_kinematics.core.kinematics import Pose
from diffdrive_kinematics.core.odometry import BaseState, Encoder
from diffdrive_kinematics.nodes import simulated_base
from diffdrive_kinematics.ros.messages import codec, plain, serialised, wheel_messages
from diffdrive_kinematics.ros.messages.cdr import Layout
from diffdrive_kinematics.ros.messages.messages import quaternion_of, set_stamp
from diffdrive_kinematics.ros.messages.plain import JointValues, StampedTwist
from diffdrive_kinematics.ros.messages.wheel_joints import WheelJoints
from diffdrive_kinematics.ros.messages.wheel_messages import set_points, WheelReader, WheelWriter
from diffdrive_kinematics.ros.publishers import odometry as odometry_publisher
from geometry_msgs.msg import TransformStamped, Twist, TwistStamped
from hypothesis import given, settings, strategies as st
from nav_msgs.msg import Odometry
import pytest
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.serialization import deserialize_message, serialize_message
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64MultiArray
from support.inside import inside

NAMES = st.text(st.characters(codec='utf-8', exclude_characters='\0'), max_size=12)
JOINTS = st.lists(NAMES, min_size=2, max_size=7, unique=True)
NUMBERS = st.floats(-1e12, 1e12)
PAIRS = st.tuples(NUMBERS, NUMBERS)
STAMPS = st.integers(0, (2**31 - 1) * 10**9 - 1)
POSES = st.builds(Pose, NUMBERS, NUMBERS, st.floats(-math.pi, math.pi))
ANY_NUMBERS = NUMBERS | st.floats(width=64)

both = pytest.mark.parametrize(
    'codec', [plain, serialised], ids=['plain', 'serialised'])


def significant(layout, data):
    """Return all bytes that mean something: padding is what ``struct`` skips."""
    return struct.unpack_from(layout.format, data)


def assert_same_bytes(layout, ours, message):
    """Compare every byte but those that only align; those rclpy leaves as they were."""
    theirs = bytes(serialize_message(message))
    if not isinstance(ours, bytes):
        assert ours == message
        ours = bytes(serialize_message(ours))[:layout.size]
    assert layout.size == len(ours) <= len(theirs)
    assert [struct.pack('=d', value) if isinstance(value, float) else value
            for value in significant(layout, ours)] == [
        struct.pack('=d', value) if isinstance(value, float) else value
        for value in significant(layout, theirs)]
    assert deserialize_message(ours, type(message)) == message


def joint_state_layout(message):
    layout = Layout()
    layout.header(message.header.frame_id)
    layout.numbers('I', [len(message.name)])
    for name in message.name:
        layout.text(name)
    for numbers in (message.position, message.velocity, message.effort):
        layout.sequence('d', numbers)
    return layout


@both
@settings(max_examples=300)
@given(frame=NAMES, child=NAMES, stamp=STAMPS, pose=POSES, twist=PAIRS, covariance=st.tuples(
    *[NUMBERS] * 6), twist_covariance=st.tuples(*[NUMBERS] * 3), floor=NUMBERS)
def test_odometry(codec, frame, child, stamp, pose, twist, covariance, twist_covariance, floor):
    message = Odometry(child_frame_id=child)
    message.header.frame_id = frame
    set_stamp(message.header.stamp, stamp)
    position, orientation = message.pose.pose.position, message.pose.pose.orientation
    position.x, position.y = pose.x, pose.y
    orientation.z, orientation.w = quaternion_of(pose.theta)
    message.twist.twist.linear.x, message.twist.twist.angular.z = twist
    pose_matrix = message.pose.covariance.reshape(6, 6)
    pose_matrix[[2, 3, 4], [2, 3, 4]] = [3.0, 4.0, 5.0]
    xx, xy, xt, yy, yt, tt = covariance
    for (row, column), value in {
            (0, 0): xx + floor, (0, 1): xy, (0, 5): xt, (1, 1): yy + floor, (1, 5): yt,
            (5, 5): tt + floor}.items():
        pose_matrix[row, column] = pose_matrix[column, row] = value
    twist_matrix = message.twist.covariance.reshape(6, 6)
    twist_matrix[[1, 2, 3, 4], [1, 2, 3, 4]] = [8.0, 9.0, 10.0, 11.0]
    vv, vw, ww = twist_covariance
    for (row, column), value in {(0, 0): vv, (0, 5): vw, (5, 5): ww}.items():
        twist_matrix[row, column] = twist_matrix[column, row] = value
    ours = codec.OdometryCodec(frame, child)
    ours.set_diagonals([1.0, 2.0, 3.0, 4.0, 5.0, 6.0], [7.0, 8.0, 9.0, 10.0, 11.0, 12.0])
    ours.set_pose_covariance(covariance, floor)
    ours.set_twist_covariance(twist_covariance)
    layout = Layout()
    layout.header(frame)
    layout.text(child)
    layout.numbers('d', [0.0] * 85)
    state = BaseState(pose, twist, (0.0, 0.0), (0.0, 0.0))
    assert_same_bytes(layout, ours.encode(stamp, state), message)
    ours.set_diagonals([0.0] * 6, [0.0] * 6)
    message.pose.covariance[:] = message.twist.covariance[:] = 0.0
    assert_same_bytes(layout, ours.encode(stamp, state), message)


@both
@settings(max_examples=300)
@given(source=NAMES, names=JOINTS, split=st.integers(1, 6), inverted=st.tuples(
    st.booleans(), st.booleans()), samples=st.lists(st.tuples(
        STAMPS, st.none() | PAIRS, st.none() | PAIRS), min_size=1, max_size=4))
def test_joint_states(codec, source, names, split, inverted, samples):
    split = min(split, len(names) - 1)
    joints = WheelJoints((tuple(names[:split]), tuple(names[split:])), inverted)
    with using(codec):
        ours = WheelWriter(joints, source)
    for stamp, rates, positions in samples:
        message = JointState(
            name=names, velocity=[] if rates is None else joints.spread(joints.signed(rates)),
            position=[] if positions is None else joints.spread(joints.signed(positions)))
        message.header.frame_id = source
        set_stamp(message.header.stamp, stamp)
        assert_same_bytes(
            joint_state_layout(message), ours.encode(stamp, rates, positions), message)


@contextmanager
def using(codec):
    """Have wheels written and read by a codec."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(wheel_messages, 'JointStateCodec', codec.JointStateCodec)
        yield


@both
@given(values=st.builds(
    JointValues, NAMES, st.lists(NAMES, max_size=5).map(tuple), st.integers(0, 2**31 - 1),
    st.integers(0, 10**9 - 1), *[st.lists(ANY_NUMBERS, max_size=5).map(tuple)] * 2))
def test_joint_values_are_read_as_they_were_written(codec, values):
    """Whatever their lengths, NaN included; read twice, since the first one makes a shape."""
    ours, theirs = codec.JointStateCodec(), plain.JointStateCodec()
    message = ours.encode(values)
    for reader in (ours, ours, theirs):
        read = reader.decode(message)
        assert repr(read._replace(
            position=tuple(read.position), velocity=tuple(read.velocity))) == repr(values)


@given(names=JOINTS, rates=PAIRS, inverted=st.tuples(st.booleans(), st.booleans()))
def test_wheel_commands(names, rates, inverted):
    joints = WheelJoints(((names[0],), tuple(names[1:])), inverted)
    message = Float64MultiArray(data=joints.spread(joints.signed(rates)))
    layout = Layout()
    layout.sequence('I', [])
    layout.numbers('I', [0])
    layout.sequence('d', message.data)
    assert_same_bytes(layout, set_points(joints, rates), message)


@both
@given(frame=st.none() | NAMES, stamp=STAMPS, twist=PAIRS)
def test_twists(codec, frame, stamp, twist):
    message = unstamped = Twist()
    unstamped.linear.x, unstamped.angular.z = twist
    layout = Layout()
    if frame is not None:
        layout.header(frame)
        message = TwistStamped(twist=unstamped)
        message.header.frame_id = frame
        set_stamp(message.header.stamp, stamp)
    layout.numbers('d', [0.0] * 6)
    ours = codec.TwistCodec(frame).encode(stamp, *twist)
    assert_same_bytes(layout, ours, message)
    value = StampedTwist(0 if frame is None else stamp, *twist)
    reader = codec.TwistCodec(frame and '')  # whatever the frame of the message
    assert reader.decode(bytes(serialize_message(message))) == value
    assert plain.TwistCodec(frame and '').decode(ours) == value


@given(frame=NAMES, child=NAMES, stamp=STAMPS, pose=POSES)
def test_a_transform(frame, child, stamp, pose):
    message = TransformStamped(child_frame_id=child)
    message.header.frame_id = frame
    set_stamp(message.header.stamp, stamp)
    message.transform.translation.x, message.transform.translation.y = pose.x, pose.y
    message.transform.rotation.z, message.transform.rotation.w = quaternion_of(pose.theta)
    assert plain.TransformCodec(frame, child).transform(stamp, pose) == message
    ours = serialised.TransformCodec(frame, child).encode(stamp, pose)
    assert ours[:8] == bytes(serialize_message(message))[:4] + struct.pack('=I', 1)
    # a TFMessage is a count and the transforms; tf2_msgs may be missing here
    layout, whole = Layout(), Layout()
    for each in (layout, whole):
        if each is whole:
            each.numbers('I', [1])
        each.header(frame)
        each.text(child)
        each.numbers('d', [0.0] * 7)
    theirs = significant(layout, bytes(serialize_message(message)))
    assert significant(whole, ours) == (theirs[0], 1, *theirs[1:])


@given(frame=NAMES, child=NAMES, stamp=STAMPS, pose=POSES)
def test_transforms_are_the_same_where_tf2_msgs_is_there(frame, child, stamp, pose):
    tf2 = pytest.importorskip('tf2_msgs.msg')
    message = plain.TransformCodec(frame, child).encode(stamp, pose)
    assert deserialize_message(
        serialised.TransformCodec(frame, child).encode(stamp, pose), tf2.TFMessage) == message


@given(st.data())
def test_wheels_are_read_alike(data):
    """Whatever comes, and whatever came before: by the object, or by a shape that is known."""
    joints = WheelJoints((('a', 'b'), ('c',)), data.draw(st.tuples(st.booleans(), st.booleans())))
    period = data.draw(st.sampled_from([0.0, 4.0]))
    readers = []
    for each in (plain, serialised):
        with using(each):
            readers.append(WheelReader(joints, encoder_range=period))
    shapes = [JointState(
        name=data.draw(st.sampled_from([
            ['a', 'b', 'c'], ['c', 'x', 'b', 'a'], ['x', 'y', 'z'], ['a', 'b', 'd'], []])))
        for _ in range(2)]
    for _ in range(data.draw(st.integers(1, 6))):
        message = data.draw(st.sampled_from(shapes))
        set_stamp(message.header.stamp, data.draw(STAMPS))
        message.header.frame_id = data.draw(st.sampled_from(['', 'p', 'qr']))
        for field in ('position', 'velocity', 'effort'):
            length = data.draw(st.sampled_from([0, len(message.name), 2]))
            setattr(message, field, data.draw(
                st.lists(ANY_NUMBERS, min_size=length, max_size=length)))
        outcomes = []
        for reader in readers:
            try:
                outcomes.append(repr(reader.read(bytes(serialize_message(message)), lambda: 77)))
            except ValueError as error:
                outcomes.append(str(error))
        assert outcomes[0] == outcomes[1]


def test_a_known_shape_is_read_without_an_object(monkeypatch):
    """Else all of the above would pass by the slow way alone."""
    joints = WheelJoints((('left',), ('right',)))
    reader, messages = WheelReader(joints), WheelWriter(joints, 'me')
    first = reader.read(messages.encode(1, (1.0, 2.0), (3.0, 4.0)), int)
    monkeypatch.setattr(
        'diffdrive_kinematics.ros.messages.serialised_joints.deserialize_message', pytest.fail)
    second = reader.read(messages.encode(2, (5.0, 6.0), (7.0, 8.0)), int)
    assert (first.rates, first.positions) == ((1.0, 2.0), (3.0, 4.0))
    assert (second.stamp_ns, second.rates, second.positions, second.source) == (
        2, (5.0, 6.0), (7.0, 8.0), 'me')


def test_publishers_whose_messages_are_of_one_length_are_told_apart():
    reader = WheelReader(WheelJoints((('l',), ('r',))))
    now_ns = itertools.count(0, 10**10).__next__  # the one before has been silent for long
    for _ in range(2):
        for source, names, velocity in (
                ('a', ['l', 'r'], [1.0, 2.0]), ('b', ['l', 'r'], [3.0, 4.0]),
                ('a', ['r', 'l'], [6.0, 5.0]), ('a', ['x', 'y'], [8.0, 9.0])):
            message = JointState(name=names, velocity=velocity)
            message.header.stamp.sec, message.header.frame_id = 1, source
            sample = reader.read(bytes(serialize_message(message)), now_ns)
            if names == ['x', 'y']:
                assert sample is None
            else:
                assert (sample.source, sample.rates) == (source, tuple(sorted(velocity)))


def test_bytes_of_another_order_are_read_as_they_say():
    """Big-endian CDR, as some machine on the network may send it."""
    big = b'\0\0\0\0' + struct.pack('>6d', 1.0, 0.0, 0.0, 0.0, 0.0, 2.0)
    for each in (plain, serialised):
        assert each.TwistCodec(None).decode(big) == (0, 1.0, 2.0)
    message = JointState(name=['left', 'right'], velocity=[3.0, 4.0])
    message.header.stamp.sec = 1
    layout = joint_state_layout(message)
    layout.values[1] = message.header.stamp.sec
    big = struct.pack('>' + layout.format[1:], b'\0\0\0\0', *layout.values[1:])
    reader = WheelReader(WheelJoints((('left',), ('right',))))
    little = reader.read(struct.pack(layout.format, *layout.values), int)
    assert reader.read(big, int) == little
    assert (little.stamp_ns, little.rates) == (10**9, (3.0, 4.0))


@both
@pytest.mark.parametrize('data', [
    b'', b'\0\1\0\0', b'\0\1\0\0' + bytes(20), b'\0\1\0\0' + b'\xff' * 40])
def test_bytes_that_are_no_message_are_refused(codec, data):
    for read in (lambda: codec.TwistCodec('').decode(data),
                 lambda: codec.TwistCodec(None).decode(data[:20]),
                 lambda: codec.JointStateCodec().decode(data)):
        with pytest.raises((ValueError, rclpy_implementation.RMWError)):
            read()


def test_encoders_are_read_where_there_are_some():
    joints = WheelJoints((('left',), ('right',)))
    message = deserialize_message(WheelWriter(joints, '', Encoder(period=4.0)).encode(
        0, (0.0, 0.0), (5.0, -5.0)), JointState)
    assert list(message.position) == [1.0, -1.0]


def test_each_name_is_one_of_both_codecs():
    """What is decided in one place can be decided otherwise."""
    for name in ('JointStateCodec', 'OdometryCodec', 'TransformCodec', 'TwistCodec'):
        assert getattr(codec, name) in (getattr(plain, name), getattr(serialised, name))
    assert codec.CommandReader in (plain.TwistCodec, serialised.TwistCodec)


@both
def test_a_base_says_the_same_with_either_codec(codec, monkeypatch):
    """One is a drop-in for the other in a running node."""
    monkeypatch.setattr(odometry_publisher, 'OdometryCodec', codec.OdometryCodec)
    parameters = {
        'wheel_radius': 0.033, 'wheel_separation': 0.16, 'enable_odom_tf': False,
        'left_slip_variance': 1e-6, 'right_slip_variance': 2e-6}
    with using(codec), inside(simulated_base.SimulatedBase, parameters) as base:
        for number in range(5):
            message = JointState(
                name=['left_wheel_joint', 'right_wheel_joint'], velocity=[3.0, 4.0])
            set_stamp(message.header.stamp, base.node.runtime.now_ns())
            base.hear('/wheel_rates', message)
            base.advance_to(base.node.runtime.now_ns() + 20_000_000)
        said = base.said['/odom'], base.said['/joint_states']
    assert [len(each) for each in said] == [5, 5]
    odometry = said[0][-1]
    assert (odometry.header.frame_id, odometry.child_frame_id) == ('odom', 'base_link')
    assert odometry.twist.twist.linear.x == pytest.approx(3.5 * 0.033, rel=1e-12)
    assert odometry.pose.pose.position.x > 0.0 < odometry.pose.covariance[0]
    assert list(said[1][-1].velocity) == [3.0, 4.0]
