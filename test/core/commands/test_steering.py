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

"""Steering laws: to the goal from anywhere, the short way round, within a real robot's limits."""

import math
from pathlib import Path

from diffdrive_kinematics.core.commands import (
    AxisLimits, Drive, DriveSettings, HeadingRegulator, PointForward, PoseController, Progress,
    PurePursuit, SteeringCommand, SteeringLimits, Twist, Waypoints, waypoints_from_poses)
from diffdrive_kinematics.core.kinematics import (
    advance, Pose, pose_change_from_travel, travel_from_angles, WheelGeometry, wrap_angle)
from hypothesis import given, strategies as st
import numpy as np
import pytest
import yaml

ROBOT = yaml.safe_load(
    (Path(__file__).parents[3] / 'config' / 'robot.yaml').read_text(encoding='utf-8'))
SHARED = ROBOT['/**']['ros__parameters']
VALUES = ROBOT['/**/diff_drive_controller']['ros__parameters']


def axis(name):
    return AxisLimits(**{key.rpartition('.')[2]: value for key, value in VALUES.items()
                         if key.startswith(name)})


SETTINGS = DriveSettings(
    WheelGeometry(SHARED['wheel_separation'], SHARED['wheel_radius']), axis('linear.x'),
    axis('angular.z'), VALUES['max_wheel_rate'], VALUES['cmd_vel_timeout'],
    VALUES['update_rate'])
LIMITS = SteeringLimits(max_speed=0.2, max_yaw_rate=1.5)
LAWS = {
    'heading': HeadingRegulator(limits=LIMITS), 'point': PointForward(limits=LIMITS),
    'pose': PoseController(limits=LIMITS)}
GOAL = Pose(0.0, 0.0, 0.0)
TICK_NS = 50_000_000
LATEST_S = 60.0
STARTS = 1000
poses = st.builds(
    Pose, st.floats(-3.0, 3.0), st.floats(-3.0, 3.0), st.floats(-math.pi, math.pi))


def random_starts(seed, n=STARTS):
    """Return poses up to 1 m away, a fifth of them with the goal straight behind."""
    generator = np.random.default_rng(seed)
    bearing, theta = generator.uniform(-math.pi, math.pi, (2, n))
    radius = np.sqrt(generator.random(n))
    theta[::5] = bearing[::5] + generator.choice([0.0, 1e-12, -1e-12, 1e-3, -1e-3], n)[::5]
    return [Pose(*map(float, row)) for row in np.column_stack(
        [radius * np.cos(bearing), radius * np.sin(bearing), theta])]


def driven(steer, pose, noise=None):
    """Return the poses on the way, and the last word, of a robot with the limits of the YAML."""
    drive, now_ns, way = Drive(SETTINGS, 0), 0, [pose]
    before = drive.command_at(0).angles
    while now_ns < LATEST_S * 1e9:
        seen = pose if noise is None else pose._replace(theta=pose.theta + noise.normal(0.0, 2e-3))
        steered = steer(seen)
        if steered.arrived:
            return way, steered
        drive, _ = drive.commanded(steered.twist, now_ns)
        now_ns += TICK_NS
        drive, _ = drive.advanced(now_ns)
        after = drive.command_at(now_ns).angles
        travel = travel_from_angles(SETTINGS.geometry, *(a - b for a, b in zip(after, before)))
        pose, before = advance(pose, *pose_change_from_travel(SETTINGS.geometry, *travel)), after
        way.append(pose)
    return way, steered


def assert_the_short_way_round(way, start):
    """Less than three quarters of a turn in all, and hardly any of it to and fro."""
    turned = np.diff([pose.theta for pose in way])
    assert np.abs(turned).sum() < 1.5 * math.pi, start
    assert np.abs(turned).sum() - abs(turned.sum()) < 0.3, start


