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

"""What a node refuses: counted, reported, survived."""

from collections import Counter
from typing import Any, Callable

from diffdrive_kinematics.core.odometry import Verdict
from diffdrive_kinematics.ros.messages.messages import check_stamp, nanoseconds
from diffdrive_kinematics.ros.runtime.rclpy_private import RMWError
from rcl_interfaces.msg import SetParametersResult
from rclpy.node import Node
from rosgraph_msgs.msg import Clock

REPORT_PERIOD_S = 1.0
MOVED = Verdict.MOVED  # by far the most; an enum is slow to look up
VERDICTS = {  # where it was seen, and what was done
    Verdict.OUT_OF_ORDER: ('stamps', 'dropped'),
    Verdict.CLOCK_STEP: ('stamps', 'no motion is integrated'),
    Verdict.JUMPED: ('positions', 'max_encoder_rate is exceeded, they count from here')}
UNREADABLE = (ValueError, OverflowError, RMWError)


class Rejections:
    """
    Counts and reports what a node refuses; at most one report a second.

    Parameters
    ----------
    node : Node
        Whose log it is.

    """

    def __init__(self, node: Node) -> None:
        self._node = node
        self.counts: 'Counter[str]' = Counter()

    def refuse(self, reason: str) -> None:
        """Count and report what was refused."""
        self.counts['refused'] += 1
        self._node.get_logger().error(
            f"refused {reason} ({self.counts['refused']} so far)",
            throttle_duration_sec=REPORT_PERIOD_S)

    def judge(self, verdict: Verdict, topic: str) -> None:
        """Count and report wheel motion that was not taken as it came."""
        if verdict is not MOVED and verdict in VERDICTS:
            what, done = VERDICTS[verdict]
            self.counts[verdict.value] += 1
            self._node.get_logger().warning(
                f"{verdict.value} in the {what} of '{topic}' "
                f'({self.counts[verdict.value]} so far): {done}',
                throttle_duration_sec=REPORT_PERIOD_S)

    def guarded(self, topic: str, callback: Callable[..., None]) -> Callable[..., None]:
        """Return a callback of a subscription that refuses what it cannot read."""
        def guarded(*message: Any) -> None:
            try:
                callback(*message)
            except UNREADABLE as error:
                self.refuse(f"message on '{topic}': {error}")

        return guarded

    def guarded_service(
            self, name: str, callback: Callable[[Any, Any], Any]) -> Callable[[Any, Any], Any]:
        """Return a callback of a service that refuses a request: the response says why."""
        def guarded(request: Any, response: Any) -> Any:
            try:
                return callback(request, response)
            except ValueError as error:
                self.refuse(f"request of '{name}': {error}")
                return _rejected(request, response, str(error))

        return guarded


def checked_clock(
        callback: Callable[[Clock], None], note: Callable[[int], None]) -> Callable[[Clock], None]:
    """
    Return a callback that raises ``ValueError`` for a time that clock or stamps cannot have.

    Others it lets ``note`` [ns] first.
    """
    def checked(message: Clock) -> None:
        check_stamp(message.clock.sec, message.clock.nanosec)
        if message.clock.sec < 0:
            raise ValueError(f'time is {message.clock.sec} s, expected 0 or later')
        note(nanoseconds(message.clock))
        callback(message)

    return checked


def _rejected(request: Any, response: Any, reason: str) -> Any:
    """Return the response to a request that is refused."""
    if hasattr(response, 'success') and hasattr(response, 'message'):
        response.success, response.message = False, reason
    refused = SetParametersResult(successful=False, reason=reason)
    if hasattr(response, 'result'):
        response.result = refused
    if hasattr(response, 'results'):
        response.results = [*response.results, *(
            refused for _ in request.parameters[len(response.results):])]
    return response
