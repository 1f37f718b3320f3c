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

from typing import Dict, List, Optional, Set

from diffdrive_kinematics.ros.messages.messages import nanoseconds
from diffdrive_kinematics.testing.lockstep import IDLE_QOS, IDLE_TOPIC
from rclpy.node import Node
from std_msgs.msg import Header

__all__ = ['Acknowledgements']


class Acknowledgements:
    """
    The time that each node acknowledged last, and the topics that it has.

    Parameters
    ----------
    observer : Node
        Node of the test.

    """

    def __init__(self, observer: Node) -> None:
        self._times_ns: Dict[str, int] = {}
        self._ends: Dict[str, List[List[str]]] = {}  # topics of each: heard, published
        observer.create_subscription(Header, IDLE_TOPIC, self._on_idle, IDLE_QOS)

    def of(self, name: str) -> Optional[int]:
        """Return the time [ns] that a node acknowledged last."""
        return self._times_ns.get(name)

    def forget_all_but(self, known: Set[str]) -> None:
        """Forget nodes that have ended, as one of the name may come."""
        self._times_ns = {name: self._times_ns[name] for name in known & {*self._times_ns}}

    def newcomer(self, known: Set[str], now_ns: int) -> str:
        """Return a node that is not known and has acknowledged the time; empty: there is none."""
        return next((name for name, time_ns in self._times_ns.items()
                     if name not in known and time_ns == now_ns), '')

    def ends_of(self, name: str) -> List[List[str]]:
        """Return the topics to which a node listens, and those that it publishes."""
        return self._ends[name]

    def _on_idle(self, message: Header) -> None:
        name, *ends = message.frame_id.split(' ')
        self._ends[name] = [[topic for topic in each.split(',') if topic] for each in ends]
        self._times_ns[name] = nanoseconds(message.stamp)
