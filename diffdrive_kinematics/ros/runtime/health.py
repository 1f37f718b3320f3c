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

from typing import Any, Optional

from diagnostic_msgs.msg import DiagnosticArray
from diffdrive_kinematics.ros.runtime.diagnostics import MessageStatistics, Reporter, Status, TOPIC
from diffdrive_kinematics.ros.runtime.simulated_clock import ClockWatch

HARDWARE = 'robot'  # what a node without a namespace belongs to


class Health:
    """
    Counts what a node hears and sends, and publishes how it is.

    Parameters
    ----------
    node : DiffDriveNode
        Whose health it is; its ``status`` says what only it can tell.
    rate : float
        Of reports [Hz]; 0: none.

    """

    def __init__(self, node: Any, rate: float) -> None:
        self._node, self.statistics, self.sent = node, MessageStatistics(), 0
        self.clock: Optional[ClockWatch] = None
        self._reporter: Optional[Reporter] = None
        if rate:
            self._reporter = Reporter(
                node.get_fully_qualified_name(), node.get_namespace().strip('/') or HARDWARE,
                node.runtime.publish(DiagnosticArray, TOPIC))
            node.runtime.every(rate, self._report, steadily=True)

    def clock_stepped(self, step_ns: int) -> None:
        """Note that the clock of the node was stepped."""
        self.statistics.clock_stepped(step_ns)
        if self._reporter:
            self._reporter.clock_stepped(step_ns)

    def _report(self) -> None:
        runtime, counts = self._node.runtime, self._node.counts
        sample = self._reporter.sample(runtime.now_ns(), self.sent)
        values, problems = self._node.status(sample)
        if self.clock and runtime.clock.ros_time_is_active:
            problems = [*self.clock.problems(), *problems]
        self._reporter.report(sample.now_ns, Status({
            **values, **{name: counts[name] for name in ('refused', 'clock steps')}}, problems))
