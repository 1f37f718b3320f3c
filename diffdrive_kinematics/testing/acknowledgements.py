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

"""What processes that call ``spin`` of this package acknowledge to a test."""

from typing import Dict, Iterator, List, Optional, Set, Tuple

from diffdrive_kinematics.ros.messages.messages import nanoseconds
from diffdrive_kinematics.testing.lockstep import IDLE_QOS, IDLE_TOPIC
from rclpy.node import Node
from std_msgs.msg import Header

__all__ = ['Acknowledgements']

Gid = Tuple[int, ...]


class Acknowledgements:
    """
    The time that each node acknowledged last, and the topics that it has.

    Parameters
    ----------
    observer : Node
        Node of the test.

    """

    def __init__(self, observer: Node) -> None:
        self._observer = observer
        self._times_ns: Dict[str, int] = {}
        self._ends: Dict[str, List[List[str]]] = {}  # topics of each: heard, published
        self._before: Set[Gid] = set()
        observer.create_subscription(Header, IDLE_TOPIC, self._on_idle, IDLE_QOS)

    def of(self, name: str) -> Optional[int]:
        """Return the time [ns] that a node acknowledged last."""
        return self._times_ns.get(name)

    def expect_newcomer(self, known: Set[str]) -> None:
        """Forget nodes that have ended, as one of the name may come, and note who is there."""
        self._times_ns = {name: self._times_ns[name] for name in known & {*self._times_ns}}
        topics = [topic for topic, _ in self._observer.get_topic_names_and_types()]
        self._before = {gid for heard in (True, False) for gid in self._gids(topics, heard)}

    def newcomer(self, known: Set[str], now_ns: int) -> str:
        """Return a node that is not known and has acknowledged the time; empty: there is none."""
        return next((name for name, time_ns in self._times_ns.items()
                     if name not in known and time_ns == now_ns), '')

    def ends_known(self, name: str) -> bool:
        """
        Return whether the graph shows all that a newcomer listens to and publishes.

        Only of topics is it sure to: whose they are may stay unknown.
        """
        return all(
            len(set(self._gids([*{*topics}], heard)) - self._before) >= len(topics)
            for heard, topics in zip((True, False), self._ends[name]))

    def _gids(self, topics: List[str], heard: bool) -> Iterator[Gid]:
        """Return what identifies each end of some topics."""
        look = (self._observer.get_subscriptions_info_by_topic if heard
                else self._observer.get_publishers_info_by_topic)
        return (tuple(end.endpoint_gid) for topic in topics for end in look(topic))

    def _on_idle(self, message: Header) -> None:
        name, *ends = message.frame_id.split(' ')
        self._ends[name] = [[topic for topic in each.split(',') if topic] for each in ends]
        self._times_ns[name] = nanoseconds(message.stamp)
