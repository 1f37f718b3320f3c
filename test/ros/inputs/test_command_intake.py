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

"""Which commands are obeyed, by their stamps and by when they were sent."""

from collections import Counter
import math
import time
from types import SimpleNamespace

from diffdrive_kinematics.ros.inputs.command_intake import CommandIntake
from diffdrive_kinematics.ros.runtime.diagnostics import WARN
from geometry_msgs.msg import Twist, TwistStamped
from hypothesis import given, strategies as st
import pytest
from rclpy.serialization import serialize_message
from support.graph import twist, twist_stamped

S = 10**9
NOW = 10**6 * S
VALUES = {'cmd_vel_timeout': 0.5, 'stamp_tolerance': 0.0, 'cmd_vel_clock_offset': 0.0}


def intake(stamped=True, **values):
    """Return an intake, and the node that counts for it."""
    values = {**VALUES, **values}
    logger = SimpleNamespace(warning=lambda *_, **__: None)
    node = SimpleNamespace(
        counts=Counter(), config=SimpleNamespace(values=values), get_logger=lambda: logger,
        resolve_topic_name=lambda name: name,
        runtime=SimpleNamespace(clock=SimpleNamespace(ros_time_is_active=True)))
    return CommandIntake(node, stamped, '/cmd_vel', values), node


def given_stamp(judge, stamp_ns, v, now_ns=NOW):
    """Return what becomes of a stamped command; None: it is refused."""
    return judge.alive(serialize_message(twist_stamped(stamp_ns, v, 0.0)), now_ns)


def reports(judge):
    """Return the reports that are to come."""
    texts = []
    judge._node.get_logger = lambda: SimpleNamespace(warning=lambda text, **_: texts.append(text))
    return texts


def sent(judge, seconds_ago, v):
    """Return what becomes of a plain command that was sent a while ago."""
    return judge.alive(serialize_message(twist(v, 0.0)), NOW,
                       time.time_ns() - round(seconds_ago * S))


@given(st.integers(-2 * S, 10 * S), st.sampled_from([0.1, 0.5, 2.0]), st.sampled_from([0.0, 1.0]))
def test_a_command_is_alive_up_to_the_timeout_or_the_tolerance_where_that_is_longer(
        age, timeout, tolerance):
    judge, node = intake(cmd_vel_timeout=timeout, stamp_tolerance=tolerance)
    command = given_stamp(judge, NOW - age, 1.0)
    alive = age <= max(timeout, tolerance) * S
    assert (command is not None) == alive and node.counts['old commands'] == (not alive)
    if command:
        twist, stamp_ns, *_ = command
        assert twist == (1.0, 0.0)
        assert stamp_ns == (NOW - age if 0 <= age <= tolerance * S else NOW)


