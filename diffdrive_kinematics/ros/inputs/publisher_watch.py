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

"""Says who publishes what should have one publisher, once where it changes, and while it lasts."""

from typing import Any, List, Optional

from diffdrive_kinematics.ros.runtime.alone import name_of, UNNAMED
from diffdrive_kinematics.ros.runtime.diagnostics import Problem, WARN
from rclpy.subscription import Subscription

LOOK_RATE = 1.0  # [Hz]; a look takes a microsecond where nothing has changed
PATIENCE = 5  # looks for a name that has not come yet


class PublisherNames:
    """
    The names of the nodes that publish a topic.

    That of a newcomer comes a little after its publisher, and later still on a busy machine.

    Parameters
    ----------
    node : DiffDriveNode
        That listens.
    topic : str
        As the node names it.

    """

    def __init__(self, node: Any, topic: str) -> None:
        self._node, self._topic = node, node.resolve_topic_name(topic)
        self._looks = 0

    def look(self, at_least: int = 1) -> Optional[str]:
        """Return all names as a list in words; None: one has not come yet, so look again."""
        names = sorted(map(name_of, self._node.get_publishers_info_by_topic(self._topic)))
        if (UNNAMED in names or len(names) < at_least) and self._looks < PATIENCE:
            self._looks += 1
            return None
        self.forget()
        return ', '.join(names) or 'nodes unknown'

    def forget(self) -> None:
        """Be as patient as at first again: it is about other publishers from now on."""
        self._looks = 0


class PublisherWatch:
    """
    Watches the number of publishers of a topic that should have one.

    Parameters
    ----------
    node : DiffDriveNode
        That listens.
    topic : str
        As the node names it.
    subscription : Subscription
        Of the node; publishers of other types, which it does not hear, do not count.
    remedy : str
        What to do about it, in words.

    """

    def __init__(self, node: Any, topic: str, subscription: Subscription, remedy: str) -> None:
        self._node, self._topic, self._remedy = node, node.resolve_topic_name(topic), remedy
        self._count_of, self._names = subscription.get_publisher_count, PublisherNames(node, topic)
        self.count = 0
        self._said, self._problem = 0, ''  # the count that was said last, and the words
        node.runtime.every(LOOK_RATE, self._look)

    def _look(self) -> None:
        before, self.count = self.count, self._count_of()
        if self.count != before:
            self._names.forget()
        if self.count == self._said:
            return
        names = self._names.look(self.count) if self.count > 1 else ''
        if names is None:
            return
        was, self._said = self._said, self.count
        if self.count > 1:
            self._problem = self._words(f' ({names})')
            self._node.get_logger().warning(self._problem)
        elif was > 1:
            self._problem = ''
            self._node.get_logger().info(f"'{self._topic}' has no more than one publisher again")

    def _words(self, names: str = '') -> str:
        return f"{self.count} publishers of '{self._topic}'{names}: {self._remedy}"

    def problems(self) -> List[Problem]:
        """Return what is wrong, for diagnostics."""
        if self.count < 2 or not self._problem:
            return []
        return [Problem(WARN, self._problem if self.count == self._said else self._words())]
