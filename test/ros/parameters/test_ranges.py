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

"""The ranges that parameter tools are told are those that the checks have."""

import math

from diffdrive_kinematics.nodes.forward_projection import ForwardProjection
from diffdrive_kinematics.ros.parameters.parameter_spec import Kind, range_of
from diffdrive_kinematics.ros.parameters.parameters import coerce
from diffdrive_kinematics.ros.parameters.tables import TABLES
import pytest
from rcl_interfaces.srv import DescribeParameters
from rclpy.parameter import Parameter
from support.graph import KHEPERA
from support.inside import inside

ENTRIES = {(entry.name, entry.check): entry for table in TABLES.values() for entry in table
           if range_of(entry)}


@pytest.mark.parametrize('entry', ENTRIES.values(), ids=lambda entry: entry.name)
def test_the_ends_of_a_range_are_accepted_and_what_is_beyond_is_refused(entry):
    ends = range_of(entry)
    for end, outward in zip(ends, (-1, 1)):
        coerce(entry, end)
        beyond = (end + outward if entry.kind is Kind.INTEGER
                  else math.nextafter(end, outward * math.inf))
        if beyond != 2**63:  # which no message can carry
            with pytest.raises(ValueError, match=f'{entry.name} is'):
                coerce(entry, beyond)


def test_tools_are_told_the_range_and_the_node_refuses_in_its_own_words():
    with inside(ForwardProjection, KHEPERA) as held:
        node = held.node
        service, = (each for each in node.services if each.srv_type is DescribeParameters)
        samples, rate, radius = service.callback(
            DescribeParameters.Request(names=['samples', 'publish_rate', 'wheel_radius']),
            DescribeParameters.Response()).descriptors
        bounds, = samples.integer_range
        assert (bounds.from_value, bounds.to_value, bounds.step) == (1, 100_000, 0)
        bounds, = rate.floating_point_range
        assert (bounds.from_value, bounds.to_value, bounds.step) == (1e-6, 1e6, 0.0)
        assert not radius.floating_point_range  # its lower bound is open
        assert samples.description and samples.additional_constraints
        result, = node.set_parameters([Parameter('samples', value=0)])
        assert not result.successful
        assert result.reason == 'samples is 0, expected an integer from 1 to 100000'
