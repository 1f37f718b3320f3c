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

"""Where the robot may soon be, as it is published: samples, and the boundary around all."""

import math
import os
from pathlib import Path
import re
import signal

from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PolygonStamped, PoseArray
from nav_msgs.msg import Odometry
import numpy as np
import pytest
from sensor_msgs.msg import JointState
from support.graph import KHEPERA, odometry_of, stamp_ns, wheel_motion
from support.health import statuses_of, WARN, with_health
from support.stepped import messages, nodes, tell_wheels

pytestmark = pytest.mark.ros

SETTINGS = {
    **KHEPERA, 'left_slip_variance': 2e-5, 'right_slip_variance': 1e-5, 'publish_rate': 20.0,
    'slip_distribution': 'uniform', 'samples': 20_000, 'stages': 1, 'command_timeout': 0.0}
BODY = {'linear_slip_variance': 1e-3, 'turn_slip_variance': 0.02, 'heading_slip_variance': 0.01,
        'stages': 3}
START, STAMP_NS = (3.0, -2.0, 2.5), 7_000_000_001
TOLERANCE = 1e-6  # m: float32 at a few metres


def tell(graph):
    """Tell where the robot is and what its wheels do; return the publisher of odometry."""
    graph.publisher(JointState, 'wheel_rates').publish(
        wheel_motion(graph.now_ns(), velocity=[6.0, 9.0]))
    return graph.publisher(Odometry, 'odom'), odometry_of(STAMP_NS, START)


def project(graph, settings):
    """Start the projection and repeat the odometry until something has come of both kinds."""
    process = graph.start('forward_projection', settings)
    poses = graph.collect(PoseArray, 'projected_poses')
    boundaries = graph.collect(PolygonStamped, 'projected_boundary')
    publisher, odometry = tell(graph)
    graph.wait_for(
        lambda: publisher.publish(odometry) or (poses and boundaries), 'projections')
    return poses, boundaries, process


def projected(diffdrive, settings, seconds=0.1, start=START, rates=(6.0, 9.0)):
    """Project on stepped time; return the robot, and what it has published for each odometry."""
    robot = diffdrive(nodes('forward_projection'), params=settings)
    for kind, topic in ((PoseArray, 'projected_poses'), (PolygonStamped, 'projected_boundary')):
        robot.listen(kind, topic)
    tell_wheels(robot, velocity=rates)
    for _ in range(round(seconds / 0.05)):
        robot.publish('odom', odometry_of(STAMP_NS, start))
        robot.advance(0.06)
    return robot, *(messages(robot, topic) for topic in ('projected_poses', 'projected_boundary'))


def positions(message):
    return np.array([(pose.position.x, pose.position.y) for pose in message.poses])


def vertices(message):
    return np.array([(point.x, point.y) for point in message.polygon.points])


def furthest_outside(points, polygon):
    """Return how far [m] the outermost of the points is from the inside; 0: none is outside."""
    x, y = points[:, 0, None], points[:, 1, None]
    (x0, y0), (x1, y1) = polygon.T, np.roll(polygon, -1, axis=0).T
    with np.errstate(divide='ignore', invalid='ignore'):
        crossed = ((y0 > y) != (y1 > y)) & (x < x0 + (y - y0) * (x1 - x0) / (y1 - y0))
    outside = np.sum(crossed, axis=1) % 2 == 0
    if not np.any(outside):
        return 0.0
    dx, dy = x1 - x0, y1 - y0
    along = np.clip(((x - x0) * dx + (y - y0) * dy) / np.maximum(dx**2 + dy**2, 1e-300), 0.0, 1.0)
    distance = np.min(np.hypot(x0 + along * dx - x, y0 + along * dy - y), axis=1)
    return float(np.max(distance[outside]))


def children(process):
    """Return the processes that a process has started, and that are not gone."""
    return [int(pid) for task in Path(f'/proc/{process.pid}/task').iterdir()
            for pid in (task / 'children').read_text().split()]


