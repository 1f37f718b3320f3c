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

"""Stamps of another clock than that of the node: noticed, and said once."""

from typing import Any, List

from diffdrive_kinematics.core.odometry import SenderClock
from diffdrive_kinematics.ros.runtime.diagnostics import Problem, WARN
from diffdrive_kinematics.ros.runtime.node import DiffDriveNode

TOLERANCE_NS = 1_000_000_000  # far from what clocks that agree differ by, latency included


class StampWatch:
    """
    What the stamps on a topic show of the clock that they are of.

    Parameters
    ----------
    node : DiffDriveNode
        It warns, once for each time that the clocks part.
    topic : str
        Where the stamps come from.
    effect : str
        What comes of it, in words.

    """

    def __init__(
            self, node: DiffDriveNode[Any], topic: str,
            effect: str = 'timeouts count from the arrival of messages') -> None:
        self._node, self._topic, self._effect = node, node.resolve_topic_name(topic), effect
        self._clock = SenderClock(TOLERANCE_NS)
        self._said = False

    def note(self, stamp_ns: int, now_ns: int) -> None:
        """Note a stamp [ns] that came now."""
        self._clock = clock = self._clock.observed(stamp_ns, now_ns)
        if clock.differs != self._said:
            self._said = clock.differs
            if self._said:
                self._node.get_logger().warning(
                    f'{self._finding()} (stamp {stamp_ns / 1e9:.3f} s, own clock '
                    f'{now_ns / 1e9:.3f} s); {self._effect}')

    def clock_stepped(self, step_ns: int) -> None:
        """Note that the clock of the node was stepped."""
        self._clock = self._clock.clock_stepped(step_ns)

    def problems(self) -> List[Problem]:
        """Return that there are two clocks, where it is so."""
        return [Problem(WARN, self._finding())] if self._clock.differs else []

    def _finding(self) -> str:
        simulated = str(self._node.runtime.clock.ros_time_is_active).lower()
        return (
            f"the stamps on '{self._topic}' are of another clock than this node's: is "
            f'use_sim_time (now {simulated}) the same where they come from?')
