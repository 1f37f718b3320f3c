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

"""Slip of the body through the nodes: the truth has it, and the belief counts it."""

import math

from diffdrive_kinematics.core.kinematics import Command, Pose, WheelGeometry
from diffdrive_kinematics.core.noise import (
    body_variances, BodySlip, sample_paths, twist_covariance, WheelSlip)
from diffdrive_kinematics.nodes.simulated_base import SimulatedBase
from diffdrive_kinematics.nodes.wheel_noise import WheelNoise
import numpy as np
import pytest
from rclpy.parameter import Parameter
from support.graph import KHEPERA, wheel_motion
from support.inside import inside
from support.stepped import refusal

PLANAR = np.ix_([0, 1, 5], [0, 1, 5])
RADIUS, SEPARATION = KHEPERA['wheel_radius'], KHEPERA['wheel_separation']
GEOMETRY = WheelGeometry(SEPARATION, RADIUS)
BODY = BodySlip(1e-4, 2e-3, 5e-3)
PARAMETERS = {f'{name}_slip_variance': getattr(BODY, f'{name}_variance') for name in (
    'linear', 'turn', 'heading')}
Z = 3.2905  # of 99.9 %, two-sided
LEGS = [(9.0, 9.0), (6.0, 9.0), (-4.0, 4.0), (9.0, 8.0)]


def drive(held, topic, rates, steps, period_ns=50_000_000):
    """Let the wheels turn from now on, and the time go on."""
    for _ in range(steps):
        now_ns = held.clock.now_ns()
        held.hear(topic, wheel_motion(now_ns, velocity=rates))
        held.advance_to(now_ns + period_ns)


def perturbed(parameters, rates, steps):
    """Return distance and turn of every step [m, rad], shape (2, steps), of a noise node."""
    with inside(WheelNoise, {**KHEPERA, **parameters, 'seed': 3}) as held:
        drive(held, '/wheel_rates', rates, steps + 1)
        said = held.said['/noisy_wheel_rates']
        left, right = RADIUS * np.diff(
            [(0.0, 0.0), *(message.position for message in said[1:])], axis=0).T
    return np.stack([0.5 * (left + right), (right - left) / SEPARATION])


@pytest.mark.parametrize('rates', [(9.0, 9.0), (-4.0, 4.0), (-6.0, -9.0)])
@pytest.mark.parametrize('distribution', ['gaussian', 'uniform'])
def test_the_noise_node_moves_the_body_with_the_variances_asked_for(rates, distribution):
    steps = 2000
    change = perturbed({**PARAMETERS, 'slip_distribution': distribution}, rates, steps)
    mean = 0.05 * RADIUS * np.array([0.5 * (rates[0] + rates[1]),
                                     (rates[1] - rates[0]) / SEPARATION])
    expected = np.array(body_variances(BODY, *mean))
    off = np.abs(change.mean(axis=1) - mean)
    assert np.all(off <= Z * np.sqrt(expected / steps) + 1e-15)
    found, moving = change.var(axis=1), expected > 0.0
    assert np.all(found[~moving] < 1e-25)
    width = math.sqrt((2.0 if distribution == 'gaussian' else 0.8) / steps)
    assert np.all(np.abs(found[moving] / expected[moving] - 1.0) < Z * width)
    if moving.all():
        assert abs(np.corrcoef(change)[0, 1]) < Z / math.sqrt(steps)
    if distribution == 'uniform':
        assert np.all(np.abs(change.T - mean) <= np.sqrt(3.0 * expected) + 1e-12)


def test_without_slip_of_the_body_every_bit_is_as_if_there_were_none():
    slip = {'left_slip_variance': 1e-6, 'right_slip_variance': 1e-6}
    zeros = dict.fromkeys(PARAMETERS, 0.0)
    without = {'wheel_separation': 0.3, **slip}
    np.testing.assert_array_equal(
        perturbed(slip, (5.0, 7.0), 200), perturbed({**without, **zeros}, (5.0, 7.0), 200))


@pytest.mark.slow
def test_the_belief_publishes_the_covariance_of_20000_sampled_runs():
    with inside(SimulatedBase, {**KHEPERA, **PARAMETERS, 'enable_odom_tf': False}) as held:
        for rates in LEGS:
            drive(held, '/wheel_rates', rates, 60)
        drive(held, '/wheel_rates', (0.0, 0.0), 2)
        odometry = held.said['/odom'][-1]
    steps = [
        Command(0.5 * RADIUS * (left + right), RADIUS * (right - left) / SEPARATION, 0.05)
        for left, right in LEGS for _ in range(60)]
    paths = sample_paths(Pose(0.0, 0.0, 0.0), steps, GEOMETRY, WheelSlip(), WheelSlip(),
                         n=20_000, seed=1, body=BODY)
    pose = odometry.pose.pose
    yaw = 2.0 * math.atan2(pose.orientation.z, pose.orientation.w)
    error = np.array([column[-1] for column in paths]) - np.array(
        [pose.position.x, pose.position.y, yaw])[:, None]
    error[2] = np.remainder(error[2] + math.pi, math.tau) - math.pi
    expected = error @ error.T / error.shape[1]
    published = np.reshape(odometry.pose.covariance, (6, 6))[PLANAR]
    scale = np.sqrt(np.diag(expected))
    assert np.all(np.abs(published - expected) < 0.05 * np.outer(scale, scale))


def test_the_belief_publishes_the_covariance_of_its_twist():
    with inside(SimulatedBase, {
            **KHEPERA, **PARAMETERS, 'enable_odom_tf': False, 'publish_rate': 20.0}) as held:
        drive(held, '/wheel_rates', (6.0, 9.0), 5)
        twist = np.reshape(held.said['/odom'][-1].twist.covariance, (6, 6))
    expected = twist_covariance(GEOMETRY, (6.0, 9.0), 0.0, 0.0, 0.05, body=BODY)
    assert (twist[0, 0], twist[0, 5], twist[5, 5]) == pytest.approx(expected, rel=1e-12)


def test_slip_of_the_body_that_is_set_while_it_drives_counts_from_then_on():
    with inside(SimulatedBase, {**KHEPERA, 'enable_odom_tf': False}) as held:
        drive(held, '/wheel_rates', (5.0, 5.0), 20)
        assert held.said['/odom'][-1].pose.covariance[35] == pytest.approx(1e-9)
        held.node.set_parameters([Parameter('heading_slip_variance', value=0.04)])
        drive(held, '/wheel_rates', (5.0, 5.0), 20)
        drive(held, '/wheel_rates', (0.0, 0.0), 2)
        assert held.said['/odom'][-1].pose.covariance[35] == pytest.approx(
            0.04 * 5.0 * RADIUS, rel=1e-6)


@pytest.mark.ros
@pytest.mark.parametrize('name', ['turn_slip_variance', 'heading_slip_variance'])
def test_a_body_that_turns_too_much_asks_for_the_separation(diffdrive, name):
    refused = refusal(diffdrive, 'wheel_noise', {'wheel_radius': 0.02, name: 0.01})
    assert 'wheel_separation is nan, expected the distance [m]' in refused
    assert f'as {name} is 0.01' in refused


@pytest.mark.ros
def test_a_negative_variance_is_refused_by_its_parameter(diffdrive):
    assert 'turn_slip_variance is -0.01, expected a finite number from 0 to 1000' in refusal(
        diffdrive, 'simulated_base', {**KHEPERA, 'turn_slip_variance': -0.01})
