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

"""``command_sequence``: plays a list of commands, or a recording, as cmd_vel."""

from dataclasses import dataclass
from importlib import import_module
from typing import Any, Dict, List, Mapping, Optional, Sequence, Set, Tuple

from diffdrive_kinematics.core.commands import (
    Course, course_from_commands, course_from_recording, square_course, square_rounds, SquareRun)
from diffdrive_kinematics.core.kinematics import Command
from diffdrive_kinematics.ros.messages.codec import TwistCodec
from diffdrive_kinematics.ros.parameters.from_values import commands_from
from diffdrive_kinematics.ros.parameters.package_share import resolved
from diffdrive_kinematics.ros.parameters.tables import COMMAND_SEQUENCE
from diffdrive_kinematics.ros.runtime.clocks import period_ns
from diffdrive_kinematics.ros.runtime.diagnostics import Problem, RateSample, Status, WARN
from diffdrive_kinematics.ros.runtime.node import DiffDriveNode
from diffdrive_kinematics.ros.runtime.running import main_of
from diffdrive_kinematics.tools.recording_sources import read_commands
from rclpy.publisher import Publisher
from rclpy.subscription import Subscription

WAITING_REPORT_PERIOD_S = 5.0


@dataclass(frozen=True)
class Config:
    """What the sequence is set to."""

    course: Course
    values: Mapping[str, Any]
    runs: Tuple[SquareRun, ...] = ()


def build(values: Mapping[str, Any]) -> Config:
    """Return the configuration of parameter values, or raise ``ValueError``."""
    sources = {'commands': list(values['commands']), 'recording': values['recording'],
               'square_side': values['square_side']}
    if not any(sources.values()):
        raise ValueError(
            f"commands is []: {' or '.join(sources)} is not set, expected exactly one of them")
    if sum(map(bool, sources.values())) != 1:
        raise ValueError(
            f"{', '.join(f'{name} is {value!r}' for name, value in sources.items())}, expected "
            'exactly one of them to be set')
    if values['square_rounds'] and (values['loop'] or not values['square_side']):
        raise ValueError(
            f"square_rounds is {values['square_rounds']}, square_side {values['square_side']!r} "
            f"and loop {values['loop']}, expected a square_side above 0, and no loop")
    if not values['recording']:
        commands, runs = (_squares(values) if values['square_side']
                          else (commands_from(values['commands']), []))
        return Config(
            course_from_commands(commands), values, () if values['loop'] else tuple(runs))
    try:
        return Config(course_from_recording(
            read_commands(resolved(values['recording']), values['cmd_vel_topic'])), values)
    except ValueError as error:
        raise ValueError(f"recording is {values['recording']!r}: {error}") from error


def _squares(values: Mapping[str, Any]) -> Tuple[List[Command], List[SquareRun]]:
    """Return the square of UMBmark, once or more often; ``ValueError`` names the parameter."""
    square = {name: values[f'square_{name}'] for name in (
        'side', 'speed', 'yaw_rate', 'corner_radius', 'pause')}
    clockwise = values['square_clockwise']
    try:
        if values['square_rounds']:
            return square_rounds(values['square_rounds'], **square)
        commands = square_course(clockwise=clockwise, **square)
        return commands, [SquareRun(clockwise, sum(each.duration for each in commands))]
    except ValueError as error:
        raise ValueError(f'square_{error}') from error


