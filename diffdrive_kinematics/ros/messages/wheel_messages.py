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

"""Wheel motion as JointState: what joints say is read in any form, and written."""

from typing import Any, Callable, Mapping, NamedTuple, Optional, Sequence, Tuple, Union

from diffdrive_kinematics.core.kinematics import NANOSECONDS
from diffdrive_kinematics.core.odometry import (
    ClockStep, Encoder, JointMessage, NO_STEP, WheelPair, WheelSample)
from diffdrive_kinematics.ros.messages.codec import JointStateCodec
from diffdrive_kinematics.ros.messages.messages import check_stamp
from diffdrive_kinematics.ros.messages.plain import JointValues
from diffdrive_kinematics.ros.messages.wheel_gathering import Gathered, Gathering
from diffdrive_kinematics.ros.messages.wheel_joints import wheel_joints, WheelJoints
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64MultiArray

NOBODY = -1
Places = Tuple[int, ...]


class UsualMessage(NamedTuple):
    """How the next message is read, if it is the usual one: ``shape`` unpacks its values."""

    number: int
    source: str
    shape: Any
    rates: Places  # where among the values the left and the right one are
    positions: Places  # empty: there are none, or they do not count
    gear_ratio: float


class WheelReader:
    """
    Reads wheel motion from JointState: joints in any order, several wheels a side.

    A side's rate and position are the means over its wheels, but for those that say nothing or
    contradict the others; of several publishers of the same joints one is believed; messages
    that carry only some of the joints are put together (see ``Gathering``).
    ``header.frame_id``, which has no other meaning in a JointState, tells one run of a publisher
    of this package from another.  Positions that wrap around with the range of the encoders
    [rad of the joint] are followed, each joint by itself; range 0: they do not wrap.
    """

    def __init__(
            self, joints: WheelJoints, *, positions: bool = True,
            encoder_range: float = 0.0) -> None:
        self._joints = joints
        self._with_positions = positions
        self._plain = len(joints.all_names()) == 2 and not encoder_range
        self.gathering = Gathering(joints, encoder_range / joints.gear_ratio)
        self._names: Sequence[str] = ()
        self.partial: Sequence[str] = ()  # the names of the last message with only some of ours
        self._indices: Tuple[int, ...] = ()
        self._ours: Tuple[int, ...] = ()
        self._codec = JointStateCodec()
        self._next, self._tag = NOBODY, ''  # whose message, if one comes, is the usual one
        self._last: Tuple[Sequence[float], Sequence[float], int] = (), (), 0
        self._step = NO_STEP

    @classmethod
    def of(cls, values: Mapping[str, Any]) -> 'WheelReader':
        """Return the reader of a node, by the values of its parameters."""
        return cls(wheel_joints(values), positions=values.get('position_feedback', True),
                   encoder_range=values['encoder_range'])

    def read(
            self, message: Union[JointState, bytes], now_ns: Callable[[], int],
            number: int = 0) -> Optional[WheelSample]:
        """
        Return the wheel sample of a message, serialised or not.

        None: none of our joints is in it, it is one of several that make a sample, or another
        publisher is believed.  A zero stamp means now.  Values that are NaN for all our joints
        count as absent, since joint_state_broadcaster fills in NaN for what a robot does not
        measure.  ``number`` is that of the message among those of its publisher; 0: unknown.

        Raises
        ------
        ValueError
            If lengths do not match, values are not finite, or the stamp is none.

        """
        return self._sample(*self._codec.decode(message), now_ns, number)

    def usual(self, message: bytes) -> Optional[UsualMessage]:
        """Return how to read what is like the message read last; None: that is not all."""
        shape = self._codec.shape_of(message)
        count = len(self._names)
        if self._next <= 0 or shape is None or any(self._joints.inverted) or (
                shape.frame_id, shape.names) != (self._tag, self._names):
            return None
        (first, count_of_rates), (first_position, count_of_positions) = (
            (numbers.start, numbers.stop - numbers.start)
            for numbers in (shape.velocity, shape.position))
        if count_of_rates != count or count_of_positions not in (0, count):
            return None
        with_positions = self._with_positions and count_of_positions
        return UsualMessage(
            self._next, self._tag, shape, tuple(first + index for index in self._indices),
            tuple(first_position + index for index in self._indices) if with_positions else (),
            self._joints.gear_ratio)

    def caught_up(
            self, number: int, positions: Sequence[float], rates: Sequence[float],
            now_ns: int) -> None:
        """Note the last of the usual messages that somebody else has read."""
        self._next, self._last = number + 1, (positions, rates, now_ns)

    def clock_stepped(self, step: ClockStep) -> None:
        """Note that the clock was stepped; messages that were sent before it may still come."""
        self._step = step
        self.gathering.clock_stepped()

    def _sample(
            self, source: str, names: Sequence[str], sec: int, nanosec: int,
            position: Sequence[float], velocity: Sequence[float],
            now_ns: Callable[[], int], number: int) -> Optional[WheelSample]:
        if names != self._names:
            self._find(names)
        indices = self._indices
        if not indices:
            return None
        check_stamp(sec, nanosec)
        rates = self._values('velocity', velocity, indices)
        positions = None
        if self._with_positions:
            positions = self._values('position', position, indices)
        arrived_ns = now_ns()
        stamp_ns = self._step.read(sec * NANOSECONDS + nanosec, arrived_ns) or arrived_ns
        if number == self._next and source == self._tag:
            self._last = positions or (), rates or (), arrived_ns
            if number:
                self._next = number + 1
        else:
            gathered = self._gathered(
                JointMessage(source, self._ours, number, arrived_ns, positions or (), rates or ()),
                stamp_ns)
            if gathered is None:
                return None
            stamp_ns, positions, rates, source = gathered
        if rates is not None:
            rates = self._joints.signed(rates)
        if positions is not None:
            positions = self._joints.signed(positions)
            if rates is not None:
                rates = None if _is_nan(*rates) else rates
                positions = None if rates and _is_nan(*positions) else positions
        return WheelSample(stamp_ns, rates, positions, source)

    def _find(self, names: Sequence[str]) -> None:
        """Note which of our joints are among the names, and where."""
        wanted = self._joints.all_names()
        self._ours = tuple(number for number, name in enumerate(wanted) if name in names)
        self._indices = tuple(names.index(wanted[number]) for number in self._ours)
        self._names = names
        if 0 < len(self._ours) < len(wanted):
            self.partial = names
        self._be_careful()

    def _gathered(self, received: JointMessage, stamp_ns: int) -> Optional[Gathered]:
        """Return what is known after a message that may not be the usual one."""
        self._be_careful()
        gathered = self.gathering.after(received, stamp_ns)
        if gathered and self._plain and len(received.joints) == 2 and self.gathering.usual():
            self._next, self._tag = received.number and received.number + 1, received.tag
            self._last = received.positions, received.rates, received.now_ns
        return gathered

    def _be_careful(self) -> None:
        """Take no message for the usual one, and catch up on those that were."""
        if self._next != NOBODY:
            positions, rates, now_ns = self._last
            self.gathering.caught_up(JointMessage(
                self._tag, (0, 1), max(0, self._next - 1), now_ns, positions, rates))
            self._next = NOBODY

    def _values(
            self, field: str, values: Sequence[float],
            indices: Tuple[int, ...]) -> Optional[Tuple[float, ...]]:
        """Return what our joints say of the wheels, in their order; zero has no sign."""
        if not values:
            return None
        if len(values) != len(self._names):
            raise ValueError(
                f'{field} has {len(values)} values, expected {len(self._names)}, one for '
                'each name')
        gear = self._joints.gear_ratio
        if len(indices) == 2:
            left, right = indices
            return 0.0 + values[left] / gear, 0.0 + values[right] / gear
        return tuple(values[index] / gear for index in indices)


