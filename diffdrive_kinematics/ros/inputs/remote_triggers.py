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

"""Services of other nodes that are triggered, and what comes of it."""

from typing import Any, Callable, Mapping, Sequence

from std_srvs.srv import Trigger


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
