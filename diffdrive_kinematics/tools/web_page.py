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

"""
The page of ``web_view``: NiceGUI for what is read and set, one WebSocket for map and driving.

The server runs in a thread of its own.  What viewers do comes out of :attr:`WebPage.actions`, what
they are to see goes in by :meth:`WebPage.send` and :meth:`WebPage.show`: the node calls all three
from its own thread, and nothing of ROS is touched here.
"""

import asyncio
from collections import deque
from itertools import count
import json
import math
from pathlib import Path
import socket
import threading
import time
from typing import Any, Deque, Dict, Mapping, NamedTuple, Sequence, Set

from diffdrive_kinematics.tools.same_origin import LOOPBACK, SameOrigin
from fastapi import FastAPI, WebSocket, WebSocketDisconnect
from nicegui import binding, ui
import uvicorn

HERE = Path(__file__).parent
START_S = 10.0
REST_S = 0.5  # after which a slider is not being moved any more
MOST_A_SECOND = 200  # messages of a viewer; a page sends some 20


class Action(NamedTuple):
    """What a viewer did: ``name`` is drive, goal, set, reset, stop, resume, joined or left."""

    viewer: int
    name: str
    value: Any = None


class Slider(NamedTuple):
    """A number that is set: its name, label, range and step."""

    name: str
    label: str
    low: float
    high: float
    step: float


class _Knob(ui.slider):
    """A slider whose page sets it at once: what the server answers may be older by then."""

    LOOPBACK = False


