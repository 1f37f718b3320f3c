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

"""Each executable starts, ends cleanly on SIGINT and SIGTERM, and the demo shows its table."""

import math
import re
import signal

from diffdrive_kinematics.core.kinematics import Pose, WheelGeometry
from diffdrive_kinematics.core.noise import CERTAIN, propagated_moments
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
import pytest
from sensor_msgs.msg import JointState
from support.graph import CONFIG, KHEPERA, twist

SIGNALS = [signal.SIGINT, signal.SIGTERM]
EXECUTABLES = {
    'diff_drive_controller': KHEPERA,
    'wheel_noise': {'wheel_radius': 0.021},
    'simulated_base': KHEPERA,
    'wheel_odometry': KHEPERA,
    'command_sequence': {'commands': [0.1, 0.0, 60.0]},
    'forward_projection': KHEPERA,
    'goal_steering': {}, 'web_view': {**KHEPERA, 'port': 0},
    'robot_description': KHEPERA,
    'diffdrive_sim': {'clock_step': 0.0},
}


@pytest.mark.parametrize('number', SIGNALS, ids=lambda number: number.name)
@pytest.mark.parametrize('name', EXECUTABLES)
def test_an_executable_ends_with_status_0_and_no_traceback(graph, name, number):
    process = graph.start(name, EXECUTABLES[name])
    graph.wait_for(
        lambda: name in graph.node.get_node_names() or not process.running, f'{name} to start')
    assert process.running, process.output
    assert process.stop(number) == 0, process.output
    assert 'Traceback' not in process.output


@pytest.mark.parametrize('name', EXECUTABLES)
def test_a_second_signal_does_not_cut_the_end_short(graph, name):
    process = graph.start(name, EXECUTABLES[name])
    graph.wait_for(lambda: name in graph.node.get_node_names(), f'{name} to start')

    def asked():
        process.send(signal.SIGINT)
        return not process.running

    graph.wait_for(asked, 'the end')
    assert process.wait() == 0, process.output
    assert 'Traceback' not in process.output


def test_the_demo_shows_progress_and_ends_with_belief_truth_and_drift(graph):
    demo = graph.start('diffdrive_sim', args=[])
    assert demo.wait() == 0
    lines = demo.output.splitlines()
    assert sum(' of 24.0 s ' in line for line in lines) == 11
    belief, truth, drift = (
        next(line for line in lines if line.startswith(start))
        for start in ('belief (/simulated_base)', 'truth (/ground_truth)', 'drift'))
    assert belief.split()[-3:] == ['0.0000', '0.0000', '0.00']  # a closed course
    x, y, yaw = map(float, truth.split()[-3:])
    millimetres, turn = re.search(r'([\d.]+) mm +(-?[\d.]+)$', drift).groups()
    assert float(millimetres) == pytest.approx(1000.0 * (x * x + y * y) ** 0.5, abs=0.1)
    assert float(turn) == pytest.approx(yaw, abs=0.01)
    assert float(millimetres) > 1.0
    error = next(line for line in lines if line.startswith('mean error (/simulated_base)'))
    assert [float(each) for each in re.findall(r'(-?[\d.]+) mm', error)] == pytest.approx(
        mean_error_of_the_square(), abs=0.006)


def mean_error_of_the_square():
    """Return the mean error of x and y [mm] that the slip of the demo makes."""
    pose, moments, turn = Pose(0.0, 0.0, 0.0), CERTAIN, 0.5 * math.pi * 0.0885 / 2.0
    for d_left, d_right in [(0.4, 0.4), (-turn, turn)] * 4:
        pose, moments = propagated_moments(
            moments, pose, WheelGeometry(0.0885, 0.021), d_left, d_right, 1e-6, 1e-6)
    return 1e3 * moments.mean_error.real, 1e3 * moments.mean_error.imag


@pytest.mark.parametrize('number', SIGNALS, ids=lambda number: number.name)
def test_a_simulation_without_a_sequence_says_how_to_drive_and_runs_until_asked_to_stop(
        graph, number):
    sim = graph.start(
        'diffdrive_sim', args=['--ros-args', '--params-file', str(CONFIG / 'noiseless.yaml')])
    odometry = graph.collect(Odometry, 'odom')
    graph.wait_for(lambda: "geometry_msgs/msg/Twist on '/cmd_vel'" in sim.output, 'the advice')
    commands = graph.publisher(Twist, 'cmd_vel')
    graph.wait_for(lambda: commands.publish(twist(0.1, 0.0)) or (
        odometry and odometry[-1].pose.pose.position.x > 0.0), 'motion')
    assert sim.stop(number) == 0
    assert 'Traceback' not in sim.output


def test_noisy_odom_has_the_noise_in_odom_itself(graph):
    graph.start(
        'diffdrive_sim', args=['--ros-args', '--params-file', str(CONFIG / 'noisy_odom.yaml')])
    odometry = graph.collect(Odometry, 'odom')
    commands = graph.publisher(Twist, 'cmd_vel')
    graph.wait_for(lambda: commands.publish(twist(0.1, 0.0)) or (
        odometry and odometry[-1].pose.pose.position.y != 0.0), 'drift')


def test_robot_yaml_turns_the_robots_joint_states_into_odometry(graph):
    graph.start(
        'diffdrive_sim', args=['--ros-args', '--params-file', str(CONFIG / 'robot.yaml')])
    odometry = graph.collect(Odometry, 'odom')
    rates = graph.collect(JointState, 'wheel_rates')
    joints = graph.publisher(JointState, 'joint_states')
    message = JointState(name=['wheel_right_joint', 'wheel_left_joint'])
    for position in ([5.0, 5.0], [6.0, 6.0]):
        message.header.stamp = graph.node.get_clock().now().to_msg()
        message.position = position
        joints.publish(message)
    moved = graph.wait_for(lambda: odometry and odometry[-1].pose.pose.position.x and odometry[-1],
                           'odometry')
    assert moved.pose.pose.position.x == pytest.approx(0.033, abs=1e-12)
    assert moved.child_frame_id == 'base_footprint'
    commands = graph.publisher(Twist, 'cmd_vel')
    limit = pytest.approx(0.22 / 0.033, rel=1e-12)
    graph.wait_for(lambda: commands.publish(twist(9.0, 0.0)) or (
        rates and rates[-1].velocity[0] == limit), 'the limit')


@pytest.mark.parametrize('attempt', range(3))
def test_a_controller_that_is_asked_to_stop_leaves_the_wheels_at_zero(graph, attempt):
    controller = graph.start('diff_drive_controller', {**KHEPERA, 'cmd_vel_timeout': 0.0})
    rates = graph.collect(JointState, 'wheel_rates')
    graph.publisher(Twist, 'cmd_vel').publish(twist(0.1, 0.0))
    graph.wait_for(lambda: rates and any(rates[-1].velocity), 'the robot to drive')
    assert controller.stop() == 0
    graph.wait_for(lambda: list(rates[-1].velocity) == [0.0, 0.0], 'the last word')
