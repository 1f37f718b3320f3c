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

"""Counts the messages on their way between the nodes of one process."""

from collections import Counter
from typing import Any, Callable, Dict, List

from rclpy.publisher import Publisher
from rclpy.subscription import Subscription


class InFlightMessages:
    """
    Tells when every message that was sent within the process has been handled.

    Only then may a stepped clock go on, if a run is to give the same numbers every time.
    Messages from other processes are handled as they come and are not waited for.
    """

    def __init__(self) -> None:
        self._listeners: 'Counter[str]' = Counter()
        self._in_flight: 'Counter[str]' = Counter()
        self._owners: Dict[str, List[str]] = {}
        self.publishers: 'list[Publisher]' = []

    def counted(
            self, topic: str, callback: Callable[..., None], *,
            informed: bool = False) -> Callable[..., None]:
        """
        Return the callback of a subscription of this process, by resolved topic name.

        One that is ``informed`` gets a ``MessageInfo`` beside the message.
        """
        self._listeners[topic] += 1

        def counting(*message: Any) -> None:
            try:
                callback(*message)
            finally:
                self._in_flight[topic] -= 1

        return counting

    def add_listener(self, subscription: Subscription) -> None:
        """Note which subscription has the callback that was counted last."""

    def remove_listener(self, subscription: Subscription) -> None:
        """Note that a subscription of this process is gone."""
        self._listeners[subscription.topic_name] -= 1

    def count_sent(self, publisher: Publisher, node: str) -> None:
        """Count what a publisher of a node sends from now on."""
        topic, publish = publisher.topic_name, publisher.publish

        def counted(message: object) -> None:
            self._in_flight[topic] += self._listeners[topic]
            publish(message)

        publisher.publish = counted
        self.publishers.append(publisher)
        self._owners.setdefault(topic, []).append(node)

    def settled(self) -> bool:
        """Return whether nothing is on its way."""
        return all(count <= 0 for count in self._in_flight.values())

    def forget(self) -> None:
        """Start counting anew, so that messages from elsewhere do not add up."""
        self._in_flight.clear()

    def internal_topics(self) -> Dict[str, List[str]]:
        """Return the nodes that publish each topic on which this process listens to itself."""
        return {topic: nodes for topic, nodes in self._owners.items() if self._listeners[topic]}

    def matched(self) -> bool:
        """Return whether every publisher has found the subscriptions of this process."""
        return all(
            publisher.get_subscription_count() >= self._listeners[publisher.topic_name]
            for publisher in self.publishers)
