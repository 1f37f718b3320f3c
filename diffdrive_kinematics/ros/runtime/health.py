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

"""The health of a node, on ``/diagnostics``."""

from typing import Any, Callable, Optional

from diagnostic_msgs.msg import DiagnosticArray
from diffdrive_kinematics.ros.runtime.diagnostics import (
    MessageStatistics, RateSample, Reporter, Status, TOPIC)
from diffdrive_kinematics.ros.runtime.runtime import Runtime
from diffdrive_kinematics.ros.runtime.simulated_clock import ClockWatch
from rclpy.node import Node

__all__ = ['Health']

HARDWARE = 'robot'  # what a node without a namespace belongs to


class Health:
    """
    Counts what a node hears and sends, and publishes how it is.

    Parameters
    ----------
    node, runtime :
        Whose health it is.
    counts : Counter
        Of what was refused, and of clock steps.
    rate : float
        Of reports [Hz]; 0: none.
    status : callable
        A rate sample -> what only this node can tell.

    """

    def __init__(
            self, node: Node, runtime: Runtime, counts: Any, rate: float,
            status: Callable[[RateSample], Status]) -> None:
        self._runtime, self._counts, self._status = runtime, counts, status
        self.statistics, self.sent = MessageStatistics(), 0
        self.clock: Optional[ClockWatch] = None
        self._reporter: Optional[Reporter] = None
        if rate:
            self._reporter = Reporter(
                node.get_fully_qualified_name(), node.get_namespace().strip('/') or HARDWARE,
                runtime.publish(DiagnosticArray, TOPIC))
            runtime.every(rate, self._report, steadily=True)

    def clock_stepped(self, step_ns: int) -> None:
        """Note that the clock of the node was stepped."""
        self.statistics.clock_stepped(step_ns)
        if self._reporter:
            self._reporter.clock_stepped(step_ns)

    def _report(self) -> None:
        sample = self._reporter.sample(self._runtime.now_ns(), self.sent)
        values, problems = self._status(sample)
        if self.clock and self._runtime.clock.ros_time_is_active:
            problems = [*self.clock.problems(), *problems]
        self._reporter.report(sample.now_ns, Status(
            {**values, 'refused': self._counts['refused'],
             'clock steps': self._counts['clock steps']}, problems))
