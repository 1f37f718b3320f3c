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
Time of a node: its clock, timers that a step of the wall clock cannot stall, and stepped time.

A :class:`SteppedClock` is shared by all nodes of a process: time moves when it is told to, and
timers fire in the order in which they were made, so that a run gives the same numbers every time.
"""

import time
from typing import Callable, List, Optional

from rclpy.clock import Clock, ROSClock
from rclpy.clock_type import ClockType
from rclpy.time import Time
from rclpy.time_source import TimeSource

__all__ = ['NANOSECONDS', 'StepWatch', 'SteppedClock', 'period_ns']

NANOSECONDS = 1_000_000_000
STEP_TOLERANCE_NS = NANOSECONDS


def period_ns(rate: float) -> int:
    """Return the period [ns] of a rate [Hz]."""
    return max(1, round(NANOSECONDS / rate))


class SteppedTimer:
    """A timer of a stepped clock, with the part of rclpy's Timer that nodes use."""

    def __init__(self, clock: 'SteppedClock', period_ns: int, callback: Callable[[], None]):
        self._clock = clock
        self.callback = callback
        self.timer_period_ns = period_ns
        self.next_ns = clock.now_ns() + period_ns

    def reset(self) -> None:
        """Start the period anew from now."""
        self.next_ns = self._clock.now_ns() + self.timer_period_ns

    def cancel(self) -> None:
        """Never fire again."""
        self._clock.timers.remove(self)


class SteppedClock:
    """A ROS clock whose time is set step by step, and the timers that run on it."""

    def __init__(self) -> None:
        self.ros_clock = ROSClock()
        source = TimeSource()  # without a node: it listens to nobody
        source.attach_clock(self.ros_clock)
        source.ros_time_is_active = True
        self.timers: List[SteppedTimer] = []
        self._now_ns = 0

    def now_ns(self) -> int:
        """Return the time [ns]."""
        return self._now_ns

    def advance_to(self, time_ns: int) -> None:
        """Set the time [ns]; due timers are for :meth:`due` to find."""
        self._now_ns = time_ns
        self.ros_clock.set_ros_time_override(
            Time(nanoseconds=time_ns, clock_type=ClockType.ROS_TIME))

    def due(self) -> List[SteppedTimer]:
        """Return the timers that are due now, in the order in which they were made."""
        return [timer for timer in self.timers if timer.next_ns <= self._now_ns]

    def fire(self, timer: SteppedTimer) -> None:
        """Call a timer back; periods that were missed are skipped, as rcl does."""
        missed = (self._now_ns - timer.next_ns) // timer.timer_period_ns
        timer.next_ns += (missed + 1) * timer.timer_period_ns
        timer.callback()

    def create_timer(self, period: int, callback: Callable[[], None]) -> SteppedTimer:
        """Return a new timer with a period [ns]."""
        timer = SteppedTimer(self, period, callback)
        self.timers.append(timer)
        return timer


class StepWatch:
    """Notices that a clock was stepped, by comparing it with the steady clock."""

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._steady_ns: Optional[int] = None
        self._last_ns = 0

    def step_since_last(self, now_ns: int) -> int:
        """
        Return by how much [ns] the clock was stepped since the last call, 0 where it was not.

        Simulated time has a pace of its own: there only a jump back counts.
        """
        if self._clock.ros_time_is_active:
            step, self._steady_ns = min(0, now_ns - self._last_ns), None
        else:
            steady = time.monotonic_ns()
            known = self._steady_ns is not None
            step = now_ns - self._last_ns - (steady - self._steady_ns) if known else 0
            step = step if abs(step) > STEP_TOLERANCE_NS else 0
            self._steady_ns = steady
        self._last_ns = now_ns
        return step
