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

"""Laws that hold for every model alike, and models that agree where they have to."""

import math

from diffdrive_kinematics.core.kinematics import WheelGeometry
from diffdrive_kinematics.core.models import (
    ackermann_car, admitted, augmented, bicycle, car, check_command, differential_drive,
    front_drive_tricycle, front_wheel_angles, least_turning_radius, Motion, rear_wheels_tricycle,
    rolling_centre, transition, transition_euler, transition_runge_kutta, tricycle, unicycle,
    Wheel)
from hypothesis import assume, given, strategies as st
import numpy as np
import pytest

GEOMETRY = WheelGeometry(0.4, 0.1)
ROBOTS = {
    'unicycle': unicycle(max_speed=2.0, max_yaw_rate=3.0),
    'differential drive': differential_drive(GEOMETRY, max_wheel_rate=10.0),
    'tricycle': tricycle(wheel_base=0.7, max_steering=1.2, max_speed=2.0),
    'car': car(wheel_base=2.0, max_steering=0.6, max_speed=5.0),
    'front drive': front_drive_tricycle(wheel_base=0.7, max_speed=2.0),
    'rear wheels': rear_wheels_tricycle(track=0.5, max_speed=2.0),
    'Ackermann': ackermann_car(wheel_base=2.0, track=1.2, max_steering=0.7, max_speed=3.0)}
SMOOTH = {
    'acceleration': augmented(ROBOTS['unicycle'], 's', bound=1.5),
    'steering rate': augmented(ROBOTS['tricycle'], 'phi', bound=2.0),
    'steering jerk': augmented(augmented(augmented(
        ROBOTS['car'], 'phi', bound=0.8), 'phi_rate', bound=2.0), 'phi_rate_rate', bound=9.0),
    'both': augmented(augmented(ROBOTS['Ackermann'], 'phi', bound=0.8), 's', bound=1.0)}
EVERY = {**ROBOTS, **SMOOTH}
every = pytest.mark.parametrize('system', EVERY.values(), ids=EVERY)
robot = pytest.mark.parametrize('system', ROBOTS.values(), ids=ROBOTS)
fractions = st.lists(st.floats(-1.0, 1.0), min_size=8, max_size=8)
places = st.tuples(st.floats(-9.0, 9.0), st.floats(-9.0, 9.0), st.floats(-math.pi, math.pi))
lengths = st.floats(0.1, 4.0)
angles = st.floats(-1.4, 1.4)


def command_of(system, parts, share=1.0):
    """Return a command in the box, of fractions of its bounds."""
    return tuple(share * part * each.high for part, each in zip(parts, system.commands))


def state_of(system, place, parts, share=1.0):
    """Return a state in its bounds, of a pose and fractions of the other bounds."""
    return (*place, *(share * part * each.high
                      for part, each in zip(parts, system.states[3:])))


def test_states_and_commands_have_names_units_and_bounds():
    jerk = SMOOTH['steering jerk']
    assert [(each.name, each.unit) for each in jerk.states] == [
        ('x', 'm'), ('y', 'm'), ('theta', 'rad'), ('phi', 'rad'), ('phi_rate', 'rad/s'),
        ('phi_rate_rate', 'rad/s^2')]
    assert [(each.name, each.unit, each.high) for each in jerk.commands] == [
        ('s', 'm/s', 5.0), ('phi_rate_rate_rate', 'rad/s^3', 9.0)]
    for system in EVERY.values():
        assert len(system.rate(state_of(system, (0.0, 0.0, 0.0), [0.1] * 3), command_of(
            system, [0.1] * 2))) == len(system.states)


@every
@given(places, fractions, st.floats(0.1, 2.0))
def test_two_half_steps_are_one(system, place, parts, duration):
    state = state_of(system, place, parts[2:], 0.1)
    command = command_of(system, parts, 1.0 if system in ROBOTS.values() else 0.05)
    middle, end = (transition(system, state, command, part * duration) for part in (0.5, 1.0))
    # No stop is hit.
    assume(all(abs(value) < each.high for at in (middle, end)
               for value, each in zip(at[3:], system.states[3:])))
    assert transition(system, middle, command, 0.5 * duration) == pytest.approx(
        end, rel=1e-7, abs=1e-7)


