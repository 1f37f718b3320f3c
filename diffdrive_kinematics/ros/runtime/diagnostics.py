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
The health of a node, as diagnostic_msgs.

Nodes count while they work, and that is all it costs them; at a low rate the counts are looked
at, compared with those of the look before, and published where anybody listens.
"""

from typing import Any, Dict, List, Mapping, NamedTuple, Optional

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from diffdrive_kinematics.core.kinematics import NANOSECONDS
from diffdrive_kinematics.core.odometry import Verdict
from diffdrive_kinematics.ros.messages.messages import set_stamp
from rclpy.publisher import Publisher

TOPIC = '/diagnostics'
OK, WARN, ERROR = DiagnosticStatus.OK, DiagnosticStatus.WARN, DiagnosticStatus.ERROR
ALARMS = {'refused': ERROR, 'timeouts': WARN, 'out of order': WARN, 'clock steps in stamps': WARN,
          'clock steps': WARN, 'position jumps': WARN, 'old commands': WARN}
SLOW = 0.8  # of the rate that is set
FEWEST_TO_JUDGE = 5
HARDWARE = 'robot'  # what a node without a namespace belongs to


class Problem(NamedTuple):
    """How bad it is, and what is wrong."""

    level: bytes
    message: str


class Status(NamedTuple):
    """Values by name, numbers or text, and what is wrong."""

    values: Mapping[str, Any]
    problems: List[Problem]


class Finding:
    """
    What is wrong, in words; empty: nothing.

    Parameters
    ----------
    node : DiffDriveNode
        That says so.

    """

    def __init__(self, node: Any) -> None:
        self._node, self.text = node, ''

    def note(self, text: str, over: str = '') -> None:
        """Note what is wrong now; ``over`` is what is said where that has ended."""
        before, self.text = self.text, text
        if text and not before:
            self._node.get_logger().warning(text)
        elif before and not text and over:
            self._node.get_logger().info(over)


class RateSample(NamedTuple):
    """When a node was looked at [ns], and the rate [Hz] and time [s] since the sample before."""

    now_ns: int
    rate: Optional[float] = None
    seconds: float = 0.0

    def problems(self, wanted: float) -> List[Problem]:
        """Return that messages are sent clearly less often than the rate [Hz] that is set."""
        if (self.rate is None or self.seconds * wanted < FEWEST_TO_JUDGE
                or self.rate >= SLOW * wanted):
            return []
        return [Problem(WARN, f'publishes at {self.rate:.1f} Hz, set to {wanted:.1f}')]


class MessageStatistics:
    """Messages that came: how many, when the last one did, and how old stamps were then."""

    def __init__(self) -> None:
        self.count = 0
        self.last_ns = 0
        self.skew_ns = 0
        self.largest_skew_ns = 0

    def note(self, now_ns: int, stamp_ns: int) -> None:
        """Note a message that came now."""
        self.count += 1
        self.last_ns = now_ns
        self.skew_ns = skew = now_ns - stamp_ns
        if abs(skew) > abs(self.largest_skew_ns):
            self.largest_skew_ns = skew

    def clock_stepped(self, step_ns: int) -> None:
        """Note that the clock by which messages came was stepped."""
        self.last_ns += step_ns

    def age(self, now_ns: int) -> Optional[float]:
        """Return the time [s] since the last message; None: none came since time began."""
        return (now_ns - self.last_ns) / NANOSECONDS if self.count and self.last_ns else None

    def values(self, now_ns: int, what: str) -> Dict[str, Any]:
        """Return how many messages have come, and how long ago the last one did."""
        return {f'age of the last {what} [s]': self.age(now_ns), f'{what} messages': self.count}

    def problems(
            self, now_ns: int, timeout: float, topic: str, *, at_rest: bool = False,
            none_yet: bytes = WARN) -> List[Problem]:
        """
        Return that no message has come yet, or none for a timeout.

        Parameters
        ----------
        now_ns : int
            The time [ns].
        timeout : float
            Time without a message [s] that is a problem; 0: none is.
        topic : str
            Name of the topic.
        at_rest : bool
            Whether the robot stands, so that no messages are no problem.
        none_yet : bytes
            How bad it is that none has come since the start.

        """
        if not self.count:
            return [Problem(none_yet, f"no messages on '{topic}' yet")]
        age = self.age(now_ns)
        if age is None or not 0.0 < timeout < age:
            return []
        text = f"no messages on '{topic}' for {age:.1f} s"
        return [Problem(OK, f'at rest, {text}') if at_rest else Problem(WARN, text)]


def stamp_values(counts: Mapping[str, int]) -> Dict[str, Any]:
    """Return how often stamps of wheel motion were out of order, or showed a step of a clock."""
    return {'out of order': counts[Verdict.OUT_OF_ORDER.value],
            'clock steps in stamps': counts[Verdict.CLOCK_STEP.value]}


class Reporter:
    """
    Publishes a node's status as a DiagnosticArray.

    Parameters
    ----------
    name, hardware_id : str
        Of the status.
    publisher : Publisher
        Of ``DiagnosticArray``.

    """

    def __init__(self, name: str, hardware_id: str, publisher: Publisher) -> None:
        self._publisher = publisher
        self._status = DiagnosticStatus(name=name, hardware_id=hardware_id)
        self._message = DiagnosticArray(status=[self._status])
        self._counts: Dict[str, int] = {}
        self._sampled_ns, self._sent = 0, 0

    def sample(self, now_ns: int, sent: int) -> RateSample:
        """Return the rate of a node that has sent so many messages up to now."""
        seconds = (now_ns - self._sampled_ns) / NANOSECONDS
        known = self._sent > 0 and self._sampled_ns > 0 and seconds > 0.0
        rate = (sent - self._sent) / seconds if known else None
        self._sampled_ns, self._sent = now_ns, sent
        return RateSample(now_ns, rate, seconds)

    def clock_stepped(self, step_ns: int) -> None:
        """Note that the clock of the samples was stepped."""
        self._sampled_ns += step_ns

    def report(self, now_ns: int, status: Status) -> None:
        """Publish a status; alarms that were counted since the last one are problems, too."""
        problems = [*self._grown(status.values), *status.problems]
        if not self._publisher.get_subscription_count():
            return
        problems.sort(key=lambda problem: problem.level, reverse=True)
        self._status.level = problems[0].level if problems else OK
        self._status.message = '; '.join(problem.message for problem in problems) or 'ok'
        self._status.values = [
            KeyValue(key=key, value=_text(value)) for key, value in status.values.items()]
        set_stamp(self._message.header.stamp, now_ns)
        self._publisher.publish(self._message)

    def _grown(self, values: Mapping[str, Any]) -> List[Problem]:
        """Return the alarms that were counted since the last report."""
        before, self._counts = self._counts, {
            name: values[name] for name in ALARMS if name in values}
        return [
            Problem(ALARMS[name], f'{name}: {count - before.get(name, 0)} more, {count} in all')
            for name, count in self._counts.items() if count > before.get(name, 0)]


class Health:
    """
    Counts what a node hears and sends, and publishes how it is.

    Parameters
    ----------
    node : DiffDriveNode
        Whose health it is; its ``status`` says what only it can tell.
    rate : float
        Of reports [Hz]; 0: none.

    """

    def __init__(self, node: Any, rate: float) -> None:
        self._node, self.statistics, self.sent = node, MessageStatistics(), 0
        self._reporter: Optional[Reporter] = None
        if rate:
            self._reporter = Reporter(
                node.get_fully_qualified_name(), node.get_namespace().strip('/') or HARDWARE,
                node.runtime.publish(DiagnosticArray, TOPIC))
            node.runtime.every(rate, self._report, steadily=True)

    def clock_stepped(self, step_ns: int) -> None:
        """Note that the clock of the node was stepped."""
        self.statistics.clock_stepped(step_ns)
        if self._reporter:
            self._reporter.clock_stepped(step_ns)

    def _report(self) -> None:
        runtime, counts = self._node.runtime, self._node.counts
        sample = self._reporter.sample(runtime.now_ns(), self.sent)
        values, problems = self._node.status(sample)
        self._reporter.report(sample.now_ns, Status({
            **values, **{name: counts[name] for name in ('refused', 'clock steps')}},
            [*self._node.time.problems(), *problems]))


def _text(value: Any) -> str:
    if value is None:
        return 'unknown'
    return f'{value:.3f}' if isinstance(value, float) else str(value)
