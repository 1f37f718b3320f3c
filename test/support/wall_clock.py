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

"""The wall clock of processes, which a test can step; all other clocks of theirs go on."""

from pathlib import Path
import shutil
import struct
import subprocess

SOURCE = Path(__file__).with_suffix('.c')
COMPILER = shutil.which('cc')
OFFSET = struct.Struct('=q')


class WallClock:
    """Compiles the library that shifts the clock, and tells it by how much."""

    def __init__(self, directory):
        library, self._file = directory / 'wall_clock.so', directory / 'offset'
        subprocess.run(
            [COMPILER, '-shared', '-fPIC', '-O1', '-o', str(library), str(SOURCE), '-ldl'],
            check=True)
        self.environment = {'LD_PRELOAD': str(library), 'WALL_CLOCK_OFFSET': str(self._file)}
        self.offset_s = 0
        self._file.write_bytes(OFFSET.pack(0))

    def step(self, seconds):
        """Step the clock of all processes that have the environment."""
        self.offset_s += seconds
        with self._file.open('r+b') as file:  # in place: they have it mapped
            file.write(OFFSET.pack(self.offset_s))
