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

"""The messages of a robot under test: all are kept, and may be lost or late where told so."""

from collections import Counter, defaultdict
from heapq import heappop, heappush
from itertools import count
import random
from typing import Any, Callable, Dict, List, NamedTuple, Tuple

from diffdrive_kinematics.ros.messages.tf_message_type import tf_message_type
from diffdrive_kinematics.ros.runtime.clocks import SteppedClock
from diffdrive_kinematics.ros.runtime.in_flight_messages import InFlightMessages
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.serialization import deserialize_message, serialize_message

__all__ = ['Recorded', 'RecordedMessages']


class Recorded(NamedTuple):
    """A message, and the simulated time [s] at which it was sent, or came from a process."""

    time: float
    message: Any


class RecordedMessages(InFlightMessages):
    """
    Counts the messages on their way between the nodes of a robot, keeps and disturbs them.

    Parameters
    ----------
    clock : SteppedClock
        Clock of the nodes.

    """

    def __init__(self, clock: SteppedClock) -> None:
        super().__init__()
        self._clock = clock
        self._types: Dict[str, type] = {}
        self._kept: Dict[str, List[Tuple[int, bytes]]] = defaultdict(list)
        self._read: Dict[str, List[Recorded]] = defaultdict(list)  # of them, what was asked for
        self.arrived: 'Counter[str]' = Counter()  # from other processes
        self._losses: Dict[str, Tuple[float, random.Random]] = {}
        self._delays: Dict[str, int] = {}
        self._late: List[Tuple[int, int, Callable[[], None]]] = []
        self._number = count()
        self._made: List[str] = []
        self.count_publishers: Callable[[str], int] = lambda topic: 0  # in the graph
        self._own: Dict[str, List['Counter[bytes]']] = defaultdict(list)  # on the way, by listener

    def listeners_made(self) -> List[str]:
        """Return the topics of the subscriptions that were made since the last call."""
        made, self._made = self._made, []
        return made

    def counted(self, topic: str, callback: Callable[..., None]) -> Callable[..., None]:
        """Return the callback of a subscription; what comes from elsewhere is kept."""
        first = not self._listeners[topic]
        self._made.append(topic)
        counting = super().counted(topic, callback)
        own: 'Counter[bytes]' = Counter()
        self._own[topic].append(own)

        def hear(*message: Any) -> None:
            if self._take_own(topic, own, message[0]):  # kept where it was sent
                return counting(*message)
            if first:
                self.arrived[topic] += 1
                self._keep(topic, _bytes_of(message[0]))
            self._hand_on(topic, lambda: hand_on(message))

        def hand_on(message: Any) -> None:
            self._in_flight[topic] += 1  # it was not counted as sent
            counting(*message)

        return hear

    def forget(self) -> None:
        """Start counting anew: what was lost on its way will not come."""
        super().forget()
        for listeners in self._own.values():
            for own in listeners:
                own.clear()

    def count_sent(self, publisher: Publisher, node: str) -> None:
        """Count and keep what a publisher sends from now on."""
        super().count_sent(publisher, node)
        topic, counted = publisher.topic_name, publisher.publish
        self._types[topic] = publisher.msg_type

        def publish(message: Any) -> None:
            data = self._keep(topic, _bytes_of(message))  # nodes use their messages again
            self._hand_on(topic, lambda: send(data))

        def send(data: bytes) -> None:
            for own in self._own[topic]:
                own[data] += 1
            counted(data)

        publisher.publish = publish

    def forget_node(self, node: Node, topics: List[str]) -> None:
        """Count no more for a node that is gone."""
        name = node.get_fully_qualified_name()
        for topic in topics:
            self.remove_listener(topic)
        for publisher in [each for each in self.publishers if each in set(node.publishers)]:
            self.publishers.remove(publisher)
            self._owners[publisher.topic_name].remove(name)
        self.forget()

    def know_types(self, node: Node) -> None:
        """Note the types of what a node listens to."""
        for subscription in node.subscriptions:
            self._types.setdefault(subscription.topic_name, subscription.msg_type)

    def history(self, topic: str) -> List[Recorded]:
        """Return all messages of a topic so far."""
        if topic not in self._types:
            raise KeyError(f'the topic {topic!r} is not kept, expected one of '
                           f'{sorted(self._types)}, or one of robot.listen(type, topic)')
        kind = self._types[topic]
        made = kind is tf_message_type()  # for lack of tf2_msgs: it carries bytes only
        read, kept = self._read[topic], self._kept[topic]
        read += [Recorded(time_ns / 1e9, data if made else deserialize_message(data, kind))
                 for time_ns, data in kept[len(read):]]
        return list(read)

    def lose(self, topic: str, share: float, seed: int) -> None:
        """Lose a share of what is sent on a topic from now on."""
        if not 0.0 <= share <= 1.0:
            raise ValueError(f'share is {share!r}, expected from 0 to 1')
        self._losses[topic] = share, random.Random(seed)

    def delay(self, topic: str, delay_ns: int) -> None:
        """Hand on later what is sent on a topic from now on."""
        if delay_ns < 0:
            raise ValueError(f'the delay is {delay_ns / 1e9!r} s, expected 0 or above')
        self._delays[topic] = delay_ns

    def hand_on_late(self) -> bool:
        """Hand on what was delayed until now; return whether something was."""
        handed = False
        while self._late and self._late[0][0] <= self._clock.now_ns():
            heappop(self._late)[2]()
            handed = True
        return handed

    def clock_stepped(self, step_ns: int) -> None:
        """Let what is late come as late as it would have."""
        self._late = [(due + step_ns, number, send) for due, number, send in self._late]

    def _take_own(self, topic: str, own: 'Counter[bytes]', message: Any) -> bool:
        """Return whether a message is one that was sent here, and wait for it no more."""
        if not own:
            return False
        if self._only_own(topic):
            data = next(iter(own))
        elif isinstance(message, bytes):
            data = message
        else:
            data = next((each for each in own if repr(
                deserialize_message(each, self._types[topic])) == repr(message)), b'')
        if data not in own:
            return False
        own[data] -= 1
        if not own[data]:
            del own[data]
        return True

    def _only_own(self, topic: str) -> bool:
        """Return whether nobody else in the graph publishes a topic."""
        return self.count_publishers(topic) <= sum(
            each.topic_name == topic for each in self.publishers)

    def _keep(self, topic: str, data: bytes) -> bytes:
        self._kept[topic].append((self._clock.now_ns(), data))
        return data

    def _hand_on(self, topic: str, send: Callable[[], None]) -> None:
        share, dice = self._losses.get(topic, (0.0, None))
        if dice and dice.random() < share:
            return
        delay_ns = self._delays.get(topic, 0)
        if delay_ns:
            heappush(self._late, (self._clock.now_ns() + delay_ns, next(self._number), send))
        else:
            send()


def _bytes_of(message: Any) -> bytes:
    data: bytes = message if isinstance(message, bytes) else serialize_message(message)
    return data
