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

"""Commands as they come: of what type, which of them are alive, what lay in a queue too long."""

import math
import time
from typing import Any, Callable, List, Mapping, Optional, Tuple

from diffdrive_kinematics.core.commands import STILL, Twist
from diffdrive_kinematics.core.kinematics import NANOSECONDS
from diffdrive_kinematics.core.odometry import SenderClocks
from diffdrive_kinematics.ros.inputs.other_clock import StampWatch
from diffdrive_kinematics.ros.messages.codec import CommandReader
from diffdrive_kinematics.ros.runtime.diagnostics import Problem
from diffdrive_kinematics.ros.runtime.rclpy_private import taker_of
from geometry_msgs import msg
from rclpy.subscription import Subscription

LATE_NS = 50_000_000  # up to which the age of a command is that of its way here
BEFORE_ALL_NS = -2**63
REPORT_PERIOD_S = 1.0
BY_STAMP = 'if the clocks differ, set cmd_vel_clock_offset'
AHEAD = 'stamps ahead of it count as now, commands that are too old by it are ignored'
BY_SENDING = 'it waited in a queue, or the clock of its sender is behind'
STALLS, CALM_S = 5, 1.0  # more, less apart, are none: such a process is slow, and goes on
GRACE_S = 0.1  # which the middleware has to deliver after the process was held up
PAUSE_S = 0.001
MOST = 1000
LOOK_PERIOD_NS = 2_000_000_000


class CommandIntake:
    """
    Reads commands, and refuses old ones: counted, and reported.

    A command is old by its stamp, where it has one, and by the time at which the middleware sent
    it: older than the timeout.  Nor does one override another that is stamped later.  A command
    to stand still is obeyed whatever its stamp.

    Parameters
    ----------
    node : DiffDriveNode
        Which counts and reports.
    stamped : bool
        Whether commands are TwistStamped.
    topic : str
        Resolved name, for reports.
    values : mapping
        Of the parameters.

    """

    def __init__(self, node: Any, stamped: bool, topic: str, values: Mapping[str, Any]) -> None:
        self._node, self._topic = node, topic
        self._reader = CommandReader('' if stamped else None)
        self._obeyed_ns = BEFORE_ALL_NS
        self._clocks, self._on_own_clock = SenderClocks(0), True
        self._stamps = StampWatch(node, topic, AHEAD)
        self._asked_s, self._older_until_s = math.inf, 0.0
        self._stalled_s, self._stalls = 0.0, 0
        self.configure(values)
        if 0.0 < values['cmd_vel_timeout'] < values['stamp_tolerance']:
            node.get_logger().warning(
                f"stamp_tolerance is {values['stamp_tolerance']!r} and cmd_vel_timeout "
                f"{values['cmd_vel_timeout']!r}: a command that is older than the timeout when it "
                'arrives ends at once')

    def configure(self, values: Mapping[str, Any]) -> None:
        """Judge by other values from now on."""
        timeout, tolerance = values['cmd_vel_timeout'], values['stamp_tolerance']
        offset = values['cmd_vel_clock_offset']
        self._offset_ns = None if math.isnan(offset) else round(offset * NANOSECONDS)
        self._tolerance_ns = round(tolerance * NANOSECONDS)
        self._oldest_ns = round(max(timeout, tolerance) * NANOSECONDS) if timeout else math.inf
        timeout_ns, given_ns = round(timeout * NANOSECONDS), self._offset_ns or None
        self._looks_at_sending = bool(timeout) and self._offset_ns is not None
        if (self._clocks.timeout_ns, self._clocks.given_ns) != (timeout_ns, given_ns):
            self._clocks = SenderClocks(timeout_ns, given_ns=given_ns)
            self._on_own_clock = True

    def alive(
            self, message: bytes, now_ns: int, sent_ns: int = 0
    ) -> Optional[Tuple[Twist, int, int]]:
        """
        Return the command of a serialised message, or None for one that is refused.

        It is the twist, the time [ns] from which it holds, and its age [ns].

        Parameters
        ----------
        message : bytes
            A serialised Twist, or TwistStamped.
        now_ns : int
            Time of arrival [ns].
        sent_ns : int
            When its sender sent it [ns], on its wall clock; 0: unknown, or just now.

        """
        own_ns, v, w = self._reader.decode(message)
        twist, stamp_ns, age_ns, hint = Twist(v, w), now_ns, 0, BY_STAMP
        if self._offset_ns is None:
            own_ns = 0
        if own_ns:
            own_ns += self._offset_ns
            age_ns = now_ns - own_ns
            if now_ns:
                self._stamps.note(own_ns, now_ns)
            if 0 <= age_ns <= self._tolerance_ns:
                stamp_ns = own_ns
            if own_ns < self._obeyed_ns and twist != STILL:
                return self._refused(
                    f'is stamped {(self._obeyed_ns - own_ns) / NANOSECONDS:.3f} s before the last '
                    'one obeyed', hint)
        if sent_ns and self._looks_at_sending:
            latency_ns = time.time_ns() - sent_ns
            if not (self._on_own_clock and 0 <= latency_ns < LATE_NS):  # as nearly always
                if age_ns <= self._oldest_ns:
                    hint = BY_SENDING
                age_ns = max(age_ns, self._learnt_age(latency_ns))
        if age_ns > self._oldest_ns and twist != STILL:
            return self._refused(
                f'is {age_ns / NANOSECONDS:.3f} s old, cmd_vel_timeout is '
                f"{self._node.config.values['cmd_vel_timeout']!r}", hint)
        if own_ns:
            self._obeyed_ns = max(self._obeyed_ns, min(own_ns, now_ns))
        return twist, stamp_ns, age_ns

    def awaits_older(self, period_ns: int) -> bool:
        """
        Return whether commands may be on their way that hold from a time that is past.

        They are for a moment after a stall, where stamps count: what was due meanwhile is sent
        now, and a repeat of the rates would say before it that they were held until now.

        Parameters
        ----------
        period_ns : int
            Time [ns] after which this is asked again where nothing holds the process up.

        """
        now_s, before_s = time.monotonic(), self._asked_s
        self._asked_s = now_s
        if not self._tolerance_ns or self._node.runtime.is_stepped or self._node.time.is_simulated:
            return False
        if now_s - before_s > (period_ns + LATE_NS) / NANOSECONDS:
            self._stalls = self._stalls + 1 if before_s - self._stalled_s < CALM_S else 1
            self._stalled_s = now_s
            if self._stalls <= STALLS:
                self._older_until_s = now_s + GRACE_S
        return now_s < self._older_until_s

    def none_before(self, time_ns: int) -> None:
        """Obey no command to move that is stamped before a time [ns]."""
        self._obeyed_ns = max(self._obeyed_ns, time_ns)

    def clock_stepped(self, step_ns: int, *, wall: bool) -> None:
        """Note that the own clock, the ``wall`` clock or a simulated one, was stepped."""
        self._obeyed_ns = max(BEFORE_ALL_NS, self._obeyed_ns + step_ns)
        self._stamps.clock_stepped(step_ns)
        if wall:
            self._clocks = self._clocks.clock_stepped(step_ns)
            self._on_own_clock = False

    def problems(self) -> List[Problem]:
        """Return what is wrong with the stamps of commands, for diagnostics."""
        return self._stamps.problems()

    def _learnt_age(self, latency_ns: int) -> int:
        """Return how long ago [ns] a message was sent, and learn of its sender's clock."""
        now_ns = time.monotonic_ns()
        if self._on_own_clock:  # up to now
            self._clocks = self._clocks.update(0, now_ns)[0]
        self._clocks, age_ns = self._clocks.update(latency_ns, now_ns)
        self._on_own_clock = self._clocks.agree()
        return age_ns

    def _refused(self, why: str, hint: str) -> None:
        self._node.counts['old commands'] += 1
        self._node.get_logger().warning(
            f"a command on '{self._topic}' {why}: ignored "
            f"({self._node.counts['old commands']} so far); {hint}",
            throttle_duration_sec=REPORT_PERIOD_S)


