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
:class:`SteadyTimers` are shared alike in real time.
"""

import time
from typing import Callable, List, Optional, Tuple

from diffdrive_kinematics.core.kinematics import NANOSECONDS
from diffdrive_kinematics.ros.runtime.rclpy_private import simulation_of, time_of
from rclpy.clock import Clock, ROSClock
from rclpy.clock_type import ClockType
from rclpy.time import Time
from rclpy.time_source import TimeSource

FORWARD_NS = NANOSECONDS  # up to which time may pass that the steady clock does not count
BACK_NS = 5_000_000  # up to which the two are read apart
SLEWED = 10  # a clock is slewed by a part of time, of which a second counts
NEVER_NS = 2**63 - 1


def period_ns(rate: float) -> int:
    """Return the period [ns] of a rate [Hz]."""
    return max(1, round(NANOSECONDS / rate))


class Timer:
    """A timer of the package's own, with the part of rclpy's Timer that nodes use."""

    def __init__(self, timers: 'Timers', period_ns: int, callback: Callable[[], None]) -> None:
        self._timers = timers
        self.callback = callback
        self.timer_period_ns = period_ns
        self.next_ns = timers.now_ns() + period_ns

    def reset(self) -> None:
        """Start the period anew from now."""
        self.next_ns = self._timers.now_ns() + self.timer_period_ns
        self._timers.expect(self.next_ns)

    def cancel(self) -> None:
        """Never fire again."""
        if self in self._timers.timers:
            self._timers.timers.remove(self)
        self.next_ns = NEVER_NS


class Timers:
    """Timers that fire in the order in which they were made."""

    def __init__(self) -> None:
        self.timers: List[Timer] = []

    def now_ns(self) -> int:
        """Return the time [ns]."""
        raise NotImplementedError

    def create_timer(self, period: int, callback: Callable[[], None]) -> Timer:
        """Return a new timer with a period [ns]."""
        timer = Timer(self, period, callback)
        self.timers.append(timer)
        self.expect(timer.next_ns)
        return timer

    def expect(self, time_ns: int) -> None:
        """Note that a timer is due at a time."""

    def due(self) -> List[Timer]:
        """Return the timers that are due now, in the order in which they were made."""
        now_ns = self.now_ns()
        return [timer for timer in self.timers if timer.next_ns <= now_ns]

    def fire(self, timer: Timer) -> None:
        """
        Call a timer back; periods that were missed are skipped, as rcl does.

        One that another timer has cancelled or reset in the meantime is due no more.
        """
        late_ns = self.now_ns() - timer.next_ns
        if late_ns < 0:
            return
        timer.next_ns += (late_ns // timer.timer_period_ns + 1) * timer.timer_period_ns
        timer.callback()


class SteadyTimers(Timers):
    """
    Timers of a process on the steady clock, fired by the loop that spins its executor.

    A timer of rclpy has a thread that wakes, and that wakes the executor's; these cost nothing
    but the wake-up in which they fire, and timers of one rate fire in the same one.
    """

    def __init__(self) -> None:
        super().__init__()
        self._next_ns = 0
        self._phase_ns = time.monotonic_ns()  # processes that were started apart wake apart

    def now_ns(self) -> int:
        """Return the time [ns]."""
        return time.monotonic_ns()

    def create_timer(self, period: int, callback: Callable[[], None]) -> Timer:
        """Return a new timer with a period [ns], in step with the others of that period."""
        timer = super().create_timer(period, callback)
        timer.next_ns -= (timer.next_ns - self._phase_ns) % period
        self.expect(timer.next_ns)
        return timer

    def expect(self, time_ns: int) -> None:
        """Note that a timer is due at a time."""
        if time_ns < self._next_ns:
            self._next_ns = time_ns

    def seconds_left(self, most: float) -> float:
        """Return the time [s] until the next timer is due, or ``most``."""
        return max(0.0, min(most, (self._next_ns - time.monotonic_ns()) / NANOSECONDS))

    def fire_due(self) -> None:
        """Fire what is due."""
        if time.monotonic_ns() < self._next_ns:
            return
        for timer in tuple(self.timers):
            self.fire(timer)
        self._next_ns = min([timer.next_ns for timer in self.timers], default=NEVER_NS)


class SetBack:
    """How far a simulated clock was set back in all, by the times that it was told."""

    def __init__(self) -> None:
        self.total_ns = self._last_ns = 0

    def note(self, time_ns: int) -> None:
        """Note that the clock is told a time [ns]."""
        self.total_ns += min(0, time_ns - self._last_ns)
        self._last_ns = time_ns


class SteppedClock(Timers):
    """A ROS clock whose time is set step by step, and the timers that run on it."""

    def __init__(self) -> None:
        super().__init__()
        self.ros_clock = ROSClock()
        source = TimeSource()  # without a node: it listens to nobody
        source.attach_clock(self.ros_clock)
        source.ros_time_is_active = True
        self.set_back = SetBack()
        self._now_ns = 0

    def now_ns(self) -> int:
        """Return the time [ns]."""
        return self._now_ns

    def advance_to(self, time_ns: int) -> None:
        """Set the time [ns]; due timers are for :meth:`due` to find."""
        self._now_ns = time_ns
        self.set_back.note(time_ns)
        self.ros_clock.set_ros_time_override(
            Time(nanoseconds=time_ns, clock_type=ClockType.ROS_TIME))


class StepWatch:
    """
    A look at a clock, which notices that it was stepped by comparing it with the steady one.

    It tells ``on_step`` by how much [ns].  A simulated clock is ``set_back`` by what it is told.
    """

    def __init__(
            self, clock: Clock, set_back: SetBack,
            on_step: Callable[[int], None] = lambda step_ns: None) -> None:
        self._on_step = on_step
        self._set_back, self._set_back_ns = set_back, set_back.total_ns
        self._now_ns, self._simulated = time_of(clock), simulation_of(clock)
        self._steady_ns: Optional[int] = None
        self._last_ns = 0

    def now_and_step(self) -> Tuple[int, int]:
        """
        Return the time [ns], and by how much the clock was stepped since the last call.

        A clock that is set back is a step, however little: what is to end would go on for longer.
        Simulated time has a pace of its own: there only a jump back counts.
        """
        if self._simulated():
            now_ns, set_back_ns = self._now_ns(), self._set_back.total_ns
            if self._steady_ns is not None:  # real time until now: from there the step is
                self._set_back_ns = set_back_ns
            step = set_back_ns - self._set_back_ns or min(0, now_ns - self._last_ns)
            self._set_back_ns, self._steady_ns = set_back_ns, None
        else:
            now_ns, steady_ns = time.time_ns(), time.monotonic_ns()
            step = 0
            if self._steady_ns is not None:
                step = now_ns - self._last_ns - (steady_ns - self._steady_ns)
                if -BACK_NS <= step <= FORWARD_NS:
                    step = 0
                elif step < 0:  # unless the process was held up between the two
                    now_ns, steady_ns = time.time_ns(), time.monotonic_ns()
                    passed_ns = steady_ns - self._steady_ns
                    step = now_ns - self._last_ns - passed_ns
                    slack_ns = BACK_NS + min(passed_ns, NANOSECONDS) // SLEWED
                    if -slack_ns <= step <= FORWARD_NS:
                        step = 0
            self._steady_ns = steady_ns
        self._last_ns = now_ns
        if step:
            self._on_step(step)
        return now_ns, step
