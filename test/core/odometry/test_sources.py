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

"""Which publisher of the wheels is believed where there are several."""

import random

from diffdrive_kinematics.core.odometry.sources import JointMessage, MOST_SOURCES, Sources
import pytest

BOTH = (0, 1)
MS = 10**6


def told(messages, sources=Sources()):
    """Return the sources after messages, and who was believed, message by message."""
    believed = ''
    for who, received in messages:
        sources, taken = sources.update(received)
        believed += who if taken else '.'
    return sources, believed


def driver(n, time_ms, position, number=None, joints=BOTH, tag='', rates=()):
    return n, JointMessage(
        tag, joints, number or 0, time_ms * MS, (position,) * len(joints), rates)


def in_turn(driver_first, zeros_first, seconds=4, moves_after=0.0):
    """Return a driver at 50 Hz that moves and zeros at 10 Hz, with numbers that begin there."""
    messages = []
    for step in range(50 * seconds):
        time_ms = 20 * step
        moved = max(0.0, 0.05 * (step - 50 * moves_after))
        messages.append(driver('D', time_ms, moved, driver_first + step))
        if step % 5 == 2:
            messages.append(driver('z', time_ms + 7, 0.0, zeros_first + step // 5))
    return messages


def test_one_publisher_is_believed_whatever_it_loses():
    random.seed(1)
    number, messages = 0, []
    for step in range(500):
        number += random.choice((1, 1, 1, 2, 5, 60))
        messages.append(driver('D', 20 * step, step % 7, number))
    sources, believed = told(messages)
    assert believed == 500 * 'D'
    assert not sources.contested(500 * 20 * MS) and len(sources.known) == 1


@pytest.mark.parametrize('driver_first', [1, 7, 90, 5000])
@pytest.mark.parametrize('zeros_first', [1, 3, 400, 90000])
def test_zeros_beside_a_driver_are_told_by_their_numbers_and_not_believed(
        driver_first, zeros_first):
    messages = in_turn(driver_first, zeros_first)
    sources, believed = told(messages)
    assert believed.replace('.', '') == 200 * 'D'
    assert sources.contested(messages[-1][1].now_ns)
    assert sources.ignored == 40


@pytest.mark.parametrize('zeros_first', [1, 60, 90000])
def test_zeros_that_were_there_first_give_way_to_the_driver_as_soon_as_it_moves(zeros_first):
    messages = [driver('z', -500, 0.0, zeros_first - 1)] if zeros_first > 1 else []
    messages += in_turn(100, zeros_first, moves_after=2.0)
    _, believed = told(messages)
    assert believed[-115:].replace('.', '') == 96 * 'D'


def test_messages_whose_numbers_meet_are_told_by_what_they_say():
    """The one that is faster passes the other one: for a moment both numbers are the same."""
    _, believed = told(in_turn(300, 330, seconds=20)[20:])
    assert believed.count('z') == 1 and believed.count('D') == 1000 - 17


def test_a_publisher_that_begins_where_the_one_before_is_silent_takes_its_place():
    messages = [driver('A', 20 * step, 0.1 * step, 1 + step) for step in range(50)]
    messages += [driver('B', 2000 + 20 * step, 0.0, 1 + step) for step in range(50)]
    sources, believed = told(messages)
    assert believed == 50 * 'A' + 50 * 'B' and not sources.contested(3000 * MS)


def test_a_restart_that_says_who_it_is_need_not_wait():
    messages = [driver('A', 20 * step, 0.1 * step, tag='a#1') for step in range(50)]
    messages += [driver('B', 1000 + 20 * step, 0.0, tag='a#2') for step in range(50)]
    assert told(messages)[1] == 50 * 'A' + 50 * 'B'


def test_of_two_that_say_who_they_are_the_one_that_moves_is_believed():
    messages = []
    for step in range(100):
        messages.append(driver('A', 20 * step, 0.1 * step, tag='a'))
        messages.append(driver('B', 20 * step + 9, 0.0, tag='b'))
    sources, believed = told(messages)
    assert believed == 'AB' + 99 * 'A.'
    assert sources.contested(2000 * MS)


def test_of_two_that_both_move_the_first_one_is_believed_until_it_falls_silent_for_long():
    messages = []
    for step in range(400):
        if step < 100:
            messages.append(driver('A', 20 * step, 0.1 * step, 500 + step))
        messages.append(driver('B', 20 * step + 9, -0.1 * step, 1 + step))
    _, believed = told(messages)
    assert 'B' not in believed[:299] and believed[:200].count('A') == 100
    assert believed.endswith(100 * 'B')


def test_a_clock_that_is_stepped_locks_nobody_out():
    messages = [driver('A', 10**9 + 20 * step, 0.1 * step, 1 + step) for step in range(50)]
    messages += [driver('B', 20 * step, 0.0, 1 + step) for step in range(50)]
    assert told(messages)[1].endswith(50 * 'B')


def test_publishers_of_different_joints_do_not_disturb_each_other():
    messages = []
    for step in range(100):
        messages.append(driver('L', 20 * step, 0.1 * step, 1 + step, joints=(0,)))
        messages.append(driver('R', 20 * step + 3, 0.2 * step, 1 + step, joints=(1,)))
    sources, believed = told(messages)
    assert believed == 100 * 'LR'
    assert not sources.contested(2000 * MS)


def test_one_publisher_that_takes_the_joints_in_turn_is_no_contest():
    messages = []
    for step in range(100):
        messages.append(driver('L', 20 * step, 0.1 * step, 1 + 2 * step, joints=(0,)))
        messages.append(driver('R', 20 * step + 3, 0.2 * step, 2 + 2 * step, joints=(1,)))
    sources, believed = told(messages)
    assert believed == 100 * 'LR'
    assert not sources.contested(2000 * MS)


def test_zeros_of_both_joints_beside_drivers_of_one_each_are_not_believed():
    messages = []
    for step in range(100):
        messages.append(driver('L', 20 * step, 0.1 * step, 301 + step, joints=(0,)))
        messages.append(driver('R', 20 * step + 3, 0.2 * step, 301 + step, joints=(1,)))
        messages.append(driver('z', 20 * step + 9, 0.0, 1 + step))
    sources, believed = told(messages)
    assert believed == 100 * 'LR.'
    assert sources.contested(2000 * MS)


def test_what_was_lost_in_a_long_silence_makes_no_other_publisher():
    """The process was stopped, and its queue has kept only the last messages."""
    messages = [driver('D', 20 * step, 0.1 * step, 1 + step) for step in range(50)]
    messages += [driver('D', 20 * step, 0.1 * step, 1 + step) for step in range(5000, 5050)]
    sources, believed = told(messages)
    assert believed == 100 * 'D' and len(sources.known) == 1


@pytest.mark.parametrize('rate', [0.0, 5.0])
@pytest.mark.parametrize('down', [100, 300, 600, 1000, 1500, 3000])
@pytest.mark.parametrize('life', [600, 1000, 3000, 4000])
def test_a_restarted_driver_that_counts_past_its_predecessor_is_not_taken_for_it(
        life, down, rate):
    def run(who, begin, end):
        return [driver(who, at, rate * (at - begin) / 1e3, 1 + (at - begin) // 20)
                for at in range(begin, end, 20)]

    again = life + down
    sources, believed = told(run('A', 0, life) + run('B', again, again + 9000))
    first = believed[life // 20:]
    assert len(first.lstrip('.')) >= 450 - 25 and '.' not in first.lstrip('.')
    owner, = sources.owners
    assert owner.now_ns == again * MS
    assert sources.contested_ns < 0


def test_a_slow_publisher_of_zeros_is_not_taken_for_the_driver_whose_number_it_meets():
    messages = []
    for step in range(500):
        messages.append(driver('D', 100 * step, 0.5 * step, 901 + step))
        if step % 12 == 7:
            messages.append(driver('z', 100 * step + 50, 0.0, 1200 + step // 12))
    _, believed = told(messages)
    assert believed.replace('.', '') == 500 * 'D'


def test_zeros_that_begin_with_the_driver_and_with_its_number_are_told_by_what_they_say():
    """The driver moves at once: its second message is as far from both."""
    messages = in_turn(1, 1, seconds=2)
    messages[1:1] = [driver('z', 9, 0.0, 1)]
    messages = [(who, received._replace(number=received.number + (who == 'z' and at > 1)))
                for at, (who, received) in enumerate(messages)]
    sources, believed = told(messages)
    assert believed.replace('.', '') == 100 * 'D'
    assert [each.moved for each in sources.known] == [True, False]


def test_however_many_strangers_speak_the_one_believed_is_not_forgotten():
    messages = [driver('D', 0, 0.0, 1), driver('D', 20, 1.0, 2)]
    messages += [driver('s', 30 + step, 0.0, 5000 - 200 * step) for step in range(20)]
    messages += [driver('D', 60, 2.0, 3)]
    sources, believed = told(messages)
    assert believed == 'DD' + 20 * '.' + 'D'
    assert len(sources.known) == MOST_SOURCES


@pytest.mark.parametrize('hertz', [50, 250, 1000, 2000])
@pytest.mark.parametrize('stall', [0.12, 0.3, 0.45, 0.7])
def test_what_a_queue_loses_while_the_listener_stalls_makes_no_other_publisher(hertz, stall):
    """The queue keeps the last 100 messages; they come all at once."""
    period_ns, messages = 10**9 // hertz, []
    lost = range(hertz, hertz + max(0, int(stall * hertz) - 100))
    for step in range(2 * hertz):
        at_ns = period_ns * step
        if 1.0 <= step / hertz < 1.0 + stall:
            at_ns = int(1e9 * (1.0 + stall))
        if step not in lost:
            messages.append(('D', JointMessage('', BOTH, 1 + step, at_ns, (0.005 * step,) * 2)))
    sources, believed = told(messages)
    assert '.' not in believed and len(sources.known) == 1


def test_messages_of_which_only_the_last_one_is_told_are_no_gap():
    sources, _ = told([driver('D', 0, 0.0, 1)])
    sources = sources.caught_up(driver('D', 2000, 5.0, 101)[1])
    sources, believed = told(
        [driver('z', 2001, 0.0, 50), driver('D', 2020, 5.1, 102), driver('z', 2021, 0.0, 51)],
        sources)
    assert believed == '.D.'


@pytest.mark.parametrize('numbered', [True, False])
def test_one_publisher_may_tell_of_all_joints_now_and_of_some_then(numbered):
    messages = []
    for step in range(100):
        messages.append(driver('F', 20 * step, 0.1 * step, numbered and 1 + 2 * step))
        messages.append(driver(
            'L', 20 * step + 3, 0.1 * step, numbered and 2 + 2 * step, joints=(0,)))
    sources, believed = told(messages)
    assert believed == 100 * 'FL' and not sources.contested(2000 * MS)
