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

"""The script of the page on campaigns: the same numbers whoever computes them."""

from pathlib import Path
import re
import runpy
import subprocess
import sys
import tracemalloc

import pytest

PAGE = Path(__file__).resolve().parents[3] / 'docs/how_to/campaigns.md'

pytest.importorskip('distributed', reason="needs pip install '.[campaign]'")


@pytest.fixture
def script(tmp_path):
    code = re.search(r'<!-- campaign.py -->\n```python\n(.*?)```', PAGE.read_text('utf-8'), re.S)
    file = tmp_path / 'campaign.py'
    file.write_text(code[1], encoding='utf-8')
    return file


def printed(script, workers):
    return subprocess.run(
        [sys.executable, str(script), '--workers', str(workers), '--paths', '100000',
         '--chunk', '16000'], check=True, capture_output=True, text=True, timeout=250,
        cwd=script.parent).stdout


@pytest.mark.slow
def test_one_and_two_workers_print_the_same_digits_and_a_covariance_that_is_right(script):
    once = printed(script, 1)
    assert once == printed(script, 2)
    paths, nees, error, beyond = map(float, re.fullmatch(
        r'(\d+) paths: NEES / 3 = (\S+) \+- (\S+), (\S+) beyond 95 %\n', once).groups())
    assert paths == 100_000
    assert abs(nees - 1.0) < 5.0 * error and error < 0.01
    assert beyond == pytest.approx(0.05, abs=0.005)


def test_the_memory_of_a_chunk_is_that_of_its_paths_alone(script):
    sums_of_chunk, peak = runpy.run_path(str(script))['sums_of_chunk'], []
    for paths in (20_000, 100_000):
        tracemalloc.start()
        sums = sums_of_chunk(1, 0, paths)
        peak.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
        assert sums.shape == (4,)
    assert peak[1] - peak[0] < 80_000 * 8 * 20
