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

"""Statistics of the noise node, measured on its topics."""

import math

import numpy as np
import pytest
from support.graph import stamp_ns
from support.stepped import nodes, tell_wheels

pytestmark = pytest.mark.ros

RADIUS = 0.021
SETTINGS = {
    'wheel_radius': RADIUS, 'left_bias': 0.02, 'right_bias': -0.01, 'left_slip_variance': 4e-6,
    'right_slip_variance': 1e-6, 'seed': 7}
MESSAGES = 2401
Z_999 = 3.2905  # two-sided 99.9 % quantile of the standard normal


def chi_square_bounds(degrees):
    """Return the central 99.9 % interval of chi-square over its degrees (Wilson & Hilferty)."""
    width = Z_999 * math.sqrt(2.0 / (9.0 * degrees))
    return tuple((1.0 - 2.0 / (9.0 * degrees) + sign * width) ** 3 for sign in (-1.0, 1.0))


def rates_of(number):
    """Return wheel rates (left, right) [rad/s]: forward, reverse, turning, with rests."""
    if number % 50 == 49:
        return 0.0, 0.0
    return 4.0 + math.sin(0.01 * number), -6.0 - math.cos(0.02 * number)


def pass_through(diffdrive, rate, settings=SETTINGS, messages=MESSAGES):
    """Send wheel rates at a rate [Hz] through a noise node; return what comes out."""
    robot = diffdrive(nodes('wheel_noise'), params=settings, clock_step=1.0 / rate)
    for rates in [(0.0, 0.0), *map(rates_of, range(messages))]:  # the first one is the baseline
        robot.advance(1.0 / rate)
        tell_wheels(robot, velocity=rates)
    outputs = [each.message for each in robot.history('noisy_wheel_rates')]
    robot.close()
    assert len(outputs) == messages + 1
    return outputs[1:]


@pytest.mark.parametrize('rate', [20.0, 100.0])
def test_bias_and_slip_have_the_mean_and_variance_that_were_set(diffdrive, rate):
    outputs = pass_through(diffdrive, rate)
    positions = np.array([message.position for message in outputs])
    effective = RADIUS * np.diff(positions, axis=0)
    nominal = RADIUS / rate * np.array([rates_of(number) for number in range(MESSAGES - 1)])
    low, high = chi_square_bounds(MESSAGES - 1 - (MESSAGES - 1) // 50)
    for wheel, side in enumerate(('left', 'right')):
        moving = nominal[:, wheel] != 0.0
        assert np.all(effective[~moving, wheel] == 0.0)
        d = nominal[moving, wheel]
        bias, k = SETTINGS[f'{side}_bias'], SETTINGS[f'{side}_slip_variance']
        e = (effective[moving, wheel] - (1.0 + bias) * d) / np.sqrt(k * np.abs(d))
        assert abs(e.mean()) < Z_999 / math.sqrt(len(e))
        assert low < (e ** 2).mean() < high
        gain = np.sum(effective[moving, wheel]) / np.sum(d) - 1.0
        spread = math.sqrt(k * np.sum(np.abs(d))) / abs(np.sum(d))
        assert abs(gain - bias) < Z_999 * spread


def test_velocity_is_the_rate_times_what_the_interval_past_made_of_its_travel(diffdrive):
    outputs = pass_through(diffdrive, 20.0, messages=60)
    for number, (before, message) in enumerate(zip(outputs, outputs[1:]), start=1):
        for wheel in range(2):
            asked, nominal = rates_of(number)[wheel], rates_of(number - 1)[wheel] / 20.0
            if nominal == 0.0:
                bias = SETTINGS['left_bias'], SETTINGS['right_bias']
                ratio = 1.0 + bias[wheel]
            else:
                ratio = (message.position[wheel] - before.position[wheel]) / nominal
            assert message.velocity[wheel] == pytest.approx(asked * ratio, rel=1e-9)
    stamps = list(map(stamp_ns, outputs))
    assert stamps == sorted(set(stamps))


def test_same_seed_and_input_give_the_same_output_bit_for_bit(diffdrive):
    def bits(seed):
        outputs = pass_through(diffdrive, 50.0, {**SETTINGS, 'seed': seed}, messages=300)
        return [(stamp_ns(message), *map(float.hex, (*message.position, *message.velocity)))
                for message in outputs]

    assert bits(3) == bits(3)
    assert bits(3) != bits(4)


def test_bounded_slip_has_the_variance_that_was_set_and_stays_within_its_bounds(diffdrive):
    outputs = pass_through(diffdrive, 50.0, {**SETTINGS, 'slip_distribution': 'uniform'})
    positions = np.array([[0.0, 0.0], *(message.position for message in outputs[1:])])
    effective = RADIUS * np.diff(positions, axis=0)[:, 0]
    nominal = RADIUS / 50.0 * np.array([rates_of(number)[0] for number in range(MESSAGES - 1)])
    d, effective = nominal[nominal != 0.0], effective[nominal != 0.0]
    e = (effective - (1.0 + SETTINGS['left_bias']) * d) / np.sqrt(
        SETTINGS['left_slip_variance'] * np.abs(d))
    assert np.max(np.abs(e)) <= math.sqrt(3.0) * (1.0 + 1e-6)
    assert np.mean(e**2) == pytest.approx(1.0, abs=Z_999 * math.sqrt(0.8 / len(e)))
