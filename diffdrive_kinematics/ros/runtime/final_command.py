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
The final command of a node that ends, repeated until it has arrived.

A publisher that goes takes along what has not arrived.  DDS asks for acknowledgement at its next
heartbeat, up to 3 s later, or as soon as a queue is full: so the command is repeated until it is
acknowledged, slowly enough to push nothing out of the reader's queue.  Who listens best-effort
never acknowledges: there it is sent three times.
"""

import time
from typing import Callable, Sequence

from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import HistoryPolicy, ReliabilityPolicy

HEARTBEAT_S = 3.0  # the longest that DDS waits before it asks for acknowledgement
PERIOD_S = 0.02
BEST_EFFORT_SENDS = 3  # how often it is sent where nobody acknowledges
FEWEST_SENDS = 10


def repeat_until_acknowledged(node: Node, publish: Callable[[], Sequence[Publisher]]) -> None:
    """Call ``publish``, which returns the publishers it used, until all subscribers have it."""
    publishers = publish()
    if any(_has_best_effort_subscriber(node, publisher) for publisher in publishers):
        for _ in range(BEST_EFFORT_SENDS - 1):
            time.sleep(PERIOD_S)
            publish()
        time.sleep(PERIOD_S)  # the last of them has to arrive, too
    period = Duration(seconds=PERIOD_S)
    for _ in range(max(map(_sends_to_fill, publishers), default=0)):
        if all(publisher.wait_for_all_acked(period) for publisher in publishers):
            return
        publish()
    if publishers:
        node.get_logger().warning('the final command of this node was not acknowledged')


def _has_best_effort_subscriber(node: Node, publisher: Publisher) -> bool:
    """Return whether a subscriber, or another end of the topic, is best-effort."""
    return any(
        end.qos_profile.reliability is ReliabilityPolicy.BEST_EFFORT
        for listener in node.get_subscriptions_info_by_topic(publisher.topic_name)
        for end in (listener, *node.get_publishers_info_by_topic(publisher.topic_name)))


def _sends_to_fill(publisher: Publisher) -> int:
    """Return how many messages fill the queue, or last for two heartbeats if that is sooner."""
    profile = publisher.qos_profile
    most = round(2.0 * HEARTBEAT_S / PERIOD_S)
    if profile.history is not HistoryPolicy.KEEP_LAST:
        return most
    return min(most, max(FEWEST_SENDS, profile.depth))
