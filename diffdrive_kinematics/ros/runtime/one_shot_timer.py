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

"""A timer that calls back once, at a time that is set anew each time."""

from typing import Callable, Optional

from diffdrive_kinematics.ros.runtime.runtime import Runtime

SELDOM = 1e-6  # [Hz], the rate of a timer that is not set
UNKNOWN_NS = -1


class OneShotTimer:
    """
    Calls back once, when the clock of a node shows a time.

    Parameters
    ----------
    runtime : Runtime
        Of the node.
    callback : callable
        What to call.  It sets the timer again, to None where nothing is due any more.

    """

    def __init__(self, runtime: Runtime, callback: Callable[[], None]) -> None:
        self._runtime, self._callback = runtime, callback
        self._time_ns: Optional[int] = None
        self._timer = runtime.every(SELDOM, self._fire)
        self._unset_ns = self._timer.timer_period_ns

    def set_to(self, time_ns: Optional[int]) -> None:
        """Call back at a time [ns]; None: not any more."""
        if time_ns == self._time_ns:
            return
        self._time_ns = time_ns
        self._timer.timer_period_ns = self._unset_ns if time_ns is None else max(
            1, time_ns - self._runtime.now_ns())
        self._timer.reset()

    def _fire(self) -> None:
        self._time_ns = UNKNOWN_NS  # the timer goes on with its period until it is set
        self._callback()
