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

"""The odometry at times that are past."""

from dataclasses import replace

from diffdrive_kinematics.core.kinematics import Pose, WheelGeometry
from diffdrive_kinematics.core.odometry import Odometry, OdometryHistory, WheelSample
import pytest

S = 1_000_000_000
START = Odometry.starting_at(
    Pose(0.0, 0.0, 0.0), geometry=WheelGeometry(0.4, 0.1), timeout_ns=None)


def heard(*samples):
    """Return the odometry after samples, and its history."""
    odometry, history = START, OdometryHistory((START,))
    for sample in samples:
        odometry, _ = odometry.update(sample, sample.stamp_ns)
        history = history.followed(odometry)
    return odometry, history


def test_a_pose_in_the_past_is_what_the_rates_of_that_time_make():
    _, history = heard(
        WheelSample(1 * S, (1.0, 1.0)), WheelSample(2 * S, (2.0, 2.0)),
        WheelSample(3 * S, (2.0, 2.0)), WheelSample(4 * S, (0.0, 0.0)))
    for seconds, x in [(0.5, 0.0), (1.0, 0.0), (1.5, 0.05), (2.0, 0.1), (3.5, 0.4), (9.0, 0.5)]:
        assert history.pose_at(int(seconds * S)).x == pytest.approx(x, abs=1e-12)


def test_an_odometry_that_went_back_begins_anew_and_a_history_does_not_grow():
    odometry, history = heard(*(
        WheelSample(number * S // 10, (float(number), 1.0)) for number in range(1, 999)))
    assert len(history.past) < 200
    assert history.pose_at(0) == history.past[0].predict(0).pose
    back = odometry.clock_stepped(-50 * S)
    assert history.followed(back).past == (back,)


def test_a_pose_in_the_past_is_that_however_often_the_rates_were_repeated_since():
    _, history = heard(*(WheelSample(number * S, (1.0, 1.0)) for number in range(1, 60)))
    assert history.pose_at(3 * S).x == pytest.approx(0.2, abs=1e-12)


@pytest.mark.parametrize('ahead', [3600 * S, -3600 * S])
def test_a_pose_in_the_past_is_that_of_the_own_clock_whatever_that_of_the_publisher(ahead):
    samples = [WheelSample(number * S, (float(number), 1.0)) for number in range(50, 90)]
    _, history = heard(*samples)
    odometry, mapped = START, OdometryHistory((START,))
    for sample in samples:
        odometry, _ = odometry.update(
            replace(sample, stamp_ns=sample.stamp_ns + ahead), sample.stamp_ns)
        mapped = mapped.followed(odometry)
    for time in 49 * S, 60 * S + 1, 85 * S, 89 * S + S // 2:
        assert mapped.pose_at(time) == history.pose_at(time)
