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
"""Several robots: each in a namespace, in one process or in many, and none moves another."""

from pathlib import Path
import re

from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
import pytest
from sensor_msgs.msg import JointState
from support.graph import twist

CONFIG = Path(__file__).parents[2] / 'config' / 'two_robots.yaml'
ROBOTS = ('robot1', 'robot2')
START_Y = {'robot1': 0.25, 'robot2': -0.25}
FLEET = 5


def one_process(graph):
    graph.start('diffdrive_sim', args=['--ros-args', '--params-file', str(CONFIG)])


def many_processes(graph):
    for robot in ROBOTS:
        space = ['--ros-args', '--params-file', str(CONFIG), '-r', f'__ns:=/{robot}']
        for name in ('diff_drive_controller', 'wheel_noise', 'simulated_base'):
            graph.start(name, args=space)
        graph.start('simulated_base', args=[*space, '-r', '__node:=ground_truth'])


def place(odometry):
    pose = odometry[-1].pose.pose
    return pose.position.x, pose.position.y, pose.orientation.z


@pytest.mark.parametrize('start', [one_process, many_processes])
def test_a_command_to_one_robot_moves_that_robot_only(graph, start):
    start(graph)
    belief = {robot: graph.collect(Odometry, f'/{robot}/odom') for robot in ROBOTS}
    truth = {robot: graph.collect(Odometry, f'/{robot}/ground_truth') for robot in ROBOTS}
    wheels = {robot: [graph.collect(JointState, f'/{robot}/{topic}') for topic in (
        'wheel_rates', 'noisy_wheel_rates')] for robot in ROBOTS}
    graph.wait_for(lambda: all([*belief.values(), *truth.values()]), 'odometry of both')
    for robot in ROBOTS:
        assert belief[robot][-1].header.frame_id == f'{robot}/odom'
        assert truth[robot][-1].header.frame_id == 'map'
        assert belief[robot][-1].child_frame_id == truth[robot][-1].child_frame_id \
            == f'{robot}/base_link'
    for robot, other in (ROBOTS, ROBOTS[::-1]):
        resting = [place(heard[other]) for heard in (belief, truth)]
        seen = len(belief[other])
        commands = graph.publisher(Twist, f'/{robot}/cmd_vel')

        def there():
            commands.publish(twist(0.2, 0.0))
            return all(heard[robot][-1].pose.pose.position.x > 0.1 for heard in (belief, truth))

        assert place(belief[robot]) == place(truth[robot]) == (0.0, START_Y[robot], 0.0)
        graph.wait_for(there, f'{robot} to drive')
        graph.wait_for_rest(wheels[robot], [belief[robot], truth[robot]])
        assert place(belief[robot])[1] == START_Y[robot]
        assert place(truth[robot])[1] != START_Y[robot]  # biased and slipping
        graph.wait_for(lambda: len(belief[other]) > seen + 5, f'odometry of {other}')
        assert [place(heard[other]) for heard in (belief, truth)] == resting


def test_a_fleet_in_one_process_is_a_list_in_the_yaml(graph, tmp_path):
    """Each robot drives its own course, and drifts in its own way."""
    names = [f'robot{number}' for number in range(1, FLEET + 1)]
    kinds = ('command_sequence', 'diff_drive_controller', 'wheel_noise', 'simulated_base')
    nodes = [f'{kind}:{name}/{kind}' for name in names for kind in kinds] + [
        f'simulated_base:{name}/ground_truth' for name in names]
    robots = ''.join(
        f'/{name}/**:\n  ros__parameters:\n    commands: [0.{number}, 0.0, 1.0]\n'
        f'    base_frame_id: {name}/base_link\n    seed: {number}\n'
        for number, name in enumerate(names, start=1))
    params = tmp_path / 'fleet.yaml'
    params.write_text(
        '/**:\n  ros__parameters:\n    wheel_radius: 0.021\n    wheel_separation: 0.0885\n'
        f'    nodes: {nodes}\n    clock_step: 0.01\n    enable_odom_tf: false\n'
        '    left_slip_variance: 1.0e-5\n    right_slip_variance: 1.0e-5\n'
        f'    wait_for_topics: [odom, ground_truth]\n{robots}'
        '/**/ground_truth:\n  ros__parameters:\n    wheel_motion_topic: noisy_wheel_rates\n'
        '    odom_topic: ground_truth\n')
    sim = graph.start('diffdrive_sim', args=['--ros-args', '--params-file', str(params)])
    assert sim.wait() == 0, sim.output
    for number, name in enumerate(names, start=1):
        row = re.search(rf'^belief \(/{name}/simulated_base\) +(\S+) +(\S+)', sim.output, re.M)
        assert (float(row[1]), float(row[2])) == (pytest.approx(0.1 * number, abs=6e-5), 0.0)
    drifts = re.findall(r'^drift \(/(\w+)\) +(\S+) mm', sim.output, re.M)
    assert [name for name, _ in drifts] == names
    assert len({drift for _, drift in drifts}) > 1 and all(float(drift) for _, drift in drifts)
