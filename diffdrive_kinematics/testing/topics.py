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

"""What a test says to a robot and hears of it: its topics and services, and their faults."""

from typing import Any, Dict, List, Set

from diffdrive_kinematics.testing.checks import (
    check_name, check_number, check_type, refuse)
from diffdrive_kinematics.testing.matching import has_subscribers, is_latched
from diffdrive_kinematics.testing.messages import Recorded
from diffdrive_kinematics.testing.nodes import RobotNodes
from diffdrive_kinematics.testing.stepping import Stepping
from rclpy.duration import Duration
from rclpy.qos import DurabilityPolicy, QoSProfile

__all__ = ['Topics']

HEARD_S = 10.0
LASTS = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class Topics:
    """
    The topics and services of a robot, for a test beside it.

    Parameters
    ----------
    nodes : RobotNodes
        The robot.
    stepping : Stepping
        Its time, which waits until what the test says is handled.

    """

    def __init__(self, nodes: RobotNodes, stepping: Stepping) -> None:
        self._observer, self._messages = nodes.observer, nodes.messages
        self._stepping = stepping
        self._publishers: Dict[str, Any] = {}
        self._found: Set[str] = set()  # topics of publishers that have found who listens
        self._clients: Dict[str, Any] = {}

    def history(self, topic: str) -> List[Recorded]:
        """Return all messages of a topic so far, each with its simulated time [s]."""
        return self._messages.history(self._name(topic))

    def listen(self, message_type: type, topic: str) -> None:
        """Keep the messages of a topic to which no node of the robot listens."""
        name = self._name(topic)
        self._check_type('message_type', message_type, name)
        self._messages.add_listener(self._observer.create_subscription(
            message_type, topic, self._messages.counted(name, lambda message: None), 1000,
            raw=True))
        self._messages.know_types(self._observer)
        self._stepping.wait(self._stepping.all_matched, 'be heard', [])

    def publish(self, topic: str, message: Any) -> None:
        """Publish a message; whoever listens in the graph has it before time goes on."""
        name = self._name(topic)
        publisher = self._publishers.get(name)
        if not publisher or type(message) is not publisher.msg_type:
            self._check_type('type of message', type(message), name)
        if name not in self._found:
            publisher = self._found_publisher(name, topic, type(message))
        publisher.publish(message)
        if not publisher.wait_for_all_acked(Duration(seconds=HEARD_S)):
            raise AssertionError(f'who listens to {topic!r} did not get a message in {HEARD_S} s')
        self._stepping.deliver()

    def _found_publisher(self, name: str, topic: str, kind: type) -> Any:
        """Return a publisher that all who listen have found; it keeps what some ask for later."""
        publisher, node = self._publishers.get(name), self._observer
        lasts = is_latched(name, node)
        if publisher and lasts and publisher.qos_profile.durability != LASTS.durability:
            self._messages.forget_publisher(publisher, node.get_fully_qualified_name())
            node.destroy_publisher(publisher)
            publisher = None
        if not publisher:
            publisher = node.create_publisher(kind, topic, LASTS if lasts else 100)
            self._messages.count_sent(publisher, node.get_fully_qualified_name())
            self._publishers[name] = publisher
        self._stepping.wait(
            lambda: publisher.get_subscription_count() and has_subscribers(publisher, node),
            f'find who listens to {topic!r}', [], timeout=HEARD_S)
        self._stepping.rest(silence=True)  # they have found the publisher, too
        self._found.add(name)
        return publisher

    def call(self, service_type: Any, name: str, request: Any) -> Any:
        """Call a service and return its response; it is answered before time goes on."""
        offered = dict(self._observer.get_service_names_and_types())
        full_name = self._observer.resolve_service_name(self._text('name', name))
        check_type('service_type', service_type, offered.get(full_name, []), name)
        if not isinstance(request, service_type.Request):
            refuse('request', request, f'a {service_type.__name__}.Request')
        if name not in self._clients:
            self._clients[name] = self._observer.create_client(service_type, name)
        client = self._clients[name]
        self._stepping.wait(client.service_is_ready, f'offer the service {name!r}', [])
        future = client.call_async(request)
        self._stepping.wait(future.done, f'answer the call of {name!r}', [])
        self._stepping.deliver()
        return future.result()

    def drop(self, topic: str, share: float, *, seed: int = 0) -> None:
        """Lose a share of the messages of a topic from now on, the same ones in every run."""
        share = check_number('share', share, 'from 0 to 1', least=0.0, most=1.0)
        if not isinstance(seed, int):
            refuse('seed', seed, 'an integer')
        self._messages.disturbances.lose(self._known(topic), share, seed)

    def delay(self, topic: str, seconds: float) -> None:
        """Hand the messages of a topic on later from now on, in steps of the clock."""
        seconds = check_number('seconds', seconds, 'from 0 to 1e9 s', least=0.0, most=1e9)
        self._messages.disturbances.delay(self._known(topic), round(seconds * 1e9))

    def _name(self, topic: str, argument: str = 'topic') -> str:
        name: str = self._observer.resolve_topic_name(self._text(argument, topic))
        return name

    def _known(self, topic: str) -> str:
        """Return the resolved name of a topic that passes through the robot, or will."""
        name = self._name(topic)
        if not self._messages.keeps(name) and not self._observer.count_subscribers(name):
            self._messages.history(name)  # tells which there are
        return name

    def _awaited(self, topic: str) -> str:
        """Return the resolved name of a topic of a process that may be waited for."""
        name = self._name(topic, 'wait_for')
        if not self._messages.hears(name):
            refuse('wait_for', topic, 'a topic to which the robot listens, or that the test has '
                   'given to robot.listen before')
        return name

    def _check_type(self, name: str, kind: Any, topic: str) -> None:
        """Refuse a type that is none of messages, or another one than the topic has."""
        known = dict(self._observer.get_topic_names_and_types())
        check_type(name, kind, known.get(topic, []), topic)

    def _text(self, name: str, value: Any) -> str:
        return check_name(name, value, self._observer.get_name())
