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

"""What lasts a run, through the nodes: the truth has it, and the belief counts it."""

from functools import reduce
import math

from diffdrive_kinematics.core.kinematics import (
    advance, Command, Pose, pose_change_from_travel, WheelGeometry, wrap_angle)
from diffdrive_kinematics.core.noise import (
    draw_session, sample_paths, session_generator, SessionSpread, travel_in_session,
    travel_of_command, WheelSlip)
from diffdrive_kinematics.nodes.simulated_base import SimulatedBase
from diffdrive_kinematics.nodes.wheel_noise import WheelNoise
from diffdrive_kinematics.ros.parameters.parameter_checks import check_slip
from diffdrive_kinematics.ros.parameters.parameter_spec import range_of
from diffdrive_kinematics.ros.parameters.tables import SIMULATED_BASE
from diffdrive_kinematics.tools.robots import moments_of
import numpy as np
import pytest
from rclpy.parameter import Parameter
from std_srvs.srv import Trigger
from support.graph import KHEPERA, pose_of, wheel_motion
from support.inside import inside
from support.stepped import refusal
from support.true_run import driven

PLANAR = np.ix_([0, 1, 5], [0, 1, 5])
GEOMETRY = WheelGeometry(KHEPERA['wheel_separation'], KHEPERA['wheel_radius'])
SPREAD = SessionSpread(scale=0.01, separation=0.03, curvature=0.01)
SESSION = {f'session_{name}_stddev': getattr(SPREAD, name) for name in (
    'scale', 'separation', 'curvature')}
COURSE = [Command(0.4, 0.0, 5.0), Command(0.2, 0.2, 5.0), Command(0.0, -1.0, 1.0),
          Command(0.4, 0.0, 2.5)]
FLOOR = 1e-9


def ends(diffdrive, noise, belief):
    """Drive the course; return the last odometry of the belief and of the truth."""
    return driven(diffdrive, [(each.v, each.w, each.duration) for each in COURSE], 0.1,
                  wheel_noise=noise, simulated_base=belief)


def covariance(message):
    """Return that of x, y and yaw, without the floor."""
    return np.reshape(message.pose.covariance, (6, 6))[PLANAR] - FLOOR * np.eye(3)


@pytest.mark.ros
def test_the_truth_drives_off_by_exactly_what_its_seed_has_drawn(diffdrive):
    _, truth = ends(diffdrive, {**SESSION, 'seed': 5}, {})
    error = draw_session(SPREAD, session_generator(5))
    expected = reduce(lambda pose, command: advance(pose, *pose_change_from_travel(
        GEOMETRY, *travel_in_session(
            error, GEOMETRY.separation, *travel_of_command(command, GEOMETRY)))),
        COURSE, Pose(0.0, 0.0, 0.0))
    off = np.array(pose_of(truth)) - np.array(expected)
    assert [*off[:2], wrap_angle(off[2])] == pytest.approx([0.0] * 3, abs=1e-9)
    plain = reduce(lambda pose, command: advance(pose, *pose_change_from_travel(
        GEOMETRY, *travel_of_command(command, GEOMETRY))), COURSE, Pose(0.0, 0.0, 0.0))
    assert math.hypot(*(np.array(pose_of(truth)) - np.array(plain))[:2]) > 0.01


@pytest.mark.ros
def test_the_belief_publishes_the_covariance_of_20000_sampled_runs(diffdrive):
    k = 1e-6
    odometry, _ = ends(diffdrive, {}, {
        **SESSION, 'left_slip_variance': k, 'right_slip_variance': k})
    slip = WheelSlip(variance=k)
    steps = [Command(each.v, each.w, 0.1) for each in COURSE
             for _ in range(round(10 * each.duration))]
    paths = sample_paths(
        Pose(0.0, 0.0, 0.0), steps, GEOMETRY, slip, slip, n=20_000, seed=1, session=SPREAD)
    error = np.array([column[-1] for column in paths]) - np.array(pose_of(odometry))[:, None]
    error[2] = wrap_angle(error[2])
    expected = error @ error.T / 20_000
    published, scale = covariance(odometry), np.sqrt(np.diag(expected))
    assert np.all(np.abs(published - expected) < 0.05 * np.outer(scale, scale))
    assert np.diag(published) == pytest.approx(np.diag(expected), rel=0.05)


