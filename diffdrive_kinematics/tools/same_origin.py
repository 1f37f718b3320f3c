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

"""Whose requests a web server that drives a robot answers."""

from typing import Any
from urllib.parse import urlsplit

LOOPBACK = ('127.0.0.1', 'localhost', '::1')


class SameOrigin:
    """
    Lets in nobody but pages of this server: who reaches it drives the robot.

    A browser says in ``Origin`` which page asks, also for a WebSocket, which other sites may open;
    and in ``Host`` by which name, which other sites may give to this machine.
    """

    def __init__(self, app: Any, *, loopback: bool) -> None:
        self._app, self._loopback = app, loopback

    async def __call__(self, scope: Any, receive: Any, send: Any) -> None:
        """Serve a request, or refuse it with 403."""
        headers = dict(scope.get('headers', ()))
        origin, host = headers.get(b'origin'), headers.get(b'host', b'')
        name = urlsplit(b'//' + host).hostname or b''
        named = (scope['type'] == 'lifespan' or not self._loopback
                 or name.decode('latin-1') in LOOPBACK)
        if named and (origin is None or urlsplit(origin).netloc == host):
            await self._app(scope, receive, send)
        elif scope['type'] == 'websocket':
            await send({'type': 'websocket.close', 'code': 1008})
        else:
            await send({'type': 'http.response.start', 'status': 403, 'headers': []})
            await send({'type': 'http.response.body', 'body': b'other origins are refused'})
