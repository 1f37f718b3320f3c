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

"""The steps of Gauss and Newton: they lower the cost, say so, and end or are refused."""

from typing import NamedTuple

from diffdrive_kinematics.core.calibration.gauss_newton import descend, ROUNDS
import numpy as np
import pytest


class Valley(NamedTuple):
    """Rosenbrock's valley as a sum of two squares, and how far one step may go."""

    at: np.ndarray
    longest: float

    def errors(self):
        x, y = self.at
        return np.array([1e2 * (y - x**2), 10.0 * (1.0 - x)])

    def cost(self):
        return float(self.errors() @ self.errors())

    def normal_equations(self):
        slope = np.array([[-2e2 * self.at[0], 1e2], [-10.0, 0.0]])
        return slope.T @ slope, slope.T @ self.errors()

    def longest_step(self):
        return np.full(2, self.longest)

    def moved(self, change):
        return self._replace(at=self.at + change)


def told(start):
    """Return the end of the search, its trace, and what it told on the way."""
    heard = []
    found, trace = descend(start, heard.append)
    return found, trace, heard


def test_the_search_ends_at_the_least_cost_and_each_step_has_lowered_it():
    found, trace, heard = told(Valley(np.array([-1.2, 1.0]), longest=0.5))
    np.testing.assert_allclose(found.at, [1.0, 1.0], atol=1e-2)
    assert heard == trace
    assert all(after.cost < before.cost for before, after in zip(trace, trace[1:]))


def test_no_step_is_longer_than_allowed():
    path = []

    class Noted(Valley):

        def normal_equations(self):
            path.append(self.at)
            return super().normal_equations()

    descend(Noted(np.array([-1.2, 1.0]), longest=0.05), lambda iteration: None)
    assert 0.049 < np.abs(np.diff(path, axis=0)).max() < 0.050001


def test_a_search_that_would_take_too_long_is_refused():
    with pytest.raises(ValueError, match=f'did not settle in {ROUNDS} steps'):
        told(Valley(np.array([-3.0, 1.0]), longest=1e-2))


def test_what_the_watcher_raises_ends_the_search():
    def stop(iteration):
        raise KeyboardInterrupt
    with pytest.raises(KeyboardInterrupt):
        descend(Valley(np.array([-1.2, 1.0]), longest=0.5), stop)
