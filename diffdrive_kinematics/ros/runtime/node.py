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

"""Base class of the package's nodes: parameters, what they ask of the world, an orderly end."""

import sys
import time
from typing import (
    Any, Callable, Collection, Generic, Iterator, Mapping, Optional, Sequence, Set, Tuple, TypeVar)

from diffdrive_kinematics.core.odometry import ClockStep
from diffdrive_kinematics.ros.parameters.parameter_spec import ParameterSpec, with_ranges
from diffdrive_kinematics.ros.parameters.parameters import ParameterSet
from diffdrive_kinematics.ros.runtime.clocks import SetBack, SteadyTimers, SteppedClock
from diffdrive_kinematics.ros.runtime.diagnostics import Health, RateSample, Status
from diffdrive_kinematics.ros.runtime.in_flight_messages import InFlightMessages
from diffdrive_kinematics.ros.runtime.node_time import NodeTime
from diffdrive_kinematics.ros.runtime.rclpy_private import given_overrides, leave_graph
from diffdrive_kinematics.ros.runtime.rejections import checked_clock, Rejections
from diffdrive_kinematics.ros.runtime.runtimes import runtime_of
from rcl_interfaces.srv import DescribeParameters
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.service import Service
from rclpy.subscription import Subscription
from rosgraph_msgs.msg import Clock

Config = TypeVar('Config')


class _LeavesWhereRefused(type):
    """Makes nodes; one whose start is refused leaves the graph, though its error holds it."""

    def __call__(cls, *arguments: Any, **options: Any) -> Any:
        node = cls.__new__(cls, *arguments, **options)
        try:
            node.__init__(*arguments, **options)
        except BaseException:
            leave_graph(node)
            raise
        return node


class DiffDriveNode(Node, Generic[Config], metaclass=_LeavesWhereRefused):
    """
    A node with a parameter table: its parts, and what nodes may put in place of the defaults.

    ``runtime`` is all that it asks of the world, ``time`` looks at its clock, ``rejections``
    counts what is refused, ``health`` what is heard and sent.  ``wheel_reader`` is told of steps
    of a clock that others share, where a node has one.

    Parameters
    ----------
    name : str
        Of the node.
    table, build :
        As for ``ParameterSet``.
    stepped, in_flight, timers :
        As for ``runtime_of``; what a process shares that spins its nodes itself.  Without them
        any executor will do.
    neighbours : collection of str, optional
        Names of all nodes of the process, where it has several.
    namespace, node_options :
        As for ``rclpy.node.Node``.

    Raises
    ------
    ConfigurationError
        If the parameters do not make a configuration.

    """

    wheel_reader: Any = None

    def __init__(
            self, name: str, table: Tuple[ParameterSpec, ...],
            build: Callable[[Mapping[str, Any]], Config], *,
            stepped: Optional[SteppedClock] = None, in_flight: Optional[InFlightMessages] = None,
            timers: Optional[SteadyTimers] = None, neighbours: Collection[str] = (),
            namespace: Optional[str] = None, **node_options: Any) -> None:
        self.polled: Set[Subscription] = set()  # that no executor is to look after
        self.rejections, self._set_back = Rejections(self), SetBack()
        super().__init__(name, namespace=namespace or None, **node_options)
        self.done = False
        self.runtime = runtime_of(
            self, self.rejections, stepped=stepped, in_flight=in_flight, timers=timers)
        argv = sys.argv if node_options.get('use_global_arguments', True) else []
        self.parameters: ParameterSet[Config] = ParameterSet(
            self, table, build, given_overrides(self), neighbours,
            argv=[*argv, *(node_options.get('cli_args') or ())])
        self.counts = self.rejections.counts
        self.health = Health(self, self.parameters.values.get('diagnostics_rate', 0.0))
        self.time = NodeTime(self, stepped.set_back if stepped else self._set_back)

    @property
    def config(self) -> Config:
        """Return the configuration in force."""
        return self.parameters.config

    def source(self) -> str:
        """Return what tells this run of this node from any other."""
        return f'{self.get_fully_qualified_name()}#{time.time_ns():x}'

    def create_subscription(
            self, msg_type: type, topic: str, callback: Callable[[Any], None], *arguments: Any,
            **options: Any) -> Subscription:
        """Return a subscription; that of ``/clock``, which rclpy makes by itself, is guarded."""
        if msg_type is Clock:
            callback = self.rejections.guarded(topic, checked_clock(callback, self._set_back.note))
        return super().create_subscription(msg_type, topic, callback, *arguments, **options)

    def create_service(
            self, srv_type: type, srv_name: str, callback: Callable[[Any, Any], Any],
            *arguments: Any, **options: Any) -> Service:
        """Return a service that is guarded, as are those of parameters, which rclpy makes."""
        if srv_type is DescribeParameters:
            callback = with_ranges(callback, lambda: self.parameters.table)
        return super().create_service(
            srv_type, srv_name, self.rejections.guarded_service(srv_name, callback), *arguments,
            **options)

    @property
    def subscriptions(self) -> Iterator[Subscription]:
        """Return the subscriptions that an executor is to look after."""
        return (each for each in super().subscriptions if each not in self.polled)

    def synchronised_now(self) -> int:
        """Return the time [ns], with what is known moved along where the clock was stepped."""
        now_ns, step_ns = self.time.now_and_step()
        if step_ns:
            step = ClockStep(step_ns, now_ns)
            if self.wheel_reader and self.time.is_shared:
                self.wheel_reader.clock_stepped(step)
            self.on_clock_step(step)
        return now_ns

    def on_clock_step(self, step: ClockStep) -> None:
        """Move along what is known by the clock, which was stepped."""

    def on_clock_look(self, stood_s: float) -> None:
        """Do what a simulated clock that has stood for so long [s] cannot bring about."""

    def status(self, sample: RateSample) -> Status:
        """Return what only this node knows of its health."""
        return Status({}, [])

    def awaited_topics(self) -> Set[str]:
        """Return the topics that are to be there before time begins to pass, and are not yet."""
        return set()

    def ready(self) -> bool:
        """Return whether the node has all it can have before time begins to pass."""
        return not self.awaited_topics()

    def final_command(self) -> Sequence[Publisher]:
        """Publish the final command of the node, and return the publishers used."""
        return ()

    def close(self) -> None:
        """Have the final command arrive; called once, while it still can be published."""
        self.runtime.conclude(self.final_command)
