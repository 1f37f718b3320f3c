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

"""The examples in the docstrings of the core do what they say, without ROS."""

from pathlib import Path
import subprocess
import sys

import pytest

ROOT = Path(__file__).resolve().parents[2]
RUN = """
import sys
sys.modules['rclpy'] = None  # an import of it would raise
import pytest
sys.exit(pytest.main(sys.argv[1:]))
"""


def run_examples(path):
    """Return what pytest says of the examples below a path; -c: by no settings of this suite."""
    return subprocess.run(
        [sys.executable, '-c', RUN, '-c', '/dev/null', '-p', 'no:cacheprovider', '--no-header',
         '-q', '--rootdir', str(path), '--import-mode=importlib', '--doctest-modules', str(path)],
        cwd=ROOT, capture_output=True, text=True)


@pytest.mark.numpydoc
@pytest.mark.linter
def test_the_examples_of_the_core_run():
    """They are what a user copies first."""
    run = run_examples(ROOT / 'diffdrive_kinematics/core')
    assert run.returncode == 0, run.stdout + run.stderr
    assert ' passed' in run.stdout


@pytest.mark.numpydoc
@pytest.mark.linter
@pytest.mark.slow
def test_an_example_that_is_wrong_is_found(tmp_path):
    """One that imports ROS, too."""
    (tmp_path / 'wrong.py').write_text('"""\n>>> 1 + 1\n3\n"""\n', encoding='utf-8')
    assert run_examples(tmp_path).returncode == 1
    (tmp_path / 'wrong.py').write_text('"""\n>>> import rclpy\n"""\n', encoding='utf-8')
    assert run_examples(tmp_path).returncode == 1
