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
What a node may ask of the world, and the plain answer: rclpy's own timers and callbacks.

``runtimes.py`` has the two other answers, and decides which of them a node gets.
"""

from typing import Any, Callable, Optional, Sequence, Set

from diffdrive_kinematics.ros.parameters.qos import (
    best_effort as best_effort_profile, latched, reliable)
from diffdrive_kinematics.ros.runtime.clocks import period_ns, Timer
from diffdrive_kinematics.ros.runtime.endpoints import Endpoints, QUEUE_DEPTH
from diffdrive_kinematics.ros.runtime.final_command import repeat_until_acknowledged
from diffdrive_kinematics.ros.runtime.polling import Poll
from diffdrive_kinematics.ros.runtime.rclpy_private import informing, MessageInfo, time_of
from diffdrive_kinematics.ros.runtime.rejections import Rejections
from rclpy.client import Client
from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile
from rclpy.service import Service
from rclpy.subscription import Subscription

SELDOM = 1e-6  # [Hz], the rate of a timer that is not set
UNKNOWN_NS = -1


class Runtime:
    """
    The time, timers, topics, services and clients of a node: all that it asks of the world.

    Here they are rclpy's own timers and callbacks: on real and simulated time, in any executor,
    by any rmw.

    Parameters
    ----------
    node : Node
        That asks.
    rejections : Rejections
        Where what is refused is counted.
    endpoints : Endpoints, optional
        That make its publishers and subscriptions.

    """

    needs_wakeup = False  # whether something comes that cannot wait for a tenth of a second
    is_stepped = False  # whether time waits until all that was sent is handled

    def __init__(
            self, node: Node, rejections: Rejections,
            endpoints: Optional[Endpoints] = None) -> None:
        self._node, self._rejections = node, rejections
        self._endpoints = endpoints or Endpoints(node)
        self._beside: Set[Subscription] = set()
        self.clock = node.get_clock()
        self._time = time_of(self.clock)

    def now_ns(self) -> int:
        """Return the time [ns] on the node's clock."""
        return self._time()

    def every(self, rate: float, callback: Callable[[], None], *, steadily: bool = False) -> Any:
        """
        Return a timer that calls back at a rate [Hz]; ``steadily`` although simulated time stands.

        Real time is kept by the steady clock: a wall clock that is stepped back would stall a
        timer of the node's own clock (rclpy issue 1490).
        """
        self.needs_wakeup = True
        clock = self.clock
        if steadily or not clock.ros_time_is_active:
            clock = Clock(clock_type=ClockType.STEADY_TIME)
        return self._node.create_timer(period_ns(rate) / 1e9, callback, clock=clock)

    def stop_timer(self, timer: Any) -> None:
        """Never let a timer fire again."""
        timer.cancel()
        if not isinstance(timer, Timer):
            self._node.destroy_timer(timer)

    def retimed(self, timer: Any, rate: float, callback: Callable[[], None]) -> Any:
        """Return the timer, or one in its place where it has another rate [Hz]."""
        if timer.timer_period_ns == period_ns(rate):
            return timer
        self.stop_timer(timer)
        return self.every(rate, callback)

    def publish(
            self, message_type: type, topic: str,
            profile: Optional[QoSProfile] = None) -> Publisher:
        """Return a publisher, reliable where no profile says otherwise."""
        return self._endpoints.publisher(message_type, topic, profile)

    def publish_unless_off(self, message_type: type, topic: str) -> Optional[Publisher]:
        """Return a publisher; None where the topic is empty, which is off."""
        return self.publish(message_type, topic) if topic else None

    def listen(
            self, message_type: type, topic: str, callback: Callable[..., None], *,
            raw: bool = False, informed: bool = False, best_effort: bool = False,
            needs_wakeup: bool = True) -> Subscription:
        """
        Return a subscription; a ``ValueError`` of the callback refuses the message.

        Parameters
        ----------
        message_type, topic, callback :
            What to hear, and who does.
        raw : bool
            Whether the callback gets serialised messages.
        informed : bool
            Whether it gets a ``MessageInfo`` as well.
        best_effort : bool
            Whether publishers of either kind are heard; else reliable ones.
        needs_wakeup : bool
            Whether no message may wait for a tenth of a second (see ``running.spin``).

        """
        self.needs_wakeup = self.needs_wakeup or needs_wakeup
        return self._endpoints.subscription(
            message_type, topic, self._guarded(topic, callback, informed),
            best_effort_profile(QUEUE_DEPTH) if best_effort else None, raw=raw)

    def listen_to_any(
            self, message_type: type, topic: str, callback: Callable[[Any], None]) -> None:
        """
        Hear reliable publishers, best-effort ones, and what was latched before the node began.

        DDS joins no reader and writer where the reader asks for more than the writer offers, so
        there is a subscription for each: the callback may get a message several times.  That one
        of them is not joined is nothing to report.
        """
        self.listen(message_type, topic, callback)
        for profile in (latched(), best_effort_profile()):
            self.listen_beside(message_type, topic, callback, profile)

    def listen_beside(
            self, message_type: type, topic: str, callback: Callable[[Any], None],
            profile: Optional[QoSProfile] = None) -> Subscription:
        """
        Return a subscription to a topic that the node may publish or hear already.

        Its messages may wait for a tenth of a second, and time that is stepped does not wait for
        them.
        """
        subscription = self._node.create_subscription(
            message_type, topic, self._rejections.guarded(topic, callback),
            profile or reliable(QUEUE_DEPTH),
            event_callbacks=SubscriptionEventCallbacks(use_default_callbacks=not profile))
        self._beside.add(subscription)
        return subscription

    def _guarded(
            self, topic: str, callback: Callable[..., None],
            informed: bool) -> Callable[..., None]:
        """Return what an executor calls back."""
        guarded = self._rejections.guarded(topic, callback)
        return informing(guarded) if informed else guarded

    def poll(
            self, message_type: type, topic: str,
            callback: Callable[[bytes, MessageInfo], None]) -> Poll:
        """Return what may let serialised messages wait until it is asked to hand them on."""
        self.listen(message_type, topic, callback, raw=True, informed=True)
        return Poll()

    def unlisten(self, subscription: Subscription) -> None:
        """End a subscription."""
        if subscription in self._beside:
            self._beside.remove(subscription)
            self._node.destroy_subscription(subscription)
        else:
            self._endpoints.destroy(subscription)

    def serve(self, service_type: type, name: str, callback: Callable[[Any, Any], Any]) -> Service:
        """
        Return a service; ``callback`` fills in the response to a request and returns it.

        A ``ValueError`` of the callback refuses the request.
        """
        return self._node.create_service(service_type, name, callback)

    def client(self, service_type: type, name: str) -> Client:
        """Return a client of a service."""
        return self._node.create_client(service_type, name)

    def conclude(self, publish: Callable[[], Sequence[Publisher]]) -> None:
        """Have the final command published, and wait until it has arrived."""
        repeat_until_acknowledged(self._node, publish)


class OneShotTimer:
    """
    Calls back once, when the clock of a node shows a time.

    Parameters
    ----------
    runtime : Runtime
        Of the node.
    callback : callable
        What to call.  It sets the timer again, to None where nothing is due any more.

    """

    def __init__(self, runtime: Runtime, callback: Callable[[], None]) -> None:
        self._runtime, self._callback = runtime, callback
        self._time_ns: Optional[int] = None
        self._timer = runtime.every(SELDOM, self._fire)
        self._unset_ns = self._timer.timer_period_ns

    def set_to(self, time_ns: Optional[int]) -> None:
        """Call back at a time [ns]; None: not any more."""
        if time_ns == self._time_ns:
            return
        self._time_ns = time_ns
        self._timer.timer_period_ns = self._unset_ns if time_ns is None else max(
            1, time_ns - self._runtime.now_ns())
        self._timer.reset()

    def _fire(self) -> None:
        self._time_ns = UNKNOWN_NS  # the timer goes on with its period until it is set
        self._callback()