@robot
@given(places, fractions, st.floats(0.1, 2.0))
def test_two_half_arcs_are_one_to_the_last_digits(system, place, parts, duration):
    command = command_of(system, parts)
    middle = transition(system, place, command, 0.5 * duration)
    assert transition(system, middle, command, 0.5 * duration) == pytest.approx(
        transition(system, place, command, duration), rel=1e-13, abs=1e-13)


@robot
@pytest.mark.parametrize(('method', 'order', 'steps'), [
    (transition_euler, 1, 200), (transition_runge_kutta, 4, 10)], ids=['Euler', 'Runge-Kutta'])
def test_euler_and_runge_kutta_tend_to_the_arc_with_their_orders(system, method, order, steps):
    command = tuple(part * each.high for part, each in zip((0.5, 0.9), system.commands))
    start, duration = (1.0, 2.0, 0.3), 1.5
    exact = transition(system, start, command, duration)

    def error(count):
        end = method(system, start, command, duration, steps=count)
        return math.dist(end[:2], exact[:2])

    assert math.log2(error(steps) / error(2 * steps)) == pytest.approx(order, abs=0.1)


@pytest.mark.parametrize('system', SMOOTH.values(), ids=SMOOTH)
@pytest.mark.parametrize(('method', 'order', 'steps'), [
    (transition_euler, 1, 400), (transition_runge_kutta, 4, 10)], ids=['Euler', 'Runge-Kutta'])
def test_without_arcs_the_two_tend_to_one_end_with_their_orders(system, method, order, steps):
    command = command_of(system, [0.3, 0.02])
    start = state_of(system, (1.0, 2.0, 0.3), [0.4, 0.1, 0.1])
    exact = transition_runge_kutta(system, start, command, 1.0, steps=500)

    def error(count):
        end = method(system, start, command, 1.0, steps=count)
        return math.dist(end[:3], exact[:3])

    assert math.log2(error(steps) / error(2 * steps)) == pytest.approx(order, abs=0.2)


@every
@given(places, fractions, st.floats(0.1, 2.0))
def test_reversing_goes_back(system, place, parts, duration):
    """What is a rate changes its sign; speeds that are states as well."""
    state = state_of(system, place, parts[2:], 0.1)
    command = command_of(system, parts, 1.0 if system in ROBOTS.values() else 0.05)
    if system is SMOOTH['steering jerk']:  # a jerk that goes back has the sign that it had
        state, command = (*state[:4], 0.0, 0.0), (command[0], 0.0)
    there = transition(system, state, command, duration)
    if system in (SMOOTH['acceleration'], SMOOTH['both']):
        there = (*there[:-1], -there[-1])
        state = (*state[:-1], -state[-1])
        command = tuple(value if each.unit == 'm/s^2' else -value
                        for value, each in zip(command, system.commands))
    else:
        command = tuple(-value if '/s' in each.unit else value
                        for value, each in zip(command, system.commands))
    assert transition(system, there, command, duration) == pytest.approx(
        state, rel=1e-7, abs=1e-7)


@every
def test_robots_in_arrays_move_as_each_alone(system):
    generator = np.random.default_rng(1)
    states = np.stack([state_of(system, generator.uniform(-3.0, 3.0, 3), generator.uniform(
        -1.0, 1.0, 3)) for _ in range(20)])
    commands = np.stack([command_of(system, generator.uniform(-1.2, 1.2, 2)) for _ in range(20)])
    together = np.stack(transition(system, tuple(states.T), tuple(commands.T), 0.7), axis=1)
    alone = [transition(system, tuple(map(float, state)), tuple(map(float, command)), 0.7)
             for state, command in zip(states, commands)]
    assert together == pytest.approx(np.array(alone), rel=1e-12, abs=1e-12)


@every
@given(fractions, st.floats(1.0, 9.0))
def test_a_command_beyond_its_bound_is_the_bound(system, parts, factor):
    state = state_of(system, (0.0, 0.0, 0.0), parts[2:])
    bound = tuple(math.copysign(each.high, part) for part, each in zip(parts, system.commands))
    beyond = tuple(factor * value for value in bound)
    assert transition(system, state, beyond, 0.3) == transition(system, state, bound, 0.3)


@pytest.mark.parametrize('system', SMOOTH.values(), ids=SMOOTH)
@given(st.lists(st.tuples(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0), st.floats(0.05, 0.8)),
                min_size=1, max_size=6))
