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

"""Encoders: wrap-around in and out, ticks, and that nothing adds up."""

import math

from diffdrive_kinematics.core.odometry import Encoder, PositionTrack, wrapped_increment
from hypothesis import given, strategies as st
import pytest

PERIODS = [math.tau, math.pi, 1.0, 0.1, 1234.5]


def followed(readings, period):
    """Return the unwrapped positions of one wheel, reading by reading."""
    track, positions = PositionTrack(period), []
    for reading in readings:
        track = track.followed((reading,))
        positions.append(track.positions[0])
    return positions


@pytest.mark.parametrize('period', PERIODS)
def test_the_ends_of_a_wrapped_increment_are_half_a_range_and_its_upper_end_counts(period):
    assert wrapped_increment(0.5 * period, period) == 0.5 * period
    assert wrapped_increment(-0.5 * period, period) == 0.5 * period
    assert wrapped_increment(-0.49 * period, period) == pytest.approx(-0.49 * period, rel=1e-15)
    assert wrapped_increment(0.51 * period, period) == pytest.approx(-0.49 * period, rel=1e-12)


def test_without_a_range_an_increment_is_what_it_is():
    assert wrapped_increment(1e6, 0.0) == 1e6


@pytest.mark.parametrize('period', PERIODS)
@pytest.mark.parametrize('offset', [0.0, 0.5], ids=['centred', 'from zero'])
@pytest.mark.parametrize('share', [0.49, -0.49, 0.013])
def test_a_wheel_is_followed_over_thousands_of_wraps_without_adding_up_rounding(
        period, offset, share):
    angles = [share * period * number for number in range(20_000)]
    readings = [
        math.remainder(angle - offset * period, period) + offset * period for angle in angles]
    positions = followed(readings, period)
    largest = abs(angles[-1])
    assert positions == pytest.approx(angles, abs=4.0 * math.ulp(largest))


@pytest.mark.parametrize('resolution', [16, 1000, 4096.5])
def test_quantised_readings_are_followed_to_the_tick(resolution):
    encoder = Encoder(math.tau, resolution)
    angles = [-0.3 * number for number in range(2000)]
    positions = followed(map(encoder.reading, angles), math.tau)
    ticks = [Encoder(resolution=resolution).reading(angle) for angle in angles]
    assert positions == pytest.approx(ticks, abs=1e-9)


def test_every_wheel_wraps_by_itself():
    track = PositionTrack(math.tau).followed((3.1, -3.1, 0.0))
    track = track.followed((-3.1, 3.1, 0.1))
    assert track.positions == pytest.approx((math.tau - 3.1, 3.1 - math.tau, 0.1), rel=1e-15)


def test_readings_of_another_number_of_wheels_begin_anew():
    track = PositionTrack(math.tau).followed((3.1,)).followed((-3.1,))
    assert track.followed((-3.1, 3.1)).positions == (-3.1, 3.1)


@given(st.floats(-1e6, 1e6), st.sampled_from([1, 3, 512, 4096, 1e5]))
def test_a_reading_is_the_tick_at_or_below_and_is_read_as_itself(angle, resolution):
    encoder = Encoder(resolution=resolution)
    reading = encoder.reading(angle)
    assert reading <= angle < reading + math.tau / resolution + math.ulp(angle)
    assert encoder.reading(reading) == reading


@given(st.floats(-1e6, 1e6), st.sampled_from(PERIODS))
def test_a_wrapped_reading_is_in_its_range_and_differs_by_whole_ranges(angle, period):
    reading = Encoder(period).reading(angle)
    assert -0.5 * period <= reading < 0.5 * period
    turns = (angle - reading) / period
    assert turns == pytest.approx(round(turns), abs=1e-6)


def test_the_upper_end_of_the_range_is_read_as_its_lower_end():
    assert Encoder(2.0).reading(1.0) == -1.0 == Encoder(2.0).reading(-1.0)


def test_an_ideal_encoder_reads_the_angle_bit_for_bit():
    assert Encoder().reading(0.1 + 0.2) == 0.1 + 0.2


@pytest.mark.parametrize('bad', [-1.0, math.nan, math.inf])
def test_a_bad_range_or_resolution_is_refused(bad):
    with pytest.raises(ValueError, match='encoder range'):
        Encoder(bad)
    with pytest.raises(ValueError, match='encoder resolution'):
        Encoder(resolution=bad)
