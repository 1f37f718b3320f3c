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

"""Robots of other packages drive by their own params files: one command, rates, odometry."""

import math
import re

from diffdrive_kinematics.ros.parameters.unknown_names import RIGHT_NAMES
from geometry_msgs.msg import Twist, TwistStamped
from nav_msgs.msg import Odometry
import pytest
from sensor_msgs.msg import JointState
from support.foreign_files import FILES
from support.graph import stamp_ns, twist, twist_stamped
import yaml

CONTROLLER = 'diff_drive_controller'
CLOSED = 'wheel_odometry', '-r', 'joint_states:=wheel_rates'  # motors that do what they are told
SIMULATED = 'simulated_base',
DRIVES = {  # node of the odometry, command, and the twist that the limits of the file leave of it
    'clearpath': (CLOSED, (5.0, 0.5), (4.0, 0.5)),
    'rosbot': (CLOSED, (2.0, -1.0), (0.9, -1.0)),
    'andino': (CLOSED, (0.3, 0.7), (0.3, 0.7)),
    'turtlebot3_fake_node': (SIMULATED, (0.2, 1.0), (0.2, 1.0)),
    'nav2_loopback_sim': (SIMULATED, (-0.2, 1.0), (-0.2, 1.0))}


def renamed(text):
    """Return a file with its frames under the names that the log gives for them."""
    for name, (_, right) in RIGHT_NAMES.items():
        if re.fullmatch(r'\w+_frame_id', right):
            text = re.sub(rf'^(\s+){name}:', rf'\1{right}:', text, flags=re.MULTILINE)
    return text


def agrees(before, after, v, w):
    """Return whether two messages lie on the arc of a twist."""
    if before is None or not math.isclose(before.twist.twist.linear.x, v, rel_tol=1e-9):
        return False
    seconds = (stamp_ns(after) - stamp_ns(before)) / 1e9
    here, there = before.pose.pose, after.pose.pose
    turn = 2.0 * math.atan2(
        there.orientation.z * here.orientation.w - there.orientation.w * here.orientation.z,
        there.orientation.w * here.orientation.w + there.orientation.z * here.orientation.z)
    way = math.hypot(there.position.x - here.position.x, there.position.y - here.position.y)
    return math.isclose(turn, w * seconds, abs_tol=1e-9) and math.isclose(
        way, abs(2.0 * v / w * math.sin(0.5 * w * seconds)), abs_tol=1e-9)


@pytest.mark.parametrize('name', DRIVES)
def test_a_robot_of_another_package_drives_as_its_file_means_it(graph, tmp_path, name):
    (odometer, *remap), command, (v, w) = DRIVES[name]
    text = renamed(FILES[name][0])
    values = yaml.safe_load(text)
    file = tmp_path / 'params.yaml'
    file.write_text(f"'/**':\n  ros__parameters:\n{text}")
    for node, *more in ((CONTROLLER,), (odometer, *remap)):
        graph.start(node, args=['--ros-args', '--params-file', str(file), *more])
    stamped = values.get('use_stamped_vel', False)
    rates = graph.collect(JointState, 'wheel_rates')
    limited = graph.collect(TwistStamped, 'cmd_vel_out')
    odometry = graph.collect(Odometry, 'odom')
    commands = graph.publisher(TwistStamped if stamped else Twist, 'cmd_vel')

    says_limited = values.get('publish_cmd', values.get('publish_limited_velocity'))
    half = 0.5 * w * values['wheel_separation'] * values.get('wheel_separation_multiplier', 1.0)
    sides = [(values.get(f'{side}_wheel_names', [f'{side}_wheel_joint']),
              (v + sign * half) / values['wheel_radius'])
             for side, sign in (('left', -1.0), ('right', 1.0))]
    expected = {joint: pytest.approx(rate, rel=1e-9) for joints, rate in sides for joint in joints}

    def drives():
        commands.publish(twist_stamped(graph.now_ns(), *command) if stamped else twist(*command))
        return (rates and dict(zip(rates[-1].name, rates[-1].velocity)) == expected
                and bool(says_limited) == any(
                    each.twist.linear.x == pytest.approx(v, rel=1e-9) for each in limited)
                and any(agrees(before, after, v, w)
                        for before, after in zip(odometry[-20:], odometry[-19:])))

    graph.wait_for(drives, f'rates, commands and odometry of ({v} m/s, {w} rad/s)')
    message = odometry[-1]
    assert message.header.frame_id == values.get('odom_frame_id', 'odom')
    assert message.child_frame_id == values.get('base_frame_id', 'base_link')
    for key, covariance in (('pose', message.pose), ('twist', message.twist)):
        if f'{key}_covariance_diagonal' in values:
            assert list(covariance.covariance[::7]) == values[f'{key}_covariance_diagonal']
    graph.wait_for(lambda: not any(rates[-1].velocity), 'rest after cmd_vel_timeout')
    assert says_limited or not limited