def test_bounds_hold_under_augmentation_to_jerk_whatever_is_commanded(system, pieces):
    state = state_of(system, (0.0, 0.0, 0.0), [0.0] * 3)
    for *parts, duration in pieces:
        state = transition(system, state, command_of(system, parts, 2.0), duration)
        for value, each in zip(state, system.states):
            assert each.low <= value <= each.high


def test_what_hits_a_stop_rests_there_and_leaves_it_at_once():
    system = SMOOTH['steering jerk']
    state = transition(system, (0.0, 0.0, 0.0, 0.5, 0.8, 0.0), (0.0, 9.0), 1.0)
    assert state[3:] == (0.6, 0.0, 0.0)
    assert transition(system, state, (0.0, -9.0), 0.1)[3] < 0.6


@given(lengths, angles, st.floats(-2.0, 2.0), places)
def test_a_bicycle_is_the_unicycle_with_w_s_tan_phi_over_l(length, phi, speed, place):
    assert transition(bicycle(wheel_base=length), place, (speed, phi), 0.8) == pytest.approx(
        transition(unicycle(), place, (speed, speed * math.tan(phi) / length), 0.8), rel=1e-12)


@given(st.floats(-9.0, 9.0), st.floats(-9.0, 9.0), places)
def test_the_differential_drive_is_the_unicycle_with_its_twist(left, right, place):
    twist = 0.1 * (left + right) / 2.0, 0.1 * (right - left) / 0.4
    assert transition(ROBOTS['differential drive'], place, (left, right), 0.8) == pytest.approx(
        transition(unicycle(), place, twist, 0.8), rel=1e-12, abs=1e-12)
    assert transition(
        rear_wheels_tricycle(track=0.4), place, (0.1 * left, 0.1 * right), 0.8) == pytest.approx(
        transition(unicycle(), place, twist, 0.8), rel=1e-12, abs=1e-12)


@given(lengths, angles, st.floats(-2.0, 2.0), places)
def test_front_drive_is_rear_drive_at_the_speed_d_w_r_c_over_r_w(length, phi, speed, place):
    assert transition(
        front_drive_tricycle(wheel_base=length), place, (speed, phi), 0.8) == pytest.approx(
        transition(tricycle(wheel_base=length), place, (speed * math.cos(phi), phi), 0.8),
        rel=1e-9, abs=1e-12)


@given(lengths, st.floats(-2.0, 2.0))
def test_front_drive_turns_in_place_at_a_right_angle(length, speed):
    x, y, theta = transition(
        front_drive_tricycle(wheel_base=length), (1.0, 2.0, 0.5), (speed, math.pi / 2.0), 0.8)
    assert (x, y) == pytest.approx((1.0, 2.0), abs=1e-14)
    assert theta == pytest.approx(0.5 + 0.8 * speed / length, rel=1e-12)


@pytest.mark.parametrize('phi', [1e-2, 1e-3, 1e-4, -1e-3])
def test_an_ackermann_car_at_small_angles_is_the_bicycle(phi):
    """Their curvatures differ by L / (2 l) phi, relative to either."""
    _, w = ROBOTS['Ackermann'].twist((1.0, phi))
    _, bicycles = bicycle(wheel_base=2.0).twist((1.0, phi))
    assert 1.0 - w / bicycles == pytest.approx(1.2 / 4.0 * abs(phi), rel=2e-2)


@given(st.floats(-0.7, 0.7))
def test_the_inner_wheel_of_an_ackermann_car_has_the_angle_commanded(phi):
    v, w = ROBOTS['Ackermann'].twist((1.0, phi))
    left, right = front_wheel_angles(wheel_base=2.0, track=1.2, curvature=w / v)
    assert (left if phi > 0.0 else right) == pytest.approx(phi, abs=1e-15)
    assert abs(left if phi > 0.0 else right) >= abs(right if phi > 0.0 else left)


@given(st.floats(0.01, 0.7), st.sampled_from([-1.0, 1.0]), places)
def test_the_centre_of_an_ackermann_car_is_one_point(phi, side, place):
    v, w = ROBOTS['Ackermann'].twist((1.0, side * phi))
    left, right = front_wheel_angles(wheel_base=2.0, track=1.2, curvature=w / v)
    x, y, theta = place
    c, s = math.cos(theta), math.sin(theta)
    wheels = [Wheel(x + c * a - s * b, y + s * a + c * b, theta + angle) for a, b, angle in (
        (0.0, 0.6, 0.0), (0.0, -0.6, 0.0), (2.0, 0.6, left), (2.0, -0.6, right))]
    centre = rolling_centre(wheels)
    assert centre.motion is Motion.TURN
    assert (centre.x, centre.y) == pytest.approx(
        (x - s * v / w, y + c * v / w), rel=1e-6, abs=1e-6)
    parallel = [*wheels[:2], *(wheel._replace(direction=theta + side * phi)
                               for wheel in wheels[2:])]
    assert rolling_centre(parallel).motion is Motion.SKID


