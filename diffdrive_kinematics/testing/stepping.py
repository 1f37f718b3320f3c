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

"""Time of a robot under test: it moves on when all who take part have handled the last step."""

import time
from typing import Any, Callable, Dict, List, Optional

from diffdrive_kinematics.ros.messages.messages import set_stamp
from diffdrive_kinematics.ros.parameters.qos import reliable
from diffdrive_kinematics.testing.acknowledgements import Acknowledgements
from diffdrive_kinematics.testing.arrival import Arrival, SERVICE
from diffdrive_kinematics.testing.at_rest import Rest, Threads
from diffdrive_kinematics.testing.matching import has_publishers, has_subscribers
from diffdrive_kinematics.testing.nodes import RobotNodes
from diffdrive_kinematics.testing.processes import Process, ProcessFailed, sleepless
from rosgraph_msgs.msg import Clock

__all__ = ['Stepping']

DEADLINE_S = REST_S = 20.0
ARRIVAL_S = 60.0
POLL_S = 0.02
REST_POLL_S = 0.00005
SOONER, LATER = 0.95, 1.1  # than last time, where the first look was not in vain, or was
COME_TO_REST = 'come to rest (one whose thread always works needs restless=True)'
REPEAT_S = 0.5
SILENCE_S = 0.003
"""For how long nothing may come where this system does not tell whether a process is done."""


