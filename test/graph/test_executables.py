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
from support.graph import CONFIG, KHEPERA, twist
from support.stepped import last, messages, tell_wheels
import yaml

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


@pytest.mark.parametrize('number', [*SIGNALS, signal.SIGHUP], ids=lambda number: number.name)
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


@pytest.mark.ros
def test_noisy_odom_has_the_noise_in_odom_itself(diffdrive):
    robot = diffdrive(CONFIG / 'noisy_odom.yaml')
    robot.drive(0.1, 0.0, 0.5)
    assert robot.odom.y != 0.0


@pytest.mark.ros
@pytest.mark.parametrize('space', ['', '/robot1'])
def test_robot_yaml_turns_joint_states_into_odometry_and_limits_commands(diffdrive, space):
    """Also in a namespace."""
    config = yaml.safe_load((CONFIG / 'robot.yaml').read_text())
    sim = config['/**/diffdrive_sim']['ros__parameters']
    sim['nodes'] = [f'{name}:{space[1:]}/{name}' if space else name for name in sim['nodes']]
    robot = diffdrive(config)
    for position in (5.0, 6.0, 6.0):
        tell_wheels(robot, [position, position], names=['wheel_right_joint', 'wheel_left_joint'],
                    topic=f'{space}/joint_states')
        robot.advance(0.2)
    odometry = last(robot, f'{space}/odom')
    assert odometry.pose.pose.position.x == pytest.approx(0.033, abs=1e-12)
    assert odometry.child_frame_id == 'base_footprint'
    for _ in range(30):
        robot.publish(f'{space}/cmd_vel', twist(9.0, 0.0))
        robot.advance(0.02)
    rates = [message.velocity[0] for message in messages(robot, f'{space}/wheel_rates')]
    assert rates[-1] == pytest.approx(0.22 / 0.033, rel=1e-12) and max(rates) <= 0.22 / 0.033
