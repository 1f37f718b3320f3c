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
A bad link of wheel motion, inside the test, and how far off its losses may bring a pose.

Over a stretch in which nothing was heard the base knows where the wheels are at its end, so the
heading there is exact, but not what happened within: it takes one arc.  Let the centre roll by S
[m] and the heading turn by T [rad] within, both summed without sign.  The true displacement
differs from S straight on by at most S T, since the heading is never off by more than T; that of
the arc, whose heading grows evenly, by at most S T / 2.  So the two differ by at most 1.5 S T.
"""

from diffdrive_kinematics.core.kinematics import (
    advance, Pose, pose_change_from_travel, travel_from_angles)
from support.graph import stamp_ns
from support.stepped import messages


class Relay:
    """Hands on wheel motion as ``link`` says: a message in, a list of messages out."""

    def __init__(self, robot, link, source='wheel_rates', target='relayed'):
        self.came, self.went = [], []
        self._robot, self._link, self._source, self._target = robot, link, source, target

    def advance(self, seconds, every):
        """Let time pass, and hand on every so many seconds what has come."""
        for _ in range(round(seconds / every)):
            self._robot.advance(every)
            for message in messages(self._robot, self._source)[len(self.came):]:
                self.came.append(message)
                for out in self._link(message):
                    self.went.append(out)
                    self._robot.publish(self._target, out)


def arcs(geometry, messages):
    """Return (distance, turn) from each message to the next, by the rates that are held."""
    moves = []
    for before, after in zip(messages, messages[1:]):
        seconds = (stamp_ns(after) - stamp_ns(before)) / 1e9
        travel = travel_from_angles(geometry, *(rate * seconds for rate in before.velocity))
        moves.append(pose_change_from_travel(geometry, *travel))
    return moves


def composed(geometry, messages):
    """Return the pose after all messages, from the origin, arc by arc."""
    pose = Pose(0.0, 0.0, 0.0)
    for move in arcs(geometry, messages):
        pose = advance(pose, *move)
    return pose


def merging_error(geometry, came, went):
    """Return the bound [m] of what it costs that only some messages were heard in time."""
    heard, latest = set(), -1
    for message in went:
        if stamp_ns(message) > latest:
            latest = stamp_ns(message)
            heard.add(latest)
    bound = distance = turn = 0.0
    rates = set()
    for message, (ds, dtheta) in zip(came, arcs(geometry, came)):
        if stamp_ns(message) in heard:
            bound += 1.5 * distance * turn if len(rates) > 1 else 0.0
            distance = turn = 0.0
            rates = set()
        distance, turn = distance + abs(ds), turn + abs(dtheta)
        rates.add(tuple(message.velocity))
    return bound + 1.5 * distance * turn
