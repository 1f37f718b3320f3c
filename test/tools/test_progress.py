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

"""What is shown while something takes long: on terminals only."""

import fcntl
import io
import os
import struct
import termios

from diffdrive_kinematics.tools.progress import LiveLine, Progress
import pytest


class Terminal(io.StringIO):

    def isatty(self):
        return True


def test_a_terminal_sees_one_line_that_is_cleared_at_the_end():
    terminal = Terminal()
    with Progress(terminal) as progress:
        progress('drive.csv: 4096 rows')
        progress('drive.csv: 8192 rows')  # too soon after the other one
        progress('fitting', begins=True)
    text = terminal.getvalue()
    assert text.startswith('\rdrive.csv: 4096 rows, 0 s') and 'fitting, 0 s' in text
    assert '8192' not in text and text.endswith('\r\x1b[K') and '\n' not in text


@pytest.mark.parametrize('kind', [Progress, LiveLine])
def test_a_line_is_cut_to_the_width_of_its_own_terminal(kind, monkeypatch):
    """A longer one would become two, of which only the second is written over."""
    monkeypatch.setenv('COLUMNS', '200')  # of another terminal
    reader, writer = os.openpty()
    fcntl.ioctl(writer, termios.TIOCSWINSZ, struct.pack('HHHH', 24, 40, 0, 0))
    with os.fdopen(writer, 'w') as terminal, os.fdopen(reader, 'rb') as screen:
        kind(terminal)('x' * 100 if kind is Progress else lambda: 'x' * 100)
        line = screen.read1().decode().strip('\r').removesuffix('\x1b[K')
    assert len(line) == 39 and (kind is LiveLine or line.endswith('x, 0 s'))


def test_what_is_no_terminal_sees_nothing():
    file = io.StringIO()
    with Progress(file) as progress:
        progress('drive.csv: 4096 rows')
    assert file.getvalue() == ''


def test_a_live_line_is_written_over_by_what_comes_next_and_only_asked_for_when_due():
    terminal, asked = Terminal(), []
    live = LiveLine(terminal)
    for number in range(3):
        live(lambda: asked.append(number) or 'x' * 500)
    live.clear()
    assert asked == [0]  # the others came too soon
    line, = terminal.getvalue().split('\r')[:-1]
    assert line.rstrip('\x1b[K').count('x') < 500 and '\n' not in terminal.getvalue()
    assert terminal.getvalue().endswith('\r\x1b[K')


def test_a_live_line_is_not_even_worked_out_where_no_terminal_is():
    file = io.StringIO()
    LiveLine(file)(lambda: 1 / 0)
    assert file.getvalue() == ''
