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

"""Descriptions of parameters are whole sentences, and those of topics say which way they go."""

from diffdrive_kinematics.ros.parameters.parameter_checks import (
    check_optional_topic, check_topic)
from diffdrive_kinematics.ros.parameters.tables import TABLES
import pytest

SPECS = [(node, spec) for node, table in TABLES.items() for spec in table]


@pytest.mark.parametrize(
    'node, spec', SPECS, ids=[f'{node}:{spec.name}' for node, spec in SPECS])
def test_a_description_is_made_of_sentences(node, spec):
    assert spec.description[0].isupper() and spec.description.endswith('.')
    assert '{' not in spec.description
    if spec.check in (check_topic, check_optional_topic):
        assert spec.description.startswith(('Publishes: ', 'Subscribes to: '))
    if spec.check is check_optional_topic and 'emergency' not in spec.name:
        assert spec.description.endswith('Empty: off.')