@pytest.mark.slow
@pytest.mark.parametrize('name', LAWS)
def test_each_law_reaches_the_goal_from_a_thousand_starts_within_a_robots_limits(name):
    law = LAWS[name]
    for start in random_starts(1):
        way, steered = driven(lambda pose: law.steer(pose, GOAL), start)
        assert steered.arrived, start
        end = way[-1]
        reached = advance(end, law.offset, 0.0) if name == 'point' else end
        assert math.hypot(reached.x, reached.y) <= LIMITS.distance_tolerance
        if name == 'pose':
            assert abs(wrap_angle(end.theta)) <= LIMITS.yaw_tolerance
        if name in ('heading', 'point'):
            assert_the_short_way_round(way, start)


@pytest.mark.parametrize('name', LAWS)
def test_a_goal_straight_behind_is_reached_whatever_the_noise_makes_of_the_sign(name):
    noise = np.random.default_rng(2)
    for start in random_starts(3, 200)[::5]:
        way, steered = driven(lambda pose: LAWS[name].steer(pose, GOAL), start, noise)
        assert steered.arrived, start
        if name in ('heading', 'point'):  # the other comes on a curve
            assert_the_short_way_round(way, start)


@pytest.mark.parametrize('sign', [1.0, -1.0])
@pytest.mark.parametrize('bearing', [0.0, 1.5, 3.1, -3.1])
def test_the_first_turn_is_the_short_way_round(sign, bearing):
    for error in (0.3, 1.0, 2.0, 3.0, math.pi - 1e-9):
        pose = Pose(-math.cos(bearing), -math.sin(bearing), wrap_angle(bearing - sign * error))
        assert sign * LAWS['heading'].steer(pose, GOAL).twist.w > 0.0
        goal = GOAL._replace(theta=bearing)
        assert sign * LAWS['pose'].steer(pose, goal).twist.w > 0.0
        pursued = PurePursuit().follow(pose, Waypoints(((0.0, 0.0),)), 0.0)
        assert sign * pursued.steered.twist.w > 0.0


@given(poses)
def test_the_heading_regulator_never_goes_away_from_the_goal(pose):
    twist, distance, error, _ = LAWS['heading'].steer(pose, GOAL)
    assert twist.v >= 0.0 and twist.v * math.cos(error) >= 0.0
    assert twist.w * error >= 0.0


@given(poses)
def test_the_point_ahead_goes_straight_to_the_goal(pose):
    law = LAWS['point']
    (v, w), distance, *_ = law.steer(pose, GOAL)
    c, s = math.cos(pose.theta), math.sin(pose.theta)
    rate = np.array([c * v - law.offset * s * w, s * v + law.offset * c * w])
    place = np.array([pose.x + law.offset * c, pose.y + law.offset * s])
    assert abs(rate[0] * place[1] - rate[1] * place[0]) < 1e-12
    assert rate @ place <= 0.0
    assert np.hypot(*rate) <= LIMITS.max_speed * (1.0 + 1e-12)


@given(poses)
def test_the_lyapunov_function_of_the_pose_controller_falls(pose):
    """The derivative is taken along the robot's motion, limits included."""
    law = LAWS['pose']
    (v, w), distance, *_ = law.steer(pose, GOAL)
    if distance <= LIMITS.distance_tolerance:
        return
    bearing = math.atan2(-pose.y, -pose.x)
    alpha, beta = wrap_angle(bearing - pose.theta), wrap_angle(bearing)
    turn = v * math.sin(alpha) / distance
    rate = (-distance * v * math.cos(alpha) + alpha * (turn - w) + law.yaw_weight * beta * turn)
    assert rate <= 1e-12
    if abs(alpha) > math.pi - 1e-6:
        assert alpha * w > 0.0


@given(poses, st.floats(0.05, 2.0), st.floats(0.1, 5.0))
def test_limits_keep_the_curvature(pose, max_speed, max_yaw_rate):
    limits = SteeringLimits(max_speed, max_yaw_rate)
    twist, *_ = PoseController(limits=limits).steer(pose, GOAL)
    free, *_ = PoseController(limits=SteeringLimits(1e6, 1e6)).steer(pose, GOAL)
    assert abs(twist.v) <= max_speed * (1.0 + 1e-12)
    assert abs(twist.w) <= max_yaw_rate * (1.0 + 1e-12)
    assert twist.v * free.w == pytest.approx(twist.w * free.v, abs=1e-9)


