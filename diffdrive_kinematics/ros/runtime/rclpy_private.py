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
What the package uses of rclpy beyond its public interface, or that only some versions have.

No other file names any of it.  Each feature is looked for once, when this file is imported.  Where
one is missing, what is public takes its place: rclpy's own timers and callbacks, and
:func:`missing` says what to log.  Only the overrides of parameters have no substitute.
"""

import inspect
from typing import Any, Callable, Mapping, NamedTuple, Optional, Tuple, Type

from diffdrive_kinematics.ros.parameters.configuration_error import ConfigurationError
from rclpy.clock import Clock
from rclpy.executors import Executor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.subscription import Subscription
try:
    from rclpy.impl.implementation_singleton import rclpy_implementation
except ImportError:
    rclpy_implementation = None
try:
    from rclpy.experimental import EventsExecutor
except ImportError:
    EventsExecutor = None


def _has(kind: str, *names: str) -> bool:
    return all(hasattr(getattr(rclpy_implementation, kind, None), name) for name in names)


CAN_TAKE = _has('Subscription', 'take_message')
READS_CLOCK = _has('Clock', 'get_now', 'get_ros_time_override_is_enabled')
HAS_LEAN_PATH = CAN_TAKE and READS_CLOCK
EVENTS_EXECUTOR: Optional[Type[Executor]] = EventsExecutor
# without names of their own they are known by their public base class
RCLError: Type[Exception] = getattr(rclpy_implementation, 'RCLError', RuntimeError)
RMWError: Type[Exception] = getattr(rclpy_implementation, 'RMWError', RuntimeError)
UnknownROSArgsError: Type[Exception] = getattr(
    rclpy_implementation, 'UnknownROSArgsError', RCLError)


def missing() -> str:
    """Return one line on what this rclpy lacks and what is done instead; empty: nothing."""
    lacking = ', no '.join(name for name, present in (
        ('taking of single messages', CAN_TAKE),
        ('quick reading of clocks', READS_CLOCK),
        ('EventsExecutor', EVENTS_EXECUTOR)) if not present)
    return lacking and (
        f'rclpy {_version()} has no {lacking}: its public timers and callbacks are used, which '
        'cost more CPU')


def _version() -> str:
    from importlib.metadata import PackageNotFoundError, version  # a tenth of the own imports
    try:
        return version('rclpy')
    except PackageNotFoundError:
        return 'of unknown version'


def given_overrides(node: Node) -> Mapping[str, Parameter]:
    """
    Return the parameters that were set for a node from outside, by name, declared or not.

    Raises
    ------
    ConfigurationError
        If this rclpy keeps them elsewhere: without them no typo in a params file is noticed, and
        no quality of service that it asks for.

    """
    try:
        return node._parameter_overrides
    except AttributeError:
        raise ConfigurationError(
            f'{node.get_fully_qualified_name()} refuses to start: this rclpy ({_version()}) has '
            'no Node._parameter_overrides, from which typos in params files and qualities of '
            'service are read; expected rclpy 7 (ROS 2 Jazzy), or a newer diffdrive_kinematics'
        ) from None


def time_of(clock: Clock) -> Callable[[], int]:
    """Return what tells the time [ns] of a clock, where it can without objects of ``now()``."""
    if READS_CLOCK:
        handle = clock.handle
        return lambda: handle.get_now().nanoseconds
    return lambda: clock.now().nanoseconds


def simulation_of(clock: Clock) -> Callable[[], bool]:
    """Return what tells whether a ROS clock shows simulated time."""
    if READS_CLOCK:
        return clock.handle.get_ros_time_override_is_enabled
    return lambda: clock.ros_time_is_active


class MessageInfo(NamedTuple):
    """
    What the middleware knows of a message; 0 is unknown.

    Parameters
    ----------
    number : int
        Among the messages of its publisher.
    sent_ns : int
        When it was sent [ns], on the wall clock of its sender.
    received_ns : int
        When it was received [ns], on our wall clock; known where it then waited to be taken.

    """

    number: int = 0
    sent_ns: int = 0
    received_ns: int = 0


UNKNOWN = MessageInfo()
NUMBER, SENT, RECEIVED = (  # what is known of a message that is taken
    'publication_sequence_number', 'source_timestamp', 'received_timestamp')
Taken = Tuple[bytes, Mapping[str, Any]]


def informing(callback: Callable[[Any, MessageInfo], None]) -> Callable[..., None]:
    """
    Return what an executor calls back; the callback also gets what the middleware knows.

    EventsExecutor hands on message and information as one argument, other executors as two.
    """
    def inform(*taken: Any) -> None:
        message, info = taken if len(taken) == 2 else taken[0]
        get = info.get
        callback(message, MessageInfo(get(NUMBER) or 0, get(SENT) or 0))

    inform.__signature__ = inspect.signature(_both)  # type: ignore[attr-defined]
    return inform


def _both(message: Any, info: Mapping[str, Any]) -> None:
    """Show rclpy that a callback wants to know what the middleware knows of a message."""


def taker_of(subscription: Subscription) -> Callable[[], Optional[Taken]]:
    """Return what takes a serialised message from a queue; None: none is there, or in reach."""
    if not CAN_TAKE:
        return lambda: None
    take, kind = subscription.handle.take_message, subscription.msg_type
    return lambda: take(kind, True)


def hand_on(taken: Taken, callback: Callable[[bytes, MessageInfo], None]) -> None:
    """Call back with a message that was taken."""
    message, info = taken
    get = info.get
    callback(message, MessageInfo(get(NUMBER) or 0, get(SENT) or 0, get(RECEIVED) or 0))


def leave_graph(node: Node) -> None:
    """Destroy a node, however far its construction has come."""
    try:
        node.destroy_node()
    except AttributeError:  # rclpy itself did not come to its end
        if hasattr(node, 'handle'):
            node.handle.destroy_when_not_in_use()
