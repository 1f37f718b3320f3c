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

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from geometry_msgs.msg import PolygonStamped, PoseArray
from nav_msgs.msg import Odometry
import numpy as np
import pytest
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState
from support.graph import JOINTS, KHEPERA, set_stamp, stamp_ns
from support.stepped import nodes, tell_wheels

pytestmark = pytest.mark.ros

SETTINGS = {
    **KHEPERA, 'left_slip_variance': 2e-5, 'right_slip_variance': 1e-5, 'publish_rate': 20.0,
    'slip_distribution': 'uniform', 'samples': 20_000, 'stages': 1, 'command_timeout': 0.0}
BODY = {'linear_slip_variance': 1e-3, 'turn_slip_variance': 0.02, 'heading_slip_variance': 0.01,
        'stages': 3}
START = (3.0, -2.0, 2.5)
TOLERANCE = 1e-6  # m: float32 at a few metres


def odometry_at(start):
    """Return the odometry of a pose."""
    odometry = Odometry()
    odometry.header.frame_id = 'odom'
    set_stamp(odometry, 7_000_000_001)
    odometry.pose.pose.position.x, odometry.pose.pose.position.y = start[:2]
    odometry.pose.pose.orientation.z = math.sin(0.5 * start[2])
    odometry.pose.pose.orientation.w = math.cos(0.5 * start[2])
    return odometry


def tell(graph, start=START, rates=((6.0, 9.0),)):
    """Tell where the robot is and what its wheels do; return the publisher of odometry."""
    wheels = graph.publisher(JointState, 'wheel_rates')
    message = JointState(name=JOINTS)
    for pair in rates:
        set_stamp(message, graph.now_ns())
        message.velocity = list(pair)
        wheels.publish(message)
    return graph.publisher(Odometry, 'odom'), odometry_at(start)


def project(graph, settings, until, **told):
    """Start the projection and repeat the odometry until something has come."""
    process = graph.start('forward_projection', settings)
    poses = graph.collect(PoseArray, 'projected_poses')
    boundaries = graph.collect(PolygonStamped, 'projected_boundary')
    publisher, odometry = tell(graph, **told)

    def arrived():
        publisher.publish(odometry)
        return until(poses, boundaries)

    graph.wait_for(arrived, 'projections')
    return poses, boundaries, process


def projected(diffdrive, settings, seconds=0.1, start=START, rates=(6.0, 9.0)):
    """Project on stepped time; return the robot, and what it has published for each odometry."""
    robot = diffdrive(nodes('forward_projection'), params=settings)
    for kind, topic in ((PoseArray, 'projected_poses'), (PolygonStamped, 'projected_boundary')):
        robot.listen(kind, topic)
    tell_wheels(robot, velocity=rates)
    for _ in range(round(seconds / 0.05)):
        robot.publish('odom', odometry_at(start))
        robot.advance(0.06)
    return robot, *([each.message for each in robot.history(topic)] for topic in (
        'projected_poses', 'projected_boundary'))


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


def tell_the_time(clock, time_ns):
    """Publish the simulated time [ns]."""
    message = Clock()
    message.clock.sec, message.clock.nanosec = divmod(time_ns, 10**9)
    clock.publish(message)


def children(process):
    """Return the processes that a process has started, and that are not gone."""
    return [int(pid) for task in Path(f'/proc/{process.pid}/task').iterdir()
            for pid in (task / 'children').read_text().split()]


def both(poses, boundaries):
    return poses and boundaries


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
    poses, boundaries, _ = project(graph, {**SETTINGS, 'executor': executor}, both)
    assert furthest_outside(positions(poses[-1]), vertices(boundaries[-1])) <= TOLERANCE
    _, in_place, around = projected(diffdrive, SETTINGS)
    assert np.array_equal(positions(poses[-1]), positions(in_place[-1]))
    assert np.array_equal(vertices(boundaries[-1]), vertices(around[-1]))


def test_the_boundary_is_no_wider_than_what_samples_reach(diffdrive):
    _, poses, boundaries = projected(diffdrive, SETTINGS)
    points, polygon = positions(poses[-1]), vertices(boundaries[-1])
    assert np.all(np.ptp(points, axis=0) > 0.9 * np.ptp(polygon, axis=0))


