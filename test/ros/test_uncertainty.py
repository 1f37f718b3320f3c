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

"""Covariance as it is published, where the robot may be, and the picture of sample paths."""

import math

from diffdrive_kinematics.core.arc import Pose
from diffdrive_kinematics.core.covariance import (
    NO_COVARIANCE, propagated_covariance, twist_covariance)
from diffdrive_kinematics.core.geometry import travel_from_angles, WheelGeometry
from geometry_msgs.msg import PolygonStamped, PoseArray
from graph import KHEPERA, set_stamp
from nav_msgs.msg import Odometry
import numpy as np
import pytest
from sensor_msgs.msg import JointState

GEOMETRY = WheelGeometry(KHEPERA['wheel_separation'], KHEPERA['wheel_radius'])
JOINTS = ['left_wheel_joint', 'right_wheel_joint']
SLIP = {'left_slip_variance': 4e-6, 'right_slip_variance': 1e-6}
FLOOR = 1e-9


def test_the_base_publishes_the_covariance_that_the_slip_makes_along_its_arcs(graph):
    graph.start('simulated_base', {**KHEPERA, **SLIP, 'enable_odom_tf': False})
    odometry = graph.collect(Odometry, 'odom')
    wheels = graph.publisher(JointState, 'wheel_rates')
    start, pose, expected = graph.now_ns() - 10**9, Pose(0.0, 0.0, 0.0), NO_COVARIANCE
    before = (0.0, 0.0)
    for number, angles in enumerate([(0.0, 0.0), (3.0, 4.0), (9.0, 8.0), (8.0, 9.0)]):
        message = JointState(name=JOINTS, position=list(angles))
        set_stamp(message, start + number * 100_000_000)
        wheels.publish(message)
        travel = travel_from_angles(GEOMETRY, angles[0] - before[0], angles[1] - before[1])
        pose, expected = propagated_covariance(
            expected, pose, GEOMETRY, *travel, SLIP['left_slip_variance'],
            SLIP['right_slip_variance'])
        before = angles
    message = graph.wait_for(
        lambda: odometry and odometry[-1].pose.pose.position.x == pytest.approx(
            pose.x, abs=1e-12) and odometry[-1], 'the end')
    published = np.reshape(message.pose.covariance, (6, 6))
    block = published[np.ix_((0, 1, 5), (0, 1, 5))]
    assert block == pytest.approx(expected.matrix() + FLOOR * np.eye(3), rel=1e-9, abs=1e-18)
    assert np.all(np.diag(published) >= FLOOR)
    assert message.twist.twist.linear.x == pytest.approx(0.0)  # positions: a rate, no motion on


def test_the_twist_has_the_variance_of_what_slips_in_a_period_and_can_be_fixed(graph):
    graph.start('simulated_base', {
        **KHEPERA, **SLIP, 'enable_odom_tf': False, 'command_timeout': 0.0,
        'pose_covariance_diagonal': [0.1, 0.2, 0.3, 0.4, 0.5, 0.6]})
    odometry = graph.collect(Odometry, 'odom')
    message = JointState(name=JOINTS, velocity=[5.0, -2.0])
    set_stamp(message, graph.now_ns())
    graph.publisher(JointState, 'wheel_rates').publish(message)
    told = graph.wait_for(lambda: odometry and odometry[-1], 'odometry')
    vv, vw, ww = twist_covariance(GEOMETRY, (5.0, -2.0), 4e-6, 1e-6, 1.0 / 50.0, FLOOR)
    published = np.reshape(told.twist.covariance, (6, 6))
    assert published[np.ix_((0, 5), (0, 5))] == pytest.approx(
        np.array([[vv, vw], [vw, ww]]), rel=1e-12)
    assert np.diag(np.reshape(told.pose.covariance, (6, 6))) == pytest.approx(
        [0.1, 0.2, 0.3, 0.4, 0.5, 0.6])


def distance_outside(x, y, point):
    """Return how far [m] a point lies outside a counter-clockwise polygon; 0 inside."""
    inside, nearest = False, math.inf
    px, py = point
    for k in range(len(x)):
        ax, ay, bx, by = x[k - 1], y[k - 1], x[k], y[k]
        if (ay > py) != (by > py) and px < ax + (py - ay) / (by - ay) * (bx - ax):
            inside = not inside
        length = (bx - ax) ** 2 + (by - ay) ** 2
        t = 0.0 if length == 0.0 else min(1.0, max(0.0, (
            (px - ax) * (bx - ax) + (py - ay) * (by - ay)) / length))
        nearest = min(nearest, math.hypot(px - ax - t * (bx - ax), py - ay - t * (by - ay)))
    return 0.0 if inside else nearest


@pytest.mark.parametrize('rates', [[5.0, 5.0], [3.0, 6.0], [-4.0, -5.0]])
def test_the_published_boundary_contains_every_sample_of_the_bounded_slip(graph, rates):
    graph.start('forward_projection', {
        **KHEPERA, **SLIP, 'slip_distribution': 'uniform', 'samples': 500,
        'command_timeout': 0.0})
    poses = graph.collect(PoseArray, 'projected_poses')
    boundaries = graph.collect(PolygonStamped, 'projected_boundary')
    wheels = graph.publisher(JointState, 'wheel_rates')
    odometry = graph.publisher(Odometry, 'odom')
    at = Odometry()
    at.header.frame_id = 'odom'
    at.pose.pose.position.x, at.pose.pose.orientation.w = 1.0, 1.0
    message = JointState(name=JOINTS, velocity=rates)
    set_stamp(message, graph.now_ns())
    wheels.publish(message)

    def projected():
        odometry.publish(at)
        return poses and boundaries

    graph.wait_for(projected, 'a projection')
    assert poses[-1].header.frame_id == boundaries[-1].header.frame_id == 'odom'
    assert len(poses[-1].poses) == 500
    x = [point.x for point in boundaries[-1].polygon.points]
    y = [point.y for point in boundaries[-1].polygon.points]
    outside = [distance_outside(x, y, (pose.position.x, pose.position.y))
               for pose in poses[-1].poses]
    assert max(outside) < 1e-6
    v = 0.5 * 0.021 * sum(rates)
    assert abs(np.mean([pose.position.x for pose in poses[-1].poses]) - 1.0) > 0.3 * abs(v)


def test_a_gaussian_slip_has_no_boundary_and_the_log_says_so(graph):
    projection = graph.start('forward_projection', {**KHEPERA, **SLIP})
    graph.wait_for(lambda: 'no boundary is published' in projection.output, 'a word')


@pytest.mark.parametrize('suffix', ['png', 'svg'])
def test_the_picture_of_sample_paths_is_written(graph, tmp_path, suffix):
    pytest.importorskip('matplotlib')
    picture = tmp_path / f'paths.{suffix}'
    plot = graph.start('plot_paths', args=['--ros-args', '-p', f'output:={picture}'])
    assert plot.wait() == 0, plot.output
    assert picture.stat().st_size > 10_000
    assert picture.read_bytes().startswith(b'\x89PNG' if suffix == 'png' else b'<?xml')
