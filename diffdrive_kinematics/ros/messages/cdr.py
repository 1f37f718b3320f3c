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

"""
Where the fields of a message stand in its serialised form.

To make, fill and serialise a message object costs a Python node more than its arithmetic.  So
what is sent often is kept as bytes whose changing numbers are overwritten in place, and what is
heard often is read by one ``struct`` that is made once for each shape of message.

The form is the OMG's CDR ("DDS Interoperability Wire Protocol", 2.5, 10.2): a header of four
bytes, then one field after the other, each aligned to its own size counted from the header's end.
Bytes that only align mean nothing, and rclpy leaves in them what was in memory.
"""

import struct
import sys
from typing import Any, Sequence

from diffdrive_kinematics.core.kinematics import NANOSECONDS

HEADER = bytes((0, sys.byteorder == 'little', 0, 0))
STAMP_AT = len(HEADER)
write_stamp = struct.Struct('=iI').pack_into


class Layout:
    """The format, for ``struct``, of a message whose fields are named one after the other."""

    def __init__(self) -> None:
        self.format = f'={len(HEADER)}s'
        self.values: 'list[Any]' = [HEADER]
        self.size = len(HEADER)

    def numbers(self, code: str, values: Sequence[float]) -> int:
        """Append numbers of one type (a code of ``struct``); return where the first one is."""
        if not values:
            return self.size  # nothing is aligned where nothing stands
        size = struct.calcsize(f'={code}')
        padding = (len(HEADER) - self.size) % size
        self.format += f'{padding}x{len(values)}{code}'
        self.values += values
        self.size += padding + size * len(values)
        return self.size - size * len(values)

    def text(self, text: str) -> None:
        """Append a string."""
        encoded = text.encode() + b'\0'
        self.numbers('I', [len(encoded)])
        self.format += f'{len(encoded)}s'
        self.values.append(encoded)
        self.size += len(encoded)

    def header(self, frame_id: str) -> int:
        """Append a std_msgs/Header with a stamp of zero; return where the stamp is."""
        at = self.numbers('i', [0])
        self.numbers('I', [0])
        self.text(frame_id)
        return at

    def sequence(self, code: str, values: Sequence[float]) -> int:
        """Append a sequence of numbers; return where the first one is."""
        self.numbers('I', [len(values)])
        return self.numbers(code, values)


class Template:
    """A serialised message whose numbers can be overwritten."""

    def __init__(self, layout: Layout) -> None:
        self.data = bytearray(struct.pack(layout.format, *layout.values))

    def doubles(self, first: int, count: int) -> 'memoryview[float]':
        """Return doubles of the message, the first one at ``first``, to be written to."""
        return memoryview(self.data)[first:first + 8 * count].cast('d')

    def stamp(self, time_ns: int, at: int = STAMP_AT) -> None:
        """Write a stamp, by default that of the header with which the message begins."""
        write_stamp(self.data, at, time_ns // NANOSECONDS, time_ns % NANOSECONDS)

    def message(self) -> bytes:
        """Return what is to be published."""
        return bytes(self.data)


def stamped_sequence(sec: int, nanosec: int, frame_id: str, count: int) -> bytes:
    """Return the beginning of a message that is a header and a sequence of so many elements."""
    layout = Layout()
    layout.header(frame_id)
    layout.numbers('I', [count])
    front = bytearray(struct.pack(layout.format, *layout.values))
    write_stamp(front, STAMP_AT, sec, nanosec)
    return bytes(front)
