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
What a node tells about its own health, as diagnostic_msgs.

Nodes count while they work, and that is all it costs them; at a low rate the counts are looked
at, compared with those of the look before, and published where anybody listens.
"""

from typing import Any, Dict, List, Mapping, NamedTuple, Optional

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from diffdrive_kinematics.core.kinematics import NANOSECONDS
from diffdrive_kinematics.core.odometry import Verdict
from diffdrive_kinematics.ros.messages.messages import set_stamp
from rclpy.publisher import Publisher

__all__ = [
    'ERROR', 'MessageStatistics', 'OK', 'Problem', 'RateSample', 'Reporter', 'Status', 'TOPIC',
    'WARN',
    'heard_values', 'quiet', 'slowness', 'stamp_values', 'unheard']

TOPIC = '/diagnostics'
OK, WARN, ERROR = DiagnosticStatus.OK, DiagnosticStatus.WARN, DiagnosticStatus.ERROR
SEVERITY = (OK, WARN, ERROR)  # STALE is the aggregator's word for who does not report
ALARMS = {'refused': ERROR, 'timeouts': WARN, 'out of order': WARN,
          'clock steps in stamps': WARN, 'clock steps': WARN, 'position jumps': WARN,
          'old commands': WARN}
SLOW = 0.8  # of the rate that is set
FEWEST_TO_JUDGE = 5


class Problem(NamedTuple):
    """How bad it is, and what is wrong."""

    level: bytes
    message: str


class Status(NamedTuple):
    """What there is to tell: values by name, numbers or text, and what is wrong."""

    values: Mapping[str, Any]
    problems: List[Problem]


class RateSample(NamedTuple):
    """A look at a node: when [ns], and the achieved rate [Hz] since the one before."""

    now_ns: int
    rate: Optional[float] = None
    seconds: float = 0.0


class MessageStatistics:
    """What a node has heard: how much, when last, and how far stamps were from arrival."""

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


def heard_values(heard: MessageStatistics, now_ns: int, what: str) -> Dict[str, Any]:
    """Return how much of what was heard, and how long ago."""
    return {f'age of the last {what} [s]': heard.age(now_ns), f'{what} messages': heard.count}


def stamp_values(counts: Mapping[str, int]) -> Dict[str, Any]:
    """Return how often stamps of wheel motion were not taken as they came."""
    return {'out of order': counts[Verdict.OUT_OF_ORDER.value],
            'clock steps in stamps': counts[Verdict.CLOCK_STEP.value]}


def unheard(heard: MessageStatistics, topic: str, level: bytes = WARN) -> List[Problem]:
    """Return that nothing was heard yet, where it is so."""
    return [] if heard.count else [Problem(level, f"no messages on '{topic}' yet")]


def quiet(
        heard: MessageStatistics, now_ns: int, timeout: float, topic: str, *,
        at_rest: bool = False) -> List[Problem]:
    """Return that nothing was heard for a timeout [s], 0: never; at rest that is no trouble."""
    age = heard.age(now_ns)
    if age is None or not 0.0 < timeout < age:
        return []
    words = f"no messages on '{topic}' for {age:.1f} s"
    return [Problem(OK, f'at rest, {words}') if at_rest else Problem(WARN, words)]


def slowness(look: RateSample, rate: float) -> List[Problem]:
    """Return the trouble of publishing clearly less often than the rate [Hz] that is set."""
    if look.rate is None or look.seconds * rate < FEWEST_TO_JUDGE or look.rate >= SLOW * rate:
        return []
    return [Problem(WARN, f'publishes at {look.rate:.1f} Hz, set to {rate:.1f}')]


class Reporter:
    """
    Turns what a node tells into one status of a DiagnosticArray.

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
        self._look_ns, self._sent = 0, 0

    def look(self, now_ns: int, sent: int) -> RateSample:
        """Return a look at a node that has sent so many messages."""
        seconds = (now_ns - self._look_ns) / NANOSECONDS
        known = self._sent > 0 and self._look_ns > 0 and seconds > 0.0
        rate = (sent - self._sent) / seconds if known else None
        self._look_ns, self._sent = now_ns, sent
        return RateSample(now_ns, rate, seconds)

    def clock_stepped(self, step_ns: int) -> None:
        """Note that the clock of the looks was stepped."""
        self._look_ns += step_ns

    def report(self, now_ns: int, status: Status) -> None:
        """Publish a status; what was counted since the last one is trouble, too."""
        problems = [*self._grown(status.values), *status.problems]
        if not self._publisher.get_subscription_count():
            return
        problems.sort(key=lambda trouble: -SEVERITY.index(trouble.level))
        self._status.level = problems[0].level if problems else OK
        self._status.message = '; '.join(trouble.message for trouble in problems) or 'ok'
        self._status.values = [
            KeyValue(key=key, value=_text(value)) for key, value in status.values.items()]
        set_stamp(self._message.header.stamp, now_ns)
        self._publisher.publish(self._message)

    def _grown(self, values: Mapping[str, Any]) -> List[Problem]:
        """Return the alarms that have gone up since the last look."""
        before, self._counts = self._counts, {
            name: values[name] for name in ALARMS if name in values}
        return [
            Problem(ALARMS[name], f'{name}: {count - before.get(name, 0)} more, {count} in all')
            for name, count in self._counts.items() if count > before.get(name, 0)]


def _text(value: Any) -> str:
    if value is None:
        return 'unknown'
    return f'{value:.3f}' if isinstance(value, float) else str(value)
