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

"""A simulation that steps its time keeps to itself, or says that it is not alone and fails."""

import re

from diffdrive_kinematics.ros.runtime.alone import UNNAMED
from diffdrive_kinematics.ros.runtime.command_line import keep_to_this_machine, RANGE, REACH
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
import pytest
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState
from support.graph import CONFIG, KHEPERA, twist, x_of

DRIFT = re.compile(r'^drift.*$', re.M)
FACTORS = 4.0, 1.0, 1.0  # in seconds to find the other one: 6, 24, 24
FAST = ['--ros-args', '-p', 'real_time_factor:=0.0']
PUBLISHED_BY = rf"FATAL.*'/\w+' is published by (/\w+|{UNNAMED}) of another process"


def test_two_demos_in_one_domain_give_no_wrong_number(graph):
    """The second one sees the first, unless that one stands still while the other drives."""
    alone = graph.start('diffdrive_sim', args=FAST)
    assert alone.wait() == 0

    def both(factor):
        """Start a demo beside one in real time; return its exit status."""
        first = graph.start('diffdrive_sim', args=['--ros-args', '-p', 'real_time_factor:=1.0'])
        graph.wait_for(lambda: ' 0.0 of 24.0 s' in first.output, 'the first to be on its way')
        second = graph.start(
            'diffdrive_sim', args=['--ros-args', '-p', f'real_time_factor:={factor}'])
        for demo in (first, second):
            if demo.wait():
                assert not DRIFT.search(demo.output)
                assert re.search(PUBLISHED_BY, demo.output), demo.output
            else:  # the other one found it before it said anything
                assert DRIFT.search(demo.output)[0] == DRIFT.search(alone.output)[0]
        return second.wait()

    assert any(both(factor) == 1 for factor in FACTORS), graph.outputs()


@pytest.mark.parametrize('message_type, topic', [
    (Twist, '/cmd_vel'), (JointState, '/wheel_rates'), (JointState, '/noisy_wheel_rates'),
    (Clock, '/clock')])
@pytest.mark.parametrize('when', ['before', 'during'])
def test_another_publisher_of_what_the_nodes_say_to_each_other_ends_the_drive(
        graph, message_type, topic, when):
    """
    Even one that says nothing: it may have said something before it was seen.

    A demo that begins waits half a second for its name, which a busy machine may not tell by then.
    """
    if when == 'before':
        graph.node.create_publisher(message_type, topic, 1)
    demo = graph.start('diffdrive_sim', args=['--ros-args', '-p', 'real_time_factor:=1.0'])
    if when == 'during':
        graph.wait_for(lambda: ' 0.0 of 24.0 s' in demo.output, 'the demo to be on its way')
        graph.node.create_publisher(message_type, topic, 1)
    assert demo.wait() == 1, demo.output
    names = ['/test', *([UNNAMED] if when == 'before' else [])]
    assert any(f"'{topic}' is published by {name} of another process" in demo.output
               for name in names), demo.output
    assert 'Traceback' not in demo.output and not DRIFT.search(demo.output)


def test_a_stepped_robot_may_be_driven_from_outside(graph, tmp_path):
    """Nothing within the process publishes commands, and nobody else its wheel rates."""
    sim = graph.simulate(tmp_path, 'diff_drive_controller', 'simulated_base', **KHEPERA,
                         enable_odom_tf=False, clock_step=0.01, real_time_factor=1.0)
    odometry = graph.collect(Odometry, 'odom')
    commands = graph.publisher(Twist, 'cmd_vel')
    joints = graph.node.create_publisher(JointState, 'joint_states', 1)  # heard by nobody there

    def moved():
        commands.publish(twist(0.1, 0.0))
        return odometry and x_of(odometry) > 0.03

    graph.wait_for(moved, 'the robot to drive')
    assert joints.get_subscription_count() == 0
    assert sim.stop() == 0, sim.output


def test_the_demo_is_heard_on_this_machine_only_and_says_so(graph):
    demo = graph.start('diffdrive_sim', args=FAST, environment={RANGE: ''})
    assert demo.wait() == 0
    assert len(re.findall('on this machine only; .*SUBNET', demo.output)) == 1


def test_what_the_user_has_set_about_who_hears_the_demo_holds(graph):
    demo = graph.start('diffdrive_sim', args=FAST)  # LOCALHOST is set
    assert demo.wait() == 0
    assert 'this machine only' not in demo.output


@pytest.mark.parametrize('name', REACH)
def test_each_way_to_say_who_hears_a_process_is_left_alone(capsys, name):
    environment = {name: 'SUBNET'}
    keep_to_this_machine(environment)
    assert environment == {name: 'SUBNET'} and not capsys.readouterr().err


def test_a_simulation_with_a_params_file_is_heard_as_any_node(graph):
    sim = graph.start('diffdrive_sim', args=[
        '--ros-args', '--params-file', str(CONFIG / 'noiseless.yaml')], environment={RANGE: ''})
    graph.wait_for(lambda: 'diffdrive_sim' in graph.node.get_node_names(), 'the simulation')
    assert sim.stop() == 0
    assert 'this machine only' not in sim.output
