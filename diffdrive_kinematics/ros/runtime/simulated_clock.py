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
A look at the simulated clock of a node by the steady one: whether it has begun, and goes on.

A clock that stands fires no timer of the node's: what has to be done nevertheless is done here.
"""

from collections import deque
import time
from typing import Any, Callable, Deque, List

from diffdrive_kinematics.ros.runtime.diagnostics import Problem, WARN
from diffdrive_kinematics.ros.runtime.runtime import Runtime

LOOK_RATE = 10.0  # [Hz]
REPORT_PERIOD_S = 5.0
PAUSE_S = 2.0  # for which a clock may stand and be well
STANDS_S = 0.2  # beyond which it stands, where it is told more often than that
PACES = 3.0  # and otherwise in what it took between two times
REMEMBERED = 5  # of such times
WAITING = 'waiting for /clock, use_sim_time is true'


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
