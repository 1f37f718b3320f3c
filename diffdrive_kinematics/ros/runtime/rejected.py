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

"""What rclpy lets through on topics and services of its own, and how a request is refused."""

from typing import Any, Callable

from diffdrive_kinematics.ros.messages.messages import check_time
from rcl_interfaces.msg import SetParametersResult
from rosgraph_msgs.msg import Clock

__all__ = ['checked_clock', 'rejected']


def checked_clock(callback: Callable[[Clock], None]) -> Callable[[Clock], None]:
    """Return a callback that raises ``ValueError`` for a time that clock or stamps cannot have."""
    def checked(message: Clock) -> None:
        check_time(message.clock)
        callback(message)

    return checked


def rejected(request: Any, response: Any, reason: str) -> Any:
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
