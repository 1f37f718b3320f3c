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

"""Stepped time, the lean loop, and which runtime a node gets: decided here and nowhere else."""

from typing import Any, Callable, Optional

from diffdrive_kinematics.ros.parameters.qos import reliable
from diffdrive_kinematics.ros.runtime.clocks import period_ns, SteadyTimers, SteppedClock
from diffdrive_kinematics.ros.runtime.endpoints import Endpoints
from diffdrive_kinematics.ros.runtime.in_flight_messages import InFlightMessages
from diffdrive_kinematics.ros.runtime.polling import Poll, QUEUE_DEPTH, QueuePoll
from diffdrive_kinematics.ros.runtime.rclpy_private import (
    HAS_LEAN_PATH, informing, MessageInfo)
from diffdrive_kinematics.ros.runtime.rejections import Rejections
from diffdrive_kinematics.ros.runtime.runtime import Runtime
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile
from rclpy.subscription import Subscription
from rclpy.utilities import get_rmw_implementation_identifier

STEPPED_QUEUE_DEPTH = 1000  # other processes cannot hold up time that is stepped
# that of Cyclone DDS in Jazzy takes the time at which a message is taken for that of its arrival
NOTES_ARRIVAL = ('rmw_fastrtps_cpp', 'rmw_fastrtps_dynamic_cpp', 'rmw_zenoh_cpp')


class SteppedRuntime(Runtime):
    """Time that all nodes of a process share; their messages are counted until handled."""

    is_stepped = True

    def __init__(
            self, node: Any, rejections: Rejections, clock: SteppedClock,
            in_flight: InFlightMessages) -> None:
        super().__init__(node, rejections, Endpoints(node, STEPPED_QUEUE_DEPTH, lossless=True))
        self._stepped, self._in_flight, self.clock = clock, in_flight, clock.ros_clock

    def now_ns(self) -> int:
        """Return the time [ns] that was set."""
        return self._stepped.now_ns()

    def every(self, rate: float, callback: Callable[[], None], *, steadily: bool = False) -> Any:
        """Return a timer of the stepped clock."""
        return self._stepped.create_timer(period_ns(rate), callback)

    def publish(
            self, message_type: type, topic: str,
            profile: Optional[QoSProfile] = None) -> Publisher:
        """Return a publisher whose messages are counted."""
        publisher = super().publish(message_type, topic, profile)
        self._in_flight.count_sent(publisher, self._node.get_fully_qualified_name())
        return publisher

    def listen(
            self, message_type: type, topic: str, callback: Callable[..., None],
            **options: bool) -> Subscription:
        """Return a subscription whose messages are counted until they are handled."""
        subscription = super().listen(message_type, topic, callback, **options)
        self._in_flight.add_listener(subscription)
        return subscription

    def _guarded(
            self, topic: str, callback: Callable[..., None],
            informed: bool) -> Callable[..., None]:
        """Count what is handled; when it was sent and came is not the same in every run."""
        guarded = self._rejections.guarded(topic, callback)
        name = self._node.resolve_topic_name(topic)
        if not informed:
            return self._in_flight.counted(name, guarded)
        return informing(self._in_flight.counted(
            name, lambda message, info: guarded(message, MessageInfo(info.number)),
            informed=True))

    def unlisten(self, subscription: Subscription) -> None:
        """End a subscription."""
        if subscription not in self._beside:
            self._in_flight.remove_listener(subscription)
        super().unlisten(subscription)

    def conclude(self, publish: Callable[[], Any]) -> None:
        """Have the final command published; nothing gets lost."""
        publish()


class LeanRuntime(Runtime):
    """Timers that ``running.spin`` fires, in which wheel motion is taken from its queue."""

    def __init__(self, node: Any, rejections: Rejections, timers: SteadyTimers) -> None:
        super().__init__(node, rejections)
        self._timers = timers
        self._on_real_time = not self.clock.ros_time_is_active

    def every(self, rate: float, callback: Callable[[], None], *, steadily: bool = False) -> Any:
        """Return a timer of the loop; one of rclpy's where it is to follow simulated time."""
        if steadily or self._on_real_time:
            return self._timers.create_timer(period_ns(rate), callback)
        return super().every(rate, callback)

    def poll(
            self, message_type: type, topic: str,
            callback: Callable[[bytes, MessageInfo], None]) -> Poll:
        """
        Let messages wait until they are asked for.

        They are handed on as they come on simulated time, where the YAML has a queue of its own,
        which may be too shallow to wait, and where it would not be known when they came.
        """
        if not (self._on_real_time and self._endpoints.keeps_depth(topic)
                and get_rmw_implementation_identifier() in NOTES_ARRIVAL):
            return super().poll(message_type, topic, callback)
        subscription = self._endpoints.subscription(
            message_type, topic, _nobody, reliable(QUEUE_DEPTH), raw=True)
        self._node.polled.add(subscription)
        return QueuePoll(self, self._rejections.guarded(topic, callback), subscription)


def _nobody(_: bytes) -> None:
    """Be the callback of a subscription that no executor calls back."""


def runtime_of(
        node: Any, rejections: Rejections, *, stepped: Optional[SteppedClock] = None,
        in_flight: Optional[InFlightMessages] = None,
        timers: Optional[SteadyTimers] = None) -> Runtime:
    """
    Return the runtime of a node: stepped, lean where this rclpy can, or plain.

    Parameters
    ----------
    node, rejections :
        As for ``Runtime``; the node leaves out those ``polled`` of its subscriptions.
    stepped, in_flight : optional
        Clock and counter that the nodes of a process on stepped time share.
    timers : SteadyTimers, optional
        That the nodes of a process share whose loop fires them.

    """
    if stepped:
        return SteppedRuntime(node, rejections, stepped, in_flight or InFlightMessages())
    if timers and HAS_LEAN_PATH:
        return LeanRuntime(node, rejections, timers)
    return Runtime(node, rejections)
