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

"""How often the controller says what: it repeats nothing that it has said just now."""

from diffdrive_kinematics.nodes.diff_drive_controller import DiffDriveController
from geometry_msgs.msg import Twist
import pytest
from sensor_msgs.msg import JointState
from support.graph import DEEP, KHEPERA, stamp_ns, twist
from support.inside import beside, inside, START_NS

MS = 10**6
PERIOD = 20 * MS  # of publish_rate 50
CALM = {'diagnostics_rate': 0.0, 'cmd_vel_timeout': 0.0}


def play(held, seconds, command_at, *, jitter=lambda n: 0):
    """Let time pass in steps of 1 ms, with a command that varies whenever it is time for one."""
    sent = 0
    for ms in range(1, 1000 * seconds + 1):
        held.advance_to(START_NS + ms * MS + jitter(ms))
        if command_at(ms):
            sent += 1
            held.hear('/cmd_vel', twist(0.1 + 0.001 * (sent % 7), 0.0))
    return held.said['/wheel_rates']


@pytest.mark.parametrize('phase', range(1, 20, 3))
def test_commands_at_the_rate_of_the_repeats_are_not_repeated(phase):
    with inside(DiffDriveController, {**KHEPERA, **CALM}) as held:
        said = play(held, 2, lambda ms: ms % 20 == phase)
    assert len(said) == pytest.approx(100, abs=3)


@pytest.mark.parametrize('command_rate', [1, 5, 10, 25, 50, 100])
def test_the_rate_that_is_set_is_kept_whatever_the_rate_of_commands(command_rate):
    period = 1000 // command_rate
    with inside(DiffDriveController, {**KHEPERA, **CALM}) as held:
        said = play(held, 2, lambda ms: ms % period == 7 % period)
    gaps = [stamp_ns(b) - stamp_ns(a) for a, b in zip(said, said[1:])]
    assert len(said) == pytest.approx(2 * max(50, command_rate), abs=4)
    assert max(gaps) < 2 * PERIOD


def test_ticks_that_jitter_repeat_what_no_command_has_said():
    with inside(DiffDriveController, {**KHEPERA, **CALM}) as held:
        said = play(held, 2, lambda ms: False, jitter=lambda ms: ms * 7919 % 1000 * 900)
    assert len(said) == 100


def test_what_was_said_exactly_a_period_ago_is_repeated():
    with inside(DiffDriveController, {**KHEPERA, **CALM}) as held:
        said = play(held, 1, lambda ms: ms == 500)
        changed = next(n for n, message in enumerate(said) if any(message.velocity))
        assert stamp_ns(said[changed]) == START_NS + 500 * MS
        assert stamp_ns(said[changed + 1]) == START_NS + 520 * MS


@pytest.mark.parametrize('rate', [10.0, 50.0, 100.0])
def test_each_step_of_a_ramp_is_said_once(rate):
    with inside(DiffDriveController, {
            **KHEPERA, **CALM, 'linear.x.max_acceleration': 0.1, 'update_rate': rate}) as held:
        said = play(held, 1, lambda ms: ms == 7)
        ramp = [message.velocity[0] for message in said if any(message.velocity)]
    assert len(set(ramp)) == pytest.approx(rate, abs=1)
    assert len(ramp) == pytest.approx(max(rate, 50), abs=1), 'said once, or repeated in between'


def test_with_timers_of_rclpy_only_gaps_between_commands_are_filled():
    """
    Each command has a speed of its own, so what is said again with the same one is a repeat.

    Gaps are those of the stamps: where this process stands still there is a long one, and the
    timer that was late may repeat once more at once.
    """
    said = []
    with beside(DiffDriveController, {**KHEPERA, **CALM}) as (_, test, spin_until):
        test.create_subscription(JointState, 'wheel_rates', said.append, DEEP)
        commands = test.create_publisher(Twist, 'cmd_vel', DEEP)
        spin_until(lambda: said and commands.get_subscription_count())
        for n in range(1, 401):
            commands.publish(twist(0.001 * n, 0.0))
            rate = 0.001 * (n - 0.5) / KHEPERA['wheel_radius']
            spin_until(lambda: said[-1].velocity[0] > rate)
        spin_until(lambda: said[-1].velocity == said[-3].velocity)  # it goes on to be repeated
    new = [n for n in range(1, len(said)) if said[n].velocity != said[n - 1].velocity]
    gaps = [stamp_ns(said[b]) - stamp_ns(said[a]) for a, b in zip(new, new[1:])]
    assert len(new) == 400
    assert new[-1] - new[0] <= len(gaps) + sum(
        1 + gap // PERIOD for gap in gaps if gap > PERIOD // 2)
