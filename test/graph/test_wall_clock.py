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

"""A wall clock that is stepped under the running nodes, as NTP does with one that is far off."""

import time

from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
import pytest
from sensor_msgs.msg import JointState
from support.graph import DEADLINE_S, KHEPERA, stamp_ns, twist, x_of
from support.wall_clock import COMPILER, WallClock

HOUR_S = 3600
HOUR_NS = HOUR_S * 10**9
SPEED = 0.2  # [m/s]


def hours_stepped(messages):
    """Return the steps [h] between the stamps of messages that are no time that has passed."""
    gaps = [stamp_ns(b) - stamp_ns(a) for a, b in zip(messages, messages[1:])]
    return [round(gap / HOUR_NS) for gap in gaps if abs(gap) > HOUR_NS // 2]


@pytest.mark.skipif(COMPILER is None, reason='no C compiler (cc) to build what shifts the clock')
@pytest.mark.parametrize('step_s', [-HOUR_S, HOUR_S], ids=['back', 'forward'])
def test_a_wall_clock_that_is_stepped_by_an_hour_stalls_nothing_and_moves_nothing(
        graph, tmp_path, step_s):
    clock = WallClock(tmp_path)
    nodes = [graph.start(name, parameters, environment=clock.environment) for name, parameters in (
        ('diff_drive_controller', KHEPERA),
        ('wheel_noise', {'wheel_radius': KHEPERA['wheel_radius']}),
        ('simulated_base', {
            **KHEPERA, 'enable_odom_tf': False, 'wheel_motion_topic': 'noisy_wheel_rates'}))]
    odometry = graph.collect(Odometry, 'odom')
    rates, noisy = (
        graph.collect(JointState, topic) for topic in ('wheel_rates', 'noisy_wheel_rates'))
    commands = graph.publisher(Twist, 'cmd_vel')
    graph.wait_for(lambda: all([odometry, rates, noisy]), 'each of the nodes')
    began, sent_ns = time.monotonic(), 0

    def driven(speed, distance):
        """Drive on, command after command."""
        end = x_of(odometry) + distance

        def there():
            nonlocal sent_ns
            commands.publish(twist(speed, 0.0))
            sent_ns = graph.now_ns()
            return (x_of(odometry) - end) * speed > 0.0

        graph.wait_for(there, f'x {end}')

    driven(SPEED, 0.1)
    clock.step(step_s)
    driven(SPEED, 0.2)
    driven(-SPEED, -0.1)
    graph.wait_for_rest([rates, noisy], [odometry], sent_ns + clock.offset_s * 10**9)
    stop = next(message for message in reversed(rates) if any(message.velocity))
    on_that_clock = sent_ns + clock.offset_s * 10**9
    assert abs(stamp_ns(stop) - on_that_clock) < DEADLINE_S * 1e9

    resting = x_of(odometry)
    clock.step(-step_s)
    heard = len(odometry)
    graph.wait_for(lambda: len(odometry) > heard + 50, 'odometry at rest')
    assert x_of(odometry) == resting
    driven(SPEED, 0.1)
    graph.wait_for_rest([rates, noisy], [odometry], sent_ns + clock.offset_s * 10**9)

    assert hours_stepped(odometry) == [step_s // HOUR_S, -step_s // HOUR_S]
    furthest = max(abs(message.pose.pose.position.x) for message in odometry)
    assert furthest < SPEED * (time.monotonic() - began)
    for node in nodes:
        assert node.running and 'refused' not in node.output, node.output
    for node in nodes[0], nodes[2]:  # wheel_noise reads no clock
        assert node.output.count('the clock was stepped by') == 2
