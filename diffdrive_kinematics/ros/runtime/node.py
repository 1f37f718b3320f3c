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

"""Base class of the package's nodes: time, parameters, refusals, and an orderly end."""

from collections import Counter
import time
from typing import (
    Any, Callable, Collection, Dict, Generic, Iterator, Mapping, Optional, Sequence, Set, Tuple,
    TypeVar)

from diagnostic_msgs.msg import DiagnosticArray
from diffdrive_kinematics.core.odometry import Verdict
from diffdrive_kinematics.ros.parameters.overrides import given_overrides
from diffdrive_kinematics.ros.parameters.parameter_spec import ParameterSpec
from diffdrive_kinematics.ros.parameters.parameters import ConfigurationError, ParameterSet
from diffdrive_kinematics.ros.parameters.qos import (
    check_delivery, Override, overrides_from, overriding_options, reliable)
from diffdrive_kinematics.ros.runtime.clocks import (
    clock_ns, period_ns, SteadyTimers, SteppedClock, StepWatch, Timer, Timers)
from diffdrive_kinematics.ros.runtime.diagnostics import (
    MessageStatistics, RateSample, Reporter, Status, TOPIC)
from diffdrive_kinematics.ros.runtime.final_command import repeat_until_heard
from diffdrive_kinematics.ros.runtime.in_flight_messages import InFlightMessages
from diffdrive_kinematics.ros.runtime.polling import (
    informing, numbering, Poll, QUEUE_DEPTH as POLLED_QUEUE_DEPTH)
from diffdrive_kinematics.ros.runtime.rejected import checked_clock, rejected
from diffdrive_kinematics.ros.runtime.simulated_clock import ClockWatch
from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rclpy.service import Service
from rclpy.subscription import Subscription
from rclpy.utilities import get_rmw_implementation_identifier
from rosgraph_msgs.msg import Clock as ClockMessage

__all__ = ['DiffDriveNode']

Config = TypeVar('Config')
QUEUE_DEPTH = 10
BEST_EFFORT = QoSProfile(depth=QUEUE_DEPTH, reliability=ReliabilityPolicy.BEST_EFFORT)
STEPPED_QUEUE_DEPTH = 1000  # other processes cannot hold up time that is stepped
REPORT_PERIOD_S = 1.0
MOVED = Verdict.MOVED  # by far the most; an enum is slow to look up
VERDICTS = {  # where it was seen, and what was done
    Verdict.OUT_OF_ORDER: ('stamps', 'dropped'),
    Verdict.CLOCK_STEP: ('stamps', 'nothing integrated'),
    Verdict.JUMPED: ('positions', 'they count anew, max_encoder_rate is exceeded')}
# of a callback that rclpy hands what is known of a message, too
UNREADABLE = (ValueError, OverflowError, rclpy_implementation.RMWError)
HARDWARE = 'robot'  # what a node without a namespace belongs to
# that of Cyclone DDS in Jazzy takes the time at which a message is taken for that of its arrival
NOTES_ARRIVAL = ('rmw_fastrtps_cpp', 'rmw_fastrtps_dynamic_cpp', 'rmw_zenoh_cpp')


