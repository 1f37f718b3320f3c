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

"""Whether a simulation is alone: who else publishes what its nodes say to each other."""

from collections import Counter
import time
from typing import List, Mapping, Sequence

from rclpy.node import Node
from rclpy.topic_endpoint_info import TopicEndpointInfo

POLL_S = 0.01
UNNAMED = 'a node without a name'


class Disturbed(Exception):
    """Another process publishes what the nodes of this one say to each other."""


def check_alone(node: Node, own: Mapping[str, Sequence[str]], *, patience_s: float = 0.0) -> None:
    """
    Raise ``Disturbed`` where a topic has another publisher than those of this process.

    Parameters
    ----------
    node : Node
        Any node of this process.
    own : mapping
        Of each topic, the full names of the nodes of its own publishers.
    patience_s : float
        How long [s] to wait for the name of a newcomer; without patience the next look has it.

    """
    for topic, ours in own.items():
        deadline = time.monotonic() + patience_s
        while UNNAMED in (others := _others(node, topic, ours)) and time.monotonic() < deadline:
            time.sleep(POLL_S)
        if others and (patience_s or UNNAMED not in others):
            raise Disturbed(
                f"'{topic}' is published by {' and '.join(others)} of another process too. This "
                'process runs on stepped time, and its results would be wrong: stop the other '
                'process, or give one of them another ROS_DOMAIN_ID or other topic names')


def _others(node: Node, topic: str, ours: Sequence[str]) -> List[str]:
    """Return the full names of the nodes elsewhere that publish a topic."""
    if node.count_publishers(topic) <= len(ours):
        return []
    found = Counter(map(name_of, node.get_publishers_info_by_topic(topic)))
    return sorted(found - Counter(ours))


def name_of(info: TopicEndpointInfo) -> str:
    """Return the full name of the node of an endpoint, or ``UNNAMED`` while it is not known."""
    return UNNAMED if 'UNKNOWN' in info.node_name else (
        f"{info.node_namespace.rstrip('/')}/{info.node_name}")