@pytest.mark.parametrize(('wheels', 'centre'), [
    ([Wheel(0.0, 0.0, 1.0)], Motion.AXLE),
    ([Wheel(0.0, 0.2, 0.0), Wheel(0.0, -0.2, 0.0)], Motion.AXLE),
    ([Wheel(0.0, 0.2, 0.0), Wheel(0.0, -0.2, math.pi)], Motion.AXLE),
    ([Wheel(0.0, 0.0, 0.0), Wheel(1.0, 0.0, 0.0)], Motion.STRAIGHT),
    ([Wheel(0.0, 0.0, 0.0), Wheel(1.0, 0.0, 0.1)], Motion.TURN),
    ([Wheel(0.0, 0.2, 0.0), Wheel(0.0, -0.2, 0.1)], Motion.TURN),
    ([Wheel(0.0, 0.2, 0.0), Wheel(0.0, -0.2, 0.0), Wheel(1.0, 0.0, math.pi / 2.0)], Motion.TURN),
    ([Wheel(0.0, 0.0, 0.0), Wheel(1.0, 0.0, 0.1), Wheel(2.0, 0.0, 0.1)], Motion.SKID)])
def test_wheels_turn_about_a_point_go_straight_or_skid(wheels, centre):
    assert rolling_centre(wheels).motion is centre
    far = [wheel._replace(x=wheel.x + 50.0, y=wheel.y - 20.0) for wheel in wheels]
    assert rolling_centre(far).motion is centre


def test_what_goes_straight_has_its_centre_at_infinity_to_the_left():
    wheels = [Wheel(0.0, 0.0, 0.5), Wheel(1.0, 0.0, 0.5)]
    assert rolling_centre(wheels)[1:] == (-math.inf, math.inf)


@given(st.floats(0.1, 1.4), lengths, lengths)
def test_no_command_of_a_car_turns_tighter_than_its_least_radius(phi, wheel_base, track):
    for system, width in (
            (car(wheel_base=wheel_base, max_steering=phi), 0.0),
            (ackermann_car(wheel_base=wheel_base, track=track, max_steering=phi), track)):
        v, w = system.twist(admitted(system, (0.0, 0.0, 0.0), (1.0, 1.5)))
        assert v / w == pytest.approx(least_turning_radius(
            wheel_base=wheel_base, track=width, max_steering=phi), rel=1e-12)


@pytest.mark.parametrize(('make', 'words'), [
    (lambda: tricycle(wheel_base=0.0), 'wheel_base is 0.0'),
    (lambda: tricycle(wheel_base=1.0, max_steering=math.pi / 2.0), 'max_steering is 1.57'),
    (lambda: unicycle(max_speed=-1.0), 'bound of s is -1.0 m/s'),
    (lambda: augmented(unicycle(), 'phi', bound=1.0), "expected one of ['s', 'w']"),
    (lambda: augmented(unicycle(), 's', bound=0.0), 'bound is 0.0'),
    (lambda: front_wheel_angles(wheel_base=1.0, track=1.0, curvature=2.0), 'curvature is 2.0'),
    (lambda: rolling_centre([]), 'no wheels'),
    (lambda: rolling_centre([Wheel(0.0, math.nan, 0.0)]), 'y of a wheel is nan'),
    (lambda: transition(unicycle(), (0.0,) * 3, (0.0,) * 2, math.inf), 'duration is inf'),
    (lambda: transition_euler(unicycle(), (0.0,) * 3, (0.0,) * 2, 1.0, steps=0), 'steps is 0'),
    (lambda: check_command(unicycle(), (1.0,)), 'has 1 numbers'),
    (lambda: check_command(unicycle(max_speed=1.0), (2.0, 0.0)), 's is 2.0 m/s')])
def test_what_makes_no_sense_is_refused_by_name_and_value(make, words):
    with pytest.raises(ValueError) as error:
        make()
    assert words in str(error.value)
