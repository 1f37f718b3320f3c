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

"""Wheel motion as JointState: read in any shape, written with the bytes overwritten in place."""

import math
from typing import Callable, Dict, Optional, Sequence, Tuple, Union

from diffdrive_kinematics.core.encoders import Encoder, PositionTrack
from diffdrive_kinematics.core.wheel_motion import Pair, WheelSample
from diffdrive_kinematics.nodes.messages import check_stamp
from diffdrive_kinematics.nodes.wheel_joints import WheelJoints
from diffdrive_kinematics.nodes.wire import (
    joint_names, JointStateLayout, Layout, NANOSECONDS, Template)
from rclpy.serialization import deserialize_message
from sensor_msgs.msg import JointState

__all__ = ['WheelCommandMessage', 'WheelMessage', 'WheelReader']

MOST_LAYOUTS = 16
Indices = Tuple[Tuple[int, ...], Tuple[int, ...]]


class WheelReader:
    """
    Reads wheel motion from JointState: joints in any order, several wheels a side.

    A side's rate and position are the means over its wheels.  ``header.frame_id``, which has no
    other meaning in a JointState, tells one run of a publisher of this package from another.
    Positions that wrap around with the range of the encoders [rad] are followed, each joint by
    itself; range 0: they do not wrap.
    """

    def __init__(
            self, joints: WheelJoints, *, positions: bool = True,
            encoder_range: float = 0.0) -> None:
        self._joints = joints
        self._with_positions = positions
        self._fresh_track = self._track = PositionTrack(encoder_range)
        self._source = ''
        self._known_names: Sequence[str] = ()
        self._indices: Optional[Indices] = None
        self._layouts: Dict[int, JointStateLayout] = {}

    def read(
            self, message: Union[JointState, bytes],
            now_ns: Callable[[], int]) -> Optional[WheelSample]:
        """
        Return the wheel sample of a message, serialised or not; None: none of our joints is in it.

        A zero stamp means now.  Values that are NaN for all our joints count as absent, since
        joint_state_broadcaster fills in NaN for what a robot does not measure.

        Raises
        ------
        ValueError
            If some of our joints are missing, lengths do not match, values are not finite, or
            the stamp is none.

        """
        if isinstance(message, bytes):
            layout = self._layouts.get(len(message))
            fields = layout.read(message) if layout else None
            if layout and fields:
                return self._sample(layout.names, layout.frame_id, *fields, now_ns)
            message = self._deserialised(message)
        stamp = message.header.stamp
        return self._sample(
            tuple(message.name), message.header.frame_id, stamp.sec, stamp.nanosec,
            message.position, message.velocity, now_ns)

    def _deserialised(self, data: bytes) -> JointState:
        """Return the message, and remember its layout: the next one will have the same."""
        message = deserialize_message(data, JointState)
        if len(self._layouts) >= MOST_LAYOUTS:
            self._layouts.clear()
        self._layouts[len(data)] = JointStateLayout(message)
        return message

    def _sample(
            self, names: Sequence[str], source: str, sec: int, nanosec: int,
            position: Sequence[float], velocity: Sequence[float],
            now_ns: Callable[[], int]) -> Optional[WheelSample]:
        if names != self._known_names:
            self._indices, self._known_names = self._find(names), names
        indices = self._indices
        if indices is None:
            return None
        check_stamp(sec, nanosec)
        rates = self._pair('velocity', velocity, indices)
        positions = None
        if self._with_positions:
            if self._track.period:
                position = self._followed(position, source, indices)
            positions = self._pair('position', position, indices)
        if rates is not None and positions is not None:
            rates = None if _is_nan(*rates) else rates
            positions = None if rates and _is_nan(*positions) else positions
        return WheelSample(
            sec * NANOSECONDS + nanosec or now_ns(), rates, positions, source)

    def _find(self, names: Sequence[str]) -> Optional[Indices]:
        """Return where our joints, (left, right), are among the names."""
        wanted = self._joints.all_names()
        missing = [name for name in wanted if name not in names]
        if len(missing) == len(wanted):
            return None
        if missing:
            raise ValueError(
                f'name is {list(names)!r}, only some of our joints, expected also {missing!r}')
        left, right = (tuple(map(names.index, side)) for side in self._joints.names)
        return left, right

    def _followed(
            self, positions: Sequence[float], source: str,
            indices: Indices) -> Sequence[float]:
        """Return the positions of a message without their wraps; each source counts anew."""
        if len(positions) != len(self._known_names):
            return positions
        ours = [positions[i] for side in indices for i in side]
        if not all(map(math.isfinite, ours)):
            return positions
        track = self._track if source == self._source else self._fresh_track
        self._track, self._source = track.followed(ours), source
        followed = list(positions)
        for index, position in zip(
                (i for side in indices for i in side), self._track.positions):
            followed[index] = position
        return followed

    def _pair(self, field: str, values: Sequence[float], indices: Indices) -> Optional[Pair]:
        if not values:
            return None
        if len(values) != len(self._known_names):
            raise ValueError(
                f'{field} has {len(values)} values, expected {len(self._known_names)}, one for '
                'each name')
        return self._joints.signed((_mean(values, indices[0]), _mean(values, indices[1])))


