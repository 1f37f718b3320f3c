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
Fast mode: time moves in fixed steps, as fast as the nodes of the process can follow.

In each step the timers that are due fire one after the other, in a fixed order, and after each
every message that it caused is handled before anything else happens.  So the numbers do not
depend on how fast the machine is, and are the same every time.  ``/clock`` tells other processes.
Where another one publishes what the nodes say to each other, the drive ends.
"""

import time
from typing import Callable, List

from diffdrive_kinematics.ros.messages.messages import set_stamp
from diffdrive_kinematics.ros.parameters.qos import reliable
from diffdrive_kinematics.ros.runtime.alone import check_alone
from diffdrive_kinematics.ros.runtime.clocks import SteppedClock
from diffdrive_kinematics.ros.runtime.in_flight_messages import InFlightMessages
from diffdrive_kinematics.ros.runtime.node import DiffDriveNode
from diffdrive_kinematics.ros.runtime.running import Stop
from rclpy.executors import Executor
from rosgraph_msgs.msg import Clock

DISCOVERY_TIMEOUT_S = 10.0
DELIVERY_TIMEOUT_S = 5.0
POLL_S = 0.01
LOOK_PERIOD_S = 0.002
LOOK_AROUND_PERIOD_S = 0.05
NAME_TIMEOUT_S = 0.5


class SimClockDriver:
    """
    Steps the clock that the nodes of a process share.

    Parameters
    ----------
    node : DiffDriveNode
        The node that publishes ``/clock``.
    members : list of DiffDriveNode
        The nodes whose time it is.
    stepped, in_flight :
        What the members share.
    step_ns : int
        Length of a step [ns].
    real_time_factor : float
        Simulated seconds a second; 0: as many as the nodes can follow.

    """

    def __init__(
            self, node: DiffDriveNode, members: List[DiffDriveNode], *, stepped: SteppedClock,
            in_flight: InFlightMessages, step_ns: int, real_time_factor: float) -> None:
        self._node, self._members = node, members
        self._stepped, self._in_flight = stepped, in_flight
        self._step_ns, self._factor = step_ns, real_time_factor
        self._publisher = node.runtime.publish(Clock, '/clock', reliable(1))
        self._message = Clock()
        self._steps = 0
        self._began = 0.0
        self._look_at = self._look_around_at = 0.0

    def spin(self, executor: Executor, finished: Callable[[], bool], stop: Stop) -> None:
        """
        Step until finished or asked to stop.

        Raises
        ------
        Disturbed
            If another process publishes to the nodes, or another clock.

        """
        self._discover(executor, stop)
        self._began = time.monotonic()
        while not stop and not finished():
            self._step(executor)
            self._pace(executor, stop)
        self._look_around(patience_s=NAME_TIMEOUT_S)

    def rate(self) -> float:
        """Return the simulated seconds a second so far (the real-time factor)."""
        return self._steps * self._step_ns / 1e9 / max(1e-9, time.monotonic() - self._began)

    def _discover(self, executor: Executor, stop: Stop) -> None:
        """Wait until the members hear each other, or no message would be sure to arrive."""
        deadline = time.monotonic() + DISCOVERY_TIMEOUT_S
        while not stop and time.monotonic() < deadline:
            self._look_around()
            ready = [member.ready() for member in self._members]
            if all(ready) and self._in_flight.matched():
                return
            executor.spin_once(timeout_sec=POLL_S)
        if not stop:
            self._node.get_logger().warning(
                'some topics that are waited for come from other processes: the results depend on '
                'when their messages arrive')

    def _step(self, executor: Executor) -> None:
        self._steps += 1
        self._stepped.advance_to(self._steps * self._step_ns)
        set_stamp(self._message.clock, self._stepped.now_ns())
        self._publisher.publish(self._message)
        if time.monotonic() > self._look_at:
            executor.spin_once(timeout_sec=0)  # services, and messages of other processes
            self._look_at = time.monotonic() + LOOK_PERIOD_S
            if self._look_at > self._look_around_at:
                self._look_around()
        self._in_flight.forget()
        for timer in self._stepped.due():
            self._stepped.fire(timer)
            self._deliver(executor)

    def _look_around(self, *, patience_s: float = 0.0) -> None:
        """Raise ``Disturbed`` where others publish what only this process should."""
        self._look_around_at = time.monotonic() + LOOK_AROUND_PERIOD_S
        own = {**self._in_flight.internal_topics(),
               self._publisher.topic_name: [self._node.get_fully_qualified_name()]}
        check_alone(self._node, own, patience_s=patience_s)

    def _deliver(self, executor: Executor) -> None:
        """Let every message in flight be handled, and all that these cause."""
        deadline = time.monotonic() + DELIVERY_TIMEOUT_S
        while not self._in_flight.settled():
            executor.spin_once(timeout_sec=POLL_S)
            if time.monotonic() > deadline:
                self._node.get_logger().error('a message within the process was lost')
                self._in_flight.forget()

    def _pace(self, executor: Executor, stop: Stop) -> None:
        """Keep to the real time factor."""
        if not self._factor:
            return
        due = self._began + self._steps * self._step_ns / 1e9 / self._factor
        while not stop and (left := due - time.monotonic()) > 0.0:
            executor.spin_once(timeout_sec=min(left, POLL_S))