class Backlog:
    """What lies in the queue of commands when the process goes on after it was held up."""

    def __init__(self, subscription: Subscription) -> None:
        self._taken, self._hand_on = taker_of(subscription), subscription.callback

    def hand_on(self, enough: Callable[[], bool], *, wait: bool) -> None:
        """
        Hand on what is there.

        With ``wait`` what is on its way has a moment to come, unless there is ``enough``: the
        middleware was held up as well.
        """
        end = time.monotonic() + (GRACE_S if wait else 0.0)
        while True:
            for _ in range(MOST):  # a flood would never end
                if not (taken := self._taken()):
                    break
                self._hand_on(*taken)
            if enough() or time.monotonic() >= end:
                return
            time.sleep(PAUSE_S)


class CommandType:
    """
    The type of the commands that a node listens to, and its topic.

    Parameters
    ----------
    node : DiffDriveNode
        That listens.
    values : mapping
        Its parameters.

    """

    def __init__(self, node: Any, values: Mapping[str, Any]) -> None:
        self._node, self.stamped = node, values['enable_stamped_cmd_vel']
        self.message_type = msg.TwistStamped if self.stamped else msg.Twist
        self.name = f'geometry_msgs/msg/{self.message_type.__name__}'
        self.topic = node.resolve_topic_name(values['cmd_vel_topic'])
        self._look_at_ns = node.runtime.now_ns() + LOOK_PERIOD_NS

    def look_for_others(self, now_ns: int) -> None:
        """Say so now and then where commands are published in a type that is not heard."""
        if now_ns < self._look_at_ns:
            return
        self._look_at_ns = now_ns + LOOK_PERIOD_NS
        others = {info.topic_type for info in self._node.get_publishers_info_by_topic(self.topic)}
        if others := others - {self.name}:
            self._node.get_logger().warning(
                f"'{self.topic}' carries {', '.join(sorted(others))}, expected {self.name}: is "
                f'enable_stamped_cmd_vel (now {str(self.stamped).lower()}) set as it should be?')