def _mean(values: Sequence[float], indices: Tuple[int, ...]) -> float:
    """Return the mean of the values at indices; zero has no sign."""
    if len(indices) == 1:
        return 0.0 + values[indices[0]]
    return sum(values[i] for i in indices) / len(indices)


def _is_nan(left: float, right: float) -> bool:
    return left != left and right != right


class WheelMessage:
    """
    A serialised JointState for all wheels that is filled anew for each sample.

    ``source`` tells this run of this publisher from any other, so that positions that begin to
    count anew are not taken for motion (see ``WheelReader``).  ``encoder`` reads the positions.
    """

    def __init__(
            self, joints: WheelJoints, source: str = '', encoder: Encoder = Encoder()) -> None:
        self._joints, self._encoder, self._source = joints, encoder, source
        self._reads = bool(encoder.period or encoder.resolution)
        self._templates: Dict[Tuple[bool, bool], _JointStateTemplate] = {}

    def filled(
            self, stamp_ns: int, rates: Optional[Pair], positions: Optional[Pair]) -> bytes:
        """Return the message with a stamp, rates [rad/s] and positions [rad]; None: absent."""
        kind = positions is not None, rates is not None
        template = self._templates.get(kind)
        if template is None:
            template = _JointStateTemplate(self._source, self._joints.all_names(), *kind)
            self._templates[kind] = template
        template.stamp(stamp_ns)
        if positions is not None:
            angles = self._joints.signed(positions)
            _fill(template.positions, self._joints.spread(
                self._read(angles) if self._reads else angles))
        if rates is not None:
            _fill(template.velocities, self._joints.spread(self._joints.signed(rates)))
        return template.message()

    def _read(self, angles: Pair) -> Pair:
        return self._encoder.reading(angles[0]), self._encoder.reading(angles[1])


class _JointStateTemplate(Template):
    """The bytes of a JointState without effort, and of those arrays that are present."""

    def __init__(
            self, source: str, names: Sequence[str], with_positions: bool,
            with_rates: bool) -> None:
        layout = joint_names(source, names)
        at = [layout.sequence('d', [0.0] * len(names) if present else [])
              for present in (with_positions, with_rates, False)]
        super().__init__(layout)
        self.positions = self.doubles(at[0], len(names) if with_positions else 0)
        self.velocities = self.doubles(at[1], len(names) if with_rates else 0)


def _fill(view: 'memoryview[float]', values: Sequence[float]) -> None:
    for index, value in enumerate(values):
        view[index] = value


class WheelCommandMessage:
    """A serialised Float64MultiArray of wheel rates, left wheels then right wheels."""

    def __init__(self, joints: WheelJoints) -> None:
        self._joints = joints
        count = len(joints.all_names())
        layout = Layout()
        layout.sequence('I', [])  # dimensions
        layout.numbers('I', [0])  # offset of the data
        at = layout.sequence('d', [0.0] * count)
        self._template = Template(layout)
        self._rates = self._template.doubles(at, count)

    def filled(self, rates: Pair) -> bytes:
        """Return the message with rates [rad/s]."""
        _fill(self._rates, self._joints.spread(self._joints.signed(rates)))
        return self._template.message()
