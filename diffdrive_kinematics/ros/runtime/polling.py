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

from typing import Any, Callable

from diffdrive_kinematics.ros.runtime.rclpy_private import hand_on, MessageInfo, taker_of
from rclpy.subscription import Subscription

LEAST_RATE = 20.0  # [Hz]
QUEUE_DEPTH = 100  # at LEAST_RATE: 2000 messages a second


class Poll:
    """What has come on a topic since it was looked at last: nothing, it is handed on at once."""

    waits = False  # whether something may be there to be taken

    def take(self) -> None:
        """Hand on what has come up to now."""

    def set_poll_rate(self, rate: float) -> None:
        """Be told the rate [Hz] at which ``take`` is called from now on."""


class QueuePoll(Poll):
    """
    What has come on a topic since it was looked at last, from the queue of its subscription.

    Parameters
    ----------
    runtime : Runtime
        It makes a timer where nobody looks as often as the queue needs.
    callback :
        Gets a serialised message, and what the middleware knows of it.
    subscription : Subscription
        One that no executor looks after.

    """

    waits = True

    def __init__(
            self, runtime: Any, callback: Callable[[bytes, MessageInfo], None],
            subscription: Subscription) -> None:
        self._runtime, self.callback, self.taken = runtime, callback, taker_of(subscription)
        self._timer: Any = None

    def take(self) -> None:
        """Hand on what has come up to now."""
        for _ in range(QUEUE_DEPTH):  # more cannot have come; a flood would never end
            taken = self.taken()
            if not taken:
                return
            hand_on(taken, self.callback)

    def set_poll_rate(self, rate: float) -> None:
        """Be told the rate [Hz] at which ``take`` is called from now on."""
        if self._timer:
            self._runtime.stop_timer(self._timer)
        self._timer = self._runtime.every(LEAST_RATE, self.take) if rate < LEAST_RATE else None
