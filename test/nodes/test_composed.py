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

"""
The controller keeps its rate and its timeout, whatever else is in its process.

Beside it in one process is each of the other nodes, at its worst; a second controller, alone in
its process, hears the same commands.  The two are compared: a busy machine holds up both.  What
holds up one of them once may be the machine, too; a node does so in each drive.
"""

from itertools import count
import time

from diffdrive_kinematics.nodes.diffdrive_sim import CLASSES
from geometry_msgs.msg import PolygonStamped, PoseArray, TwistStamped
from nav_msgs.msg import Odometry, Path
import pytest
from rclpy.qos import QoSProfile
from sensor_msgs.msg import JointState
from support.graph import JOINTS, KHEPERA, odometry_of, set_stamp, Twist, twist
import yaml

CONTROLLER = 'diff_drive_controller'
TIMEOUT_S, RATE = 0.5, 50.0
COMMAND_PERIOD_S = 0.05
LEAST_DRIVE_S = 3.0
DRIVES = 5  # at most
TOLERANCE_S = 0.5  # between two processes of a busy machine
SILENT_S = 5.0 / RATE  # a gap of more than a few repeats
MOST_SILENT = 0.5  # of the drive, more than the other one
MANY = [f'wheel_{number}' for number in range(100)]
DRIVE = {**KHEPERA, 'cmd_vel_timeout': TIMEOUT_S, 'publish_rate': RATE}


class Worst:
    """Parameters of a node, what it is told as fast as can be, and what shows that it works."""

    def __init__(self, parameters, told=(), wanted=(), enough=1):
        self.parameters = parameters
        self.told, self.wanted, self.enough = told, wanted, enough


def wheels():
    """Return wheel motion of a robot that pivots about its left wheel."""
    return JointState(name=JOINTS, velocity=[0.0, 9.0])


def standing():
    """Return odometry of a robot that stands."""
    return odometry_of(0, (0.0, 0.0, 0.0))


WORST = {
    'wheel_noise': Worst(
        {'wheel_radius': 0.021, 'input_topic': 'flood', 'slip_distribution': 'truncated_gaussian',
         'left_slip_variance': 1e-5, 'right_slip_variance': 1e-5},
        [(JointState, 'flood', wheels)], [(JointState, 'noisy_wheel_rates')], 1000),
    **dict.fromkeys(('simulated_base', 'wheel_odometry'), Worst(
        {**KHEPERA, 'enable_odom_tf': False, 'wheel_motion_topic': 'flood', 'publish_rate': 1000.0,
         'path_topic': 'path', 'path_length': 100_000, 'path_spacing': 0.0, 'path_rate': 50.0,
         'left_slip_variance': 1e-5, 'right_slip_variance': 1e-5},
        [(JointState, 'flood', wheels)], [(Odometry, 'odom'), (Path, 'path')], 100)),
    'command_sequence': Worst(
        {'cmd_vel_topic': 'other_cmd_vel', 'commands': [0.1, 0.0, 0.001] * 2000,
         'loop': True, 'publish_rate': 1000.0},
        wanted=[(Twist, 'other_cmd_vel')], enough=1000),
    'forward_projection': Worst(
        {**KHEPERA, 'wheel_motion_topic': 'flood', 'publish_rate': 50.0, 'samples': 100_000,
         'stages': 25, 'slip_distribution': 'uniform', 'left_slip_variance': 2e-5,
         'right_slip_variance': 1e-5},
        [(Odometry, 'odom', Odometry), (JointState, 'flood', wheels)],
        [(PoseArray, 'projected_poses'), (PolygonStamped, 'projected_boundary')]),
    'goal_steering': Worst(
        {'cmd_vel_topic': 'other_cmd_vel', 'goals': [1000.0, 0.0, 0.0], 'publish_rate': 1000.0,
         'patience': 3600.0, 'odom_timeout': 3600.0},
        [(Odometry, 'odom', standing)], [(Twist, 'other_cmd_vel')], 1000),
    'web_view': Worst(
        {**KHEPERA, 'port': 0, 'cmd_vel_topic': 'other_cmd_vel', 'frame_rate': 1000.0,
         'enable_stamped_cmd_vel': True, 'autonomous_cmd_vel_topic': 'flood'},
        [(TwistStamped, 'flood', TwistStamped)], [(TwistStamped, 'other_cmd_vel')], 100),
    'robot_description': Worst({
        **KHEPERA, 'left_wheel_names': MANY, 'right_wheel_names': [f'{each}_r' for each in MANY]})}


