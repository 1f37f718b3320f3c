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

"""What odometry publishes about its own uncertainty, and whether it can be believed."""

import math

from diffdrive_kinematics.core.kinematics import (
    Command, Pose, travel_from_angles, WheelGeometry, wrap_angle)
from diffdrive_kinematics.core.noise import (
    CERTAIN, heading_variance, propagated_moments, sample_heading, sample_paths, twist_covariance,
    WheelSlip)
import numpy as np
import pytest
from support.graph import KHEPERA, pose_of
from support.stepped import last, nodes, tell_wheels

pytestmark = pytest.mark.ros

GEOMETRY = WheelGeometry(KHEPERA['wheel_separation'], KHEPERA['wheel_radius'])
SLIP = {'left_slip_variance': 2e-6, 'right_slip_variance': 1e-6}
RATES = (3.0, 5.0)
FLOOR = 1e-9
PLANAR = np.ix_([0, 1, 5], [0, 1, 5])
RUNS = 50
MEAN_NEES_OF_50 = (1.99, 4.27)  # chi^2 of 150 degrees of freedom over 50, 99.9 %
CHI2_3 = 16.27  # of 99.9 %, with 3 degrees of freedom
SQUARE = [(0.1, 0.0, 4.0), (0.0, math.pi / 4, 2.0)] * 4 + [(0.0, 0.0, 1.0)]


def base(diffdrive, **settings):
    """Return a robot that is a base alone."""
    return diffdrive(
        nodes('simulated_base'), params={**KHEPERA, 'enable_odom_tf': False, **settings})


def moved(diffdrive, settings, rates=RATES):
    """Return odometry of a base whose wheels have turned for half a second."""
    robot = base(diffdrive, **{
        'initial_pose': [1.0, 2.0, 2.0], 'command_timeout': 0.0, **settings})
    tell_wheels(robot, velocity=rates)
    robot.advance(0.5)
    return last(robot, 'odom')


def matrix(covariance):
    return np.array(covariance).reshape(6, 6)


def test_the_pose_has_the_covariance_of_its_path_in_the_axes_of_the_fixed_frame(diffdrive):
    message = moved(diffdrive, SLIP)
    travel = (0.5 * KHEPERA['wheel_radius'] * rate for rate in RATES)
    _, moments = propagated_moments(
        CERTAIN, Pose(1.0, 2.0, 2.0), GEOMETRY, *travel, *SLIP.values())
    published = matrix(message.pose.covariance)
    assert published[PLANAR] - FLOOR * np.eye(3) == pytest.approx(
        moments.second_moment().matrix(), rel=1e-9, abs=1e-18)


def test_the_twist_has_the_covariance_of_its_period(diffdrive):
    message = moved(diffdrive, {**SLIP, 'publish_rate': 20.0})
    published = matrix(message.twist.covariance)
    rolled = [k * rate * KHEPERA['wheel_radius'] for k, rate in zip(SLIP.values(), RATES)]
    assert published[0, 0] - FLOOR == pytest.approx(sum(rolled) * 20.0 / 4.0, rel=1e-6)
    assert published[5, 5] - FLOOR == pytest.approx(
        sum(rolled) * 20.0 / KHEPERA['wheel_separation']**2, rel=1e-6)
    assert published[0, 5] == published[5, 0] == pytest.approx(
        twist_covariance(GEOMETRY, RATES, *SLIP.values(), 0.05).vw, rel=1e-12)


@pytest.mark.parametrize('settings', [SLIP, {}], ids=['slip', 'no_slip'])
def test_no_variance_is_zero_and_none_is_inflated(diffdrive, settings):
    message = moved(diffdrive, {**settings, 'covariance_floor': 1e-8})
    for field, observed in ((message.pose, {0, 1, 5}), (message.twist, {0, 5})):
        published = matrix(field.covariance)
        assert np.array_equal(published, published.T)
        for i in range(6):
            if i in observed:
                assert 1e-8 <= published[i, i] < 0.01
            else:
                assert published[i, i] == 1e-8
                assert not np.any(np.delete(published[i], i))


def test_a_fixed_diagonal_takes_the_place_of_the_slip(diffdrive):
    message = moved(diffdrive, {
        **SLIP, 'pose_covariance_diagonal': [1.0, 2.0, 3.0, 4.0, 5.0, 6.0],
        'twist_covariance_diagonal': [6.0, 5.0, 4.0, 3.0, 2.0, 1.0]})
    assert np.array_equal(
        matrix(message.pose.covariance), np.diag([1.0, 2.0, 3.0, 4.0, 5.0, 6.0]))
    assert np.array_equal(
        matrix(message.twist.covariance), np.diag([6.0, 5.0, 4.0, 3.0, 2.0, 1.0]))


def test_variances_that_are_none_per_metre_are_not_taken_for_such(diffdrive):
    message = moved(diffdrive, {**SLIP, 'slip_model': 'command'})
    assert np.array_equal(matrix(message.pose.covariance), FLOOR * np.eye(6))
    assert np.array_equal(matrix(message.twist.covariance), FLOOR * np.eye(6))


