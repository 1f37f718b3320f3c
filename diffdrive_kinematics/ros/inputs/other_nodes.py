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

"""Other nodes: numbers that are parameters of one are shown and set, services are triggered."""

import math
import time
from typing import Any, Callable, Dict, Mapping, Sequence

from rcl_interfaces.srv import GetParameters, SetParameters
from rclpy.parameter import Parameter
from std_srvs.srv import Trigger

ANSWER_S = 1.0  # after which it is asked again: answers are lost while DDS finds its ends


class RemoteParameters:
    """
    Parameters of another node.

    Parameters
    ----------
    node : DiffDriveNode
        Who asks.
    target : str
        Name of the other node.
    names : sequence of str
        Of its parameters, all of them numbers.
    show : callable
        Called with what they are, by name, whenever that was asked for, and returns whether that
        is shown; if not, it is asked for again.

    """

    def __init__(
            self, node: Any, target: str, names: Sequence[str],
            show: Callable[[Dict[str, float]], bool]) -> None:
        self._names, self._show = names, show
        self._get = node.runtime.client(GetParameters, f'{target}/get_parameters')
        self._set = node.runtime.client(SetParameters, f'{target}/set_parameters')
        self._wanted, self._asked_s = False, -math.inf

    def ask(self) -> None:
        """Want to know what they are, sooner or later."""
        self._wanted, self._asked_s = True, -math.inf

    def look(self) -> None:
        """Ask where that is wanted; called often."""
        if (self._wanted and time.monotonic() > self._asked_s + ANSWER_S
                and self._get.service_is_ready()):
            self._asked_s = time.monotonic()
            self._get.call_async(GetParameters.Request(names=self._names)).add_done_callback(
                self._answered)

    def set(self, name: str, number: float) -> None:  # noqa: A003
        """Set one of them, or raise ``ValueError``."""
        if name not in self._names:
            raise ValueError(f'{name!r}, expected one of {list(self._names)}')
        parameter = Parameter(name, Parameter.Type.DOUBLE, float(number))
        self._set.call_async(SetParameters.Request(
            parameters=[parameter.to_parameter_msg()])).add_done_callback(lambda _: self.ask())

    def _answered(self, future: Any) -> None:
        values = future.result().values
        if len(values) == len(self._names):
            self._wanted = not self._show(
                {name: value.double_value for name, value in zip(self._names, values)})


class RemoteTriggers:
    """
    Services of ``std_srvs/Trigger``.

    Parameters
    ----------
    node : DiffDriveNode
        Who triggers them.
    services : mapping of str to sequence of str
        Names of the services that belong together.
    complain : callable
        Called with a text where nobody serves one, or it was not done.

    """

    def __init__(
            self, node: Any, services: Mapping[str, Sequence[str]],
            complain: Callable[[str], None]) -> None:
        self._complain = complain
        self._clients = {name: [node.runtime.client(Trigger, service) for service in each]
                         for name, each in services.items()}

    def call(self, name: str) -> None:
        """Trigger those of a name."""
        for client in self._clients[name]:
            if client.service_is_ready():
                client.call_async(Trigger.Request()).add_done_callback(self._answered)
            else:
                self._complain(f"nobody serves '{client.srv_name}'")

    def _answered(self, future: Any) -> None:
        if not future.result().success:
            self._complain(future.result().message)
