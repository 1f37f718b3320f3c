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

"""Commands as messages: written as objects, of which some are sent, and read from bytes."""

import struct
from typing import Any, Mapping, NamedTuple, Optional, Union

from diffdrive_kinematics.core.kinematics import NANOSECONDS
from diffdrive_kinematics.ros.messages.cdr import HEADER, STAMP_AT
from diffdrive_kinematics.ros.messages.messages import header_of, nanoseconds
from geometry_msgs.msg import Twist, TwistStamped
from rclpy.serialization import deserialize_message

DOUBLES = 6
_read_twist = struct.Struct('=d32xd').unpack_from  # linear.x and angular.z
_read_stamp_and_length = struct.Struct('=iII').unpack_from


class StampedTwist(NamedTuple):
    """Speed [m/s] and yaw rate [rad/s] of a command, and its stamp [ns]; 0: it has none."""

    stamp_ns: int
    v: float
    w: float


class TwistCodec:
    """A TwistStamped in a frame, or, without one, a Twist."""

    def __init__(self, frame_id: Optional[str]) -> None:
        self._frame_id = frame_id
        self.message_type = Twist if frame_id is None else TwistStamped

    @classmethod
    def of(cls, values: Mapping[str, Any]) -> 'TwistCodec':
        """Return the codec of the commands of a node, by the values of its parameters."""
        return cls(values['base_frame_id'] if values['enable_stamped_cmd_vel'] else None)

    def encode(self, stamp_ns: int, v: float, w: float) -> Union[Twist, TwistStamped]:
        """Return the message with a stamp, where it has one, and a twist [m/s, rad/s]."""
        twist = Twist()
        twist.linear.x, twist.angular.z = v, w
        if self._frame_id is None:
            return twist
        return TwistStamped(header=header_of(self._frame_id, stamp_ns), twist=twist)

    def decode(self, message: bytes) -> StampedTwist:
        """Return what the message commands, whatever its frame."""
        stamped, stamp_ns = self._frame_id is not None, 0
        if found := _twist_in(message, stamped):
            return found
        read = deserialize_message(message, self.message_type)
        if stamped:
            read, stamp_ns = read.twist, nanoseconds(read.header.stamp)
        return StampedTwist(stamp_ns, read.linear.x, read.angular.z)


def _twist_in(data: bytes, stamped: bool) -> Optional[StampedTwist]:
    """Return what a Twist or TwistStamped commands; None: it is in another form."""
    if data[:STAMP_AT] != HEADER or len(data) < STAMP_AT + 12:
        return None
    stamp_ns, first = 0, STAMP_AT
    if stamped:
        sec, nanosec, length = _read_stamp_and_length(data, STAMP_AT)
        after = STAMP_AT + 12 + length
        stamp_ns, first = sec * NANOSECONDS + nanosec, after + (STAMP_AT - after) % 8
    if len(data) < first + 8 * DOUBLES:
        return None
    return StampedTwist(stamp_ns, *_read_twist(data, first))
