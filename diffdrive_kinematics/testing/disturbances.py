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

"""Messages of a robot under test that are lost, or come late, where a test wants it so."""

from heapq import heappop, heappush
from itertools import count
import random
from typing import Callable, Dict, List, Tuple

from diffdrive_kinematics.ros.runtime.clocks import SteppedClock

__all__ = ['Disturbances']


class Disturbances:
    """
    Loses messages, or hands them on late.

    Parameters
    ----------
    clock : SteppedClock
        By which they are late.

    """

    def __init__(self, clock: SteppedClock) -> None:
        self._clock = clock
        self._losses: Dict[str, Tuple[float, random.Random]] = {}
        self._delays: Dict[str, int] = {}
        self._late: List[Tuple[int, int, Callable[[], None]]] = []
        self._number = count()

    def lose(self, topic: str, share: float, seed: int) -> None:
        """Lose a share of what is sent on a topic from now on."""
        self._losses[topic] = share, random.Random(seed)

    def delay(self, topic: str, delay_ns: int) -> None:
        """Hand on later what is sent on a topic from now on."""
        self._delays[topic] = delay_ns

    def hand_on_late(self) -> bool:
        """Hand on what was delayed until now; return whether something was."""
        handed = False
        while self._late and self._late[0][0] <= self._clock.now_ns():
            heappop(self._late)[2]()
            handed = True
        return handed

    def clock_stepped(self, step_ns: int) -> None:
        """Let what is late come as late as it would have."""
        self._late = [(due + step_ns, number, send) for due, number, send in self._late]

    def hand_on(self, topic: str, send: Callable[[], None]) -> None:
        """Send a message of a topic now, later, or never."""
        share, dice = self._losses.get(topic, (0.0, None))
        if dice and dice.random() < share:
            return
        delay_ns = self._delays.get(topic, 0)
        if delay_ns:
            heappush(self._late, (self._clock.now_ns() + delay_ns, next(self._number), send))
        else:
            send()
