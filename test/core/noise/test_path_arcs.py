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

"""Covariance along a whole path beside that of one arc after another."""

from diffdrive_kinematics.core.kinematics import Pose, WheelGeometry
from diffdrive_kinematics.core.noise import (
    arcs_along, covariance_along, NO_COVARIANCE, propagated_covariance)
from hypothesis import given, strategies as st
import numpy as np
import pytest

GEOMETRY = WheelGeometry(0.2, 0.04, wheel_separation_multiplier=1.1)

travels = st.one_of(
    st.floats(-0.01, 0.01), st.floats(-2.0, 2.0), st.sampled_from([0.0, 0.11, 0.22, 1e-160]))


@given(st.lists(st.tuples(travels, travels), min_size=1, max_size=12))
def test_all_arcs_at_once_give_what_they_give_one_after_another(rows):
    """Straights, turns in place, arcs of several turns, and turns where the series ends."""
    arcs = arcs_along(GEOMETRY, np.array(rows))
    pose, covariance = arcs.end, covariance_along(arcs)
    for side, slip in enumerate(((1.0, 0.0), (0.0, 1.0))):
        at, expected = Pose(0.0, 0.0, 0.0), NO_COVARIANCE
        for row in rows:
            at, expected = propagated_covariance(expected, at, GEOMETRY, *row, *slip)
        assert pose == pytest.approx(at, rel=1e-12, abs=1e-12)
        size = max(1e-9, float(np.abs(expected.matrix()).max()))
        assert covariance[side] == pytest.approx(expected.matrix(), rel=1e-9, abs=1e-11 * size)
