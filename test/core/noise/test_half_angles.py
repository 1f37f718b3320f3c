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

"""Sines and cosines by polynomials, against fifty digits."""

import math

from diffdrive_kinematics.core.noise.half_angles import fill_half_angles, fill_sincs
from mpmath import cos, mp, mpf, sin
import numpy as np
import pytest

ANGLES = np.concatenate([
    np.linspace(-10.0, 10.0, 401), np.geomspace(1e-300, 6e6, 200), -np.geomspace(1e-9, 6e6, 100),
    np.nextafter(0.5 * math.pi * np.arange(-9.0, 9.0), 1e9)])


def directions(angle):
    p, q, work = angle.copy(), *np.empty((2, len(angle)))
    fill_half_angles(p, q, work)
    square = p * p + q * q
    return 2.0 * p * q / square, (q - p) * (q + p) / square


def test_sines_and_cosines_are_those_of_fifty_digits():
    with mp.workdps(50):
        expected = [(float(sin(mpf(a))), float(cos(mpf(a)))) for a in ANGLES.tolist()]
    for found, there in zip(directions(ANGLES), zip(*expected)):
        assert np.abs(found - there).max() < 1e-15


def test_small_angles_keep_their_digits():
    angle = np.geomspace(1e-300, 1e-3, 300)
    np.testing.assert_allclose(directions(angle)[0], np.sin(angle), rtol=6e-16)


def test_sincs_are_those_of_fifty_digits():
    with mp.workdps(50):
        expected = [float(sin(mpf(a)) / mpf(a)) if a else 1.0 for a in ANGLES.tolist()]
    sinc, work = np.empty((2, len(ANGLES)))
    fill_sincs(ANGLES, sinc, work)
    assert np.abs(sinc - expected).max() < 4e-16
    assert sinc[ANGLES == 0.0] == pytest.approx(1.0, abs=0.0)


def test_what_is_no_angle_makes_no_direction():
    with np.errstate(invalid='ignore'):
        assert np.isnan(directions(np.array([math.nan, math.inf, 1.0]))[0][:2]).all()
