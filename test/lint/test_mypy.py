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

"""The core is typed, strictly."""

from pathlib import Path

from mypy import api
import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.mark.mypy
@pytest.mark.linter
@pytest.mark.timeout(900)  # the first time all of it and its libraries is read
def test_mypy_finds_nothing(monkeypatch):
    """What to check, and how strictly, stands in setup.cfg."""
    monkeypatch.chdir(ROOT)
    out, err, code = api.run([])
    assert code == 0, out + err


@pytest.mark.mypy
@pytest.mark.linter
def test_mypy_is_strict_on_the_core(monkeypatch, tmp_path):
    """A function without types is refused under the settings of this package."""
    monkeypatch.chdir(ROOT)
    untyped = tmp_path / 'untyped.py'
    untyped.write_text('def double(x):\n    return 2 * x\n', encoding='utf-8')
    out, _, code = api.run(['--cache-dir', str(tmp_path / 'cache'), str(untyped)])
    assert code == 1
    assert 'no-untyped-def' in out
