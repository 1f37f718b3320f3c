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

"""What the command line and params files set for a node: rclpy keeps it in a private attribute."""

import ast
from pathlib import Path

from diffdrive_kinematics.nodes.simulated_base import SimulatedBase
from diffdrive_kinematics.ros.parameters.configuration_error import ConfigurationError
from diffdrive_kinematics.ros.runtime.rclpy_private import given_overrides
import pytest
import rclpy
from rclpy.node import Node

PACKAGE = Path(__file__).resolve().parents[3] / 'diffdrive_kinematics'
KHEPERA = ['-p', 'wheel_radius:=0.021', '-p', 'wheel_separation:=0.0885']


@pytest.fixture
def started(tmp_path):
    """Initialise rclpy in a domain of its own, with parameters of whatever node is made."""
    from support.domains import own_domain
    with own_domain() as domain:
        rclpy.init(args=['--ros-args', *KHEPERA, '-p', 'wheel_radios:=0.1'],
                   domain_id=domain)
        yield
        rclpy.try_shutdown()


@pytest.fixture
def renamed(monkeypatch):
    """Make rclpy one that keeps the overrides under another name."""
    def init(self, *arguments, **options):
        real(self, *arguments, **options)
        self._overrides = self.__dict__.pop('_parameter_overrides')

    real = Node.__init__
    monkeypatch.setattr(Node, '__init__', init)


def test_the_overrides_of_a_node_are_those_that_were_given(started):
    node = Node('any')
    try:
        assert {'wheel_radius', 'wheel_separation', 'wheel_radios'} <= set(given_overrides(node))
    finally:
        node.destroy_node()


def test_an_rclpy_that_keeps_them_elsewhere_is_named_and_no_node_starts(started, renamed):
    """Else typos would no longer be reported, and qualities of service not obeyed, in silence."""
    with pytest.raises(ConfigurationError) as refused:
        SimulatedBase()
    for word in ('/simulated_base refuses to start', '_parameter_overrides', 'rclpy'):
        assert word in str(refused.value)


@pytest.mark.parametrize('path', sorted(PACKAGE.rglob('*.py')), ids=lambda path: path.stem)
def test_no_private_attribute_is_read_with_a_default(path):
    """One that is renamed would be taken for one that is empty."""
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Call) and getattr(node.func, 'id', '') in ('getattr', 'hasattr'):
            name = node.args[1]
            assert not (isinstance(name, ast.Constant) and name.value.startswith('_'))