@given(st.lists(st.tuples(st.integers(0, S // 2), st.booleans()), min_size=1, max_size=20))
def test_no_command_overrides_one_that_is_stamped_later(commands):
    judge, newest = intake()[0], -1
    for age, moves in commands:
        obeyed = given_stamp(judge, NOW - age, float(moves)) is not None
        assert obeyed == (NOW - age >= newest or not moves)  # to stand still is always obeyed
        newest = max(newest, NOW - age)


def test_without_a_timeout_none_is_too_old_and_the_order_counts():
    judge = intake(cmd_vel_timeout=0.0)[0]
    assert given_stamp(judge, NOW - 3600 * S, 1.0)
    assert given_stamp(judge, NOW - 3601 * S, 1.0) is None


def test_a_command_to_stand_still_is_obeyed_whatever_its_stamp_and_lets_none_from_before_through():
    judge = intake()[0]
    assert given_stamp(judge, NOW - 3600 * S, 0.0)
    assert given_stamp(judge, NOW, 1.0)
    assert given_stamp(judge, NOW - S // 4, 0.0)
    assert given_stamp(judge, NOW - S // 8, 1.0) is None
    assert given_stamp(judge, NOW, 1.0)
    assert sent(intake(stamped=False)[0], 3600.0, 0.0)


@given(st.integers(0, 10**9 * S), st.integers(0, 10**9 * S))
def test_a_stamp_of_the_future_counts_as_now(ahead, later):
    judge = intake(cmd_vel_timeout=0.0)[0]
    assert given_stamp(judge, NOW + ahead, 1.0)[1] == NOW
    assert given_stamp(judge, NOW, 1.0)
    assert given_stamp(judge, NOW + later, 1.0, NOW + later)


@pytest.mark.parametrize('step', [-3600 * S, 3600 * S])
def test_the_order_is_kept_over_a_step_of_the_clock(step):
    judge = intake()[0]
    assert given_stamp(judge, NOW, 1.0)
    judge.clock_stepped(step, wall=True)
    assert given_stamp(judge, NOW + step - 1, 1.0, NOW + step) is None
    assert given_stamp(judge, NOW + step, 1.0, NOW + step)


@given(st.floats(-1e5, 1e5))
def test_an_offset_that_is_known_is_taken_off(offset):
    judge = intake(cmd_vel_clock_offset=offset)[0]
    assert given_stamp(judge, NOW - round(offset * S), 1.0)
    assert given_stamp(judge, NOW - round(offset * S) - S, 1.0) is None


def test_where_the_offset_is_not_a_number_stamps_do_not_count():
    judge = intake(cmd_vel_clock_offset=float('nan'))[0]
    for stamp in (NOW, NOW - 3600 * S, NOW + 3600 * S):
        assert given_stamp(judge, stamp, 1.0)[1:] == (NOW, 0)


def test_a_plain_command_is_as_old_as_the_middleware_says():
    judge, node = intake(stamped=False)
    assert sent(judge, 0.001, 1.0)[2] < S // 10
    assert 0.1 * S <= sent(judge, 0.1, 1.0)[2] < 0.4 * S
    assert sent(judge, 3.0, 1.0) is None and node.counts['old commands'] == 1
    assert judge.alive(serialize_message(Twist()), NOW, 0)[2] == 0
    assert sent(intake(stamped=False, cmd_vel_timeout=0.0)[0], 3.0, 1.0)


def test_a_stamp_that_is_fresh_by_a_clock_ahead_does_not_hide_that_it_was_sent_long_ago():
    judge = intake()[0]
    message = serialize_message(twist_stamped(NOW + S, 1.0, 0.0))
    assert judge.alive(message, NOW, time.time_ns() - 3 * S) is None


def test_a_zero_stamp_means_the_time_of_arrival():
    judge = intake()[0]
    assert given_stamp(judge, NOW, 1.0)
    assert judge.alive(serialize_message(TwistStamped()), NOW + 1)[1] == NOW + 1


@pytest.mark.parametrize('offset', [3.0, -3.0, 3600.0])
@pytest.mark.parametrize('stamped', [False, True])
def test_an_offset_that_is_known_is_that_of_the_senders_as_well(offset, stamped):
    judge = intake(stamped, cmd_vel_clock_offset=offset)[0]
    message = twist_stamped(NOW - round(offset * S), 1.0, 0.0) if stamped else twist(1.0, 0.0)
    sent_ns = time.time_ns() - round(offset * S)
    assert judge.alive(serialize_message(message), NOW, sent_ns)[2] < S // 10


def test_a_command_that_is_old_by_an_offset_that_is_known_is_refused_at_once_and_for_ever():
    judge = intake(stamped=False, cmd_vel_clock_offset=3.0)[0]
    assert sent(judge, 5.0, 1.0) is None
    for _ in range(30):
        assert sent(judge, 0.0, 1.0)  # of another sender, on the own clock
    assert sent(judge, 3.0, 1.0)[2] < S // 10


def test_where_the_offset_is_not_a_number_it_does_not_count_either_when_a_command_was_sent():
    for stamped in (False, True):
        judge = intake(stamped, cmd_vel_clock_offset=float('nan'))[0]
        message = serialize_message((twist_stamped(NOW - S, 1.0, 0.0) if stamped
                                     else twist(1.0, 0.0)))
        assert judge.alive(message, NOW, time.time_ns() - 3 * S)[2] == 0


def test_a_change_of_the_offset_counts_from_then_on():
    judge = intake(stamped=False)[0]
    assert sent(judge, 3.0, 1.0) is None
    judge.configure({**VALUES, 'cmd_vel_clock_offset': 3.0})
    assert sent(judge, 3.0, 1.0)


def test_the_offset_is_named_where_the_stamp_is_old_and_not_where_a_command_lay_in_a_queue():
    plain, stamped = intake(stamped=False)[0], intake()[0]
    texts = reports(plain)
    assert sent(plain, 3.0, 1.0) is None
    assert 'cmd_vel_clock_offset' not in texts[0] and 's old, cmd_vel_timeout is 0.5' in texts[0]
    texts = reports(stamped)
    assert given_stamp(stamped, NOW - S, 1.0) is None and 'cmd_vel_clock_offset' in texts[0]


def test_after_a_stop_no_command_is_obeyed_that_is_stamped_before_it():
    judge = intake()[0]
    judge.none_before(NOW)
    assert given_stamp(judge, NOW - 1, 1.0) is None
    assert given_stamp(judge, NOW, 1.0)
    judge.none_before(NOW - S)
    assert given_stamp(judge, NOW - 1, 1.0) is None


def over_ten_seconds(judge, ahead_ns):
    """Tell commands of a clock that is ahead of ours."""
    for number in range(200):
        now_ns = NOW + number * S // 20
        given_stamp(judge, now_ns + ahead_ns, 0.1, now_ns)


@pytest.mark.parametrize('ahead_s', [1_700_000_000, 3600, 3, -3, -900_000])
def test_stamps_of_another_clock_are_named_once_and_as_long_as_it_is_another(ahead_s):
    judge, node = intake()
    node.runtime.clock.ros_time_is_active = ahead_s > 3
    texts = reports(judge)
    over_ten_seconds(judge, ahead_s * S)
    text, = (text for text in texts if 'another clock' in text)
    simulated = 'true' if ahead_s > 3 else 'false'
    assert f'use_sim_time (now {simulated})' in text and "'/cmd_vel'" in text
    problem, = judge.problems()
    assert problem.level == WARN and 'another clock' in problem.message
    judge.clock_stepped(ahead_s * S, wall=False)  # now it is the same
    over_ten_seconds(judge, 0)
    assert judge.problems() == []


@pytest.mark.parametrize('stamped, ahead_s, values', [
    (True, 0.0, {}), (True, 0.9, {}), (True, -0.4, {}),
    (True, -3600.0, {'cmd_vel_clock_offset': 3600.0}),
    (True, -3600.0, {'cmd_vel_clock_offset': math.nan}), (False, 0.0, {})])
def test_nothing_is_said_of_clocks_that_agree_or_are_known_to_be_apart(stamped, ahead_s, values):
    judge, _ = intake(stamped, **values)
    texts = reports(judge)
    if stamped:
        over_ten_seconds(judge, round(ahead_s * S))
    assert texts == [] and judge.problems() == []
