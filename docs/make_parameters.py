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

"""Print docs/reference/parameters.md from the parameter tables of the nodes."""

import math

from diffdrive_kinematics.ros.parameters.parameter_spec import ParameterSpec
from diffdrive_kinematics.ros.parameters.tables import TABLES

HEAD = """# Parameters

Generated from the parameter tables:
`python docs/make_parameters.py > docs/reference/parameters.md`.

Names, units and defaults are those of ros2_controllers' `diff_drive_controller` wherever it has
the same thing. Integers are accepted for numbers. A value that breaks its rule is refused with
its name, the value and the rule: at start the node does not start (exit status 2), at run time the
old value stays. Parameters marked *fixed* are read once, at start. A parameter that no node of
the package knows is reported in the log, with the name that was probably meant.

In a params file `/**` stands first and holds what all nodes share; a node's own section comes
after it. On the command line `-p NAME:=VALUE` replaces a value of `/**`, and
`-p NODE:NAME:=VALUE` one of the node's own section.
"""


def default(entry: ParameterSpec) -> str:
    """Return the default as YAML has it."""
    if entry.required:
        return '**required**'
    value = entry.default
    if isinstance(value, float) and math.isnan(value):
        return '`.nan`'
    if isinstance(value, bool):
        return f'`{str(value).lower()}`'
    return f'`{value}`'.replace("'", '') if value != '' else "`''`"


def row(entry: ParameterSpec) -> str:
    """Return the table row of a parameter."""
    name = f'`{entry.name}`' + (' *fixed*' if entry.read_only else '')
    description = entry.description.replace('|', '\\|')
    return f'| {name} | {default(entry)} | {description} |'


def main() -> None:
    """Print the page."""
    print(HEAD)
    for node, table in TABLES.items():
        print(f'## {node}\n\n| parameter | default | meaning |\n|---|---|---|')
        print('\n'.join(map(row, table)), end='\n\n')


if __name__ == '__main__':
    main()