def drive(held, topic, seconds, rates=(4.0, 5.0)):
    """Let the wheels turn from now on, and the time go on."""
    for _ in range(round(10 * seconds)):
        now_ns = held.clock.now_ns()
        held.hear(topic, wheel_motion(now_ns, velocity=rates))
        held.advance_to(now_ns + 100_000_000)


def test_a_reset_base_knows_its_pose_again_and_its_session_goes_on():
    with inside(SimulatedBase, {**KHEPERA, **SESSION, 'enable_odom_tf': False}) as held:
        drive(held, '/wheel_rates', 1.0)
        driven = covariance(held.said['/odom'][-1])
        assert np.all(np.diag(driven) > 0.0)
        held.node._on_reset(Trigger.Request(), Trigger.Response())
        held.advance_to(held.clock.now_ns() + 20_000_000)
        assert covariance(held.said['/odom'][-1]) == pytest.approx(np.zeros((3, 3)), abs=1e-15)


def test_a_spread_that_is_set_while_it_drives_counts_from_then_on():
    with inside(SimulatedBase, {**KHEPERA, 'enable_odom_tf': False}) as held:
        drive(held, '/wheel_rates', 1.0)
        assert covariance(held.said['/odom'][-1]) == pytest.approx(np.zeros((3, 3)), abs=1e-15)
        held.node.set_parameters([Parameter('session_curvature_stddev', value=0.5)])
        drive(held, '/wheel_rates', 2.0)
        metres = 2.0 * 4.5 * KHEPERA['wheel_radius']
        assert math.sqrt(covariance(held.said['/odom'][-1])[2, 2]) == pytest.approx(
            0.5 * metres, rel=0.1)


def test_another_seed_is_another_session_and_another_spread_the_same_one():
    settings = {**KHEPERA, 'session_scale_stddev': 0.01, 'seed': 3}
    with inside(WheelNoise, settings) as held:
        def ratio():
            drive(held, '/wheel_rates', 0.5)
            return held.said['/noisy_wheel_rates'][-1].velocity[0] / 4.0 - 1.0

        first = ratio()
        assert first == pytest.approx(
            draw_session(SessionSpread(scale=0.01), session_generator(3)).scale, rel=1e-9)
        held.node.set_parameters([Parameter('session_scale_stddev', value=0.02)])
        assert ratio() == pytest.approx(2.0 * first, rel=1e-9)
        held.node.set_parameters([Parameter('seed', value=4)])
        assert ratio() == pytest.approx(
            draw_session(SessionSpread(scale=0.02), session_generator(4)).scale, rel=1e-9)


@pytest.mark.ros
def test_a_curvature_asks_for_the_separation(diffdrive):
    assert 'wheel_separation is nan, expected the distance' in refusal(
        diffdrive, 'wheel_noise', {'wheel_radius': 0.02, 'session_curvature_stddev': 0.01})


def test_a_covariance_is_finite_whatever_may_be_set():
    most = {entry.name: range_of(entry)[1] for entry in SIMULATED_BASE
            if entry.check is check_slip}
    assert len(most) == 6
    fractions = {f'session_{name}_stddev': 0.1 for name in ('scale', 'separation')}
    with inside(SimulatedBase, {
            **KHEPERA, **most, **fractions, 'enable_odom_tf': False}) as held:
        for step in range(200):
            time_ns = held.clock.now_ns() + 20_000_000
            held.hear('/wheel_rates', wheel_motion(
                time_ns, velocity=[30.0, 20.0 - 40.0 * (step > 100)]))
            held.advance_to(time_ns)
        odometry = held.said['/odom'][-1]
    assert np.isfinite(odometry.pose.covariance).all()
    assert np.isfinite(odometry.twist.covariance).all()


def test_the_drive_that_is_kept_is_as_uncertain_as_the_odometry_that_is_published():
    settings = {**KHEPERA, 'session_curvature_stddev': 0.5, 'enable_odom_tf': False}
    with inside(SimulatedBase, settings) as held:
        drive(held, '/wheel_rates', 1.0)
        moment, = moments_of([(held.node, False)], held.clock.now_ns())
        published = covariance(held.said['/odom'][-1])
        assert published[2, 2] > 0.0
        assert moment.covariance.tt == pytest.approx(published[2, 2], abs=1e-12)
        assert moment.covariance.yy == pytest.approx(published[1, 1], abs=1e-12)
