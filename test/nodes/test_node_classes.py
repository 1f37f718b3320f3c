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

"""The class of each executable takes what ``rclpy.node.Node`` takes."""

from importlib import import_module
import os
import pty

from diffdrive_kinematics import executables
from diffdrive_kinematics.ros.runtime.node import DiffDriveNode
import pytest
import rclpy
from rclpy.parameter import Parameter
from support.domains import own_domain
from support.graph import KHEPERA

pytestmark = [pytest.mark.ros, pytest.mark.slow]

NEEDED = {  # beside the geometry
    'command_sequence': {'commands': [0.1, 0.0, 1.0]}, 'plot_paths': {'commands': [0.1, 0.0, 1.0]},
    'diffdrive_sim': {'nodes': ['simulated_base:base', 'wheel_noise'], 'enable_odom_tf': False},
    'simulated_base': {'enable_odom_tf': False}, 'wheel_odometry': {'enable_odom_tf': False},
    'web_view': {'port': 0}}


def class_of(executable):
    """Return the class of nodes that the module of an executable defines."""
    module = import_module(f'diffdrive_kinematics.nodes.{executable}')
    made, = (each for each in vars(module).values() if isinstance(each, type)
             and issubclass(each, DiffDriveNode) and each.__module__ == module.__name__)
    return made


@pytest.fixture
def terminal(monkeypatch):
    """Let the standard input be a terminal, which teleop needs."""
    ends = pty.openpty()
    with os.fdopen(ends[1]) as stdin:
        monkeypatch.setattr('sys.stdin', stdin)
        yield
    os.close(ends[0])


@pytest.mark.parametrize('executable', executables.__all__)
def test_a_class_takes_a_context_and_overrides_and_arguments(executable, terminal):
    assert not rclpy.ok()  # nothing but what is given is to be used
    context = rclpy.Context()
    with own_domain() as domain:
        rclpy.init(context=context, domain_id=domain)
        node = None
        try:
            node = class_of(executable)(
                context=context, namespace='robot', use_global_arguments=False,
                parameter_overrides=[
                    Parameter(name, value=value)
                    for name, value in {**KHEPERA, **NEEDED.get(executable, {})}.items()],
                cli_args=['--ros-args', '-p', 'wheel_radius:=0.5', '-r', '__node:=mine'])
            assert node.context is context
            assert node.get_namespace() == '/robot'
            assert node.get_name() == 'mine'
            if 'wheel_separation' in node.parameters.values:
                assert node.parameters.values['wheel_separation'] == KHEPERA['wheel_separation']
                assert node.parameters.values['wheel_radius'] == KHEPERA['wheel_radius']
            node.close()
        finally:
            if node:
                node.destroy_node()
            rclpy.try_shutdown(context=context)
    assert not rclpy.ok()
