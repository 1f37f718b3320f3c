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
The keys of a terminal, with what is released where the terminal tells.

Terminals tell of keys that go down, again and again while they are held; those that know the
keyboard protocol of kitty (kitty, foot, WezTerm, Ghostty, recent Konsole and others) also tell
when they come up.
"""

import os
import re
import select
import termios
import time
import tty
from typing import List, NamedTuple

ASK = b'\x1b[?u\x1b[c'  # for the protocol, and for what every terminal answers
BEGIN, END = b'\x1b[>11u', b'\x1b[<u'  # all keys as escape codes, with events
ANSWER_S = 0.5
REST_S = 0.05  # after which a sequence that is not finished counts as nothing
MOST = 4096  # bytes of one that is not finished
CODE = re.compile(rb'\x1b\[(\d+)(?::[\d:]*)?(?:;(\d*)(?::(\d))?)?(?:;[\d:]*)?u')
OTHER = re.compile(rb'\x1b\[[0-9;:?<>]*[A-Za-z~]|\x1bO.|\x1b[^\[O]')
UNFINISHED = re.compile(rb'\x1b(?:\[[0-9;:?<>]*|O)?\Z')
RELEASED = 3


class Key(NamedTuple):
    """A key, and whether it came up."""

    text: str
    released: bool = False


def keys_in(data: bytes) -> List[Key]:
    r"""
    Return the keys that bytes of a terminal tell of, in their order.

    Parameters
    ----------
    data : bytes
        What was read; sequences that name no character count as nothing.

    Returns
    -------
    list of Key
        The keys.

    Examples
    --------
    >>> keys_in(b'i\x1b[A\x1b[105;1:3u')
    [Key(text='i', released=False), Key(text='i', released=True)]

    """
    keys, at = [], 0
    while at < len(data):
        code, other = CODE.match(data, at), OTHER.match(data, at)
        if code:
            number, event = int(code[1]), int(code[3] or 1)
            modifiers = int(code[2] or 1) - 1
            if number < 0x110000 and not 0xe000 <= number < 0xf900:  # else a key such as shift
                text = chr(number)
                if modifiers & 4 and text == 'c':
                    text = '\x03'  # Ctrl-C is no signal while keys come as escape codes
                keys.append(Key(text, event == RELEASED))
            at = code.end()
        elif other or data[at] == 0x1b:
            at = other.end() if other else len(data)
        else:
            keys.append(Key(chr(data[at])))
            at += 1
    return keys


class Keyboard:
    """
    A terminal whose keys come one by one, from now until it is closed.

    Parameters
    ----------
    descriptor : int
        Of the terminal.

    Raises
    ------
    ValueError
        If it is none.

    """

    def __init__(self, descriptor: int) -> None:
        self._descriptor, self._rest, self._rest_s = descriptor, b'', 0.0
        self.tells_releases = False
        try:
            self._before = termios.tcgetattr(descriptor)
        except termios.error as error:
            raise ValueError(
                'standard input is not a terminal, expected one to read keys from') from error
        try:
            tty.setcbreak(descriptor)
            self.tells_releases = self._asks()
            if self.tells_releases:
                os.write(descriptor, BEGIN)
        except BaseException:
            self.close()
            raise

    def _asks(self) -> bool:
        """Return whether the terminal knows the protocol."""
        try:
            os.write(self._descriptor, ASK)
        except OSError:  # it can be read only
            return False
        answer, end_s = b'', time.monotonic() + ANSWER_S
        while not answer.endswith(b'c') and self._is_ready(max(0.0, end_s - time.monotonic())):
            data = os.read(self._descriptor, MOST)
            if not data:
                break
            answer += data
        return re.search(rb'\x1b\[\?\d+u', answer) is not None

    def _is_ready(self, seconds: float) -> bool:
        return bool(select.select([self._descriptor], [], [], seconds)[0])

    def read(self) -> List[Key]:
        """Return the keys since the last time; raises ``EOFError`` where the terminal is gone."""
        now_s = time.monotonic()
        if not self._is_ready(0.0):
            if now_s > self._rest_s + REST_S:
                self._rest = b''
            return []
        data = os.read(self._descriptor, MOST)
        if not data:
            raise EOFError
        data = self._rest + data
        unfinished = UNFINISHED.search(data)
        self._rest = data[unfinished.start():][:MOST] if unfinished else b''
        self._rest_s = now_s
        return keys_in(data[:unfinished.start()] if unfinished else data)

    def close(self) -> None:
        """Restore the terminal."""
        try:
            if self.tells_releases:
                os.write(self._descriptor, END)
            termios.tcsetattr(self._descriptor, termios.TCSADRAIN, self._before)
        except (OSError, termios.error):  # it is gone
            pass
