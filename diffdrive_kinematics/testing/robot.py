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

"""A simulated robot inside a test, and the processes under test beside it."""

import math
from pathlib import Path
from typing import Any, Callable, Mapping, Optional, Sequence, Union

from diffdrive_kinematics.testing.checks import (
    check_command, check_condition, check_environment, check_number, refuse, whole_steps)
from diffdrive_kinematics.testing.composition import composition
from diffdrive_kinematics.testing.guardian import Guardian
from diffdrive_kinematics.testing.nodes import RobotNodes, State, topic_of
from diffdrive_kinematics.testing.processes import environment_of, Process
from diffdrive_kinematics.testing.stepping import Stepping
from diffdrive_kinematics.testing.topics import Topics
from geometry_msgs.msg import Twist, TwistStamped

__all__ = ['Robot']

CLOCK_END_NS = 2**31 * 10**9
"""The seconds of a stamp have 31 bits."""


class Robot(Topics):
    """
    A robot of the package's nodes on stepped time, in a ROS domain of its own.

    Parameters
    ----------
    config : path or mapping, optional
        Params file of ``diffdrive_sim``, or what one would hold; None: one robot with a belief
        (``odom``) and a truth (``ground_truth``).
    params : mapping, optional
        Parameters of all nodes.
    noise : mapping, optional
        Parameters of ``wheel_noise``.
    clock_step : float, optional
        Step of the clock [s]; None: that of the file, or 0.02.

    """

    def __init__(
            self, config: Union[str, Path, Mapping[str, Any], None] = None, *,
            params: Optional[Mapping[str, Any]] = None, noise: Optional[Mapping[str, Any]] = None,
            clock_step: Optional[float] = None) -> None:
        made = composition(config, params or {}, noise or {}, clock_step)
        self._nodes = RobotNodes(made)
        self._guardian = Guardian()
        self.domain = self._nodes.domain
        self._stepping = Stepping(self._nodes, made.step_ns)
        super().__init__(self._nodes, self._stepping)
        try:
            self._settle()
        except BaseException:
            self.close()
            raise

    @property
    def time(self) -> float:
        """Return the simulated time [s]."""
        return self._nodes.clock.now_ns() / 1e9

    @property
    def odom(self) -> State:
        """Return where the robot believes to be."""
        return self._nodes.state(noisy=False)

    @property
    def truth(self) -> State:
        """Return where the robot is."""
        return self._nodes.state(noisy=True)

    def drive(self, v: float, w: float, seconds: float) -> None:
        """Publish a command [m/s, rad/s] in every step for some simulated seconds."""
        steps = self._steps('seconds', seconds)
        v, w = (check_number(*each, finite=False) for each in (('v', v), ('w', w)))
        controller = self._nodes.controller()
        stamped = controller.get_parameter('enable_stamped_cmd_vel').value
        message = TwistStamped() if stamped else Twist()
        twist = message.twist if stamped else message
        twist.linear.x, twist.angular.z = v, w
        for _ in range(steps):
            self.publish(topic_of(controller, 'cmd_vel_topic'), message)
            self._stepping.step()

    def advance(
            self, seconds: float, *, wait_for: Optional[str] = None,
            period: Optional[float] = None) -> None:
        """
        Let simulated seconds pass, as fast as all can follow.

        After it the processes have the time of the robot.

        Parameters
        ----------
        seconds : float
            How many; up to the next whole step of the clock.
        wait_for : str, optional
            Topic that a process publishes once a ``period``: each time that message is waited for,
            but not at the end of a call where less than a period was left.
        period : float, optional
            By which ``/clock`` moves for the processes [s], in whole steps of the clock, counted
            from the start of this call; at its end by what is left.  None: a step of the clock.

        Raises
        ------
        ValueError
            If ``seconds`` or ``period`` is not finite, or less than a step of the clock, or the
            robot does not listen to ``wait_for``.
        ProcessFailed
            If a process ended with an error, or does not answer.

        """
        steps, each = self._steps('seconds', seconds), self._steps_of(period)
        topic = None if wait_for is None else self._awaited(wait_for)
        for number in range(1, steps + 1):
            whole = number % each == 0
            self._stepping.step(
                tell=whole or number == steps, wait_for=topic if whole else None)

    def advance_until(
            self, condition: Callable[[], Any], *, timeout: float, **options: Any) -> None:
        """
        Advance until a condition holds; it is asked each step, or each ``period``.

        Parameters
        ----------
        condition : callable
            Returns whether it holds.
        timeout : float
            Simulated seconds after which it should.
        options :
            As for ``advance``.

        Raises
        ------
        AssertionError
            If it does not hold within ``timeout``.
        ValueError
            If ``condition`` is no function, ``timeout`` is not above 0, and as for ``advance``.
        ProcessFailed
            If a process ended with an error, or does not answer.

        """
        check_condition(condition)
        each, steps = self._steps_of(options.get('period')), self._steps('timeout', timeout)
        for _ in range(math.ceil(steps / each)):
            self.advance(each * self._stepping.step_ns / 1e9, **options)
            if condition():
                return
        try:
            odom: Any = self.odom
        except LookupError:
            odom = 'not there'
        raise AssertionError('\n'.join([
            f'not within {timeout} simulated seconds; odom is {odom}', *self._nodes.problems(),
            *(process.describe() for process in self._stepping.processes)]))

    def start_process(
            self, command: Sequence[str], *, lockstep: bool = False, restless: bool = False,
            environment: Optional[Mapping[str, str]] = None) -> Process:
        """
        Start a process under test in the robot's domain, on its clock, and wait until it is there.

        Parameters
        ----------
        command : sequence of str
            What to run.
        lockstep : bool
            Whether it calls ``diffdrive_kinematics.testing.spin``: then every step waits for it.
        restless : bool
            Whether one of its threads works all the time, as in a loop around ``spin_once``.  It
            is not waited for then, but for a while in which nothing comes from it.
        environment : mapping, optional
            Variables to set.

        Returns
        -------
        Process
            With ``output``, ``running``, ``stop()`` and ``kill()``.

        """
        words, variables = check_command(command), check_environment(environment or {})
        arrival = self._stepping.expect()
        process = Process(words, {**environment_of(self.domain), **variables},
                          lockstep=lockstep, restless=restless)
        self._stepping.processes.append(process)
        self._found.clear()
        self._guardian.guard(process.pid)
        self._stepping.begin(process, arrival)
        return process

    def kill(self, name: str) -> None:
        """End a node of the robot at once, as a crash does."""
        self._nodes.kill(name)

    def restart(self, name: str) -> None:
        """Start a node of the robot again; one that is alive is killed before."""
        self._nodes.restart(name)
        self._settle()

    def step_clock(self, seconds: float) -> None:
        """Step the clock itself, forward or back [s], but not below 0, as a time server does."""
        expected = (f'a number that leaves the clock, now at {self.time} s, from 0 to below '
                    f'{CLOCK_END_NS // 10**9} s')
        step = check_number('seconds', seconds, expected) * 1e9
        if not math.isfinite(step) or not (
                0 <= self._nodes.clock.now_ns() + round(step) < CLOCK_END_NS):
            refuse('seconds', seconds, expected)
        self._stepping.jump(round(step))

    def check(self) -> None:
        """Raise ``ProcessFailed`` if a process has ended with an error that was not told yet."""
        self._stepping.check()

    def close(self) -> None:
        """End everything; the robot first, as a killed writer leaves its shared memory locked."""
        try:
            self._stepping.close()
            self._nodes.close()
        finally:
            for process in self._stepping.processes:
                process.close()
                self._guardian.release(process.pid)
            self._guardian.close()

    def _settle(self) -> None:
        """Wait until the nodes hear each other."""
        self._stepping.wait(self._nodes.ready, 'hear itself', [])

    def _steps_of(self, period: Optional[float]) -> int:
        return 1 if period is None else self._steps('period', period)

    def _steps(self, name: str, seconds: float) -> int:
        return whole_steps(name, seconds, self._stepping.step_ns)
