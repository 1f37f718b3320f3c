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

"""``teleop``: keys of a terminal in, velocity commands out."""

import atexit
import sys
import time
from typing import Any, Mapping, Sequence, Tuple

from diffdrive_kinematics.core.commands import Helm
from diffdrive_kinematics.ros.messages.codec import TwistCodec
from diffdrive_kinematics.ros.parameters.configuration_error import refusing
from diffdrive_kinematics.ros.parameters.tables import TELEOP
from diffdrive_kinematics.ros.runtime.node import DiffDriveNode
from diffdrive_kinematics.ros.runtime.output import show
from diffdrive_kinematics.ros.runtime.running import main_of
from diffdrive_kinematics.tools.keyboard import Keyboard
from rclpy.publisher import Publisher

HELP = """Drive:    u  i  o      Speeds:   q/z  both up/down by 10 %
          j  k  l                w/x  linear
          m  ,  .                e/c  angular
i forward, comma back, j and l turn; any other key stops; Ctrl-C ends."""
MOVES = {'i': (1, 0), 'o': (1, -1), 'j': (0, 1), 'l': (0, -1), 'u': (1, 1), ',': (-1, 0),
         '.': (-1, 1), 'm': (-1, -1)}
SPEEDS = {'q': (1.1, 1.1), 'z': (0.9, 0.9), 'w': (1.1, 1.0), 'x': (0.9, 1.0), 'e': (1.0, 1.1),
          'c': (1.0, 0.9)}
SOMEBODY = 1  # at the helm
END = '\x03'


class Teleop(DiffDriveNode[Mapping[str, Any]]):
    """
    Publishes while a key is held, rest once it ends, and nothing else.

    A key ends where it is released, if the terminal tells, and after ``key_timeout`` without a
    repeat in any case: a terminal that lost the focus, or hangs, tells of no release.
    """

    def __init__(self, name: str = 'teleop', **composition: Any) -> None:
        super().__init__(name, TELEOP, dict, **composition)
        values = self.config
        self._message = TwistCodec.of(values)
        self._publisher = self.runtime.publish(self._message.message_type, values['cmd_vel_topic'])
        self._speeds = values['speed'], values['yaw_rate']
        with refusing(self.get_fully_qualified_name()):
            self._keyboard = Keyboard(sys.stdin.fileno() if sys.stdin else -1)
        atexit.register(self._keyboard.close)
        self._helm, self._key, self._drove = Helm(values['key_timeout']), '', False
        show(HELP)
        self._show_speeds()
        self.runtime.every(values['publish_rate'], self._tick, steadily=True)

    def _tick(self) -> None:
        try:
            keys = self._keyboard.read()
        except (EOFError, OSError):  # the terminal is gone
            self.done = True
            keys = []
        for key in keys:
            if key.text == END:
                self.done = True
            elif not key.released:
                self._press(key.text)
            elif key.text == self._key:
                self._helm = self._helm.left(SOMEBODY)
        self._helm = self._helm.at(time.monotonic())
        driving = bool(self._helm.viewer) and not (self.done or self.time.waits_for_clock())
        if driving or self._drove:
            self._send(self._helm.command if driving else (0.0, 0.0))
        self._drove = driving

    def _press(self, key: str) -> None:
        if key in SPEEDS:
            self._speeds = tuple(
                speed * factor for speed, factor in zip(self._speeds, SPEEDS[key]))
            self._show_speeds()
            return
        self._key = key
        move = MOVES.get(key, (0, 0))
        self._helm = self._helm.asked(
            SOMEBODY, (move[0] * self._speeds[0], move[1] * self._speeds[1]), time.monotonic())

    def _show_speeds(self) -> None:
        show('speed {:.3f} m/s, yaw rate {:.3f} rad/s'.format(*self._speeds))

    def _send(self, command: Tuple[float, float]) -> None:
        self.health.sent += 1
        self._publisher.publish(self._message.encode(self.runtime.now_ns(), *command))

    def final_command(self) -> Sequence[Publisher]:
        """Leave the robot at rest, and the terminal as it was."""
        self._keyboard.close()
        if not self.health.sent:
            return ()
        self._send((0.0, 0.0))
        return [self._publisher]


main = main_of(Teleop)