@pytest.mark.slow
@pytest.mark.parametrize('changes', [
    {}, {'stages': 5}, {'slip_distribution': 'triangular', 'stages': 3},
    {'slip_distribution': 'truncated_gaussian'}, {'left_slip_variance': 2e-3, 'stages': 2},
    {'rates': (5.0, 5.0)}, {'rates': (-4.0, -5.0), 'stages': 4},
    {'rates': (0.0, 9.0), 'stages': 25}, BODY],
    ids=['uniform', 'stages', 'triangular', 'truncated', 'large', 'straight', 'reverse', 'pivot',
         'body'])
def test_the_published_boundary_contains_every_published_sample(diffdrive, changes):
    settings = {**SETTINGS, **changes}
    rates = settings.pop('rates', (6.0, 9.0))
    _, poses, boundaries = projected(diffdrive, settings, rates=rates)
    assert len(poses[-1].poses) == 20_000
    assert furthest_outside(positions(poses[-1]), vertices(boundaries[-1])) <= TOLERANCE


@pytest.mark.parametrize('executor', ['events', 'single_threaded'])
def test_a_worker_beside_each_executor_projects_the_same_as_one_in_place(
        graph, diffdrive, executor):
    poses, boundaries, _ = project(graph, {**SETTINGS, 'executor': executor})
    assert furthest_outside(positions(poses[-1]), vertices(boundaries[-1])) <= TOLERANCE
    _, in_place, around = projected(diffdrive, SETTINGS)
    assert np.array_equal(positions(poses[-1]), positions(in_place[-1]))
    assert np.array_equal(vertices(boundaries[-1]), vertices(around[-1]))


@pytest.mark.slow
def test_the_boundary_is_no_wider_than_what_samples_reach(diffdrive):
    _, poses, boundaries = projected(diffdrive, SETTINGS)
    points, polygon = positions(poses[-1]), vertices(boundaries[-1])
    assert np.all(np.ptp(points, axis=0) > 0.9 * np.ptp(polygon, axis=0))


def test_projections_have_the_stamp_and_frame_of_the_odometry_and_start_from_its_pose(diffdrive):
    _, poses, boundaries = projected(
        diffdrive, {**KHEPERA, 'publish_rate': 20.0, 'command_timeout': 0.0, 'samples': 3,
                    'horizon': 4.0}, rates=(5.0, 5.0))
    for message in (poses[-1], boundaries[-1]):
        assert (message.header.frame_id, stamp_ns(message)) == ('odom', STAMP_NS)
    distance = 5.0 * KHEPERA['wheel_radius'] * 4.0
    expected = START[0] + distance * math.cos(START[2]), START[1] + distance * math.sin(START[2])
    assert positions(poses[-1]) == pytest.approx(np.array([expected] * 3), abs=1e-9)
    q = poses[-1].poses[0].orientation
    assert 2.0 * math.atan2(q.z, q.w) == pytest.approx(START[2], abs=1e-9)
    assert np.mean(vertices(boundaries[-1]), axis=0) == pytest.approx(expected, abs=1e-5)


def test_unbounded_slip_has_samples_and_no_boundary_and_says_so(diffdrive, capfd):
    _, poses, boundaries = projected(
        diffdrive, {**SETTINGS, 'slip_distribution': 'gaussian', 'samples': 50}, 0.3)
    assert len(poses) > 3 and not boundaries
    output = capfd.readouterr().err
    assert output.count('no boundary is published') == 1
    assert 'refused' not in output


def test_the_same_seed_gives_the_same_samples_every_time(diffdrive):
    _, poses, _ = projected(diffdrive, {**SETTINGS, 'samples': 50}, 0.3)
    assert len(poses) > 3 and np.array_equal(positions(poses[0]), positions(poses[-1]))


def test_a_robot_whose_wheels_have_fallen_silent_stays_where_it_is(diffdrive):
    _, poses, _ = projected(
        diffdrive, {**SETTINGS, 'samples': 5, 'command_timeout': 0.1}, 0.5)
    assert np.ptp(positions(poses[0])[:, 0]) > 0.0
    assert positions(poses[-1]) == pytest.approx(np.array([START[:2]] * 5), abs=1e-9)


def test_an_odometry_that_is_not_finite_is_refused_and_the_next_is_projected(diffdrive, capfd):
    robot, poses, _ = projected(diffdrive, {**SETTINGS, 'samples': 5})
    assert poses
    robot.publish('odom', odometry_of(STAMP_NS, (math.nan, 0.0, 0.0)))
    robot.advance(0.1)
    assert "refused message on 'odom'" in capfd.readouterr().err
    robot.publish('odom', odometry_of(STAMP_NS, (9.0, 0.0, 0.0)))
    robot.advance(0.1)
    assert robot.history('projected_poses')[-1].message.poses[0].position.x > 8.0