def _is_nan(left: float, right: float) -> bool:
    return left != left and right != right


class WheelWriter:
    """
    Writes wheel motion as JointState for all wheels.

    ``source`` tells this run of this publisher from any other, so that positions that begin to
    count anew are not taken for motion (see ``WheelReader``).  ``encoder`` reads the positions.
    ``encode_two`` makes the message of a stamp, and of positions and rates of two joints; None:
    there are others, some are inverted, or an encoder reads them.
    """

    def __init__(
            self, joints: WheelJoints, source: str = '', encoder: Encoder = Encoder()) -> None:
        self._joints, self._encoder, self._source = joints, encoder, source
        self._reads = bool(encoder.period or encoder.resolution)
        self._names, self._codec = joints.all_names(), JointStateCodec()
        usual = len(self._names) == 2 and not any(joints.inverted) and not self._reads
        self.encode_two = self._codec.encoder_of_two(source, self._names) if usual else None

    def encode(
            self, stamp_ns: int, rates: Optional[WheelPair], positions: Optional[WheelPair]
    ) -> Union[bytes, JointState]:
        """Return the message with a stamp, rates [rad/s] and positions [rad]; None: absent."""
        joints, angles = self._joints, None
        if self.encode_two and positions and rates:  # as nearly always
            gear = joints.gear_ratio
            return self.encode_two(stamp_ns, gear * positions[0], gear * positions[1],
                                   gear * rates[0], gear * rates[1])
        if positions is not None:
            angles = joints.motion(positions)
            if self._reads:
                angles = self._encoder.reading(angles[0]), self._encoder.reading(angles[1])
        return self._codec.encode(JointValues(
            self._source, self._names, stamp_ns // NANOSECONDS, stamp_ns % NANOSECONDS,
            () if angles is None else joints.spread(angles),
            () if rates is None else joints.spread(joints.motion(rates))))


def set_points(joints: WheelJoints, rates: WheelPair) -> Float64MultiArray:
    """Return wheel rates [rad/s] as those of the joints, left wheels then right wheels."""
    return Float64MultiArray(data=joints.spread(joints.motion(rates)))
