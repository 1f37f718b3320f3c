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

"""Normals of float32: their law, and what becomes of any bits."""

import math

from diffdrive_kinematics.core.noise.normals import fill_normals, WORDS
import numpy as np
import pytest

N = 4_000_000


class Words:
    """A source of randomness that says given words of 64 bits."""

    def __init__(self, words):
        self._words = words

    def integers(self, _, size, dtype, endpoint):
        return np.resize(np.array(self._words, dtype), size)


def normals_of(generator, n):
    normals = np.full(n, math.nan)
    fill_normals(generator, normals, np.empty(5 * ((n + 1) // 2), np.float32))
    return normals


def box_muller(words, n):
    """Return the same from the same u and angles of 24 digits, by numpy's functions of float64."""
    parts = [words[i:i + WORDS].view(np.int32) for i in range(0, len(words), WORDS)]
    first, second = (np.concatenate(half) for half in zip(*(np.split(p, 2) for p in parts)))
    u = ((first & 0x7FFFFFFF).astype(np.float32) + np.float32(0.5)).astype(np.float64) / 2.0**31
    radius = np.where(second & 1, -1.0, 1.0) * np.sqrt(-2.0 * np.log(u))
    angle = np.pi * second.astype(np.float32).astype(np.float64) / 2.0**32
    return np.concatenate([radius * np.cos(angle), radius * np.sin(angle)])[:n]


@pytest.mark.parametrize('n', [1, 2, 3, 10_001, 2 * WORDS, 100_000])
def test_they_are_those_of_box_and_muller_within_1e_6(n):
    words = np.random.SFC64(3).random_raw((n + 1) // 2)
    found = normals_of(np.random.Generator(np.random.SFC64(3)), n)
    np.testing.assert_allclose(found, box_muller(words, n), rtol=0.0, atol=1e-6)


def test_any_bits_give_finite_normals_within_6_66():
    """Guard the ends: the logarithm of 0, a root of less than 0, and angles of half a turn."""
    ends = [0, 1, 2**31 - 1, 2**31, 2**32 - 1, 2**31 - 64, 2**31 - 65, 2**30, 2**31 + 1, 759250124]
    words = [low | high << 32 for low in ends for high in ends]
    normals = normals_of(Words(words), 2 * len(words))
    assert np.isfinite(normals).all() and np.abs(normals).max() == pytest.approx(6.66, abs=0.01)
    np.testing.assert_allclose(
        normals, box_muller(np.array(words, np.uint64), len(normals)), rtol=0.0, atol=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize('source', [np.random.SFC64, np.random.MT19937])  # of 64 bits, of 32
def test_the_distribution_is_normal(source):
    """Each count is off by its own root: chi^2 of 80 bins is 80 +- 13; seeded."""
    normals = normals_of(np.random.Generator(source(1)), N)
    edges = np.concatenate([[-np.inf], np.linspace(-3.9, 3.9, 79), [np.inf]])
    shares = np.diff([0.5 * math.erf(edge / math.sqrt(2.0)) for edge in edges])
    counts = np.histogram(normals, edges)[0]
    assert np.sum((counts - N * shares)**2 / (N * shares)) < 80.0 + 4.0 * 13.0
    for power, spread in ((1, 1.0), (2, 2.0), (3, 15.0), (4, 96.0)):
        moment = {1: 0.0, 2: 1.0, 3: 0.0, 4: 3.0}[power]
        assert abs(np.mean(normals**power) - moment) < 4.0 * math.sqrt(spread / N)


@pytest.mark.parametrize('apart', [1, N // 6, N // 4, N // 3, N // 2])
def test_normals_do_not_know_each_other_nor_how_large_the_others_are(apart):
    """Half of them share a radius with one each, and thirds of them are three errors of a pose."""
    normals = normals_of(np.random.Generator(np.random.SFC64(2)), N)
    one, other = normals[:-apart], normals[apart:]
    for a, b in ((one, other), (np.abs(one), np.abs(other)), (np.abs(one), other)):
        assert abs(np.corrcoef(a, b)[0, 1]) < 4.5 / math.sqrt(len(one))