@pytest.mark.slow
def test_paths_are_followed_from_a_thousand_starts_within_a_robots_limits():
    law = PurePursuit(lookahead=0.2, limits=LIMITS)
    generator = np.random.default_rng(4)
    for start in random_starts(5):
        corners = np.cumsum(generator.uniform(-0.6, 0.6, (3, 2)), axis=0)
        path, along = Waypoints(tuple(map(tuple, corners.tolist()))), 0.0

        def steer(pose):
            nonlocal along
            steered, along = law.follow(pose, path, along)
            return steered

        way, steered = driven(steer, start)
        assert steered.arrived, (start, path)
        end = path.at(math.inf)
        assert math.dist(way[-1][:2], end) <= LIMITS.distance_tolerance


def test_a_path_that_is_begun_on_is_followed_to_a_few_centimetres_and_corners_are_cut():
    path = Waypoints(((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (0.0, 0.0)))
    law, along = PurePursuit(lookahead=0.15, limits=LIMITS), 0.0

    def steer(pose):
        nonlocal along
        steered, along = law.follow(pose, path, along)
        return steered

    way, steered = driven(steer, Pose(0.0, 0.0, 0.0))
    assert steered.arrived and along == pytest.approx(4.0, abs=0.03)
    off = [math.dist(pose[:2], path.at(path.nearest(pose.x, pose.y, 0.0, 4.0))) for pose in way]
    assert max(off) < 0.06
    assert max(pose.y for pose in way) > 0.95


@given(st.lists(st.tuples(st.floats(-2.0, 2.0), st.floats(-2.0, 2.0)), min_size=1, max_size=6),
       st.floats(-2.0, 2.0), st.floats(-2.0, 2.0))
def test_what_is_nearest_on_a_path_is_nearer_than_all_else(points, x, y):
    path = Waypoints(tuple(points))
    place = path.nearest(x, y, 0.0, path.length)
    distance = math.dist(path.at(place), (x, y))
    for along in np.linspace(0.0, path.length, 50):
        assert distance <= math.dist(path.at(along), (x, y)) + 1e-9
    assert path.nearest(x, y, 0.5 * path.length, path.length) >= 0.5 * path.length


def test_a_crossing_does_not_shorten_the_path():
    path = Waypoints(((-1.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (0.0, -1.0)))
    _, along = PurePursuit(lookahead=0.2).follow(Pose(0.0, 0.0, 0.0), path, 0.9)
    assert along == pytest.approx(1.0)


def test_an_approach_notices_that_the_robot_comes_no_nearer():
    progress = Progress(math.inf, math.inf, 0)
    progress = progress.updated(SteeringCommand(Twist(0.1, 0.0), 1.0, 0.5, False), 1)
    assert progress == (1.0, 0.5, 1)
    assert progress.updated(SteeringCommand(Twist(0.1, 0.0), 0.9995, 0.6, False), 2).since_ns == 1
    nearer = progress.updated(SteeringCommand(Twist(0.1, 0.0), 0.99, 0.6, False), 2)
    assert nearer == (0.99, 0.5, 2)
    assert progress.updated(SteeringCommand(Twist(0.0, 0.1), 1.0, -0.4, False), 3) == (1.0, 0.4, 3)


@pytest.mark.parametrize(('make', 'words'), [
    (lambda: SteeringLimits(max_speed=0.0), 'max_speed is 0.0'),
    (lambda: SteeringLimits(yaw_tolerance=math.nan), 'yaw_tolerance is nan'),
    (lambda: HeadingRegulator(heading_gain=0.5), 'heading_gain is 0.5, expected above'),
    (lambda: PointForward(offset=0.0), 'offset is 0.0'),
    (lambda: PoseController(yaw_weight=-1.0), 'yaw_weight is -1.0'),
    (lambda: PurePursuit(lookahead=0.0), 'lookahead is 0.0'),
    (lambda: Waypoints(()), 'no points'),
    (lambda: waypoints_from_poses([Pose(0.0, math.inf, 0.0)]), 'expected finite numbers')])
def test_what_makes_no_sense_is_refused_by_name_and_value(make, words):
    with pytest.raises(ValueError) as error:
        make()
    assert words in str(error.value)
