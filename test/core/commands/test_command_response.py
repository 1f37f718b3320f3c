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

"""The response to commands: what it never does, and that its inverse is one."""

from diffdrive_kinematics.core.commands import CommandResponse, STILL, Twist
import numpy as np
import pytest

SPEED, YAW_RATE = 0.5, 2.0
RESPONSES = {
    'gains': CommandResponse(SPEED, YAW_RATE, speed_gain=1.03, yaw_rate_gain=0.9, veer=0.1),
    'loss in proportion': CommandResponse(
        SPEED, YAW_RATE, turn_loss=0.09, turn_loss_order=1, veer=-0.2, yaw_rate_gain=0.95),
    'loss of the root': CommandResponse(
        SPEED, YAW_RATE, speed_gain=1.03, turn_loss=0.18, veer=0.2, yaw_rate_gain=0.95),
    'table': CommandResponse(
        SPEED, YAW_RATE, curvatures=(0.0, 0.1, 2.0, 6.0),
        shares=(1.0, 1.05, 0.9, 0.4), veer=0.1),
    'loss and table': CommandResponse(
        SPEED, YAW_RATE, turn_loss=0.18, curvatures=(0.0, 0.1), shares=(0.95, 1.0), veer=-0.1)}
each = pytest.mark.parametrize('response', RESPONSES.values(), ids=RESPONSES)
GRID = [Twist(float(v), float(w)) for v in np.linspace(-SPEED, SPEED, 21)
        for w in np.linspace(-YAW_RATE, YAW_RATE, 21)]


@each
def test_a_robot_that_is_asked_to_stand_still_does_and_standstill_asks_for_nothing(response):
    assert response.motion_of(STILL) == STILL
    assert response.command_for(STILL) == (STILL, True)
    assert response.motion_of(Twist(0.0, 1.0)).v == 0.0
    assert response.command_for(Twist(0.0, 1.0)).command.v == 0.0


@each
def test_the_inverse_gives_the_command_back(response):
    for asked in GRID:
        motion = response.motion_of(asked)
        command, reached = response.command_for(motion)
        assert reached
        assert response.motion_of(command) == pytest.approx(motion, abs=1e-9)
        assert command == pytest.approx(asked, abs=1e-9)


@each
def test_one_command_is_answered_in_plain_floats_as_many_are_in_arrays(response):
    """Numbers of numpy cost several times more, and a command takes some forty steps."""
    for v, w in GRID:
        if v:
            motion = response.motion_of(Twist(v, w))
            asked = response.command_for(motion).command
            assert type(motion.v) is float and type(asked.v) is float
            share = response.share(np.array([w / v]))[0]
            assert motion.v == pytest.approx(response.speed_gain * v * share, rel=1e-14)


@each
def test_backward_is_the_mirror_image_of_forward(response):
    for v, w in GRID:
        there, back = response.motion_of(Twist(v, w)), response.motion_of(Twist(-v, -w))
        assert back == pytest.approx((-there.v, -there.w), abs=1e-15)


@each
def test_a_larger_speed_yields_a_larger_one_at_every_yaw_rate(response):
    for w in np.linspace(-YAW_RATE, YAW_RATE, 21):
        speeds = [response.motion_of(Twist(float(v), float(w))).v
                  for v in np.linspace(-SPEED, SPEED, 201)]
        assert (np.diff(speeds) > 0.0).all()


@each
def test_beyond_the_range_driven_its_edge_counts(response):
    edge = response.motion_of(Twist(SPEED, -YAW_RATE))
    assert response.motion_of(Twist(10.0 * SPEED, -7.0 * YAW_RATE)) == edge


@each
def test_a_motion_beyond_reach_gets_the_nearest_command_of_the_range_and_says_so(response):
    command, reached = response.command_for(Twist(2.0 * SPEED, 0.0))
    assert not reached and command.v == pytest.approx(SPEED, abs=1e-9)
    command, reached = response.command_for(Twist(0.01, -9.0))
    assert not reached and command.w == -YAW_RATE
    assert response.motion_of(command).v == pytest.approx(0.01, abs=1e-9)


@each
@pytest.mark.parametrize('motion', [(np.nan, 0.0), (0.1, np.nan), (np.inf, 0.0)])
def test_a_motion_that_is_not_finite_stays_for_whoever_refuses_it(response, motion):
    command, reached = response.command_for(Twist(*motion))
    assert not reached and command is not STILL
    assert np.array_equal(command, motion, equal_nan=True)


def test_gains_alone_are_linear():
    assert RESPONSES['gains'].motion_of(Twist(0.2, 1.0)) == pytest.approx((0.206, 0.92))


def test_the_losses_are_those_of_their_formulas_away_from_the_corner():
    proportional = CommandResponse(1.0, 2.0, turn_loss=0.09, turn_loss_order=1)
    assert proportional.motion_of(Twist(0.2, 1.0)).v == pytest.approx(0.2 - 0.09, abs=3e-3)
    root = CommandResponse(1.0, 2.0, turn_loss=0.18)
    assert root.motion_of(Twist(0.3, 1.0)).v == pytest.approx(0.24, abs=2e-3)


@pytest.mark.parametrize('wrong', [
    {'max_speed': 0.0}, {'max_yaw_rate': np.inf}, {'speed_gain': -1.0}, {'yaw_rate_gain': 0.0},
    {'delay': -0.1}, {'turn_loss': -0.1}, {'turn_loss_order': 3}, {'veer': np.nan},
    {'turn_loss': 0.2, 'veer': 6.0}, {'curvatures': (0.0, 1.0)},
    {'curvatures': (0.0,), 'shares': (1.0,)}, {'curvatures': (1.0, 0.0), 'shares': (1.0, 1.0)},
    {'curvatures': (1.0, 2.0), 'shares': (0.2, 1.0)},
    {'curvatures': (0.0, 1.0), 'shares': (1.0, -0.2)}])
def test_what_no_robot_does_is_refused_by_name(wrong):
    with pytest.raises(ValueError, match=next(iter(wrong)).rstrip('s')):
        CommandResponse(**{'max_speed': 1.0, 'max_yaw_rate': 2.0, **wrong})


@pytest.mark.parametrize('most', [1e5, 1e9, 1e308])
def test_the_inverse_ends_at_any_speed(most):
    command, _ = CommandResponse(most, 2.0).command_for(Twist(0.4 * most, 0.1))
    assert command == pytest.approx((0.4 * most, 0.1))
