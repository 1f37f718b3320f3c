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

"""A node that is refused is gone, and node classes take what those of rclpy take."""

import time

from diffdrive_kinematics.nodes.diff_drive_controller import DiffDriveController
from diffdrive_kinematics.nodes.diffdrive_sim import DiffDriveSim
from diffdrive_kinematics.nodes.simulated_base import SimulatedBase
from diffdrive_kinematics.ros.parameters.configuration_error import ConfigurationError
from diffdrive_kinematics.ros.runtime.running import make_executor
import pytest
import rclpy
from rclpy.parameter import Parameter
from sensor_msgs.msg import JointState
from support.domains import own_domain
from support.graph import KHEPERA

pytestmark = pytest.mark.ros
DEADLINE_S = 60.0
GIVEN = [Parameter(name, value=value) for name, value in KHEPERA.items()]
NO_TF = [*GIVEN, Parameter('enable_odom_tf', value=False)]


@pytest.fixture
def context():
    """Yield a context of its own, in a domain of its own."""
    with own_domain() as domain:
        private = rclpy.Context()
        rclpy.init(context=private, domain_id=domain)
        try:
            yield private
        finally:
            rclpy.try_shutdown(context=private)


def names_of(executor, node):
    """Return the names in the graph of a node, as soon as it is alone, or at the deadline."""
    deadline = time.monotonic() + DEADLINE_S
    while {*node.get_node_names()} != {node.get_name()} and time.monotonic() < deadline:
        executor.spin_once(timeout_sec=0.05)
    return {*node.get_node_names()}


@pytest.mark.parametrize('make, overrides', [
    (SimulatedBase, []),  # what must be set is not
    (SimulatedBase, [*NO_TF, Parameter('odom_topic', value='diagnostics')]),  # a later refusal
    (SimulatedBase, [*NO_TF, Parameter('use_sim_time', value='perhaps')]),  # one by rclpy itself
    (DiffDriveController, [*GIVEN, Parameter('wheel_rates_topic', value='cmd_vel')]),
], ids=['unset', 'endpoints', 'rclpy', 'controller'])
def test_a_node_that_is_refused_has_left_the_graph_while_its_error_is_held(
        context, make, overrides):
    with pytest.raises(Exception) as held:
        make(context=context, parameter_overrides=overrides)
    witness = rclpy.create_node('witness', context=context)
    try:
        executor = make_executor([witness], 'single_threaded')
        assert names_of(executor, witness) == {'witness'}
        assert held.value is not None
    finally:
        witness.destroy_node()


def test_a_composition_that_is_refused_takes_its_members_along(context):
    nodes = ['simulated_base', 'diff_drive_controller:not a name']
    with pytest.raises(Exception) as held:
        DiffDriveSim(context=context, parameter_overrides=[
            *NO_TF, Parameter('nodes', value=nodes)])
    witness = rclpy.create_node('witness', context=context)
    try:
        executor = make_executor([witness], 'single_threaded')
        assert names_of(executor, witness) == {'witness'}
        assert 'not a name' in str(held.value)
    finally:
        witness.destroy_node()


def test_a_node_takes_what_those_of_rclpy_take(context):
    """A context, overrides, arguments, a namespace; and it works there, in any executor."""
    node = SimulatedBase(
        context=context, namespace='robot', parameter_overrides=NO_TF,
        cli_args=['--ros-args', '-p', 'publish_rate:=20.0', '-r', 'odom:=belief'],
        use_global_arguments=False, start_parameter_services=False, enable_rosout=False,
        automatically_declare_parameters_from_overrides=True)
    executor = make_executor([node])
    try:
        assert node.context is context
        assert node.get_fully_qualified_name() == '/robot/simulated_base'
        assert node.config.values['publish_rate'] == 20.0
        assert node.config.geometry.separation == KHEPERA['wheel_separation']
        assert node.count_publishers('/robot/belief') == 1
        assert not [each for each in node.services if 'parameters' in each.srv_name]
        publisher = node.create_publisher(JointState, 'wheel_rates', 10)
        deadline = time.monotonic() + DEADLINE_S
        while node.reading().rates != (1.0, 2.0):
            assert time.monotonic() < deadline
            publisher.publish(JointState(
                name=['left_wheel_joint', 'right_wheel_joint'], velocity=[1.0, 2.0]))
            executor.spin_once(timeout_sec=0.05)
    finally:
        executor.shutdown()
        node.destroy_node()


def test_overrides_of_the_constructor_are_judged_like_others(context):
    with pytest.raises(ConfigurationError, match=r"wheel_radius is 'wide', expected"):
        SimulatedBase(context=context, parameter_overrides=[
            *GIVEN[1:], Parameter('wheel_radius', value='wide')])
