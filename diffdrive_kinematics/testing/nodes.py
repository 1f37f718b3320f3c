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

"""The nodes of a robot under test: in a context and a domain of their own, on stepped time."""

import math
import os
import tempfile
from typing import Any, Dict, List, Mapping, NamedTuple

from diffdrive_kinematics.nodes.diffdrive_sim import node_class
from diffdrive_kinematics.ros.parameters.from_values import Member
from diffdrive_kinematics.ros.runtime.clocks import SteppedClock
from diffdrive_kinematics.ros.runtime.diagnostics import RateSample
from diffdrive_kinematics.ros.runtime.running import make_executor
from diffdrive_kinematics.testing.composition import Composition
from diffdrive_kinematics.testing.domains import FreeDomain
from diffdrive_kinematics.testing.messages import RecordedMessages
from diffdrive_kinematics.testing.processes import RANGE
import rclpy
from rclpy.signals import SignalHandlerOptions

__all__ = ['RobotNodes', 'State', 'topic_of']

MOTION = {'simulated_base': 'wheel_motion_topic', 'wheel_odometry': 'wheel_motion_topic',
          'wheel_noise': 'output_topic'}


class State(NamedTuple):
    """Where a robot is [m, m, rad] and how it moves [m/s, rad/s]."""

    x: float
    y: float
    yaw: float
    speed: float
    yaw_rate: float

    def distance_to(self, x: float, y: float) -> float:
        """Return the distance [m] to a place."""
        return math.hypot(self.x - x, self.y - y)


class RobotNodes:
    """
    The nodes of a robot, and the node of the test beside them.

    Parameters
    ----------
    made : Composition
        Which nodes, and their parameters.

    """

    def __init__(self, made: Composition) -> None:
        self._members = {_path(member): member for member in made.members}
        self._live: Dict[str, Any] = {}
        self._timers: Dict[str, List[Any]] = {}
        self._motion: Dict[str, str] = {}  # topics: of bases what they hear, of noise what it says
        self.executor: Any = None
        self._context = rclpy.Context()
        self._range = os.environ.get(RANGE)
        self._domain = FreeDomain()
        self.domain = self._domain.id
        try:
            self._start(made.params)
        except BaseException:
            self.close()
            raise

    def _start(self, params: str) -> None:
        os.environ[RANGE] = 'LOCALHOST'
        with tempfile.NamedTemporaryFile('w', suffix='.yaml') as file:
            file.write(params)
            file.flush()
            rclpy.init(args=['--ros-args', '--params-file', file.name], context=self._context,
                       domain_id=self.domain, signal_handler_options=SignalHandlerOptions.NO)
        self.clock = SteppedClock()
        self.messages = RecordedMessages(self.clock)
        self.observer = rclpy.create_node(
            'diffdrive_test', context=self._context, use_global_arguments=False,
            start_parameter_services=False)
        self.messages.count_publishers = self.observer.count_publishers
        self.executor = make_executor([self.observer])
        for member in self._members.values():
            self._add(member)

    def _add(self, member: Member) -> None:
        timers = list(self.clock.timers)
        node = node_class(member.kind)(
            member.name, namespace=member.namespace, context=self._context,
            stepped=self.clock, in_flight=self.messages,
            neighbours=[each.name for each in self._members.values()])
        self._live[_path(member)] = node
        if member.kind in MOTION:
            self._motion[_path(member)] = topic_of(node, MOTION[member.kind])
        self._timers[_path(member)] = [each for each in self.clock.timers if each not in timers]
        self.messages.know_types(node)
        self.executor.add_node(node)

    def ready(self) -> bool:
        """Return whether the nodes hear each other; topics of processes may come later."""
        own = {publisher.topic_name for publisher in self.messages.publishers}
        awaited = [node.awaited_topics() for node in self._live.values()]
        return self.messages.matched() and own.isdisjoint(set().union(*awaited))

    def of(self, *kinds: str) -> List[Any]:
        """Return the nodes of some kinds that are alive."""
        return [node for path, node in self._live.items() if self._members[path].kind in kinds]

    def state(self, *, noisy: bool) -> State:
        """Return the state of the base that is fed with noise, or of the one that is not."""
        noises = {path for path in self._motion if self._members[path].kind == 'wheel_noise'}
        outputs = {self._motion[path] for path in noises}
        base = min((path for path in self._motion if path not in noises), default='simulated_base',
                   key=lambda path: (self._motion[path] in outputs) != noisy)
        if base not in self._live:  # another one would be a belief for a truth
            raise LookupError(f'no {base} is alive, expected one')
        reading = self._live[base].reading()
        return State(*map(float, reading.pose), *map(float, reading.twist))

    def controller(self) -> Any:
        """Return the first controller that is alive."""
        for node in self.of('diff_drive_controller'):
            return node
        raise LookupError('no diff_drive_controller is alive, expected one')

    def problems(self) -> List[str]:
        """Return what the nodes say is wrong with them, each with the node's name."""
        look = RateSample(self.clock.now_ns())
        return [f'{path} says: {problem.message}' for path, node in self._live.items()
                for problem in node.status(look).problems]

    def kill(self, name: str) -> None:
        """End a node at once, as a crash does."""
        node = self._live.pop(_known(name, self._live))
        for timer in self._timers.pop(name):
            timer.cancel()
        self.messages.forget_node(node)
        self.executor.remove_node(node)
        node.destroy_node()

    def restart(self, name: str) -> None:
        """Start a node again; one that is alive is killed before."""
        member = self._members[_known(name, self._members)]
        if name in self._live:
            self.kill(name)
        self._add(member)

    def close(self) -> None:
        """End everything."""
        for node in self._live.values():
            self.executor.remove_node(node)
            node.destroy_node()
        self._live.clear()
        if self.executor:
            self.executor.shutdown()
            self.observer.destroy_node()
            self.executor = None
        rclpy.try_shutdown(context=self._context)
        if self._range is None:
            os.environ.pop(RANGE, None)
        else:
            os.environ[RANGE] = self._range
        self._domain.close()


def _known(name: str, names: Mapping[str, Any]) -> str:
    if name not in names:
        raise LookupError(f'the node is {name!r}, expected one of {list(names)}')
    return name


def _path(member: Member) -> str:
    """Return the name of a member with its namespace."""
    return f'{member.namespace}/{member.name}'.lstrip('/')


def topic_of(node: Any, parameter: str) -> str:
    """Return the resolved name of a topic that a parameter of a node has."""
    name: str = node.resolve_topic_name(node.get_parameter(parameter).value)
    return name
