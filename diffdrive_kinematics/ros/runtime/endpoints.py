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

"""Publishers and subscriptions of a node, with the quality of service that its YAML asks for."""

from typing import Any, Callable, Optional, Set

from diffdrive_kinematics.ros.parameters.configuration_error import ConfigurationError, refusing
from diffdrive_kinematics.ros.parameters.qos import (
    check_delivery, overrides_from, overriding_options, reliable)
from diffdrive_kinematics.ros.runtime.rclpy_private import given_overrides, RCLError
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile
from rclpy.subscription import Subscription

QUEUE_DEPTH = 10


class Endpoints:
    """
    Makes publishers and subscriptions, each topic once: no node hears itself.

    Parameters
    ----------
    node : Node
        Whose endpoints they are.
    depth : int
        Of queues where no profile says otherwise.
    lossless : bool
        Whether overrides under which a message might not arrive are refused.

    Raises
    ------
    ConfigurationError
        If overrides of quality of service are no such ones.

    """

    def __init__(self, node: Node, depth: int = QUEUE_DEPTH, *, lossless: bool = False) -> None:
        self._node, self._depth, self._lossless = node, depth, lossless
        self._topics: Set[str] = set()
        given = {name: parameter.value for name, parameter in given_overrides(node).items()}
        self._name = node.get_fully_qualified_name()
        with refusing(self._name):
            self._overrides = overrides_from(given)

    def publisher(
            self, message_type: type, topic: str, profile: Optional[QoSProfile]) -> Publisher:
        """Return a publisher, reliable where no profile says otherwise."""
        return self._made(self._node.create_publisher, message_type, topic, 'publisher', profile)

    def subscription(
            self, message_type: type, topic: str, callback: Callable[..., None],
            profile: Optional[QoSProfile] = None, *, raw: bool) -> Subscription:
        """Return a subscription; ``raw`` hands the callback serialised messages."""
        return self._made(
            lambda message_type, topic, profile, **options: self._node.create_subscription(
                message_type, topic, callback, profile, raw=raw, **options),
            message_type, topic, 'subscription', profile)

    def keeps_depth(self, topic: str) -> bool:
        """Return whether a subscription has the queue that it is given."""
        overrides = self._overrides.get((self._node.resolve_topic_name(topic), 'subscription'), ())
        return not any(override.policy in ('depth', 'history') for override in overrides)

    def destroy(self, subscription: Subscription) -> None:
        """Destroy a subscription."""
        self._topics.discard(subscription.topic_name)
        self._node.destroy_subscription(subscription)

    def _made(
            self, create: Callable[..., Any], message_type: type, topic: str, end: str,
            profile: Optional[QoSProfile]) -> Any:
        """Return what ``create`` makes of a type, a topic and a quality of service."""
        resolved = self._node.resolve_topic_name(topic)
        overrides = self._overrides.get((resolved, end), ())
        with refusing(self._name):
            if self._lossless:
                check_delivery(overrides, self._depth)
            if resolved in self._topics:
                raise ValueError(
                    f"it would hear itself on '{resolved}', expected different topics in and out")
        try:
            endpoint = create(message_type, topic, profile or reliable(self._depth),
                              qos_overriding_options=overriding_options(overrides))
        except RCLError as error:
            raise ConfigurationError(
                f"{self._name} refuses to start: '{resolved}' cannot carry "
                f'{message_type.__name__}, is it another type elsewhere in this process? ({error})'
            ) from error
        self._topics.add(resolved)
        return endpoint
