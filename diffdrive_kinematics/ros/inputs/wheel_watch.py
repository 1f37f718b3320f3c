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

"""Says what is wrong with the publishers of wheel motion, and with single wheels."""

from typing import Any, Dict, List

from diffdrive_kinematics.ros.inputs.publisher_watch import LOOK_RATE, PublisherNames
from diffdrive_kinematics.ros.messages.wheel_messages import WheelReader
from diffdrive_kinematics.ros.runtime.diagnostics import Finding, Problem, WARN

MOST_APART_NS = 250_000_000  # of the delays of joints whose clocks agree
GRACE_NS = 1_000_000_000  # for messages with the other joints
REMEDY = (
    'one of them is used, the others are ignored: let one node publish these joints, and '
    "remap the others' topic (do not run joint_state_publisher beside a driver)")


class WheelWatch:
    """
    Looks at a reader of wheel motion now and then, and says what has changed.

    Parameters
    ----------
    node : DiffDriveNode
        That listens.
    reader : WheelReader
        What it reads with.
    topic : str
        Of wheel motion, as the node names it.

    """

    def __init__(self, node: Any, reader: WheelReader, topic: str) -> None:
        self._node, self._gathering, self._reader = node, reader.gathering, reader
        self._topic, self._names = node.resolve_topic_name(topic), PublisherNames(node, topic)
        self._contest, self._silent, self._apart = Finding(node), Finding(node), Finding(node)
        self._disagreements: List[str] = []
        self._left_out = self._reported_left_out = self._reported_incomplete = 0
        node.runtime.every(LOOK_RATE, self._look)

    def _look(self) -> None:
        now_ns = self._node.runtime.now_ns()
        self._look_at_publishers(now_ns)
        self._look_at_missing_joints(now_ns)
        self._look_at_stamps()
        self._look_at_wheels()

    def _look_at_publishers(self, now_ns: int) -> None:
        sources = self._gathering.sources
        if not sources.contested(now_ns):
            self._contest.note('')
            self._names.forget()
        elif not self._contest.text and (names := self._names.look()) is not None:
            self._contest.note(
                f"wheel motion of our joints comes from several publishers on '{self._topic}' "
                f'(it is published by {names}): {REMEDY}')

    def _look_at_missing_joints(self, now_ns: int) -> None:
        since_ns = self._gathering.waiting_since_ns
        if since_ns is None or now_ns - since_ns < GRACE_NS:
            self._silent.note('')
            return
        missing, never = self._gathering.missing()
        if never and self._reported_incomplete != self._gathering.incomplete:
            self._reported_incomplete = self._gathering.incomplete
            self._node.rejections.refuse(
                f"message on '{self._topic}': name is {list(self._reader.partial)!r}, only some "
                f'of our joints, expected also {missing!r}')
        elif not never and not self._silent.text:
            self._silent.note(
                f"no messages of {missing!r} on '{self._topic}', while the other joints have some")

    def _look_at_stamps(self) -> None:
        delays = self._gathering.delays()
        if delays is None:
            return
        first, last = min(delays, key=delays.__getitem__), max(delays, key=delays.__getitem__)
        apart_ns = delays[last] - delays[first]
        self._apart.note('' if apart_ns <= MOST_APART_NS else (
            f"stamps of {last!r} on '{self._topic}' are {apart_ns / 1e9:.3f} s behind those of "
            f'{first!r}, so the wheels are read at different times: does each board have '
            'a clock of its own?'))

    def _look_at_wheels(self) -> None:
        gathering = self._gathering
        self._left_out = gathering.left_out - self._reported_left_out
        self._reported_left_out = gathering.left_out
        if self._left_out:
            self._node.get_logger().warning(
                f'{self._left_out_text()}, {gathering.left_out} so far: the other wheels of the '
                'side are used')
        before, self._disagreements = self._disagreements, gathering.disagreements()
        if len(self._disagreements) > len(before):
            self._node.get_logger().warning(self._disagreement_text())
        elif before and not self._disagreements:
            self._node.get_logger().info(f"wheels of a side agree again on '{self._topic}'")

    def _left_out_text(self) -> str:
        return (f"{self._gathering.last_left_out} in '{self._topic}' "
                f'({self._left_out} readings left out)')

    def _disagreement_text(self) -> str:
        return (f"wheels of a side disagree on '{self._topic}', in the same time they have gone "
                f"{'; '.join(self._disagreements)}: is an encoder stuck, or a wheel in the air?")

    def problems(self) -> List[Problem]:
        """Return what is wrong, for diagnostics."""
        texts = [self._contest.text, self._silent.text, self._apart.text]
        if self._left_out:
            texts.append(self._left_out_text())
        if self._disagreements:
            texts.append(self._disagreement_text())
        return [Problem(WARN, text) for text in texts if text]

    def values(self) -> Dict[str, Any]:
        """Return what there is to count, for diagnostics."""
        gathering = self._gathering
        return {'messages of other publishers': gathering.sources.ignored,
                'wheel readings left out': gathering.left_out,
                'wheels that disagree': '; '.join(self._disagreements) or 'none'}