class Stepping:
    """
    Steps the clock of a robot's nodes and of the processes under test.

    Parameters
    ----------
    nodes : RobotNodes
        The robot's nodes.
    step_ns : int
        Length of a step [ns].

    """

    def __init__(self, nodes: RobotNodes, step_ns: int) -> None:
        self._nodes = nodes
        self._observer, self._executor, self.clock = nodes.observer, nodes.executor, nodes.clock
        self._messages, self.step_ns = nodes.messages, step_ns
        self.processes: List[Process] = []
        self._publisher = self._observer.create_publisher(Clock, '/clock', reliable(10))
        self._acknowledgements = Acknowledgements(self._observer)
        self._first_look_s: Dict[str, float] = {}
        self._rest = Rest(self._executor)

    def step(self, *, tell: bool = True, wait_for: Optional[str] = None) -> None:
        """Let one step pass; ``tell`` the processes, and wait until they have handled it."""
        if tell:
            self.check(wait_for)
        self.clock.advance_to(self.clock.now_ns() + self.step_ns)
        self._messages.forget()
        if self._messages.disturbances.hand_on_late():
            self.deliver()
        for timer in self.clock.due():
            self.clock.fire(timer)
            self.deliver()
        if tell:
            self.tell(wait_for)

    def jump(self, step_ns: int) -> None:
        """Step the clock itself; timers of robots do not run on it, and go on as before."""
        self.check()
        for timer in self.clock.timers:
            timer.next_ns += step_ns
        self._messages.disturbances.clock_stepped(step_ns)
        self.clock.advance_to(self.clock.now_ns() + step_ns)
        self.tell()

    def check(self, wait_for: Optional[str] = None) -> None:
        """Raise ``ProcessFailed`` before a step which the others would miss, or nobody answer."""
        for process in self.processes:
            if process.running and process.nodes and not any(
                    self._observer.count_services(name + SERVICE) for name in process.nodes):
                process.await_end()
            process.check()
        if wait_for and self._messages.only_own(wait_for) and not any(
                process.running for process in self.processes):
            raise ProcessFailed('\n'.join([
                f'{wait_for!r} is waited for, and no process runs that could publish it',
                *(process.describe() for process in self.processes)]))

    def tell(self, wait_for: Optional[str] = None) -> None:
        """Show the time to the processes, and wait until they have handled it."""
        self._watch(self._watched(), self._rest.asleep, 'before the time')  # who hears the robot
        came = self._messages.arrived[wait_for] if wait_for else 0
        now_ns = self.clock.now_ns()
        self._show()
        if steady := [each for each in self.processes if each.lockstep and each.running]:
            self.wait(lambda: all(
                self._acknowledgements.of(each.name) == now_ns or not each.running
                for each in steady), 'acknowledge the step', steady, show=True)
        if wait_for:
            self.wait(lambda: self._messages.arrived[wait_for] > came,
                      f'publish {wait_for!r}', self.processes, show=True)
        self.rest(silence=not wait_for)

    def rest(self, *, silence: bool = False) -> None:
        """
        Let the processes handle all that they have heard, and the robot all that they say.

        Where this system does not tell that they are done, those that do not tell it themselves
        are given a while of ``silence``.
        """
        running = [each for each in self.processes if each.running]
        watched = self._watched()
        if not all(each.lockstep for each in watched):  # else they have told already
            self._watch(watched, lambda threads: self._rest.reached(threads, self.deliver),
                        'after the time')
        if silence and any(not each.lockstep for each in running if each not in watched):
            self._be_silent()
        self.deliver()

    def _watched(self) -> List[Process]:
        return [each for each in self.processes
                if each.running and self._rest.can_tell and not each.restless]

    def _watch(
            self, watched: List[Process], done: Callable[[List[Threads]], bool],
            moment: str) -> None:
        """Look until they are done, first when they have mostly been done of late."""
        threads = [each.threads for each in watched]
        if not threads:
            return
        first_s, pauses = self._first_look_s.get(moment, REST_POLL_S), 0

        def pause() -> None:
            nonlocal pauses
            time.sleep(REST_POLL_S if pauses else first_s)
            pauses += 1

        self.wait(lambda: done(threads), COME_TO_REST, watched, timeout=REST_S, pause=pause,
                  suspects=lambda: sleepless(watched))
        self._first_look_s[moment] = max(REST_POLL_S, first_s * (LATER if pauses > 1 else SOONER))

    def deliver(self) -> None:
        """Let every message between the robot's nodes be handled, and all that these cause."""
        self._messages.hand_over()
        if not self._messages.settled():
            self.wait(self._messages.settled, 'handle a message', [])

    def _spin_once(self, timeout: float) -> None:
        self._executor.spin_once(timeout_sec=timeout)
        self._messages.hand_over()

    def wait(
            self, condition: Callable[[], Any], what: str, processes: List[Process], *,
            show: bool = False, timeout: Optional[float] = None,
            pause: Optional[Callable[[], None]] = None,
            suspects: Optional[Callable[[], List[Process]]] = None) -> None:
        """Spin until a condition holds, or raise ``ProcessFailed``."""
        timeout = timeout or DEADLINE_S
        pause = pause or (lambda: self._spin_once(POLL_S))
        deadline, show_at = time.monotonic() + timeout, time.monotonic() + REPEAT_S
        while not condition():
            pause()
            now = time.monotonic()
            if show and now > show_at:  # who finds the publisher late has missed it
                self._show()
                show_at = now + REPEAT_S
                for process in self.processes:
                    process.check()
            if now > deadline:
                names = (suspects and suspects()) or [
                    each for each in processes if each.running] or processes
                raise ProcessFailed('\n'.join(
                    each.describe(f'did not {what} within {timeout:.0f} s') for each in names)
                    or f'the robot did not {what} within {timeout:.0f} s')

    def expect(self) -> Arrival:
        """Note who is there, before a process is started."""
        running = [each for each in self.processes if each.running]
        self._acknowledgements.forget_all_but({each.name for each in running})
        there, known = (set().union(*(each.nodes for each in some))
                        for some in (running, self.processes))
        return Arrival(self._observer, known - there)

    def begin(self, process: Process, arrival: Arrival) -> None:
        """Wait until a process is there, and it and the robot hear all that they say."""
        known = {each.name for each in self.processes if each.running} - {process.name}

        def greeted() -> bool:
            process.check()
            name = self._acknowledgements.newcomer(known, self.clock.now_ns())
            process.name = name or process.name
            return bool(name)

        if process.lockstep:
            self.wait(greeted, 'call diffdrive_kinematics.testing.spin', [process], show=True)
            listens, publishes = self._acknowledgements.ends_of(process.name)
            self.wait(lambda: arrival.shows(listens, heard=True)
                      and arrival.shows(publishes, heard=False), 'show its topics', [process])
        else:
            self.wait(lambda: arrival.shows(['/clock'], heard=True) or not process.running,
                      'listen to /clock', [process], show=True)
        self.wait(lambda: arrival.complete(self.all_matched(), process), 'come to rest',
                  [process], show=True, timeout=ARRIVAL_S)
        process.nodes = arrival.answered
        arrival.close()
        self._show()
        self.rest(silence=True)
        process.check()

    def all_matched(self) -> bool:
        """Return whether all of this process have found all in the graph who fit them."""
        observer = self._observer
        nodes = self._executor.get_nodes()
        subscriptions = [each for node in nodes for each in node.subscriptions]
        return self._nodes.ready() and all(
            has_subscribers(each, observer) for each in self._messages.publishers) and all(
            has_publishers(each, observer) for each in subscriptions)

    def _be_silent(self) -> None:
        """Spin until nothing has come for a while."""
        came, until = sum(self._messages.arrived.values()), time.monotonic() + SILENCE_S
        while time.monotonic() < until:
            self._spin_once(max(0.0, until - time.monotonic()))
            now = sum(self._messages.arrived.values())
            if now > came:
                came, until = now, time.monotonic() + SILENCE_S

    def close(self) -> None:
        """Look at no process any more."""
        self._rest.close()

    def _show(self) -> None:
        message = Clock()
        set_stamp(message.clock, self.clock.now_ns())
        self._publisher.publish(message)
