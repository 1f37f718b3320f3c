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

"""Where the installed files of the package are."""

from pathlib import Path
from typing import List

PACKAGE = 'diffdrive_kinematics'
SCHEME = 'package://'


def share_directory() -> Path:
    """
    Return the directory with the installed ``config``, or the source tree's.

    Every kind of installation has it as ``share/`` of the prefix that holds this file (ROS,
    colcon, a virtual environment), or, where the sources are used in place, beside the package.

    Raises
    ------
    FileNotFoundError
        If it is in none of these places.

    """
    candidates = [
        place for parent in Path(__file__).resolve().parents
        for place in (parent, parent / 'share' / PACKAGE)]
    for candidate in candidates:
        if (candidate / 'config' / 'demo.yaml').is_file():
            return candidate
    raise FileNotFoundError(f'config/demo.yaml is in none of {list(map(str, candidates))}')


def resolved(path: str) -> str:
    """
    Return the path of a file that is named as one of the installed package.

    Parameters
    ----------
    path : str
        ``package://diffdrive_kinematics/`` and the path in its share directory, or another path,
        which is returned as it is.

    Raises
    ------
    ValueError
        If another package is named.

    """
    if not path.startswith(SCHEME):
        return path
    package, _, inside = path[len(SCHEME):].partition('/')
    if package != PACKAGE:
        raise ValueError(f'{path!r} is in another package, expected {SCHEME}{PACKAGE}/..., or the '
                         'path of a file')
    return str(share_directory() / inside)


def with_params_file(argv: List[str], name: str) -> List[str]:
    """Return the command line, with a file of ``config`` where it names no params file."""
    if '--params-file' in argv:
        return argv
    file = share_directory() / 'config' / name
    return [argv[0], '--ros-args', '--params-file', str(file), '--', *argv[1:]]
