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

from collections import deque
import time
from typing import Any, Callable, Deque, List, Optional

from diffdrive_kinematics.ros.runtime.clocks import SetBack, StepWatch
from diffdrive_kinematics.ros.runtime.diagnostics import Problem, WARN
from diffdrive_kinematics.ros.runtime.runtime import Runtime

LOOK_RATE = 10.0  # [Hz]
REPORT_PERIOD_S = 5.0
PAUSE_S = 2.0  # for which a clock may stand and be well
STANDS_S = 0.2  # beyond which it stands, where it is told more often than that
PACES = 3.0  # and otherwise in what it took between two times
REMEMBERED = 5  # of such times
WAITING = 'waiting for /clock, use_sim_time is true'


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
            self._watch = ClockWatch(
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

    def problems(self) -> List[Problem]:
        """Return what is wrong with a simulated clock, for diagnostics."""
        if self._watch and self._runtime.clock.ros_time_is_active:
            return self._watch.problems()
        return []


class ClockWatch:
    """
    Looks at the clock of a node ten times a second.

    Parameters
    ----------
    runtime, logger :
        Of the node.
    on_look : callable
        Called at each look with the time [s] for which the clock has stood.

    """

    def __init__(self, runtime: Runtime, logger: Any, on_look: Callable[[float], None]) -> None:
        self._runtime, self._logger, self._on_look = runtime, logger, on_look
        self._shown_ns = runtime.now_ns()
        self._since = self._report_at = time.monotonic()
        self._reported = False
        self._stood_s = 0.0
        self._paces: Deque[float] = deque([0.0] * REMEMBERED, maxlen=REMEMBERED)
        runtime.every(LOOK_RATE, self._look, steadily=True)

    def stood_s(self) -> float:
        """Return the time [s] on the steady clock since the node's was last seen to move."""
        now_ns, now = self._runtime.now_ns(), time.monotonic()
        if now_ns != self._shown_ns:
            self._paces.append(self._stood_s)
            self._shown_ns, self._since, self._reported = now_ns, now, False
        self._stood_s = now - self._since
        return self._stood_s

    def stands(self) -> bool:
        """
        Return whether the node's clock has stood for longer than it does between two times.

        The longest of the last ones but one counts: a pause is not the pace of a clock.
        """
        pace_s = sorted(self._paces)[-2]
        return self.stood_s() > max(STANDS_S, min(PACES * pace_s, PAUSE_S))

    def problems(self) -> List[Problem]:
        """Return what is wrong with the clock."""
        stood_s = self.stood_s()
        if not self._shown_ns:
            return [Problem(WARN, WAITING)]
        return [Problem(WARN, self._standing(stood_s))] if stood_s > PAUSE_S else []

    def _look(self) -> None:
        stood_s = self.stood_s()
        if not self._shown_ns:
            if time.monotonic() >= self._report_at + REPORT_PERIOD_S:
                self._report_at += REPORT_PERIOD_S
                self._logger.warning(WAITING)
        elif stood_s > REPORT_PERIOD_S and not self._reported:
            self._reported = True
            self._logger.warning(self._standing(stood_s))
        self._on_look(stood_s)

    def _standing(self, stood_s: float) -> str:
        return (f'/clock stands at {self._shown_ns / 1e9:.3f} s for {stood_s:.1f} s now, '
                'use_sim_time is true')
