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

"""A real robot's recorded motion through the nodes: as encoders, and as commands."""

import csv

from diffdrive_kinematics.core.kinematics import wrap_angle
from nav_msgs.msg import Odometry
import pytest
from sensor_msgs.msg import JointState
from support.graph import JOINTS, pose_of, set_stamp, stamp_ns
from support.recorded import (
    end_error, implied_commands, load, offline_pose, RADIUS, RUNS, SEPARATION, wheel_positions)

ROBOT = {'wheel_radius': RADIUS, 'wheel_separation': SEPARATION}
BATCH = 8  # below the depth of the base's queue


def standing(graph, messages, after):
    """Return the last message of a robot that stands, after a time."""
    return graph.wait_for(lambda: [
        message for message in messages if stamp_ns(message) > after
        and message.twist.twist.linear.x == message.twist.twist.angular.z == 0.0],
        'the robot to stand')[-1]


def replay_encoders(graph, rows):
    """Play encoder positions as joint_states into a base; return its odometry at the end."""
    joints = graph.publisher(JointState, 'joint_states')
    rolled = graph.collect(JointState, 'rolled')
    odometry = graph.collect(Odometry, 'odom')
    start = graph.now_ns() - 100_000_000_000
    positions = wheel_positions(rows)
    message = JointState(name=JOINTS)
    for number, (row, position) in enumerate(zip(rows, positions)):
        set_stamp(message, start + round(row['time_sec'] * 1e9))
        message.position = list(position)
        joints.publish(message)
        if number % BATCH == 0 or number == len(rows) - 1:
            expected = [angle - first for angle, first in zip(position, positions[0])]
            graph.wait_for(
                lambda: rolled and list(rolled[-1].position) == pytest.approx(expected, abs=1e-9),
                f'the base to have read row {number}')
    last = stamp_ns(rolled[-1])
    return graph.wait_for(
        lambda: [pose_of(message) for message in odometry if stamp_ns(message) >= last],
        'odometry')[-1]


def test_recorded_encoders_give_the_odometry_that_offline_integration_gives(graph):
    errors = []
    assert len(RUNS) == 6
    for run in RUNS:
        rows = load(run)
        base = graph.start('simulated_base', {
            **ROBOT, 'wheel_motion_topic': 'joint_states', 'joint_states_topic': 'rolled',
            'publish_rate': 1000.0, 'enable_odom_tf': False, 'extrapolate_positions': False})
        pose = replay_encoders(graph, rows)
        expected = offline_pose(rows)
        assert pose.x == pytest.approx(expected.x, abs=1e-9)
        assert pose.y == pytest.approx(expected.y, abs=1e-9)
        assert wrap_angle(pose.theta - expected.theta) == pytest.approx(0.0, abs=1e-9)
        errors.append(end_error(pose, rows))
        assert base.stop() == 0
        for subscription in list(graph.node.subscriptions):
            graph.node.destroy_subscription(subscription)
        for publisher in list(graph.node.publishers):
            if publisher.topic_name == '/joint_states':
                graph.node.destroy_publisher(publisher)
    assert sum(errors) / len(errors) == pytest.approx(0.064, abs=0.002)


@pytest.mark.timeout(600)
def test_recorded_commands_through_four_processes_end_where_the_offline_arcs_end(
        graph, tmp_path):
    rows = load(RUNS[0])
    recording = tmp_path / 'drive.csv'
    with recording.open('w', newline='') as file:
        writer = csv.writer(file)
        writer.writerow(('time_sec', 'linear_x', 'angular_z'))
        writer.writerows(implied_commands(rows))
    graph.start('diff_drive_controller', {
        **ROBOT, 'enable_stamped_cmd_vel': True, 'stamp_tolerance': 5.0, 'cmd_vel_timeout': 5.0})
    graph.start('wheel_noise', ROBOT)
    graph.start('simulated_base', {**ROBOT, 'enable_odom_tf': False})
    graph.start('simulated_base', {
        **ROBOT, 'wheel_motion_topic': 'noisy_wheel_rates', 'odom_topic': 'ground_truth',
        'joint_states_topic': '', 'enable_odom_tf': False}, '-r', '__node:=ground_truth')
    odometry = graph.collect(Odometry, 'odom')
    truth = graph.collect(Odometry, 'ground_truth')
    sequence = graph.start('command_sequence', {
        'recording': str(recording), 'enable_stamped_cmd_vel': True,
        'wait_for_topics': ['odom', 'ground_truth']})
    graph.wait_for(lambda: not sequence.running, 'the recording to end', timeout=300.0)
    assert sequence.wait() == 0, sequence.output
    done = graph.now_ns()
    expected = offline_pose(rows)
    # Without noise the truth is the belief, but for commands that come later than a repeat of
    # the one before: the noise node cannot take back what it has put out, only make up for it.
    for messages, tolerance in ((odometry, 1e-6), (truth, 1e-4)):
        pose = pose_of(standing(graph, messages, done))
        assert pose.x == pytest.approx(expected.x, abs=tolerance)
        assert pose.y == pytest.approx(expected.y, abs=tolerance)
        assert wrap_angle(pose.theta - expected.theta) == pytest.approx(0.0, abs=1e-6)
