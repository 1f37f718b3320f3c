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
import math

from diffdrive_kinematics.core.kinematics import wrap_angle
import pytest
from support.graph import assert_pose
from support.recorded import (
    end_error, implied_commands, load, offline_pose, RADIUS, RUNS, SEPARATION, wheel_positions)
from support.stepped import nodes, tell_wheels

pytestmark = pytest.mark.ros

ROBOT = {'wheel_radius': RADIUS, 'wheel_separation': SEPARATION}
STEP_S = 0.02  # of the clock


def steps_to(seconds, robot):
    """Let time pass until it is so late, at the next step of the clock."""
    steps = math.ceil((seconds - robot.time) / STEP_S)
    if steps > 0:
        robot.advance(steps * STEP_S)


def replay_encoders(diffdrive, rows):
    """Play encoder positions as joint_states into a base; return its pose at the end."""
    robot = diffdrive(nodes('simulated_base'), params={
        **ROBOT, 'wheel_motion_topic': 'joint_states', 'joint_states_topic': 'rolled',
        'enable_odom_tf': False, 'extrapolate_positions': False}, clock_step=STEP_S)
    for row, position in zip(rows, wheel_positions(rows)):
        steps_to(row['time_sec'], robot)
        tell_wheels(robot, position, topic='joint_states', at_ns=round(row['time_sec'] * 1e9))
    pose = robot.odom
    robot.close()
    return pose


@pytest.mark.slow
def test_recorded_encoders_give_the_odometry_that_offline_integration_gives(diffdrive):
    errors = []
    assert len(RUNS) == 6
    for run in RUNS:
        rows = load(run)
        pose = replay_encoders(diffdrive, rows)
        expected = offline_pose(rows)
        assert_pose(pose, expected)
        errors.append(end_error(pose, rows))
    assert sum(errors) / len(errors) == pytest.approx(0.064, abs=0.002)


def test_recorded_commands_through_four_nodes_end_where_the_offline_arcs_end(
        diffdrive, tmp_path):
    rows = load(RUNS[0])
    recording = tmp_path / 'drive.csv'
    with recording.open('w', newline='') as file:
        writer = csv.writer(file)
        writer.writerow(('time_sec', 'linear_x', 'angular_z'))
        writer.writerows(implied_commands(rows))
    robot = diffdrive(
        nodes('command_sequence', 'diff_drive_controller', 'wheel_noise', 'simulated_base',
              'simulated_base:ground_truth', command_sequence={'recording': str(recording)},
              ground_truth={'wheel_motion_topic': 'noisy_wheel_rates', 'joint_states_topic': '',
                            'odom_topic': 'ground_truth'}),
        params={**ROBOT, 'enable_stamped_cmd_vel': True, 'stamp_tolerance': 5.0,
                'cmd_vel_timeout': 5.0, 'enable_odom_tf': False}, clock_step=STEP_S)
    steps_to(rows[-1]['time_sec'] + 1.0, robot)
    expected = offline_pose(rows)
    # Without noise the truth is the belief, but for commands that come later than a repeat of
    # the one before: the noise node cannot take back what it has put out, only make up for it.
    for state, tolerance in ((robot.odom, 1e-6), (robot.truth, 1e-4)):
        assert state.speed == state.yaw_rate == 0.0
        assert state.x == pytest.approx(expected.x, abs=tolerance)
        assert state.y == pytest.approx(expected.y, abs=tolerance)
        assert wrap_angle(state.yaw - expected.theta) == pytest.approx(0.0, abs=1e-6)