class CommandSequence(DiffDriveNode[Config]):
    """
    Sends zeros until somebody subscribes, then each command at its time, then zero.

    Stamps are the times at which commands should hold, start plus offset, whenever the message
    is really sent; a controller with a ``stamp_tolerance`` then repeats the course exactly.
    """

    def __init__(self, name: str = 'command_sequence', **composition: Any) -> None:
        super().__init__(name, COMMAND_SEQUENCE, build, **composition)
        values = self.config.values
        self._course = self.config.course
        self._repeat_ns = period_ns(values['publish_rate'])
        self._start_ns = -1
        self._waited_since_ns: Optional[int] = None
        self._next = 0
        self._message = TwistCodec.of(values)
        self._loop = values['loop']
        self._publisher = self.runtime.publish(self._message.message_type, values['cmd_vel_topic'])
        self._unanswered: Set[str] = {
            self.resolve_topic_name(topic) for topic in values['wait_for_topics']}
        self._answers: Dict[str, Subscription] = {}
        self._unknown: Set[str] = set()
        self._timer = self.runtime.every(values['publish_rate'], self._tick)
        if self._course.duplicates:
            self.get_logger().warning(
                f'{self._course.duplicates} rows of the recording are skipped, as the row after '
                'has the same time')

    @property
    def length_s(self) -> float:
        """Return the duration of the course [s]."""
        return self._course.length_ns / 1e9

    def begun(self) -> bool:
        """Return whether the course has begun."""
        return self._start_ns >= 0

    def elapsed_s(self) -> float:
        """Return the time [s] since the course began, 0 before."""
        return (self.runtime.now_ns() - self._start_ns) / 1e9 if self.begun() else 0.0

    def _tick(self) -> None:
        now_ns, step_ns = self.time.now_and_step()
        if self.done:
            return
        if self.begun():
            self._start_ns += step_ns
        else:
            self._send(now_ns, 0.0, 0.0)
            if not self._has_answers():
                self._report_waiting(now_ns, step_ns)
                return
            self._start_ns = now_ns
            self.get_logger().info(
                f'playing {self.length_s:.3f} s of commands, starting at {now_ns / 1e9:.3f} s')
        self._play(now_ns)

    def _play(self, now_ns: int) -> None:
        """Send what is due, or repeat what holds; and wake up for whichever is next."""
        sent = self._send_due(now_ns)
        if self._next == len(self._course.twists):
            self.done = True
            self.get_logger().info('the course is done')
            return
        if not sent:
            held = self._course.twists[self._next - 1]
            self._send(now_ns, held.v, held.w)
        next_ns = self._start_ns + self._course.twists[self._next].offset_ns
        self._timer.timer_period_ns = min(self._repeat_ns, max(1, next_ns - now_ns))
        self._timer.reset()

    def _send_due(self, now_ns: int) -> bool:
        """Send all that is due, and return whether that was anything; a loop has no last zero."""
        sent = False
        while due := self._course.due(self._next, now_ns - self._start_ns):
            self._next += len(due)
            lap = self._loop and self._next == len(self._course.twists)
            for twist in due[:-1] if lap else due:
                self._send(self._start_ns + twist.offset_ns, twist.v, twist.w)
                sent = True
            if not lap:
                break
            self._next, self._start_ns = 0, self._start_ns + self._course.length_ns
        return sent

    def awaited_topics(self) -> Set[str]:
        """Return the topics to wait for that nobody publishes yet; the others are listened to."""
        for topic, types in self.get_topic_names_and_types():
            if topic in self._unanswered - set(self._answers) - self._unknown:
                self._listen(topic, types[0])
        return self._unanswered - set(self._answers)

    def _has_answers(self) -> bool:
        """Return whether somebody listens and all topics to wait for have answered."""
        self.awaited_topics()
        if not self._unanswered and self._publisher.get_subscription_count() > 0:
            for subscription in self._answers.values():
                self.runtime.unlisten(subscription)
            return True
        return False

    def _report_waiting(self, now_ns: int, step_ns: int) -> None:
        """Say what is waited for after some time of this clock, and then not too often."""
        since_ns = now_ns if self._waited_since_ns is None else self._waited_since_ns + step_ns
        self._waited_since_ns = since_ns
        if now_ns - since_ns >= WAITING_REPORT_PERIOD_S * 1e9:
            self.get_logger().info(
                self._waiting(), throttle_duration_sec=WAITING_REPORT_PERIOD_S)

    def _waiting(self) -> str:
        missing = sorted(self._unanswered) or [f'a subscriber of {self._publisher.topic_name}']
        return f"waiting for {', '.join(missing)}"

    def status(self, sample: RateSample) -> Status:
        """Return how far the course has come."""
        elapsed = min(self.elapsed_s(), self.length_s)
        return Status({
            'state': 'done' if self.done else 'playing' if self.begun() else 'waiting',
            'elapsed [s]': elapsed, 'length [s]': self.length_s,
            'progress [%]': 100.0 * elapsed / self.length_s,
            'achieved publish rate [Hz]': sample.rate},
            [] if self.begun() else [Problem(WARN, self._waiting())])

    def _listen(self, topic: str, type_name: str) -> None:
        """Subscribe to a topic of whatever type until it answers."""
        package, _, name = type_name.split('/')
        try:
            message_type = getattr(import_module(f'{package}.msg'), name)
        except (ImportError, AttributeError):
            self._unknown.add(topic)
            self.get_logger().error(
                f"cannot wait for '{topic}': its type {type_name} is not installed here")
            return
        self._answers[topic] = self.runtime.listen(
            message_type, topic, lambda _: self._unanswered.discard(topic), raw=True)

    def _send(self, stamp_ns: int, v: float, w: float) -> None:
        self.health.sent += 1
        self._publisher.publish(self._message.encode(stamp_ns, v, w))

    def final_command(self) -> Sequence[Publisher]:
        """Leave the robot with the command to stand still."""
        self._send(self.runtime.now_ns(), 0.0, 0.0)
        return [self._publisher]


main = main_of(CommandSequence)
