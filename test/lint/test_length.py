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

"""No file of the package is longer than can be read at one go."""

from pathlib import Path

import pytest

PACKAGE = Path(__file__).resolve().parents[2] / 'diffdrive_kinematics'
LONGEST = 250  # lines, with the licence


@pytest.mark.linter
@pytest.mark.parametrize('path', sorted(PACKAGE.rglob('*.py')), ids=lambda path: path.stem)
def test_no_file_of_the_package_is_longer_than_250_lines(path):
    assert len(path.read_text(encoding='utf-8').splitlines()) <= LONGEST
