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

"""What several publishers, messages and wheels say of the joints, as motion of two sides."""

import math
from typing import Dict, List, NamedTuple, Optional, Sequence, Tuple

from diffdrive_kinematics.core.kinematics import is_sane
from diffdrive_kinematics.core.odometry import (
    Assembly, JointMessage, JointReading, mean_of, PositionTrack, SideTrack, Sources, WheelPair)
from diffdrive_kinematics.ros.messages.wheel_joints import WheelJoints

LONGEST_HELD = 1.0  # [s]; rates are not summed up over longer gaps


class Gathered(NamedTuple):
    """Motion of the joints of the (left, right) side, and who says so; None: absent."""

    stamp_ns: int
    positions: Optional[WheelPair]
    rates: Optional[WheelPair]
    source: str


class Gathering:
    """
    Keeps what is known of each joint and of who speaks of it.

    Parameters
    ----------
    joints : WheelJoints
        Of the robot; they are numbered, those of the left side first.
    period : float
        Range of the encoders [rad of the wheel]; 0: they do not wrap.

    """

    def __init__(self, joints: WheelJoints, period: float) -> None:
        self._names, self._left = joints.all_names(), len(joints.names[0])
        self._all = tuple(range(len(self._names)))
        self._fresh_track, self._wraps = PositionTrack(period), bool(period)
        self.sources = Sources()
        self._shifts: Dict[Tuple[object, ...], Dict[int, float]] = {}
        self._tags: Dict[int, str] = {}
        self._tracks: Dict[int, PositionTrack] = {}
        self._assembly = Assembly.of(len(self._all))
        self._begin_anew(())
        self.left_out, self.last_left_out = 0, ''
        self._delays: Dict[int, int] = {}  # of messages with some of the joints [ns]
        self.waiting_since_ns: Optional[int] = None
        self.incomplete = 0  # messages that had to wait for others

    def _begin_anew(self, joints: Sequence[int]) -> None:
        """Forget what joints have said: another run of their publisher counts anew."""
        for joint in joints:
            self._tracks.pop(joint, None)
        self._assembly = self._assembly.without(joints)
        self._sides: Optional[List[SideTrack]] = None
        self._turned, self._turned_ns = [0.0] * len(self._all), 0

    def clock_stepped(self) -> None:
        """Put only such messages together that came after a step of the clock."""
        self._assembly = Assembly.of(len(self._all))

    def usual(self) -> bool:
        """Return whether one publisher says everything that there is to say."""
        return len(self.sources.known) == 1 and not any(
            map(any, (shift.values() for shift in self._shifts.values())))

    def caught_up(self, received: JointMessage) -> None:
        """
        Take note of messages of the only publisher, of which this was the last one.

        Their positions were taken as they are, so those to come are as well: nothing is added.
        """
        self.sources = self.sources.caught_up(received)
        shift, = self._shifts.values()
        for joint, position in zip(received.joints, received.positions):
            if is_sane(position):
                shift.setdefault(joint, 0.0)
                self._follow(joint, position)

    def after(self, received: JointMessage, stamp_ns: int) -> Optional[Gathered]:
        """Return the motion that is known after a message; None: nothing new."""
        self.sources, believed = self.sources.update(received)
        if not believed:
            return None
        positions = self._positions(received)
        if received.joints == self._all:
            self.waiting_since_ns, source = None, received.tag
            self._assembly = Assembly.of(len(self._all))
            rates: Sequence[float] = received.rates
        else:
            self._note_delay(received.joints, received.now_ns - stamp_ns)
            nothing = (math.nan,) * len(received.joints)
            self._assembly, sample = self._assembly.after({
                joint: JointReading(stamp_ns, position, rate) for joint, position, rate in zip(
                    received.joints, positions or nothing, received.rates or nothing)})
            if sample is None:
                self.incomplete += 1
                if self.waiting_since_ns is None:
                    self.waiting_since_ns = received.now_ns
                return None
            self.waiting_since_ns = None
            source = '+'.join(dict.fromkeys(self._tags[joint] for joint in self._all))
            stamp_ns = sample.stamp_ns
            positions, rates = (
                () if all(map(math.isnan, values)) else values
                for values in (sample.positions, sample.rates))
        return Gathered(stamp_ns, *self._motion(stamp_ns, positions, rates), source)

    def _positions(self, received: JointMessage) -> Tuple[float, ...]:
        """
        Return positions without wraps that go on from those of the publisher before.

        Where that one is gone, they go on from the first ones heard, believed or not; which way
        they have gone since is not known where they wrap.
        """
        owner = next(each for each in self.sources.owners if each.joints == received.joints)
        goes_on = all(self._tags.get(joint) == received.tag for joint in received.joints)
        if not goes_on:
            self._begin_anew(received.joints)
            self._tags.update(dict.fromkeys(received.joints, received.tag))
        shift = self._shifts.setdefault(owner[:4], {})
        if len(self._shifts) > len(self.sources.known):
            kept = {each.first[:4] for each in self.sources.known}
            self._shifts = {key: value for key, value in self._shifts.items() if key in kept}
        heard = received if self._wraps or self.sources.contested(received.now_ns) else owner
        return tuple(
            self._follow(joint, position + shift.setdefault(
                joint, self._shift(joint, first if is_sane(first) else position)))
            if is_sane(position) else position
            for joint, position, first in zip(
                received.joints, received.positions, heard.positions or received.positions))

    def _shift(self, joint: int, position: float) -> float:
        """Return what makes the first position [rad] of a publisher the last one before it."""
        track = self._tracks.get(joint)
        return track.positions[0] - position if track else 0.0

    def _follow(self, joint: int, position: float) -> float:
        track = self._tracks.get(joint, self._fresh_track).followed((position,))
        self._tracks[joint] = track
        return track.positions[0]

    def _motion(
            self, stamp_ns: int, positions: Sequence[float], rates: Sequence[float]
    ) -> Tuple[Optional[WheelPair], Optional[WheelPair]]:
        """Return positions and rates of the sides, whatever single wheels say."""
        if len(self._all) == 2:
            return _pair(positions), _pair(rates)
        for what, values in (('position', positions), ('velocity', rates)):
            self._note_left_out(what, values)
        sides = self._followed(positions or self._summed(stamp_ns, rates))
        used = [not out for side in self._sides or () for out in side.left_out]
        return sides if positions else None, self._halves(rates, used) if rates else None

    def _followed(self, readings: Sequence[float]) -> WheelPair:
        """Return the positions [rad] of the sides."""
        halves = readings[:self._left], readings[self._left:]
        if self._sides is None:
            left, right = map(SideTrack.starting_at, halves)
            self._sides = [left._replace(start_other=right.position),
                           right._replace(start_other=left.position)]
            return left.position, right.position
        left, right = self._sides
        self._sides[0], left_position = left.followed(halves[0], right.position)
        self._sides[1], right_position = right.followed(halves[1], left.position)
        return left_position, right_position

    def _halves(self, values: Sequence[float], used: Sequence[bool]) -> WheelPair:
        use = [a and is_sane(value) for a, value in zip(used, values)]
        return (mean_of(values[:self._left], use[:self._left]),
                mean_of(values[self._left:], use[self._left:]))

    def _summed(self, stamp_ns: int, rates: Sequence[float]) -> List[float]:
        """Return how far [rad] the wheels have turned by their rates alone, NaN where unknown."""
        seconds = (stamp_ns - self._turned_ns) / 1e9
        self._turned_ns = stamp_ns
        if 0.0 < seconds <= LONGEST_HELD:
            means = self._halves(rates, [True] * len(rates))  # for those that say nothing
            speeds = [rate if is_sane(rate) else means[joint >= self._left]
                      for joint, rate in enumerate(rates)]
            self._turned = [angle + rate * seconds if is_sane(rate) else angle
                            for angle, rate in zip(self._turned, speeds)]
        return [angle if is_sane(rate) else math.nan for angle, rate in zip(self._turned, rates)]

    def _note_left_out(self, what: str, values: Sequence[float]) -> None:
        """Count what is not finite where there are others; what is NaN for all is absent."""
        bad = [joint for joint, value in enumerate(values) if not is_sane(value)]
        if bad and len(bad) < len(values):
            self.left_out += len(bad)
            self.last_left_out = f'{what} of {self._names[bad[0]]!r} is {values[bad[0]]!r}'

    def missing(self) -> Tuple[List[str], bool]:
        """Return the joints that are waited for, and whether some of them were never heard."""
        late = [joint for joint in self._all if not self._assembly.fresh[joint]]
        never = [joint for joint in late if self._assembly.newest[joint] is None]
        return [self._names[joint] for joint in never or late], bool(never)

    def _note_delay(self, joints: Sequence[int], delay_ns: int) -> None:
        for joint in joints:
            self._delays[joint] = min(delay_ns, self._delays.get(joint, delay_ns))

    def delays(self) -> Optional[Dict[str, int]]:
        """
        Return by how much stamps are behind the clock here [ns], the least of it for each joint.

        Since the last time all were told; None: some joints have not come by themselves since.
        """
        if len(self._delays) < len(self._all):
            return None
        delays, self._delays = self._delays, {}
        return {self._names[joint]: delay for joint, delay in delays.items()}

    def disagreements(self) -> List[str]:
        """Return what differs between wheels of a side, in words."""
        found, first = [], 0
        for side in self._sides or ():
            names = self._names[first:first + len(side.readings)]
            first += len(names)
            if side.disagreement:
                ways = ', '.join(
                    f'{name!r} {travel:.2f} rad{" (left out)" * out}' for name, travel, out in zip(
                        names, *side.disagreement))
                found.append(ways)
        return found


def _pair(values: Sequence[float]) -> Optional[WheelPair]:
    """Return the values of two joints, whose zeros have no sign; None where there are none."""
    return (0.0 + values[0], 0.0 + values[1]) if values else None
