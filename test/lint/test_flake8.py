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

"""The Python files follow the code style of ROS 2."""

from pathlib import Path
import subprocess
import sys

import pytest

ROOT = Path(__file__).resolve().parents[2]
SOURCES = [str(ROOT / name) for name in ('setup.py', 'docs', 'diffdrive_kinematics', 'test')]


@pytest.mark.flake8
@pytest.mark.linter
@pytest.mark.slow
def test_flake8_finds_nothing():
    """The configuration is that of ament_flake8."""
    # In a process of its own: flake8 forks, which the threads of other tests do not survive.
    # In test/: ament_flake8 walks through the current directory, which could be anything.
    checked = subprocess.run([sys.executable, '-m', 'ament_flake8.main', *SOURCES],
                             cwd=ROOT / 'test', capture_output=True, text=True)
    code = checked.returncode
    findings, _, files = checked.stdout.partition('Checked files:')
    assert code == 0, findings + checked.stderr
    assert str(ROOT / 'diffdrive_kinematics/core/kinematics/arc.py') in files
