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

"""Euler and Runge-Kutta against the exact arc and a 50-digit quadrature: order of convergence."""

import math

from diffdrive_kinematics.core.kinematics import (
    advance, integrate_euler, integrate_runge_kutta, Pose, pose_rate)
import mpmath
import numpy as np
import pytest

START = Pose(0.3, -0.2, 0.4)
DURATION = 2.0
ORDERS = pytest.mark.parametrize(('integrate', 'steps', 'order'), [
    (integrate_euler, [64, 128, 256, 512, 1024], 1.0),
    (integrate_runge_kutta, [8, 16, 32, 64, 128], 4.0)])
BOTH = pytest.mark.parametrize('integrate', [integrate_euler, integrate_runge_kutta])


def constant(time):
    return 0.7, 1.1


def varying(time):
    return 0.5 + 0.3 * math.sin(2.0 * time), 0.2 + 0.9 * math.cos(time)


def quadrature(start, duration):
    """Return the pose that ``varying`` leads to, with 50 digits."""
    with mpmath.workdps(50):
        def theta(t):
            return (START.theta + 0.2 * (t - start)
                    + 0.9 * (mpmath.sin(t) - mpmath.sin(start)))

        def speed(t):
            return 0.5 + 0.3 * mpmath.sin(2 * t)

        end = mpmath.mpf(start) + duration
        return Pose(
            float(START.x + mpmath.quad(lambda t: speed(t) * mpmath.cos(theta(t)), [start, end])),
            float(START.y + mpmath.quad(lambda t: speed(t) * mpmath.sin(theta(t)), [start, end])),
            float(theta(end)))


def measured_order(integrate, twist, reference, steps, start=0.0):
    """Return the slope of the error over the step in a log-log plot."""
    errors = [
        math.dist(reference, integrate(START, twist, start=start, duration=DURATION, steps=n))
        for n in steps]
    return -np.polyfit(np.log(steps), np.log(errors), 1)[0]


@ORDERS
def test_the_error_to_the_exact_arc_falls_with_the_order_of_the_method(integrate, steps, order):
    arc = advance(START, 0.7 * DURATION, 1.1 * DURATION)
    assert measured_order(integrate, constant, arc, steps) == pytest.approx(order, rel=0.02)


@ORDERS
@pytest.mark.parametrize('start', [0.0, 1.7])
def test_the_order_holds_for_a_command_that_varies(integrate, steps, order, start):
    reference = quadrature(start, DURATION)
    assert measured_order(integrate, varying, reference, steps, start) == pytest.approx(
        order, rel=0.04)


def test_runge_kutta_converges_to_the_exact_arc_and_to_the_quadrature():
    arc = advance(START, 0.7 * DURATION, 1.1 * DURATION)
    assert integrate_runge_kutta(
        START, constant, start=0.0, duration=DURATION, steps=500) == pytest.approx(arc, abs=1e-12)
    assert integrate_runge_kutta(
        START, varying, start=0.0, duration=DURATION, steps=1000
    ) == pytest.approx(quadrature(0.0, DURATION), abs=1e-12)


@BOTH
def test_a_straight_line_is_exact_in_one_step(integrate):
    end = integrate(START, lambda time: (2.0, 0.0), start=5.0, duration=3.0, steps=1)
    assert end == pytest.approx(advance(START, 6.0, 0.0), abs=1e-15)


@BOTH
def test_going_on_from_the_middle_is_going_through(integrate):
    through = integrate(START, varying, start=1.0, duration=2.0, steps=16)
    middle = integrate(START, varying, start=1.0, duration=1.0, steps=8)
    assert integrate(middle, varying, start=2.0, duration=1.0, steps=8) == pytest.approx(
        through, abs=1e-15)


def test_euler_samples_the_command_at_the_start_of_each_step():
    end = integrate_euler(
        Pose(0.0, 0.0, 0.0), lambda time: (time, 0.0), start=1.0, duration=1.0, steps=2)
    assert end.x == 0.5 * 1.0 + 0.5 * 1.5


def test_runge_kutta_is_simpsons_rule_along_a_line_and_for_the_heading():
    """Guard the weights 1, 2, 2, 1: exact for cubics in one step."""
    end = integrate_runge_kutta(
        Pose(0.0, 0.0, 0.0), lambda time: (time ** 3, 0.0), start=1.0, duration=2.0, steps=1)
    assert end.x == pytest.approx(20.0, rel=1e-15)  # (3^4 - 1^4) / 4
    end = integrate_runge_kutta(
        Pose(0.0, 0.0, 0.0), lambda time: (0.0, time ** 3), start=1.0, duration=2.0, steps=1)
    assert end.theta == pytest.approx(20.0, rel=1e-15)


@BOTH
def test_arrays_of_poses_move_like_each_pose_alone(integrate):
    thetas = np.array([0.0, 1.0, -2.5])
    together = integrate(
        Pose(thetas * 0.0, thetas * 2.0, thetas), varying, start=0.0, duration=1.0, steps=5)
    for k, theta in enumerate(thetas.tolist()):
        alone = integrate(
            Pose(0.0, 2.0 * theta, theta), varying, start=0.0, duration=1.0, steps=5)
        assert [column[k] for column in together] == pytest.approx(alone, abs=1e-15)


@pytest.mark.parametrize(('theta', 'rate'), [
    (0.0, (2.0, 0.0, 0.5)), (math.pi / 2, (0.0, 2.0, 0.5)), (math.pi, (-2.0, 0.0, 0.5))])
def test_the_pose_changes_along_the_heading(theta, rate):
    assert pose_rate(Pose(9.0, 9.0, theta), 2.0, 0.5) == pytest.approx(rate, abs=1e-15)


@BOTH
@pytest.mark.parametrize(('start', 'duration', 'steps', 'name'), [
    (0.0, 1.0, 0, 'steps'), (0.0, 1.0, -3, 'steps'), (math.nan, 1.0, 1, 'start'),
    (0.0, math.inf, 1, 'duration')])
def test_bad_steps_and_times_are_refused_by_name(integrate, start, duration, steps, name):
    with pytest.raises(ValueError, match=f'^{name} is'):
        integrate(START, constant, start=start, duration=duration, steps=steps)
