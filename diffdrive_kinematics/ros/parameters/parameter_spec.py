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

"""A parameter: its name, type, default and meaning, and what its value must satisfy."""

from dataclasses import dataclass, replace
import enum
from functools import partial
import os
from typing import Any, Optional

from diffdrive_kinematics.ros.parameters.parameter_checks import (
    Check, check_optional_topic, check_topic)


class Kind(enum.Enum):
    """Type of a parameter, in words for its user."""

    BOOL = 'true or false'
    INTEGER = 'an integer'
    DOUBLE = 'a number'
    STRING = 'a string'
    STRINGS = 'a list of strings'
    DOUBLES = 'a list of numbers'


@dataclass(frozen=True)
class ParameterSpec:
    """One parameter: name, default, meaning, and what a value must satisfy."""

    name: str
    default: Any
    description: str
    kind: Kind = Kind.DOUBLE
    check: Optional[Check] = None
    read_only: bool = False
    required: bool = False
    names_files: bool = False

    def expanded(self, value: Any) -> Any:
        """Return a value with the home directory for ``~`` where it names files."""
        if not self.names_files or value is None:
            return value
        if isinstance(value, str):
            return os.path.expanduser(value)
        return tuple(map(os.path.expanduser, value))


def settable(
        name: str, default: Any, description: str, check: Optional[Check] = None, *,
        kind: Optional[Kind] = None, required: bool = False) -> ParameterSpec:
    """Return a parameter that can be set at any time, of the kind of its default."""
    return ParameterSpec(
        name, default, description, kind or _kind_of(default), check, required=required)


def fixed(
        name: str, default: Any, description: str, check: Optional[Check] = None, *,
        kind: Optional[Kind] = None, names_files: bool = False) -> ParameterSpec:
    """Return a parameter that is set at the start and stays."""
    entry = settable(name, default, description, check, kind=kind)
    return replace(entry, read_only=True, names_files=names_files)


file = partial(fixed, names_files=True)


def topic(name: str, default: str, description: str, *, optional: bool = False) -> ParameterSpec:
    return fixed(name, default, description, check_optional_topic if optional else check_topic)


def _kind_of(default: Any) -> Kind:
    """Return the kind of a default; an empty list is one of numbers."""
    if isinstance(default, list):
        return Kind.STRINGS if default and isinstance(default[0], str) else Kind.DOUBLES
    kinds = {bool: Kind.BOOL, int: Kind.INTEGER, float: Kind.DOUBLE, str: Kind.STRING}
    return kinds[type(default)]
