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

"""The clock of a node: the steps that it makes, and whether one that is simulated goes on."""

from typing import Any, Optional

from diffdrive_kinematics.ros.runtime.clocks import SetBack, StepWatch
from diffdrive_kinematics.ros.runtime.simulated_clock import ClockWatch


class NodeTime:
    """
    Looks at the clock of a node: ``now_and_step`` is that of a ``StepWatch``.

    Parameters
    ----------
    node : DiffDriveNode
        Whose clock it is.  Where time is simulated its ``on_clock_look`` is called ten times a
        second, with the time [s] that the clock has stood.
    set_back : SetBack
        How far it was set back, where time is simulated.

    """

    def __init__(self, node: Any, set_back: SetBack) -> None:
        self._node, self._runtime = node, node.runtime
        self.now_and_step = StepWatch(
            node.runtime.clock, set_back, self._on_step).now_and_step
        self._watch: Optional[ClockWatch] = None
        self._watch_clock(())
        node.add_post_set_parameters_callback(self._watch_clock)

    def _watch_clock(self, _: object) -> None:
        """Look at the clock from now on where it is a simulated one."""
        runtime = self._runtime
        if not (self._watch or runtime.is_stepped) and runtime.clock.ros_time_is_active:
            self._watch = self._node.health.clock = ClockWatch(
                runtime, self._node.get_logger(), self._node.on_clock_look)

    def _on_step(self, step_ns: int) -> None:
        """Count and report a step of the clock."""
        self._node.counts['clock steps'] += 1
        self._node.health.clock_stepped(step_ns)
        self._node.get_logger().warning(f'the clock was stepped by {step_ns / 1e9:.3f} s')

    @property
    def is_simulated(self) -> bool:
        """Return whether another process tells the time."""
        return self._watch is not None

    @property
    def is_shared(self) -> bool:
        """Return whether all nodes have this time, as it is simulated: each has its own else."""
        return self._runtime.is_stepped or self._runtime.clock.ros_time_is_active

    def waits_for_clock(self) -> bool:
        """Return whether simulated time has not begun: nothing may move."""
        return self._watch is not None and not self._runtime.now_ns()

    def clock_stands(self) -> bool:
        """Return whether a simulated clock has stood for longer than it does as it goes on."""
        return self._watch is not None and self._watch.stands()
