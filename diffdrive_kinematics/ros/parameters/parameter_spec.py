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

"""A parameter: its name, type, default and meaning, its check, and how ROS describes it."""

from dataclasses import dataclass, replace
import enum
from functools import partial
import math
import os
from typing import Any, Callable, Mapping, Optional, Tuple

from diffdrive_kinematics.core.kinematics import check_rate
from diffdrive_kinematics.ros.parameters.parameter_checks import (
    Check, check_optional_topic, check_topic, Within)
from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
from rcl_interfaces.srv import DescribeParameters

Answer = Callable[[DescribeParameters.Request, DescribeParameters.Response],
                  DescribeParameters.Response]


class Kind(enum.Enum):
    """Type of a parameter, in words for its user."""

    BOOL = 'true or false'
    INTEGER = 'an integer'
    DOUBLE = 'a number'
    STRING = 'a string'
    STRINGS = 'a list of strings'
    DOUBLES = 'a list of numbers'


IMPOSSIBLE = {Kind.DOUBLE: -math.inf, Kind.INTEGER: -2**62, Kind.STRING: '~ ', Kind.STRINGS: (),
              Kind.DOUBLES: (-math.inf,)}


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


def descriptor_of(entry: ParameterSpec) -> ParameterDescriptor:
    """
    Return the descriptor of a parameter.

    What its check expects stands there in words, as many bounds are open or allow NaN.  Its type
    is said to be dynamic so that values of another type are refused in our words, not rclpy's.
    """
    return ParameterDescriptor(
        description=entry.description, dynamic_typing=True, read_only=entry.read_only,
        additional_constraints=_expected(entry))


def _expected(entry: ParameterSpec) -> str:
    """Return what the check of a parameter expects, in the words of its error; '' for none."""
    try:
        if entry.check is not None:
            entry.check(entry.name, IMPOSSIBLE[entry.kind])
    except ValueError as error:
        return str(error).partition('expected ')[2].partition(' (topic')[0]
    return ''


def range_of(entry: ParameterSpec) -> Optional[Tuple[float, float]]:
    """Return the ends of what a parameter may be; None where it has not two, or an exception."""
    if entry.check is check_rate:
        return 1e-6, 1e6
    return (entry.check.least, entry.check.most) if isinstance(entry.check, Within) else None


def with_ranges(answer: Answer, table: Callable[[], Mapping[str, ParameterSpec]]) -> Answer:
    """
    Return the answer of the service that describes parameters, with ranges of numbers added.

    They are not in the descriptors that rclpy keeps: it would refuse a value by them itself,
    without a line in the log, and in words that lack the unit and what to set instead.

    Parameters
    ----------
    answer : callable
        The service's callback.
    table : callable
        Returns the parameters of the node, by name.

    """
    def ranged(
            request: DescribeParameters.Request, response: DescribeParameters.Response
    ) -> DescribeParameters.Response:
        response = answer(request, response)
        response.descriptors = [
            _ranged(each, table().get(each.name)) for each in response.descriptors]
        return response

    return ranged


def _ranged(kept: ParameterDescriptor, entry: Optional[ParameterSpec]) -> ParameterDescriptor:
    """Return a copy of a descriptor with the range of the parameter, where it has one."""
    ends = entry and range_of(entry)
    if not ends:
        return kept
    least, most = ends
    ranged = ParameterDescriptor(**{
        name: getattr(kept, name) for name in kept.get_fields_and_field_types()})
    if entry.kind is Kind.INTEGER:
        ranged.integer_range = [IntegerRange(from_value=int(least), to_value=int(most))]
    else:
        ranged.floating_point_range = [FloatingPointRange(from_value=least, to_value=most)]
    return ranged
