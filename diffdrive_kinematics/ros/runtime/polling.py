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

"""Messages that are looked at when a timer fires, so that none of them wakes the process."""

import inspect
from typing import Any, Callable, Mapping, Optional

from rclpy.subscription import Subscription

__all__ = ['Poll', 'QUEUE_DEPTH', 'informing', 'numbering']

LEAST_RATE = 20.0  # [Hz]
QUEUE_DEPTH = 100  # at LEAST_RATE: 2000 messages a second


def _number_in(told: Mapping[str, Any]) -> int:
    """Return the number of a message among those of its publisher; 0: it has none."""
    return told['publication_sequence_number'] or 0


def informing(callback: Callable[[Any, Mapping[str, Any]], None]) -> Callable[..., None]:
    """
    Return what an executor calls back; the callback also gets what the middleware tells.

    EventsExecutor hands on message and information as one argument, other executors as two.
    """
    def hear(*taken: Any) -> None:
        message, told = taken if len(taken) == 2 else taken[0]
        callback(message, told)

    hear.__signature__ = inspect.signature(_both)  # type: ignore[attr-defined]
    return hear


def numbering(callback: Callable[[Any, int], None], *, stepped: bool) -> Callable[..., None]:
    """
    Return what an executor calls back with a message, and the callback gets its number as well.

    The number is 0 where time is ``stepped``, as it is the same in every run.
    """
    if stepped:
        return lambda message: callback(message, 0)
    return informing(lambda message, told: callback(message, _number_in(told)))


def _both(message: Any, told: Mapping[str, Any]) -> None:
    """Show rclpy that a callback wants to know what the middleware tells of a message."""


class Poll:
    """
    What has come on a topic since it was looked at last.

    Parameters
    ----------
    node : DiffDriveNode
        It makes a timer where nobody looks as often as the queue needs.
    callback :
        Gets a serialised message, the time [ns] on the system's clock at which it came, and its
        number among those of its publisher; 0 where they are unknown.
    subscription : Subscription, optional
        One that no executor looks after; without it there is nothing to look at.

    """

    def __init__(
            self, node: Any, callback: Callable[[bytes, int, int], None],
            subscription: Optional[Subscription] = None) -> None:
        self._node, self._callback, self._subscription = node, callback, subscription
        self._timer: Any = None

    def take(self) -> None:
        """Hand on what has come up to now."""
        if self._subscription is None:
            return
        take, kind = self._subscription.handle.take_message, self._subscription.msg_type
        for _ in range(QUEUE_DEPTH):  # more cannot have come; a flood would never end
            taken = take(kind, True)
            if not taken:
                return
            data, told = taken
            self._callback(data, told['received_timestamp'], _number_in(told))

    def set_poll_rate(self, rate: float) -> None:
        """Be told the rate [Hz] at which ``take`` is called from now on."""
        if self._timer:
            self._node.stop_timer(self._timer)
        needed = self._subscription is not None and rate < LEAST_RATE
        self._timer = self._node.every(LEAST_RATE, self.take) if needed else None
