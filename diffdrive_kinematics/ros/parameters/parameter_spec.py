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
import os
from typing import Any, Optional

from diffdrive_kinematics.ros.parameters.parameter_checks import (
    Check, check_optional_topic, check_topic)

__all__ = ['Kind', 'ParameterSpec', 'file', 'string', 'topic']


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


def string(
        name: str, default: str, description: str, check: Optional[Check] = None
) -> ParameterSpec:
    return ParameterSpec(name, default, description, Kind.STRING, check, read_only=True)


def file(
        name: str, default: str, description: str, check: Optional[Check] = None
) -> ParameterSpec:
    return replace(string(name, default, description, check), names_files=True)


def topic(name: str, default: str, description: str, *, optional: bool = False) -> ParameterSpec:
    return string(name, default, description, check_optional_topic if optional else check_topic)
