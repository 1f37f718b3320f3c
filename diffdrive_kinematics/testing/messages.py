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

from collections import Counter, defaultdict, deque
from itertools import count
from typing import Any, Callable, Deque, Dict, List, NamedTuple, Optional, Tuple

from diffdrive_kinematics.ros.messages.tf_message_type import tf_message_type
from diffdrive_kinematics.ros.runtime.clocks import SteppedClock
from diffdrive_kinematics.ros.runtime.in_flight_messages import InFlightMessages
from diffdrive_kinematics.ros.runtime.rclpy_private import MessageInfo
from diffdrive_kinematics.testing.disturbances import Disturbances
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy
from rclpy.serialization import deserialize_message, serialize_message
from rclpy.subscription import Subscription

__all__ = ['Recorded', 'RecordedMessages']


class Recorded(NamedTuple):
    """A message, and the simulated time [s] at which it was sent, or came from a process."""

    time: float
    message: Any


class _Listener:
    """A subscription of this process, and what it is to hear of this process."""

    def __init__(self, callback: Callable[..., None], informed: bool) -> None:
        self.callback, self.informed = callback, informed
        self.subscription: Optional[Subscription] = None
        self.expected: Dict[bytes, Deque[int]] = {}  # numbers of what the middleware brings

    def read(self, data: bytes) -> Any:
        """Return a message as the subscription hands it on."""
        subscription = self.subscription
        return data if subscription.raw else deserialize_message(data, subscription.msg_type)


class RecordedMessages(InFlightMessages):
    """
    Counts the messages on their way between the nodes of a robot, keeps and disturbs them.

    What is said to nobody but nodes of this process does not pass through the middleware.

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
        self.disturbances = Disturbances(clock)
        self.count_publishers: Callable[[str], int] = lambda topic: 0  # in the graph
        self._heard_by: Dict[str, List[_Listener]] = defaultdict(list)
        self._made: Optional[_Listener] = None
        self._here: Deque[Tuple[str, _Listener, bytes, int]] = deque()  # said to this process

    def counted(
            self, topic: str, callback: Callable[..., None], *,
            informed: bool = False) -> Callable[..., None]:
        """Return the callback of a subscription; what comes from elsewhere is kept."""
        counting = super().counted(topic, callback)
        self._made = listener = _Listener(counting, informed)
        self._heard_by[topic].append(listener)

        def hear(message: Any, *info: MessageInfo) -> None:
            number = self._take_own(topic, listener.expected, message)
            if number:  # kept where it was sent
                return counting(message, *(MessageInfo(number) for _ in info))
            if self._heard_by[topic][0] is listener:
                self.arrived[topic] += 1
                self._keep(topic, _bytes_of(message))
            self.disturbances.hand_on(topic, lambda: hand_on(message, *info))

        def hand_on(message: Any, *info: MessageInfo) -> None:
            self._in_flight[topic] += 1  # it was not counted as sent
            counting(message, *info)

        return hear

    def add_listener(self, subscription: Subscription) -> None:
        """Note which subscription has the callback that was counted last."""
        self._made.subscription = subscription

    def remove_listener(self, subscription: Subscription) -> None:
        """Note that a subscription of this process is gone."""
        super().remove_listener(subscription)
        topic = subscription.topic_name
        self._heard_by[topic] = [
            each for each in self._heard_by[topic] if each.subscription is not subscription]

    def forget(self) -> None:
        """Start counting anew: what was lost on its way will not come."""
        super().forget()
        for listeners in self._heard_by.values():
            for listener in listeners:
                listener.expected.clear()

    def settled(self) -> bool:
        """Return whether nothing is on its way."""
        return not self._here and super().settled()

    def hand_over(self) -> None:
        """Have this process hear what it has said to itself, and all that this causes."""
        while self._here:
            topic, listener, data, number = self._here.popleft()
            if listener in self._heard_by[topic]:
                self._in_flight[topic] += 1
                listener.callback(
                    listener.read(data), *[MessageInfo(number)] * listener.informed)

    def count_sent(self, publisher: Publisher, node: str) -> None:
        """Count and keep what a publisher sends from now on."""
        super().count_sent(publisher, node)
        topic, counted, numbers = publisher.topic_name, publisher.publish, count(1)
        lasts = publisher.qos_profile.durability == DurabilityPolicy.TRANSIENT_LOCAL
        listeners = self._heard_by
        self._types[topic] = publisher.msg_type

        def publish(message: Any) -> None:
            data = self._keep(topic, _bytes_of(message))  # nodes use their messages again
            number = next(numbers)
            self.disturbances.hand_on(topic, lambda: send(data, number))

        def send(data: bytes, number: int) -> None:
            if lasts or publisher.get_subscription_count() > len(listeners[topic]):
                for listener in listeners[topic]:
                    listener.expected.setdefault(data, deque()).append(number)
                counted(data)
            else:
                self._here.extend(
                    (topic, listener, data, number) for listener in listeners[topic])

        publisher.publish = publish

    def forget_node(self, node: Node) -> None:
        """Count no more for a node that is gone."""
        name = node.get_fully_qualified_name()
        for listener in [each for listeners in self._heard_by.values() for each in listeners]:
            if listener.subscription in set(node.subscriptions):
                self.remove_listener(listener.subscription)
        for publisher in [each for each in self.publishers if each in set(node.publishers)]:
            self.forget_publisher(publisher, name)
        self.forget()

    def forget_publisher(self, publisher: Publisher, node: str) -> None:
        """Count no more for a publisher of a node that is gone."""
        self.publishers.remove(publisher)
        self._owners[publisher.topic_name].remove(node)

    def know_types(self, node: Node) -> None:
        """Note the types of what a node listens to."""
        for subscription in node.subscriptions:
            self._types.setdefault(subscription.topic_name, subscription.msg_type)

    def keeps(self, topic: str) -> bool:
        """Return whether the messages of a topic are kept."""
        return topic in self._types

    def hears(self, topic: str) -> bool:
        """Return whether what processes say on a topic comes here."""
        return bool(self._heard_by.get(topic))

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

    def _take_own(self, topic: str, expected: Dict[bytes, Deque[int]], message: Any) -> int:
        """Return the number of a message that was sent here, and wait for it no more; else 0."""
        if not expected:
            return 0
        if isinstance(message, bytes):
            data = message
        elif self.only_own(topic):
            data = next(iter(expected))
        else:
            data = next((each for each in expected if repr(
                deserialize_message(each, self._types[topic])) == repr(message)), b'')
        if data not in expected:
            return 0
        number = expected[data].popleft()
        if not expected[data]:
            del expected[data]
        return number

    def only_own(self, topic: str) -> bool:
        """Return whether nobody else in the graph publishes a topic."""
        return self.count_publishers(topic) <= sum(
            each.topic_name == topic for each in self.publishers)

    def _keep(self, topic: str, data: bytes) -> bytes:
        self._kept[topic].append((self._clock.now_ns(), data))
        return data


def _bytes_of(message: Any) -> bytes:
    data: bytes = message if isinstance(message, bytes) else serialize_message(message)
    return data
