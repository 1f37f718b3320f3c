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

"""The emergency stop of the controller: a topic, and services."""

from typing import Any, Callable, Dict, List, Tuple

from diffdrive_kinematics.ros.runtime.diagnostics import ERROR, Problem
from rclpy.qos import DurabilityPolicy
from std_msgs.msg import Bool
from std_srvs.srv import Trigger

REPORT_PERIOD_S = 5.0
LOOK_RATE = 10.0  # [Hz]
# looks, which neither a slow start nor a stall makes: what came meanwhile is heard between them
NOBODY = 10  # in which a topic that nobody publishes may still be found
LATCHED = 50  # and in which what a publisher has latched may be on its way


class EmergencyStop:
    """
    Is engaged while the topic last said so, or since ``~/stop`` was called until ``~/resume`` is.

    What was latched on the topic comes after the first commands now and then.  So none is heard
    until the topic has said something, or has had the time to, from the first spin on.

    Parameters
    ----------
    node : DiffDriveNode
        Whose stop it is.
    topic : str
        Of ``std_msgs/Bool``, true: stop; empty: there is none.
    on_stop : callable
        Called where it is engaged.
    on_release : callable
        Called before the stop is over.
    on_known : callable
        Called once commands may be heard: at once where nothing has to be awaited.

    """

    def __init__(
            self, node: Any, topic: str, on_stop: Callable[[], None],
            on_release: Callable[[], None], on_known: Callable[[], None]) -> None:
        self._node, self._on_stop, self._on_release = node, on_stop, on_release
        self._on_known = on_known
        self._topic = node.resolve_topic_name(topic) if topic else ''
        self._by: Tuple[str, ...] = ()
        self.engaged = False
        self.ignored = 0
        self._looks = 0
        self._timer: Any = None  # while what the topic says is awaited
        if topic and not node.runtime.is_stepped:
            self._timer = node.runtime.every(LOOK_RATE, self._look, steadily=True)
        else:
            on_known()
        if topic:
            node.runtime.listen_to_any(Bool, topic, self._on_topic)
        node.runtime.serve(Trigger, '~/stop', self._on_stop_service)
        node.runtime.serve(Trigger, '~/resume', self._on_resume)

    def ignore(self) -> None:
        """Count a command that is not obeyed."""
        self.ignored += 1
        self._node.get_logger().warning(
            f'{self._state()}: a command is ignored ({self.ignored} so far)',
            throttle_duration_sec=REPORT_PERIOD_S)

    def values(self) -> Dict[str, Any]:
        """Return what diagnostics tell of it."""
        return {'emergency stop': self._state() if self.engaged else 'off',
                'commands ignored while stopped': self.ignored}

    def problems(self) -> List[Problem]:
        """Return that the robot will not move."""
        return [Problem(ERROR, self._state())] if self.engaged else []

    def _state(self) -> str:
        return f"stopped by {' and '.join(self._by)}"

    def _look(self) -> None:
        """Wait for the topic no longer than it may take."""
        self._looks += 1
        if self._looks == 1:
            self._node.get_logger().info(
                f"commands are heard as soon as '{self._topic}' has said something, or after "
                f'{NOBODY / LOOK_RATE:.0f} s ({LATCHED / LOOK_RATE:.0f} s beside a latched '
                'publisher of it)')
        if self._looks >= LATCHED or self._looks >= NOBODY and not any(
                each.qos_profile.durability == DurabilityPolicy.TRANSIENT_LOCAL
                for each in self._node.get_publishers_info_by_topic(self._topic)):
            self._know()

    def _know(self) -> None:
        if self._timer:
            self._node.runtime.stop_timer(self._timer)
            self._timer = None
            self._on_known()

    def _on_topic(self, message: Bool) -> None:
        self._set(f"'{self._topic}'", message.data)
        self._know()

    def _on_stop_service(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        self._set('~/stop', True)
        response.success, response.message = True, self._state()
        return response

    def _on_resume(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        self._set('~/stop', False)
        response.success = not self.engaged
        response.message = (
            f'{self._state()}, which still says so' if self.engaged
            else 'the next command is obeyed')
        return response

    def _set(self, source: str, stop: bool) -> None:
        if stop == (source in self._by):
            return
        if stop:
            self._by = (*self._by, source)
            self.engaged = True
            self._on_stop()
        else:
            if len(self._by) == 1:
                self._on_release()
            self._by = tuple(each for each in self._by if each != source)
            self.engaged = bool(self._by)
        self._node.get_logger().warning(
            f"emergency stop: {self._state() if self.engaged else 'off'}")