class Driven:
    """A controller in a namespace: its commands, and when its messages came."""

    def __init__(self, graph, namespace):
        self._publisher = graph.publisher(Twist, f'{namespace}/cmd_vel')
        self.turning_at, self.still_at = [], []
        graph.collect(JointState, f'{namespace}/wheel_rates', self._note)

    def _note(self, message):
        at = self.turning_at if any(message.velocity) else self.still_at
        at.append(time.monotonic())

    def command(self, message):
        self._publisher.publish(message)

    def stopped(self, since):
        """Return when the wheels were told to stand after a time; None: not yet."""
        return next((at for at in self.still_at if at > max(since, self.turning_at[-1])), None)

    def forget(self):
        """Begin another drive."""
        self.turning_at.clear()
        self.still_at.clear()

    def gaps(self, since):
        """Return the silences [s] while the robot was driven, up to its stop."""
        times = [*self.turning_at, self.stopped(since)]
        return [b - a for a, b in zip(times, times[1:])]

    def silent(self, since):
        """Return the share of that time in which it missed repeats: one call that takes long."""
        gaps = self.gaps(since)
        return sum(gap for gap in gaps if gap > SILENT_S) / sum(gaps)


def flood(graph, worst):
    """Return what tells the node a little of all that it is told, with stamps of now."""
    publishers = [(graph.publisher(kind, f'/composed/{topic}'), make)
                  for kind, topic, make in worst.told]

    def tell():
        for publisher, make in publishers:
            message = make()
            set_stamp(message, graph.now_ns())
            publisher.publish(message)

    return tell


def test_every_node_that_can_be_composed_with_the_controller_has_its_worst():
    assert set(WORST) == set(CLASSES) - {CONTROLLER}


@pytest.mark.parametrize('kind', sorted(set(CLASSES) - {CONTROLLER}))
def test_a_controller_keeps_its_rate_and_its_timeout_beside_any_node_at_its_worst(
        graph, tmp_path, kind):
    worst = WORST[kind]
    file = tmp_path / 'composed.yaml'
    file.write_text(yaml.safe_dump({
        f'/**/{node}': {'ros__parameters': parameters} for node, parameters in (
            ('diffdrive_sim', {'nodes': [f'{each}:composed/{each}' for each in (
                CONTROLLER, kind)]}), (CONTROLLER, DRIVE), (kind, worst.parameters))}))
    sim = graph.start('diffdrive_sim', None, '--params-file', str(file))
    graph.start(CONTROLLER, DRIVE, '-r', '__ns:=/alone')
    came = {topic: count() for _, topic in worst.wanted}
    numbers = dict.fromkeys(came, 0)

    def note(topic):
        numbers[topic] = next(came[topic]) + 1

    for message_type, topic in worst.wanted:
        graph.node.create_subscription(
            message_type, f'/composed/{topic}', lambda _, topic=topic: note(topic),
            QoSProfile(depth=10), raw=True)
    both = composed, alone = [Driven(graph, namespace) for namespace in ('composed', 'alone')]
    tell = flood(graph, worst)

    def keeps_up():
        """Drive; return whether the composed one repeats and stops as the other one does."""
        began = last_at = time.monotonic()
        for each in both:
            each.forget()

        def driven():
            nonlocal last_at
            tell()
            if time.monotonic() > last_at + COMMAND_PERIOD_S:
                last_at = time.monotonic()
                for each in both:
                    each.command(twist(0.1, 0.0))
            return time.monotonic() > began + LEAST_DRIVE_S and all(
                each.turning_at for each in both) and all(
                number >= worst.enough for number in numbers.values())

        def stopped():
            tell()
            return all(each.stopped(last_at) for each in both)

        graph.wait_for(driven, f'the work of {kind}, {numbers}')
        graph.wait_for(stopped, 'the wheels to stand')
        return (max(composed.gaps(last_at)) < max(alone.gaps(last_at)) + TOLERANCE_S
                and composed.stopped(last_at) < alone.stopped(last_at) + TOLERANCE_S
                and composed.silent(last_at) < alone.silent(last_at) + MOST_SILENT)

    assert any(keeps_up() for _ in range(DRIVES))
    assert sim.running
