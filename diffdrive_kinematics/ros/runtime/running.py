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
The executor of the package, and how an executable runs and ends, with what errors of rcl mean.

``EventsExecutor`` costs half of ``SingleThreadedExecutor`` per callback, and exists since rclpy
7.1.4.  It must be driven with a finite timeout: without one it can busy-wait and starve its
callbacks.
"""

from contextlib import contextmanager
import gc
import os
import signal
import sys
import time
from typing import Callable, Iterator, List, Mapping, Optional, Sequence

from diffdrive_kinematics.ros.parameters.configuration_error import ConfigurationError
from diffdrive_kinematics.ros.runtime import rclpy_private
from diffdrive_kinematics.ros.runtime.clock_step_guard import ClockStepGuard
from diffdrive_kinematics.ros.runtime.clocks import SteadyTimers
from diffdrive_kinematics.ros.runtime.node import DiffDriveNode
from diffdrive_kinematics.ros.runtime.output import complain, open_stderr
from diffdrive_kinematics.ros.runtime.signals import answer_signals, SIGNALS
import rclpy
from rclpy.exceptions import NameValidationException
from rclpy.executors import Executor, ExternalShutdownException, SingleThreadedExecutor
from rclpy.signals import SignalHandlerOptions

SPIN_TIMEOUT_S = 0.1
ASK_PERIOD_S = 0.1
CONFIGURATION_ERROR = 2
DIRECTORIES = 'ROS_LOG_DIR', 'ROS_HOME', 'HOME'
NO_FILES = '--disable-external-lib-logs'
REMEDY = (
    'set ROS_LOG_DIR to a directory that can be written (Environment= or LogsDirectory= of a '
    f'systemd unit), or ROS_HOME or HOME, or keep no log files: --ros-args {NO_FILES}')
HINTS = {  # to what rcl says of params files, -p and -r
    'Sequence should be of same type':
        'all numbers of a list need the same form: [0.1, 0.0, 4.0], not [0.1, 0, 4]',
    'Error opening YAML file':
        'the file does not exist (paths are relative to the current directory), or cannot be '
        'read',
    'Cannot have a value before ros__parameters':
        'expected a line NODE: (or /**:), below it ros__parameters: (two underscores), and the '
        'values below that, each level two spaces further right',
    'Error parsing a event':
        'there is no YAML: is it a directory? If not, indent by spaces instead of tabs',
    "Couldn't parse remap rule":
        "expected -r FROM:=TO; a namespace begins with '/' and has letters, digits and '_', as in "
        '-r __ns:=/robot1'}


class Interrupted(KeyboardInterrupt):
    """The process was asked to stop while it did what cannot be asked; ``status`` is its own."""

    def __init__(self, number: int) -> None:
        super().__init__(f'signal {number}')
        self.status = 128 + number  # as shells have it


class Stop:
    """Turns true where it is to end, so that nodes can still publish their final commands."""

    def __init__(self) -> None:
        self.number = 0
        self._interrupts = False
        answer_signals(self._ask)

    def __bool__(self) -> bool:
        """Return whether the process was asked to stop."""
        return bool(self.number)

    @contextmanager
    def interrupting(self, *, after: int = 0) -> Iterator[None]:
        """
        Raise ``Interrupted`` in what is done meanwhile as soon as the process is asked to stop.

        What was asked for before counts too, unless it is the signal ``after``.
        """
        self._interrupts = True
        try:
            if self.number not in (0, after):
                raise Interrupted(self.number)
            yield
        finally:
            self._interrupts = False

    def _ask(self, number: int, _: object) -> None:
        self.number = number
        if self._interrupts:
            raise Interrupted(number)


def make_executor(nodes: Sequence[DiffDriveNode], kind: str = 'auto') -> Executor:
    """
    Return the executor of the package with nodes added to it.

    Raises
    ------
    ConfigurationError
        If the kind is 'events' and this rclpy has no EventsExecutor.

    """
    events = rclpy_private.EVENTS_EXECUTOR
    if kind == 'events' and not events:
        raise ConfigurationError(
            "executor is 'events', and this rclpy has none (it came with rclpy 7.1.4): update "
            "ROS 2 Jazzy, or leave it at 'auto'")
    make = events if events and kind != 'single_threaded' else SingleThreadedExecutor
    executor = make(context=nodes[0].context)
    for node in nodes:
        executor.add_node(node)
    return executor


def spin(
        executor: Executor, timers: SteadyTimers, finished: Callable[[], bool], stop: Stop, *,
        needs_wakeup: bool = True) -> None:
    """
    Spin, and fire timers, until finished or asked to stop.

    Where nothing ``needs_wakeup``, the time until a timer is due is slept away, which costs less
    than to wait in the executor; it is asked ten times a second, and until it has nothing more
    to do.
    """
    gc.freeze()  # what start-up made stays: nothing is gained by looking at it again and again
    spin_once, seconds_left, fire_due = executor.spin_once, timers.seconds_left, timers.fire_due
    monotonic, ask_at = time.monotonic, 0.0
    with ClockStepGuard(executor):
        while not stop and not finished():
            now, left = monotonic(), seconds_left(SPIN_TIMEOUT_S)
            if needs_wakeup or now >= ask_at:
                spin_once(timeout_sec=left)
                if monotonic() >= now + left:
                    ask_at = now + ASK_PERIOD_S
            else:
                time.sleep(min(left, ask_at - now))
            fire_due()


def run(work: Callable[[Stop], int], args: Optional[List[str]] = None) -> int:
    """Initialise rclpy, do ``work``, and return its exit status, whatever ends it."""
    open_stderr()
    stop = Stop()
    try:
        check_log_directory(os.environ, sys.argv if args is None else args)
        rclpy.init(args=args, signal_handler_options=SignalHandlerOptions.NO)
        if lacking := rclpy_private.missing():
            rclpy.logging.get_logger('diffdrive_kinematics').info(lacking)
        return work(stop)
    except rclpy_private.UnknownROSArgsError as error:
        complain(f'diffdrive_kinematics: unknown arguments after --ros-args: {error}, expected '
                 '-p NAME:=VALUE (in quotes if it has spaces) or an option of ROS')
        return CONFIGURATION_ERROR
    except (rclpy_private.RCLError, NameValidationException) as error:
        complain(f'diffdrive_kinematics: {with_remedy(str(error))}')
        return CONFIGURATION_ERROR
    except ConfigurationError as error:
        rclpy.logging.get_logger('diffdrive_kinematics').fatal(str(error))
        return CONFIGURATION_ERROR
    except (KeyboardInterrupt, ExternalShutdownException):
        return 0
    finally:
        for number in SIGNALS:  # a second Ctrl-C does not cut short what is already ending
            signal.signal(number, signal.SIG_IGN)
        rclpy.try_shutdown()


def finish(nodes: Sequence[DiffDriveNode], executor: Executor) -> None:
    """Have the final command of every node arrive, then end the executor."""
    for node in nodes:
        node.close()
    executor.shutdown()


def spin_node(node: DiffDriveNode, timers: SteadyTimers, stop: Stop) -> None:
    """Spin one node until it is done or asked to stop, and have its final command arrive."""
    executor = make_executor([node], node.parameters.values['executor'])
    try:
        spin(executor, timers, lambda: node.done, stop, needs_wakeup=node.runtime.needs_wakeup)
    finally:
        finish([node], executor)


def main_of(make: Callable[..., DiffDriveNode]) -> Callable[[], None]:
    """Return the ``main`` of an executable that runs one node."""
    def work(stop: Stop) -> int:
        timers = SteadyTimers()
        node = make(timers=timers)
        try:
            spin_node(node, timers, stop)
        finally:
            node.destroy_node()
        return 0

    def main() -> None:
        sys.exit(run(work))

    return main


def check_log_directory(environment: Mapping[str, str], argv: Sequence[str]) -> None:
    """Raise ``ConfigurationError`` where rcl would find no directory, and say so at length."""
    elsewhere = NO_FILES in argv or environment.get('RCL_LOGGING_IMPLEMENTATION')
    if not elsewhere and not any(environment.get(name) for name in DIRECTORIES):
        raise ConfigurationError(
            f"there is no directory for log files, as {', '.join(DIRECTORIES)} are not set: "
            f'{REMEDY}')


def with_remedy(error: str) -> str:
    """Return what rcl says, with what to do where that is known."""
    for words, hint in HINTS.items():
        if words in error:
            return f"{error.partition(', at ')[0]}: {hint}"
    if 'log directory' not in error and 'logging directory' not in error:
        return error
    return f"{error.partition(', at ')[0]}: {REMEDY}"
