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

"""Every Python file of the repository carries the licence header."""

import os
from pathlib import Path
import re

import pytest

ROOT = Path(__file__).resolve().parents[2]
NOT_SOURCES = ('build', 'install', 'log')

HEADER = re.compile(r"""# Copyright 20\d\d diffdrive_kinematics contributors
#
# Licensed under the Apache License, Version 2\.0 \(the "License"\);
# you may not use this file except in compliance with the License\.
# You may obtain a copy of the License at
#
#     http://www\.apache\.org/licenses/LICENSE-2\.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied\.
# See the License for the specific language governing permissions and
# limitations under the License\.
""")


def python_files(root):
    """Yield the Python files below a directory, without virtual environments and builds."""
    for directory, children, files in os.walk(root):
        if 'pyvenv.cfg' in files:
            children.clear()
            continue
        children[:] = [name for name in children if not name.startswith('.')
                       and not (directory == str(root) and name in NOT_SOURCES)]
        yield from (Path(directory, name) for name in files if name.endswith('.py'))


@pytest.mark.copyright
@pytest.mark.linter
def test_every_python_file_starts_with_the_licence_header():
    """A file without the header has no known licence."""
    files = sorted(python_files(ROOT))
    assert ROOT / 'diffdrive_kinematics/core/kinematics/arc.py' in files
    without = [str(file.relative_to(ROOT)) for file in files
               if not HEADER.match(file.read_text(encoding='utf-8'))]
    assert not without


@pytest.mark.copyright
@pytest.mark.linter
def test_the_licence_is_the_whole_apache_licence():
    """The header and package.xml point to this text."""
    text = (ROOT / 'LICENSE').read_text(encoding='utf-8')
    assert re.search(r'Apache License\s+Version 2\.0, January 2004', text)
    assert '9. Accepting Warranty or Additional Liability.' in text
