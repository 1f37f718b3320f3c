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
"""Names of files in parameters: ``~`` is the home directory, as in a shell."""

import re

from diffdrive_kinematics.ros.parameters.parameter_spec import Kind
from diffdrive_kinematics.ros.parameters.parameters import coerce
from diffdrive_kinematics.ros.parameters.tables import TABLES
import pytest

NAMED = [(executable, entry) for executable, table in TABLES.items() for entry in table
         if entry.kind in (Kind.STRING, Kind.STRINGS)
         and re.match(r'(CSV |Params )?[Ff]ile|Picture of|Recording|Bags', entry.description)]


def ids(value):
    return getattr(value, 'name', value)


def test_files_are_found_by_what_parameters_say_of_themselves():
    assert len(NAMED) >= 12
    assert {entry.name for table in TABLES.values() for entry in table if entry.names_files} == {
        entry.name for _, entry in NAMED}


@pytest.mark.parametrize('executable, entry', NAMED, ids=ids)
def test_a_file_may_be_named_from_the_home_directory(executable, entry, monkeypatch):
    monkeypatch.setenv('HOME', '/somewhere')
    ending = next((each for each in ('.csv', '.svg', '.yaml')
                   if accepted(entry, f'a{each}')), '')
    value = accepted(entry, f'~/drives/a{ending}')
    assert value == f'/somewhere/drives/a{ending}'
    for other in (f'a~/b{ending}', f'/tmp/~{ending}', f'package://diffdrive_kinematics/a{ending}'):
        assert accepted(entry, other) == other


def accepted(entry, name):
    """Return what a parameter makes of the name of a file, '' where it refuses it."""
    listed = entry.kind is Kind.STRINGS
    try:
        value = coerce(entry, [name] if listed else name)
    except ValueError:
        return ''
    return value[0] if listed else value
