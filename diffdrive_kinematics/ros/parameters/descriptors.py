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
"""What ``ros2 param describe`` says of a parameter."""

import math
from typing import Any, Callable, Dict, Mapping, Optional, Tuple

from diffdrive_kinematics.core.kinematics import check_rate
from diffdrive_kinematics.ros.parameters.parameter_checks import (
    check_count, check_delay, check_gear_ratio, check_optional_seed, check_port, check_seed,
    check_slip, check_stages, check_update_rate, check_window, LEAST_UPDATE_RATE, MOST,
    MOST_DELAY, MOST_IN_WINDOW, MOST_SLIP, MOST_STAGES, MOST_UPDATE_RATE)
from diffdrive_kinematics.ros.parameters.parameter_spec import Kind, ParameterSpec
from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
from rcl_interfaces.srv import DescribeParameters

__all__ = ['descriptor_of', 'with_ranges']

MOST_INTEGER = 2**63 - 1
RANGES: Dict[Any, Tuple[float, float]] = {  # of the checks that have two ends and no exception
    check_count: (1, MOST), check_window: (1, MOST_IN_WINDOW), check_stages: (1, MOST_STAGES),
    check_port: (0, 65535), check_seed: (0, MOST_INTEGER),
    check_optional_seed: (-1, MOST_INTEGER), check_rate: (1e-6, 1e6),
    check_gear_ratio: (1e-3, 1e6), check_update_rate: (LEAST_UPDATE_RATE, MOST_UPDATE_RATE),
    check_delay: (0.0, MOST_DELAY), check_slip: (0.0, MOST_SLIP)}

IMPOSSIBLE = {Kind.DOUBLE: -math.inf, Kind.INTEGER: -2**62, Kind.STRING: '~ ', Kind.STRINGS: (),
              Kind.DOUBLES: (-math.inf,)}


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


Answer = Callable[[DescribeParameters.Request, DescribeParameters.Response],
                  DescribeParameters.Response]


def with_ranges(
        answer: Answer, table: Callable[[], Mapping[str, ParameterSpec]]) -> Answer:
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


def _ranged(
        kept: ParameterDescriptor, entry: Optional[ParameterSpec]) -> ParameterDescriptor:
    """Return a copy of a descriptor with the range of the parameter, where it has one."""
    if entry is None or entry.check not in RANGES:
        return kept
    least, most = RANGES[entry.check]
    ranged = ParameterDescriptor(**{
        name: getattr(kept, name) for name in kept.get_fields_and_field_types()})
    if entry.kind is Kind.INTEGER:
        ranged.integer_range = [IntegerRange(from_value=int(least), to_value=int(most))]
    else:
        ranged.floating_point_range = [FloatingPointRange(from_value=least, to_value=most)]
    return ranged
