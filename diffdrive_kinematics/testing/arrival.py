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

"""Whether a process that was started is there: its nodes spin, and have found the robot."""

import time
from typing import Dict, Iterator, List, Set, Tuple

from diffdrive_kinematics.testing.processes import Process
from rcl_interfaces.srv import GetParameters
from rclpy.client import Client
from rclpy.node import Node

__all__ = ['Arrival', 'SERVICE']

Gid = Tuple[int, ...]
LONGEST_LOOK_S, REPEAT_S = 0.05, 0.5
STILL_S, SILENT_S = 0.5, 5.0
"""For how long the graph may not change before a process is there: one whose nodes have answered,
and one of which a node does not, as it does not spin or has no parameter services."""

SERVICE = '/get_parameters'


class Arrival:
    """
    What is new in the graph since before a process was started.

    Each node that is new is asked for its parameters.  It answers when it spins, so all that its
    constructor makes is there; and as the middleware tells in order who publishes and listens, it
    has found by then all that the robot had before the node was asked.

    Parameters
    ----------
    observer : Node
        Node of the test.
    ended : set of str
        Nodes that have ended; the graph may show them for a while, and one of the name may come.

    """

    def __init__(self, observer: Node, ended: Set[str]) -> None:
        self._observer, self._ended = observer, ended
        self._clients: Dict[str, Client] = {}
        self._asked_at: Dict[str, float] = {}
        self._ends: List[Tuple[str, int]] = []
        self._still_s, self._looked_at = 0.0, time.monotonic()
        self.answered: Set[str] = set()
        self._nodes_before = {*self._nodes()} - ended
        topics = [topic for topic, _ in observer.get_topic_names_and_types()]
        self._before = {gid for heard in (True, False) for gid in self._gids(topics, heard)}

    def shows(self, topics: List[str], *, heard: bool) -> bool:
        """Return whether as many new ends as topics are there, ends that listen or publish."""
        return len({*self._gids([*{*topics}], heard)} - self._before) >= len(topics)

    def complete(self, matched: bool, process: Process) -> bool:
        """
        Return whether the nodes of a process answer, and the graph is still.

        A node in lockstep has told what it listens to and publishes: it needs no more.
        """
        ends = sorted((topic, self._observer.count_subscribers(topic))
                      for topic, _ in self._observer.get_topic_names_and_types())
        now = time.monotonic()
        self._still_s += min(now - self._looked_at, LONGEST_LOOK_S)  # the test may stand still
        if ends != self._ends or not matched:
            self._still_s = 0.0
        self._looked_at, self._ends = now, ends
        answered = self._all_answer() or not process.running
        return self._still_s > SILENT_S or answered and self._still_s > (
            0.0 if process.lockstep else STILL_S)

    def _all_answer(self) -> bool:
        """Return whether each new node has answered, at least one; ask those that have not."""
        asked = {*self._nodes()} - self._nodes_before
        for name in asked - self.answered:
            self._ask(name)
        return bool(self.answered) and asked - self.answered <= self._ended

    def close(self) -> None:
        """Ask no more."""
        for client in self._clients.values():
            self._observer.destroy_client(client)

    def _ask(self, name: str) -> None:
        if name not in self._clients:
            self._clients[name] = self._observer.create_client(GetParameters, name + SERVICE)
        now, client = time.monotonic(), self._clients[name]
        if client.service_is_ready() and now > self._asked_at.get(name, 0.0) + REPEAT_S:
            self._asked_at[name] = now
            client.call_async(GetParameters.Request()).add_done_callback(
                lambda _: self.answered.add(name))

    def _nodes(self) -> Iterator[str]:
        """Return the nodes of the graph that tell their parameters, by what only each has."""
        return (name[:-len(SERVICE)] for name, _ in self._observer.get_service_names_and_types()
                if name.endswith(SERVICE))

    def _gids(self, topics: List[str], heard: bool) -> Iterator[Gid]:
        """Return what identifies each end of some topics."""
        look = (self._observer.get_subscriptions_info_by_topic if heard
                else self._observer.get_publishers_info_by_topic)
        return (tuple(end.endpoint_gid) for topic in topics for end in look(topic))