class WebPage:
    """
    Serves the page.

    Parameters
    ----------
    title : str
        Of the page.
    host, port : str, int
        Where it listens; port 0 takes a free one.
    sliders : sequence of Slider
        The numbers that viewers set.
    setup : mapping
        What the map has to know once: geometry of the robot and speeds.

    Raises
    ------
    OSError
        If it cannot listen there.

    """

    def __init__(
            self, title: str, host: str, port: int, sliders: Sequence[Slider],
            setup: Mapping[str, Any]) -> None:
        self.actions: Deque[Action] = deque()
        self._sliders, self._setup = sliders, setup
        self._sockets: Set[WebSocket] = set()
        self._busy: Set[WebSocket] = set()
        self._numbers = count(1)
        self._model = _model_of(sliders)
        self._moved_s = -math.inf
        self._listening = socket.create_server((host, port), reuse_port=False)
        self.port = self._listening.getsockname()[1]
        api = FastAPI()
        api.add_api_websocket_route('/robot', self._serve_viewer)
        api.add_middleware(SameOrigin, loopback=host in LOOPBACK)
        ui.page('/', title=title)(self._page)
        ui.run_with(api, dark=None, reconnect_timeout=3.0, show_welcome_message=False)
        self._server = uvicorn.Server(uvicorn.Config(
            api, log_level='critical', ws_ping_interval=2.0, ws_ping_timeout=2.0,
            timeout_graceful_shutdown=1))
        self._started = threading.Event()
        self._loop: Any = None
        self._thread = threading.Thread(target=self._run, name='web_page', daemon=True)
        self._thread.start()
        self._started.wait(START_S)

    @property
    def viewers(self) -> int:
        """Return how many viewers there are."""
        return len(self._sockets)

    def send(self, frame: Mapping[str, Any]) -> None:
        """Send every viewer a frame."""
        self._call(self._broadcast, json.dumps(frame, separators=(',', ':'), allow_nan=False))

    def show(self, values: Mapping[str, float]) -> bool:
        """Set sliders of all viewers; False: one is being moved, and would be moved back."""
        at_rest = time.monotonic() > self._moved_s + REST_S
        if at_rest:
            self._call(self._set, dict(values))
        return at_rest

    def close(self) -> None:
        """End the server."""
        self._server.should_exit = True
        self._thread.join(START_S)

    def _call(self, function: Any, *arguments: Any) -> None:
        if self._loop is not None and self._loop.is_running():
            self._loop.call_soon_threadsafe(function, *arguments)

    def _run(self) -> None:
        async def serve() -> None:
            self._loop = asyncio.get_running_loop()
            self._started.set()
            await self._server.serve(sockets=[self._listening])

        asyncio.run(serve())

    def _set(self, values: Dict[str, float]) -> None:
        for name, value in values.items():
            setattr(self._model, name, value)

    def _broadcast(self, text: str) -> None:
        for viewer in self._sockets - self._busy:  # one that is slow misses frames
            self._busy.add(viewer)
            self._loop.create_task(self._send(viewer, text))

    async def _send(self, viewer: WebSocket, text: str) -> None:
        try:
            await viewer.send_text(text)
        except (RuntimeError, WebSocketDisconnect):  # it has just left
            pass
        finally:
            self._busy.discard(viewer)

    async def _serve_viewer(self, viewer: WebSocket) -> None:
        number = next(self._numbers)
        await viewer.accept()
        await viewer.send_text(json.dumps({'viewer': number, **self._setup}))
        self._sockets.add(viewer)
        self.actions.append(Action(number, 'joined'))
        try:
            second, heard = 0, 0
            while True:
                name, value = json.loads(await viewer.receive_text())
                now = int(time.monotonic())
                second, heard = now, heard + 1 if now == second else 1
                if heard > MOST_A_SECOND or name in ('joined', 'left'):
                    await viewer.close(1008)
                    break
                self.actions.append(Action(number, str(name), value))
        except (WebSocketDisconnect, ValueError, TypeError, RecursionError):
            pass
        finally:
            self._sockets.discard(viewer)
            self.actions.append(Action(number, 'left'))

    def _page(self) -> None:
        """Build the page of one viewer."""
        ui.add_css(HERE / 'web_page.css')
        ui.add_body_html(f'<script>{(HERE / "web_page.js").read_text()}</script>')
        with ui.element('div').classes('dd-page'):
            with ui.element('div').classes('dd-map'):
                ui.html('<canvas id="dd-map"></canvas><div id="dd-state"></div>'
                        '<div id="dd-legend"></div>', sanitize=False)
                ui.button('Fit', icon='fit_screen').props(
                    'id=dd-fit dense size=sm').classes('dd-fit')
            with ui.element('div').classes('dd-panel'):
                self._driving()
                self._noise()
                ui.html('<div id="dd-plots"></div><div id="dd-health"></div>', sanitize=False)

    def _driving(self) -> None:
        with ui.row().classes('dd-row'):
            ui.html('<div id="dd-pad" role="application" aria-label="joystick"><i></i></div>',
                    sanitize=False)
            with ui.column().classes('gap-2'):
                ui.button('Emergency stop', icon='dangerous', color='negative',
                          on_click=lambda: self._act('stop'))
                ui.button('Release', icon='lock_open', on_click=lambda: self._act('resume'))
                ui.button('Reset poses', icon='restart_alt', on_click=lambda: self._act('reset'))
        ui.label('Drive: arrow keys, WASD or the stick. Click on the map: drive there.').classes(
            'dd-hint')

    def _noise(self) -> None:
        for slider in self._sliders:
            with ui.row().classes('dd-row'):
                ui.label(slider.label).classes('dd-label')
                _Knob(min=slider.low, max=slider.high, step=slider.step).bind_value(
                    self._model, slider.name).on('update:model-value', self._moved).on(
                        'change', lambda event, name=slider.name: self._act(
                            'set', (name, event.args))).classes('dd-slider').props(
                                f'id=dd-{slider.name} aria-label="{slider.label}"')
                ui.label().bind_text_from(
                    self._model, slider.name, lambda value: f'{value:g}').classes('dd-number')

    def _moved(self) -> None:
        self._moved_s = time.monotonic()

    def _act(self, name: str, value: Any = None) -> None:
        self.actions.append(Action(0, name, value))


def _model_of(sliders: Sequence[Slider]) -> Any:
    """Return one object whose attributes all viewers' sliders are bound to."""
    properties = {slider.name: binding.BindableProperty() for slider in sliders}
    model = type('Model', (), properties)()
    for slider in sliders:
        setattr(model, slider.name, 0.0)
    return model
