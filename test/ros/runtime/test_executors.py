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

"""Executors: that of the package by parameter, those of other people, and a loop that sleeps."""

from itertools import cycle
import time

from diffdrive_kinematics.nodes.simulated_base import SimulatedBase
from geometry_msgs.msg import PoseWithCovarianceStamped, Twist
from nav_msgs.msg import Odometry
import pytest
from sensor_msgs.msg import JointState
from std_srvs.srv import Trigger
from support.graph import KHEPERA, stamp_ns, twist, wheel_motion, x_of
from support.inside import beside
from support.once import obeyed_once

TRIES = 3


@pytest.mark.parametrize('kind', ['single_threaded', 'auto'])
def test_a_base_works_in_an_executor_that_knows_nothing_of_its_timers(kind):
    odometry = []
    with beside(SimulatedBase, {**KHEPERA, 'enable_odom_tf': False, 'command_timeout': 0.0},
                kind) as (_, test, spin_until):
        test.create_subscription(Odometry, 'odom', odometry.append, 10)
        wheels = test.create_publisher(JointState, 'wheel_rates', 100)
        spin_until(wheels.get_subscription_count)
        wheels.publish(wheel_motion(time.time_ns(), velocity=[1.0, 1.0]))
        spin_until(lambda: odometry and x_of(odometry) > 0.001)


@pytest.mark.parametrize('executor', ['single_threaded', 'events', 'auto'])
def test_a_robot_drives_and_stops_on_every_executor(graph, executor, tmp_path):
    sim = graph.simulate(
        tmp_path, 'diff_drive_controller', 'simulated_base', **KHEPERA, executor=executor,
        enable_odom_tf=False, cmd_vel_timeout=0.2)
    odometry = graph.collect(Odometry, 'odom')
    rates = graph.collect(JointState, 'wheel_rates')
    commands = graph.publisher(Twist, 'cmd_vel')
    graph.wait_for(lambda: odometry and rates, 'odometry')
    send = obeyed_once(sim, lambda: commands.publish(twist(0.1, 0.0)))
    graph.wait_for(lambda: send() or any(
        message.twist.twist.linear.x == pytest.approx(0.1) for message in odometry), 'driving')
    graph.wait_for(lambda: odometry[-1].twist.twist.linear.x == 0.0, 'standing')
    graph.wait_for(lambda: rates[-1].velocity[0] == 0.0 and any(
        message.velocity[0] for message in rates), 'the rates to be heard, too')
    moving = [message for message in rates if message.velocity[0] > 0.0]
    stop = next(message for message in rates if stamp_ns(message) > stamp_ns(moving[-1]))
    assert stamp_ns(stop) - stamp_ns(moving[0]) == 200_000_000
    assert odometry[-1].pose.pose.position.x == pytest.approx(0.02, rel=1e-9)


@pytest.mark.parametrize('executor', ['single_threaded', 'events', 'auto'])
def test_a_ramp_steps_at_its_own_rate_on_every_executor(graph, executor):
    graph.start('diff_drive_controller', {
        **KHEPERA, 'executor': executor, 'cmd_vel_timeout': 0.0, 'publish_rate': 0.01,
        'linear.x.max_acceleration': 1.0})
    told = []
    graph.collect(JointState, 'wheel_rates', lambda message: told.append(
        (stamp_ns(message), message.velocity[0] * KHEPERA['wheel_radius'])))
    commands = graph.publisher(Twist, 'cmd_vel')

    def steps_of_ramps():
        """Speed up and brake; return the steps of both."""
        told.clear()
        for speed in (0.1, 0.0):
            commands.publish(twist(speed, 0.0))
            graph.wait_for(lambda: told and told[-1][1] == pytest.approx(speed), 'the ramp')
        return [told[0], *(after for before, after in zip(told, told[1:])
                           if abs(after[1] - before[1]) > 1e-12)]  # rounding leaves one, too

    def exact():
        """Return whether they come on time, unless the machine has held up the process."""
        steps = steps_of_ramps()
        speeds = [0.01 * k for k in (*range(1, 11), *range(9, -1, -1))]
        return [v for _, v in steps] == pytest.approx(speeds) and all(
            [stamp - ramp[0][0] for stamp, _ in ramp] == [10_000_000 * k for k in range(10)]
            for ramp in (steps[:10], steps[10:]))

    speeds = cycle((0.01, 0.02))
    graph.wait_for(  # nothing repeats the rates for a reader that comes late
        lambda: commands.publish(twist(next(speeds), 0.0)) or told, 'to hear it')
    graph.wait_for(
        lambda: commands.publish(twist(0.0, 0.0)) or abs(told[-1][1]) < 1e-9, 'the robot to stand')
    assert any(exact() for _ in range(TRIES))


def test_a_base_that_sleeps_between_its_ticks_is_there_for_whoever_asks(graph):
    """Nothing of it is needs_wakeup: what comes waits for a tenth of a second, and is heard."""
    graph.start('simulated_base', {
        **KHEPERA, 'enable_odom_tf': False, 'publish_rate': 200.0, 'command_timeout': 0.0})
    odometry = graph.collect(Odometry, 'odom')
    graph.publisher(JointState, 'wheel_rates').publish(
        wheel_motion(graph.now_ns(), velocity=[1.0, 1.0]))
    poses = graph.publisher(PoseWithCovarianceStamped, 'set_pose')
    graph.wait_for(lambda: odometry, 'odometry')
    for number in range(1, 8):
        message = PoseWithCovarianceStamped()
        message.header.frame_id = 'odom'
        message.pose.pose.position.x, message.pose.pose.orientation.w = float(number), 1.0
        poses.publish(message)
        graph.wait_for(
            lambda x=number: odometry[-1].pose.pose.position.x == x, 'the pose that was set')
    for _ in range(5):
        assert graph.call(Trigger, 'simulated_base/reset', Trigger.Request()).success
    graph.wait_for(lambda: odometry[-1].pose.pose.position.x == 0.0, 'the start')