class DiffDriveNode(Node, Generic[Config]):
    """
    A node with a parameter table, on real, simulated or stepped time.

    Parameters
    ----------
    name, namespace : str
        Of the node.
    table, build :
        As for ``ParameterSet``.
    stepped : SteppedClock, optional
        Shared clock of a process that steps its time; replaces the node's own.
    timers : SteadyTimers, optional
        Shared timers of a process that fires them itself (``running.spin``); without them, and
        on simulated time, the node has timers of rclpy, and any executor will do.
    in_flight : InFlightMessages, optional
        Counts messages between the nodes of such a process.
    neighbours : collection of str, optional
        Names of all nodes of the process, where it has several.

    Raises
    ------
    ConfigurationError
        If the parameters do not make a configuration.

    """

    def __init__(
            self, name: str, table: Tuple[ParameterSpec, ...],
            build: Callable[[Mapping[str, Any]], Config], *, namespace: str = '',
            stepped: Optional[SteppedClock] = None, in_flight: Optional[InFlightMessages] = None,
            timers: Optional[SteadyTimers] = None, neighbours: Collection[str] = ()) -> None:
        self._polled: Set[Subscription] = set()
        self.needs_wakeup = False  # whether something comes that cannot wait for the next look
        super().__init__(name, namespace=namespace or None)
        self._stepped = stepped
        self._in_flight = in_flight
        self._steady_timers = timers
        self.time_clock: Clock = stepped.ros_clock if stepped else self.get_clock()
        self._step_watch = StepWatch(self.time_clock)
        self._beat: Optional[Timers] = (
            stepped if stepped or self.time_clock.ros_time_is_active else timers)
        self.counts: 'Counter[str]' = Counter()
        self.done = False
        self._topics: Set[str] = set()
        self._qos_overrides = self._judged_overrides()
        self.statistics, self.sent = MessageStatistics(), 0
        self._reporter: Optional[Reporter] = None
        self.parameters: ParameterSet[Config] = ParameterSet(self, table, build, neighbours)
        self._start_diagnostics(self.parameters.values.get('diagnostics_rate', 0.0))
        self._clock_watch: Optional[ClockWatch] = None
        self._watch_clock(())
        self.add_post_set_parameters_callback(self._watch_clock)

    @property
    def config(self) -> Config:
        """Return the configuration in force."""
        return self.parameters.config

    def now_ns(self) -> int:
        """Return the time [ns] on the node's clock."""
        return self._stepped.now_ns() if self._stepped else clock_ns(self.time_clock)

    def now_and_step(self) -> Tuple[int, int]:
        """Return the time [ns], and by how much the clock was stepped since the last call."""
        now_ns, step_ns = self._step_watch.now_and_step()
        if step_ns:
            self.counts['clock steps'] += 1
            self.statistics.clock_stepped(step_ns)
            if self._reporter:
                self._reporter.clock_stepped(step_ns)
            self.get_logger().warning(f'the clock was stepped by {step_ns / 1e9:.3f} s')
        return now_ns, step_ns

    def every(self, rate: float, callback: Callable[[], None]) -> Any:
        """
        Return a timer that calls back at a rate [Hz].

        Real time is kept by the steady clock: a wall clock that is stepped back would stall a
        timer of the node's own clock (rclpy issue 1490).
        """
        if self._beat:
            return self._beat.create_timer(period_ns(rate), callback)
        self.needs_wakeup = True
        clock = self.time_clock
        if not clock.ros_time_is_active:
            clock = Clock(clock_type=ClockType.STEADY_TIME)
        return self.create_timer(period_ns(rate) / 1e9, callback, clock=clock)

    def steadily(self, rate: float, callback: Callable[[], None]) -> Any:
        """Return a timer that calls back at a rate [Hz] although a simulated clock stands."""
        if self._stepped or not self.time_clock.ros_time_is_active:
            return self.every(rate, callback)
        if self._steady_timers:
            return self._steady_timers.create_timer(period_ns(rate), callback)
        return self.create_timer(
            period_ns(rate) / 1e9, callback, clock=Clock(clock_type=ClockType.STEADY_TIME))

    def waits_for_clock(self) -> bool:
        """Return whether the node is on simulated time that has not begun: nothing may move."""
        return self._clock_watch is not None and not clock_ns(self.time_clock)

    def clock_stands(self) -> bool:
        """Return whether a simulated clock has stood for longer than it does as it goes on."""
        return self._clock_watch is not None and self._clock_watch.stands()

    def on_clock_look(self, stood_s: float) -> None:
        """Do what a simulated clock that has stood for so long [s] cannot bring about."""

    def _watch_clock(self, _: object) -> None:
        """Look at the clock from now on where it is a simulated one."""
        if not (self._clock_watch or self._stepped) and self.time_clock.ros_time_is_active:
            self._clock_watch = ClockWatch(self)

    def retimed(self, timer: Any, rate: float, callback: Callable[[], None]) -> Any:
        """Return the timer, or one in its place where it has another rate [Hz]."""
        if timer.timer_period_ns == period_ns(rate):
            return timer
        self.stop_timer(timer)
        return self.every(rate, callback)

    def stop_timer(self, timer: Any) -> None:
        """Never let a timer fire again."""
        timer.cancel()
        if not isinstance(timer, Timer):
            self.destroy_timer(timer)

    def source(self) -> str:
        """Return what tells this run of this node from any other."""
        return f'{self.get_fully_qualified_name()}#{time.time_ns():x}'

    def publisher(
            self, message_type: type, topic: str,
            profile: Optional[QoSProfile] = None) -> Publisher:
        """Return a publisher, reliable where no profile says otherwise."""
        publisher = self._endpoint(
            self.create_publisher, message_type, topic, 'publisher', profile)
        if self._in_flight:
            self._in_flight.count_sent(publisher, self.get_fully_qualified_name())
        return publisher

    def sender(self, publisher: Publisher) -> Callable[[Any], None]:
        """Return what publishes messages, serialised or not."""
        return lambda message: publisher.publish(message)

    def create_subscription(
            self, msg_type: type, topic: str, callback: Callable[[Any], None], *arguments: Any,
            **options: Any) -> Subscription:
        """Return a subscription; that of ``/clock``, which rclpy makes by itself, is guarded."""
        if msg_type is ClockMessage:
            callback = self._guarded(topic, checked_clock(callback))
        return super().create_subscription(msg_type, topic, callback, *arguments, **options)

    def subscribe(
            self, message_type: type, topic: str, callback: Callable[[Any], None], *,
            raw: bool = False, best_effort: bool = False, needs_wakeup: bool = True,
            informed: bool = False, numbered: bool = False) -> Subscription:
        """
        Return a reliable subscription; ``raw`` hands the callback serialised messages.

        One that is ``informed`` gets, as a second argument, what the middleware knows of them.

        What is not ``needs_wakeup`` may wait for a tenth of a second (see ``running.spin``).

        With ``best_effort`` it hears publishers of either kind: trackers offer no more than that.

        ``numbered`` hands the callback the number of a message among those of its publisher as
        well (0: unknown; so where time is stepped).

        A ``ValueError`` of the callback refuses the message: it is counted and reported, and
        the node lives on.
        """
        self.needs_wakeup = self.needs_wakeup or needs_wakeup
        guarded = self._guarded(topic, callback)
        if self._in_flight:
            guarded = self._in_flight.counted(self.resolve_topic_name(topic), guarded)
        hear = guarded
        if informed:
            hear = informing(guarded)
        elif numbered:
            hear = numbering(guarded, stepped=bool(self._stepped))
        return self._endpoint(
            lambda message_type, topic, profile, **options: self.create_subscription(
                message_type, topic, hear, profile, raw=raw, **options),
            message_type, topic, 'subscription', BEST_EFFORT if best_effort else None)

    def poll(
            self, message_type: type, topic: str,
            callback: Callable[[bytes, int, int], None]) -> Poll:
        """
        Return what hands serialised messages on when it is asked to; see :class:`Poll`.

        They are handed on as they come where the process does not fire timers by itself, where
        the YAML has a queue of its own, which may be too shallow to wait, and where it would not
        be known when they came.
        """
        if not (isinstance(self._beat, SteadyTimers) and self._keeps_enough(topic)
                and get_rmw_implementation_identifier() in NOTES_ARRIVAL):
            self.subscribe(message_type, topic, lambda data, number: callback(data, 0, number),
                           raw=True, numbered=True)
            return Poll(self, callback)
        subscription = self._endpoint(
            lambda message_type, topic, profile, **options: self.create_subscription(
                message_type, topic, _nobody, profile, raw=True, **options),
            message_type, topic, 'subscription', reliable(POLLED_QUEUE_DEPTH))
        self._polled.add(subscription)
        return Poll(self, self._guarded(topic, callback), subscription)

    def _keeps_enough(self, topic: str) -> bool:
        """Return whether a subscription has the queue that it is given."""
        overrides = self._qos_overrides.get((self.resolve_topic_name(topic), 'subscription'), ())
        return not any(override.policy in ('depth', 'history') for override in overrides)

    @property
    def subscriptions(self) -> Iterator[Subscription]:
        """Return the subscriptions that an executor is to look after."""
        return (each for each in super().subscriptions if each not in self._polled)

    def _guarded(self, topic: str, callback: Callable[..., None]) -> Callable[..., None]:
        """Return a callback that refuses what it cannot read: counted, reported, survived."""
        def guarded(*message: Any) -> None:
            try:
                callback(*message)
            except UNREADABLE as error:
                self.refuse(f"message on '{topic}': {error}")

        return guarded

    def create_service(
            self, srv_type: type, srv_name: str, callback: Callable[[Any, Any], Any],
            *arguments: Any, **options: Any) -> Service:
        """
        Return a service; ``callback`` fills in the response to a request and returns it.

        A ``ValueError`` of the callback refuses the request: it is counted and reported, and the
        response says why where it can.  So do the services of parameters, which rclpy makes by
        itself, for a value that is of no type.
        """
        def guarded(request: Any, response: Any) -> Any:
            try:
                return callback(request, response)
            except ValueError as error:
                self.refuse(f"request of '{srv_name}': {error}")
                return rejected(request, response, str(error))

        return super().create_service(srv_type, srv_name, guarded, *arguments, **options)

    def _endpoint(
            self, create: Callable[..., Any], message_type: type, topic: str, end: str,
            profile: Optional[QoSProfile] = None) -> Any:
        """Return what ``create`` makes of a type, a topic and a quality of service."""
        depth = STEPPED_QUEUE_DEPTH if self._stepped else QUEUE_DEPTH
        resolved = self.resolve_topic_name(topic)
        overrides = self._qos_overrides.get((resolved, end), ())
        if self._stepped:
            self._refuse_start(check_delivery, overrides, depth)
        if resolved in self._topics:
            raise ConfigurationError(
                f'{self.get_fully_qualified_name()} refuses to start: it would hear itself on '
                f"'{resolved}', expected different topics in and out")
        try:
            endpoint = create(message_type, topic, profile or reliable(depth),
                              qos_overriding_options=overriding_options(overrides))
        except rclpy_implementation.RCLError as error:
            raise ConfigurationError(
                f"{self.get_fully_qualified_name()} refuses to start: '{resolved}' cannot carry "
                f'{message_type.__name__}, is it another type elsewhere in this process? '
                f'({error})') from error
        self._topics.add(resolved)
        return endpoint

    def _judged_overrides(self) -> Dict[Tuple[str, str], Tuple[Override, ...]]:
        """Return the overrides of quality of service that the YAML has."""
        given = given_overrides(self)
        return self._refuse_start(
            overrides_from, {name: parameter.value for name, parameter in given.items()})

    def _refuse_start(self, judge: Callable[..., Any], *arguments: Any) -> Any:
        """Return what ``judge`` returns; its ``ValueError`` refuses the start."""
        try:
            return judge(*arguments)
        except ValueError as error:
            raise ConfigurationError(
                f'{self.get_fully_qualified_name()} refuses to start: {error}') from error

    def unsubscribe(self, subscription: Subscription) -> None:
        """Destroy a subscription."""
        if self._in_flight:
            self._in_flight.remove_listener(subscription.topic_name)
        self._topics.discard(subscription.topic_name)
        self.destroy_subscription(subscription)

    def _start_diagnostics(self, rate: float) -> None:
        if rate:
            self._reporter = Reporter(
                self.get_fully_qualified_name(), self.get_namespace().strip('/') or HARDWARE,
                self.publisher(DiagnosticArray, TOPIC))
            self.steadily(rate, self._report)

    def _report(self) -> None:
        """Publish how the node is."""
        look = self._reporter.look(self.now_ns(), self.sent)
        values, problems = self.status(look)
        if self._clock_watch and self.time_clock.ros_time_is_active:
            problems = [*self._clock_watch.problems(), *problems]
        self._reporter.report(look.now_ns, Status(
            {**values, 'refused': self.counts['refused'],
             'clock steps': self.counts['clock steps']}, problems))

    def status(self, look: RateSample) -> Status:
        """Return what only this node can tell about its health."""
        return Status({}, [])

    def refuse(self, reason: str) -> None:
        """Count and report what was refused; at most one report a second."""
        self.counts['refused'] += 1
        self.get_logger().error(
            f"refused {reason} ({self.counts['refused']} so far)",
            throttle_duration_sec=REPORT_PERIOD_S)

    def judge(self, verdict: Verdict, topic: str) -> None:
        """Count and report wheel motion that was not taken as it came."""
        if verdict is not MOVED and verdict in VERDICTS:
            what, done = VERDICTS[verdict]
            self.counts[verdict.value] += 1
            self.get_logger().warning(
                f"{verdict.value} in the {what} of '{topic}' "
                f'({self.counts[verdict.value]} so far): {done}',
                throttle_duration_sec=REPORT_PERIOD_S)

    def ready(self) -> bool:
        """Return whether the node has all it can have before time begins to pass."""
        return True

    def final_command(self) -> Sequence[Publisher]:
        """Publish what must be said before the node goes, and return the publishers used."""
        return ()

    def close(self) -> None:
        """Say the last word, and see that it is heard; called once, while it still can be said."""
        if self._stepped:
            self.final_command()
        else:
            repeat_until_heard(self, self.final_command)


def _nobody(_: bytes) -> None:
    """Be the callback of a subscription that no executor calls back."""