def test_what_nobody_listens_to_starts_no_process(graph):
    process = graph.start('forward_projection', {**SETTINGS, 'diagnostics_rate': 20.0})
    looks = graph.collect(DiagnosticArray, '/diagnostics')
    publisher, odometry = tell(graph)

    def heard():
        publisher.publish(odometry)
        return looks and int(next(
            value.value for value in looks[-1].status[0].values
            if value.key == 'odometry messages')) > 20

    graph.wait_for(heard, 'twenty odometries')
    assert not children(process)
    poses = graph.collect(PoseArray, 'projected_poses')
    graph.wait_for(lambda: publisher.publish(odometry) or poses, 'projections')
    assert len(children(process)) == 1


def test_a_projection_whose_process_is_killed_says_so_and_goes_on(graph):
    poses, _, process = project(graph, {**SETTINGS, 'samples': 5})
    child, = children(process)
    os.kill(child, signal.SIGKILL)
    publisher, odometry = tell(graph)
    graph.wait_for(
        lambda: publisher.publish(odometry) or 'status -9' in process.output, 'the report')
    passed = len(poses)
    graph.wait_for(lambda: publisher.publish(odometry) or len(poses) > passed, 'more of them')
    assert child not in children(process)


@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGTERM])
def test_a_projection_ends_in_the_middle_of_its_work_and_leaves_no_process(graph, number):
    poses, _, process = project(
        graph, {**SETTINGS, 'samples': 100_000, 'stages': 25, 'publish_rate': 100.0})
    child, = children(process)
    passed, (publisher, odometry) = len(poses), tell(graph)
    graph.wait_for(lambda: publisher.publish(odometry) or len(poses) > passed, 'work')
    assert process.stop(number) == 0
    assert not Path(f'/proc/{child}').exists()
    assert 'Traceback' not in process.output


@pytest.mark.parametrize(
    'own_s, stamps_s', [(1.7e9, 100.0), (100.0, 1.7e9)], ids=['stamps', 'node'])
def test_a_clock_that_is_not_that_of_the_stamps_is_named_and_projections_are_right(
        diffdrive, capfd, own_s, stamps_s):
    """One of both is simulated: the time of the stamps, or that of the node."""
    robot = with_health(diffdrive(nodes('forward_projection'), params={
        **KHEPERA, 'publish_rate': 20.0, 'samples': 2, 'horizon': 4.0, 'diagnostics_rate': 5.0}))
    robot.listen(PoseArray, 'projected_poses')
    robot.step_clock(own_s)
    for number in range(50):
        at_ns = round((stamps_s + 0.06 * number) * 1e9)
        tell_wheels(robot, velocity=[5.0, 5.0], at_ns=at_ns)
        robot.publish('odom', odometry_of(at_ns, (0.0, 0.0, 0.0)))
        robot.advance(0.06)
    found = [status for status in statuses_of(robot, '/forward_projection')
             if 'use_sim_time' in status[1]]
    assert {level for level, *_ in found} == {WARN}
    output = capfd.readouterr().err
    for topic in ('/odom', '/wheel_rates'):
        (said,) = [line for line in output.splitlines() if f"stamps on '{topic}'" in line]
        assert '[WARN]' in said and 'use_sim_time (now ' in said
        times = [float(time) for time in re.findall(r'([0-9.]+) s\b', said)]
        assert times == pytest.approx([stamps_s, own_s], abs=3.0)
    distance, projections = 5.0 * KHEPERA['wheel_radius'] * 4.0, messages(robot, 'projected_poses')
    assert len(projections) > 20
    for message in projections:
        assert positions(message) == pytest.approx(np.array([[distance, 0.0]] * 2), abs=1e-9)
    robot.advance(5.0)  # without a word from outside but the time
    _, text, values = statuses_of(robot, '/forward_projection')[-1]
    assert 'no messages' in text
    assert float(values['age of the last odometry [s]']) == pytest.approx(5.0, abs=0.3)
