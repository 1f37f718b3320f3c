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

"""Fast mode: the same numbers every time, and as fast as the nodes can follow."""

import re
import struct

from nav_msgs.msg import Odometry
from std_msgs.msg import Empty
from support.graph import KHEPERA, stamp_ns

REPEATS = 10
PACE = 20.0  # times real time: so that the observer can follow on a loaded machine, too


def bits_of(message):
    """Return what an odometry message says, to the bit."""
    pose, twist = message.pose.pose, message.twist.twist
    return struct.pack(
        '<7d', pose.position.x, pose.position.y, pose.orientation.z,
        pose.orientation.w, twist.linear.x, twist.linear.y, twist.angular.z)


def drive(graph, pace):
    """Drive the demo's course; return (belief, truth) by time since its start, and the report."""
    go = graph.publisher(Empty, 'go', listeners=0)
    collected = [graph.collect(Odometry, topic) for topic in ('odom', 'ground_truth')]
    topics = "command_sequence:wait_for_topics:=['odom', 'ground_truth', 'go']"
    sim = graph.start('diffdrive_sim', {'real_time_factor': pace}, '-p', topics)
    graph.wait_for(lambda: all(collected), 'odometry')
    graph.play_out(sim, go)
    start = round(1e9 * float(re.search(r'of commands, starting at ([\d.]+) s', sim.output)[1]))
    bits = [{stamp_ns(message) - start: bits_of(message) for message in messages
             if stamp_ns(message) >= start} for messages in collected]
    for entity in (*graph.node.subscriptions, *graph.node.publishers):
        if entity.topic_name in ('/odom', '/ground_truth', '/go'):
            (graph.node.destroy_publisher if entity in graph.node.publishers
             else graph.node.destroy_subscription)(entity)
    return bits, sim.output


def test_the_demos_course_gives_bitwise_the_same_odometry_and_truth_every_time(graph):
    """Compare whatever another process hears: a run waits for nobody, so it may miss some."""
    _, report = drive(graph, 0.0)
    print(re.search(r'\d+ times real time', report)[0])
    table = report[report.index('x [m]'):report.index('times real time') - 5].strip()
    first, report = drive(graph, PACE)
    assert table in report
    compared = 0
    for _ in range(REPEATS - 2):
        again, report = drive(graph, PACE)
        assert table in report
        for before, after in zip(first, again):
            both = before.keys() & after.keys()
            compared += len(both)
            assert all(before[time] == after[time] for time in both)
    assert compared > (REPEATS - 2) * 2 * 24 * 50 / 4


def test_a_course_that_begins_at_the_first_step_moves_the_base_from_there_on(graph, tmp_path):
    """The controller says at one time that the wheels stand and that they turn."""
    sim = graph.simulate(
        tmp_path, 'diff_drive_controller', 'simulated_base', 'command_sequence', **KHEPERA,
        enable_odom_tf=False, commands=[0.5, 0.0, 2.0], real_time_factor=0.0, clock_step=0.01)
    assert sim.wait() == 0
    assert 'out of order' not in sim.output
    assert re.search(r'belief \(/simulated_base\) +1\.0000 +0\.0000', sim.output)