def test_the_base_publishes_the_covariance_that_the_slip_makes_along_its_arcs(diffdrive):
    robot = base(diffdrive, **SLIP, extrapolate_positions=False, velocity_rolling_window_size=1)
    pose, expected = Pose(0.0, 0.0, 0.0), CERTAIN
    before = (0.0, 0.0)
    for angles in [(0.0, 0.0), (3.0, 4.0), (9.0, 8.0), (8.0, 9.0)]:
        tell_wheels(robot, angles)
        robot.advance(0.1)
        travel = travel_from_angles(GEOMETRY, angles[0] - before[0], angles[1] - before[1])
        pose, expected = propagated_moments(
            expected, pose, GEOMETRY, *travel, *SLIP.values())
        before = angles
    robot.advance(0.5)
    message = last(robot, 'odom')
    assert message.pose.pose.position.x == pytest.approx(pose.x, abs=1e-12)
    published = np.reshape(message.pose.covariance, (6, 6))
    block = published[np.ix_((0, 1, 5), (0, 1, 5))]
    assert block == pytest.approx(
        expected.second_moment().matrix() + FLOOR * np.eye(3), rel=1e-9, abs=1e-18)
    assert np.all(np.diag(published) >= FLOOR)
    assert message.twist.twist.linear.x == pytest.approx(0.0)  # positions: a rate, no motion on


@pytest.mark.parametrize('seed', [-1, 5])
def test_an_uncertain_heading_is_published_or_drawn(diffdrive, seed):
    message = moved(diffdrive, {
        'initial_heading_concentration': 100.0, 'initial_heading_seed': seed}, (0.0, 0.0))
    variance = matrix(message.pose.covariance)[5, 5] - FLOOR
    yaw = pose_of(message).theta
    if seed < 0:
        assert yaw == pytest.approx(2.0, abs=1e-12)
        assert variance == pytest.approx(heading_variance(100.0), rel=1e-9)
    else:
        generator = np.random.default_rng(seed)
        assert yaw == pytest.approx(sample_heading(2.0, 100.0, generator), abs=1e-12)
        assert variance == pytest.approx(0.0, abs=1e-12)


def test_the_covariance_of_a_long_straight_is_that_of_20000_sampled_paths(diffdrive):
    """Along, across, yaw and across with yaw within 5 %; first order has 1/23 of that along."""
    robot = diffdrive(nodes('diff_drive_controller', 'simulated_base'), params={
        'wheel_radius': 0.021, 'wheel_separation': 0.2, 'left_slip_variance': 1e-5,
        'right_slip_variance': 1e-5, 'publish_rate': 10.0, 'enable_odom_tf': False,
        'joint_states_topic': ''}, clock_step=0.1)  # its yaw: 0.1 rad of standard deviation
    robot.drive(2.0, 0.0, 10.0)
    robot.drive(0.0, 0.0, 2.0)
    end = last(robot, 'odom')
    assert pose_of(end).x == pytest.approx(20.0, abs=1e-6)
    slip = WheelSlip(variance=1e-5)
    paths = sample_paths(
        Pose(0.0, 0.0, 0.0), 200 * [Command(1.0, 0.0, 0.1)], WheelGeometry(0.2, 0.021), slip, slip,
        n=20_000, seed=1)
    error = np.array([column[-1] for column in paths]) - np.array(pose_of(end))[:, None]
    expected = error @ error.T / 20_000
    published = matrix(end.pose.covariance)[PLANAR]
    scale = np.sqrt(np.diag(expected))
    assert np.all(np.abs(published - expected) < 0.05 * np.outer(scale, scale))
    for i, j in ((0, 0), (1, 1), (2, 2), (1, 2)):
        assert published[i, j] == pytest.approx(expected[i, j], rel=0.05)


@pytest.mark.slow
def test_belief_is_consistent_with_truth_over_50_runs_of_the_nodes(diffdrive):
    """
    Drive a square once; the robot believes one thing, 50 seeded noises make 50 truths of it.

    The belief does not depend on the noise, so one node stands for that of all runs.
    """
    members = ['diff_drive_controller', 'simulated_base']
    for run in range(RUNS):
        members += [f'wheel_noise:run{run}/noise', f'simulated_base:run{run}/truth']
    robot = diffdrive({
        '/**': {**KHEPERA, **SLIP, 'nodes': members, 'clock_step': 0.1, 'publish_rate': 10.0,
                'enable_odom_tf': False, 'joint_states_topic': ''},
        '/**/noise': {'input_topic': '/wheel_rates'},
        '/**/truth': {'wheel_motion_topic': 'noisy_wheel_rates', 'odom_topic': 'ground_truth',
                      'odom_frame_id': 'map', 'publish_rate': 1.0},
        **{f'/run{run}/noise': {'seed': run} for run in range(RUNS)}})
    for command in SQUARE:
        robot.drive(*command)
    robot.advance(3.0)
    belief = last(robot, 'odom')
    truths = [last(robot, f'/run{run}/ground_truth') for run in range(RUNS)]
    assert not any(message.twist.twist.linear.x for message in (belief, *truths))
    errors = np.array([pose_of(truth) for truth in truths]) - pose_of(belief)
    errors[:, 2] = wrap_angle(errors[:, 2])
    covariance = matrix(belief.pose.covariance)[PLANAR]
    white = np.linalg.solve(np.linalg.cholesky(covariance), errors.T)
    nees = float(np.mean(np.sum(white**2, axis=0)))
    mean_statistic = RUNS * float(np.sum(np.mean(white, axis=1)**2))
    print(f'mean NEES {nees:.3f}, mean error {mean_statistic:.2f}, '
          f'yaw std {math.sqrt(covariance[2, 2]):.4f} rad')
    assert MEAN_NEES_OF_50[0] < nees < MEAN_NEES_OF_50[1]
    assert mean_statistic < CHI2_3
