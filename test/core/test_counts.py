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

"""Whatever counts something in the core is a whole number, large enough, or is refused by name."""

import math

from diffdrive_kinematics.core import commands, kinematics, models, noise
from diffdrive_kinematics.core.kinematics import Pose, WheelGeometry
import numpy as np
import pytest

AT, GEOMETRY, NONE = Pose(0.0, 0.0, 0.0), WheelGeometry(0.5, 0.125), noise.WheelSlip()
STEPS = {'start': 0.0, 'duration': 1.0}
WHEELED = models.unicycle(), (0.0, 0.0, 0.0), (1.0, 0.5)


def integrated(method, steps):
    return method((1.0,), lambda state, time: state, **STEPS, steps=steps)


def integrated_pose(method, steps):
    return method(AT, lambda time: (1.0, 0.5), **STEPS, steps=steps)


def propagated(threads):
    return noise.propagate(
        Pose(*np.zeros((3, 2))), 0.1, 0.1, GEOMETRY, NONE, NONE, seed=1, threads=threads)


def sampled(n):
    return noise.sample_paths(
        AT, [kinematics.Command(0.1, 0.0, 1.0)], GEOMETRY, NONE, NONE, n=n, seed=1)


def sampled_model(n):
    system, state, command = WHEELED
    return models.sample_paths(
        system, state, [(command, 1.0)], models.bounded([0.1, 0.0]), n=n,
        generator=np.random.default_rng(1))


def disturbed(n):
    return models.disturbed((1.0, 0.5), models.bounded([0.1, 0.0]), n=n,
                            generator=np.random.default_rng(1))


def reached(most_vertices):
    return noise.reachable_set(AT, [(0.1, 0.1)], GEOMETRY, 1e-3, 1e-3, most_vertices=most_vertices)


def drawn(runs):
    return noise.draw_session(noise.SessionSpread(0.1), np.random.default_rng(1), runs)


COUNTS = {
    'euler': ('steps', 1, lambda n: integrated(kinematics.euler, n)),
    'runge_kutta': ('steps', 1, lambda n: integrated(kinematics.runge_kutta, n)),
    'integrate_euler': ('steps', 1, lambda n: integrated_pose(kinematics.integrate_euler, n)),
    'integrate_runge_kutta': (
        'steps', 1, lambda n: integrated_pose(kinematics.integrate_runge_kutta, n)),
    'transition_by_euler': ('steps', 1, lambda n: models.transition_euler(*WHEELED, 1.0, steps=n)),
    'transition_by_runge_kutta': (
        'steps', 1, lambda n: models.transition_runge_kutta(*WHEELED, 1.0, steps=n)),
    'disturbed': ('n', 1, disturbed), 'sample_paths': ('n', 1, sampled),
    'sample_paths of a model': ('n', 1, sampled_model), 'propagate': ('threads', 1, propagated),
    'reachable_set': ('most_vertices', 64, reached), 'draw_session': ('runs', 1, drawn),
    'square_rounds': ('rounds', 1, lambda n: commands.square_rounds(
        n, side=1.0, speed=0.5, yaw_rate=0.5))}


@pytest.mark.parametrize('what', COUNTS)
def test_what_counts_is_a_whole_number_that_is_large_enough(what):
    """A NaN passes where only too small numbers are refused, and True is a mistake, not a 1."""
    name, least, call = COUNTS[what]
    for bad in (math.nan, math.inf, least + 0.5, float(least), least - 1, -5, str(least), True,
                np.True_, [least], np.array([least])):
        with pytest.raises(ValueError, match=f'^{name} is .*, expected an integer, {least} or '):
            call(bad)
    for good in (least, np.int64(least), np.uint8(least)):
        call(good)
