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

"""The docstrings follow PEP 257, as ROS 2 reads it."""

import logging
from pathlib import Path

from ament_pep257.main import main
import pytest

ROOT = Path(__file__).resolve().parents[2]
SOURCES = [str(ROOT / name) for name in ('setup.py', 'diffdrive_kinematics', 'test')]


@pytest.mark.pep257
@pytest.mark.linter
@pytest.mark.slow
def test_pep257_finds_nothing(capfd, caplog):
    """The configuration is that of ament_pep257."""
    caplog.set_level(logging.WARNING, logger='pydocstyle.utils')  # else a line for each file
    code = main(argv=SOURCES)
    out, err = capfd.readouterr()
    assert f'checking {ROOT / "diffdrive_kinematics/core/kinematics/arc.py"}' in out
    assert code == 0, err
