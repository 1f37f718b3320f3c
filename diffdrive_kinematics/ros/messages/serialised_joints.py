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

"""The codec of bytes for JointState; see :mod:`.serialised`."""

from operator import itemgetter
import struct
from typing import Any, Callable, Dict, Optional, Sequence, Tuple

from diffdrive_kinematics.core.kinematics import NANOSECONDS
from diffdrive_kinematics.ros.messages import plain
from diffdrive_kinematics.ros.messages.cdr import Layout, STAMP_AT, Template, write_stamp
from diffdrive_kinematics.ros.messages.plain import JointValues
from rclpy.serialization import deserialize_message
from sensor_msgs.msg import JointState

EncoderOfTwo = Callable[[int, float, float, float, float], bytes]
MOST_SHAPES = 16
AFTER_STAMP = 3  # values: those of the header of four bytes, of sec and of nanosec
_write_pair = struct.Struct('=2d').pack_into


class JointStateCodec(plain.JointStateCodec):
    """A JointState without efforts."""

    def __init__(self) -> None:
        self._written: Dict[Tuple[str, Sequence[str], int, int], _JointStateTemplate] = {}
        self._read: Dict[int, JointStateShape] = {}

    def encode(self, values: JointValues) -> bytes:
        """Return the message."""
        frame_id, names, sec, nanosec, position, velocity = values
        shape = frame_id, names, len(position), len(velocity)
        template = self._written.get(shape)
        if template is None:
            template = _keep(self._written, shape, _JointStateTemplate(*shape))
        template.stamp(sec * NANOSECONDS + nanosec)
        for numbers, given in ((template.position, position), (template.velocity, velocity)):
            for index, value in enumerate(given):
                numbers[index] = value
        return template.message()

    def encoder_of_two(self, frame_id: str, names: Sequence[str]) -> EncoderOfTwo:
        """Return what makes the message of a stamp, and of positions and velocities of two."""
        template = _JointStateTemplate(frame_id, names, 2, 2)
        data, position_at, velocity_at = template.data, *template.at

        def encode(stamp_ns: int, left: float, right: float, left_rate: float,
                   right_rate: float) -> bytes:
            write_stamp(data, STAMP_AT, *divmod(stamp_ns, NANOSECONDS))
            _write_pair(data, position_at, left, right)
            _write_pair(data, velocity_at, left_rate, right_rate)
            return bytes(data)

        return encode

    def decode(self, message: bytes) -> JointValues:
        """Return what the message says of all its joints, whatever their lengths."""
        shape = self._read.get(len(message))
        found = shape.values(message) if shape else None
        if found:
            return found
        known = deserialize_message(message, JointState)
        _keep(self._read, len(message), JointStateShape(known))  # the next one will be like it
        return super().decode(known)

    def shape_of(self, message: bytes) -> 'Optional[JointStateShape]':
        """Return what reads messages like the last one of that length; None: none was read."""
        return self._read.get(len(message))


def _keep(shapes: Dict[Any, Any], key: Any, shape: Any) -> Any:
    """Remember a shape and return it; of many the old ones are forgotten."""
    if len(shapes) >= MOST_SHAPES:
        shapes.clear()
    shapes[key] = shape
    return shape


def _joint_names(frame_id: str, names: Sequence[str]) -> Layout:
    """Return the layout of a JointState up to its positions."""
    layout = Layout()
    layout.header(frame_id)
    layout.numbers('I', [len(names)])
    for name in names:
        layout.text(name)
    return layout


class _JointStateTemplate(Template):
    """The bytes of a JointState with so many positions and velocities."""

    def __init__(
            self, frame_id: str, names: Sequence[str], positions: int, velocities: int) -> None:
        layout = _joint_names(frame_id, names)
        self.at = [layout.sequence('d', [0.0] * count) for count in (positions, velocities)]
        layout.sequence('d', [])  # efforts
        super().__init__(layout)
        self.position = self.doubles(self.at[0], positions)
        self.velocity = self.doubles(self.at[1], velocities)


class JointStateShape:
    """
    Reads messages that differ only in their stamp and numbers from the one it is made of.

    Of ``unpack(data)``, values 1 and 2 are the stamp, ``position`` and ``velocity`` those of the
    joints; ``texts(values)`` has to be ``known``.
    """

    def __init__(self, message: JointState) -> None:
        self.frame_id, self.names = message.header.frame_id, tuple(message.name)
        layout = _joint_names(self.frame_id, self.names)
        fixed = [*range(AFTER_STAMP, len(layout.values))]
        self.position, self.velocity, effort = (
            self._sequence(layout, numbers)
            for numbers in (message.position, message.velocity, message.effort))
        fixed += [each.start - 1 for each in (self.position, self.velocity, effort)]
        self.texts = itemgetter(*fixed)
        self.known = self.texts(layout.values)
        self.unpack = struct.Struct(layout.format).unpack_from
        self.size = layout.size

    @staticmethod
    def _sequence(layout: Layout, numbers: Sequence[float]) -> slice:
        """Append a sequence of doubles; return which of the values they are."""
        layout.sequence('d', numbers)
        return slice(len(layout.values) - len(numbers), len(layout.values))

    def values(self, data: bytes) -> Optional[JointValues]:
        """Return what a serialised message says; None: it is of another shape."""
        if len(data) < self.size:
            return None
        fields = self.unpack(data)
        if self.texts(fields) != self.known:
            return None
        return JointValues(self.frame_id, self.names, fields[1], fields[2],
                           fields[self.position], fields[self.velocity])