def test_projections_have_the_stamp_and_frame_of_the_odometry_and_start_from_its_pose(diffdrive):
    _, poses, boundaries = projected(
        diffdrive, {**KHEPERA, 'publish_rate': 20.0, 'command_timeout': 0.0, 'samples': 3,
                    'horizon': 4.0}, rates=(5.0, 5.0))
    for message in (poses[-1], boundaries[-1]):
        assert (message.header.frame_id, stamp_ns(message)) == ('odom', 7_000_000_001)
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
    robot.publish('odom', odometry_at((math.nan, 0.0, 0.0)))
    robot.advance(0.1)
    assert "refused message on 'odom'" in capfd.readouterr().err
    robot.publish('odom', odometry_at((9.0, 0.0, 0.0)))
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
    poses, _, process = project(graph, {**SETTINGS, 'samples': 5}, both)
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
        graph, {**SETTINGS, 'samples': 100_000, 'stages': 25, 'publish_rate': 100.0}, both)
    child, = children(process)
    passed, (publisher, odometry) = len(poses), tell(graph)
    graph.wait_for(lambda: publisher.publish(odometry) or len(poses) > passed, 'work')
    assert process.stop(number) == 0
    assert not Path(f'/proc/{child}').exists()
    assert 'Traceback' not in process.output


@pytest.mark.parametrize('simulated', [False, True], ids=['stamps', 'node'])
def test_a_clock_that_is_not_that_of_the_stamps_is_named_and_projections_are_right(
        graph, simulated):
    """One of both is simulated: the time of the stamps, or that of the node."""
    process = graph.start('forward_projection', {
        **KHEPERA, 'publish_rate': 20.0, 'samples': 2, 'horizon': 4.0, 'use_sim_time': simulated,
        'diagnostics_rate': 5.0})
    began_ns = graph.now_ns()
    clock = graph.publisher(Clock, '/clock') if simulated else None
    poses = graph.collect(PoseArray, 'projected_poses')
    looks = graph.collect(DiagnosticArray, '/diagnostics')
    wheels, odometries = (
        graph.publisher(kind, topic)
        for kind, topic in ((JointState, 'wheel_rates'), (Odometry, 'odom')))
    turning, odometry = JointState(name=JOINTS, velocity=[5.0, 5.0]), Odometry()
    odometry.pose.pose.orientation.w = 1.0

    def pass_time():
        """Return what the simulated clock shows [ns]."""
        simulated_ns = 100 * 10**9 + graph.now_ns() - began_ns
        if clock:
            tell_the_time(clock, simulated_ns)
        return simulated_ns

    def tell():
        simulated_ns = pass_time()
        for publisher, message in ((wheels, turning), (odometries, odometry)):
            set_stamp(message, graph.now_ns() if simulated else simulated_ns)
            publisher.publish(message)

    def found():
        tell()
        return [status for look in looks for status in look.status
                if 'use_sim_time' in status.message]

    graph.wait_for(lambda: pass_time() and looks, 'a node that knows the time')
    (level,) = {status.level for status in graph.wait_for(found, 'the finding')}
    assert level == DiagnosticStatus.WARN
    topics = '/odom', '/wheel_rates'

    def warnings(topic):
        return [line for line in process.output.splitlines() if f"stamps on '{topic}'" in line]

    graph.wait_for(lambda: tell() or all(map(warnings, topics)), 'a warning of each topic')
    for topic in topics:
        said = warnings(topic)
        assert len(said) == 1 and '[WARN]' in said[0]
        assert f'use_sim_time (now {str(simulated).lower()})' in said[0]
        times = sorted(float(time) for time in re.findall(r'([0-9.]+) s\b', said[0]))
        assert times[0] == pytest.approx(100.0, abs=60.0) and times[1] > 1e9
    distance = 5.0 * KHEPERA['wheel_radius'] * 4.0
    graph.wait_for(lambda: tell() or poses, 'projections')
    for message in poses:
        assert positions(message) == pytest.approx(np.array([[distance, 0.0]] * 2), abs=1e-9)
    looks.clear()
    graph.wait_for(  # without a word from outside but the time
        lambda: pass_time() and any(
            'no messages' in status.message for look in looks for status in look.status),
        'silence')
    ages = [float(value.value) for look in looks for status in look.status
            for value in status.values if value.key == 'age of the last odometry [s]']
    assert ages and all(0.0 <= age < 60.0 for age in ages)
