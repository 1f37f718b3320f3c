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


"""Calibration from drives: it finds what was put in, knows how well, and refuses what it must."""

from collections import Counter
from dataclasses import replace
import math

from diffdrive_kinematics.core.calibration import (
    CalibrationParameters, Clock, drive_from_positions, fit_drive_slip, fit_trajectory,
    linearised, NO_FRAME, odometry_at, Windows, windows_between, without_frozen_poses)
from diffdrive_kinematics.core.kinematics import Pose, WheelGeometry
import numpy as np
import pytest
from support.drives import curved_twists, Disturbance, drive, EXACT, GEOMETRY, Truth
from support.end_points import encoder_drive, predicted_end
from support.recorded import RADIUS, RUNS, SEPARATION

NAMES = ('left_wheel_radius_multiplier', 'right_wheel_radius_multiplier',
         'wheel_separation_multiplier', 'frame_x', 'frame_y', 'frame_yaw')
SEEDS = 200
ROUGH = Disturbance(outliers=0.02, gaps=((20.0, 23.0), (50.0, 52.0)))


def straight_twists(time):
    """Return a straight course at a changing speed."""
    return np.stack([0.35 + 0.15 * np.sin(0.4 * time), 0.0 * time], axis=1)


def spot_twists(time):
    """Return turns on the spot, both ways."""
    return np.stack([0.0 * time, 0.8 * np.sin(0.3 * time)], axis=1)


def found(fit):
    """Return the fitted wheels, frame and first offset."""
    return [getattr(fit, name) for name in NAMES] + [fit.offsets[0]]


def z_scores(disturbance, seeds):
    """Return errors over standard errors, shape (seeds, 7)."""
    truth = Truth()
    return np.array([
        [(each.value - true) / each.error for each, true in zip(
            found(fit_trajectory(GEOMETRY, [drive(seed, truth, disturbance)])), truth)]
        for seed in seeds])


def kolmogorov_smirnov(scores):
    """Return the p value of scores that should be standard normal."""
    ordered, number = np.sort(scores), len(scores)
    normal = np.array([0.5 * (1.0 + math.erf(z / math.sqrt(2.0))) for z in ordered])
    step = np.arange(number + 1) / number
    gap = max(np.max(step[1:] - normal), np.max(normal - step[:-1]))
    root = math.sqrt(number)
    t = (root + 0.12 + 0.11 / root) * gap  # Stephens 1970
    return min(1.0, 2.0 * sum((-1)**(n - 1) * math.exp(-2.0 * (n * t)**2) for n in range(1, 60)))


def test_the_test_of_normality_tells_wider_and_shifted_scores():
    scores = np.random.default_rng(1).standard_normal(SEEDS)
    assert kolmogorov_smirnov(scores) > 0.01
    assert kolmogorov_smirnov(2.0 * scores) < 1e-3
    assert kolmogorov_smirnov(scores + 0.4) < 1e-3


@pytest.mark.slow
@pytest.mark.timeout(900)
def test_errors_over_standard_errors_are_standard_normal():
    """Of all seeds; slip from 0.0005 to 0.002 sqrt(m), outliers and gaps."""
    scores = np.concatenate([
        z_scores(ROUGH._replace(slip=slip), range(first, SEEDS, 3))
        for first, slip in enumerate((5e-4, 1e-3, 2e-3))])
    for name, column in zip([*NAMES, 'offset'], scores.T, strict=True):
        assert len(column) == SEEDS, name
        assert kolmogorov_smirnov(column) > 1e-3, name
        assert 0.75 < np.std(column) < 1.25, name


def test_exact_data_give_what_was_put_in():
    truth = Truth(drift=4e-4)
    fit = fit_trajectory(GEOMETRY, [drive(0, truth, EXACT)], clock=Clock.DRIFTS)
    values = [each.value for each in (*found(fit), fit.drifts[0])]
    np.testing.assert_allclose(values, truth, atol=2e-5)
    corrected = fit.corrected(GEOMETRY)
    assert corrected.left_wheel_radius_multiplier == fit.left_wheel_radius_multiplier.value
    assert corrected.wheel_separation == GEOMETRY.wheel_separation
    assert fit.after.position < 0.01 * fit.before.position


def test_the_factors_multiply_those_of_the_geometry_that_the_fit_started_from():
    half = WheelGeometry(0.2, 0.04, 1.02, 1.01, 0.99)
    recorded = drive(3)
    whole = fit_trajectory(GEOMETRY, [recorded]).corrected(GEOMETRY)
    other = fit_trajectory(half, [recorded]).corrected(half)
    assert other.separation == pytest.approx(whole.separation, rel=1e-4)
    assert other.left_radius == pytest.approx(whole.left_radius, rel=1e-4)


def test_with_the_mean_radius_kept_yaw_is_that_of_the_fit_and_distance_as_given():
    recorded = drive(5)
    free = fit_trajectory(GEOMETRY, [recorded])
    kept = fit_trajectory(GEOMETRY, [recorded], mean_radius=False)
    wheels, held = np.array(found(free)[:3]), np.array(found(kept)[:3])
    mean = 0.5 * (wheels[0, 0] + wheels[1, 0])
    np.testing.assert_allclose(held[:, 0], wheels[:, 0] / mean, rtol=1e-12)
    assert 0.5 * (held[0, 0] + held[1, 0]) == pytest.approx(1.0, abs=1e-15)
    draws = np.random.default_rng(0).multivariate_normal(
        wheels[:, 0], free.covariance[:3, :3], 100_000)
    scattered = np.std(draws / np.mean(draws[:, :2], axis=1, keepdims=True), axis=0)
    np.testing.assert_allclose(held[:, 1], scattered, rtol=0.02)
    assert free.after.position < kept.after.position <= kept.before.position * 1.01


def test_drives_have_clocks_of_their_own_or_share_a_delay():
    drives = [drive(n, Truth(offset=offset)) for n, offset in enumerate((0.1, -0.15))]
    own = fit_trajectory(GEOMETRY, drives)
    for estimate, true in zip(own.offsets, (0.1, -0.15)):
        assert abs(estimate.value - true) < 4.0 * estimate.error < 0.02
    same = [drive(n, Truth(offset=0.2)) for n in (2, 3)]
    shared = fit_trajectory(GEOMETRY, same, clock=Clock.DELAY)
    assert shared.offsets[0] == shared.offsets[1]
    assert shared.names[-1] == 'delay'
    assert abs(shared.offsets[0].value - 0.2) < 4.0 * shared.offsets[0].error


def test_what_is_given_is_held():
    truth = Truth(1.0, 1.0, 1.0)
    fit = fit_trajectory(GEOMETRY, [drive(0, truth)], wheels=False, frame=Pose(*truth[3:6]))
    assert fit.names == ('offset of drive 1',)
    assert fit.frame == Pose(*truth[3:6])
    assert fit.wheel_separation_multiplier == (1.0, 0.0)
    assert fit.before == fit.after


def test_outliers_do_not_move_the_fit():
    clean, rough = (fit_trajectory(GEOMETRY, [drive(5, disturbance=each)])
                    for each in (Disturbance(), Disturbance(outliers=0.02)))
    assert rough.outliers > 5
    for there, here in zip(found(rough), found(clean)):
        assert abs(there.value - here.value) < 4.0 * here.error


def test_windows_with_an_end_in_a_gap_are_left_out():
    fit = fit_trajectory(GEOMETRY, [drive(0, disturbance=ROUGH._replace(outliers=0.0))])
    whole = fit_trajectory(GEOMETRY, [drive(0)])
    assert whole.in_gaps == 0
    assert fit.in_gaps > 20
    assert fit.windows + fit.in_gaps == whole.windows


@pytest.mark.parametrize('field', CalibrationParameters._fields)
def test_the_derivatives_are_those_of_the_errors(field):
    recorded, truth = drive(1), CalibrationParameters(1.01, 0.99, 1.02, 0.1, -0.2, 0.1, 0.06, 1e-3)
    windows = windows_between(recorded, (2.0, 7.0), 0.5, 0.1)
    step = 1e-5
    there, here = (linearised(GEOMETRY, recorded, windows, truth._replace(
        **{field: getattr(truth, field) + way})).error for way in (step, -step))
    number = CalibrationParameters._fields.index(field)
    derivative = linearised(GEOMETRY, recorded, windows, truth).jacobian[:, :, number]
    np.testing.assert_allclose(derivative, (there - here) / (2.0 * step), rtol=2e-2,
                               atol=2e-2 * np.abs(derivative).max())


def test_the_derivatives_by_the_reference_are_those_of_the_errors():
    recorded, truth = drive(1), CalibrationParameters(x=0.1, y=-0.2, yaw=0.1)
    windows = windows_between(recorded, (5.0,), 60.0, 0.1)
    row = {'at_start': windows.start[0], 'at_end': windows.end[0]}
    base = linearised(GEOMETRY, recorded, windows, truth)
    for name in row:
        for axis in range(3):
            moved = recorded.reference.copy()
            moved[row[name], axis] += 1e-6
            changed = replace(recorded, reference=moved)
            error = linearised(GEOMETRY, changed, windows, truth).error
            np.testing.assert_allclose(getattr(base, name)[0, :, axis],
                                       (error - base.error)[0] / 1e-6, atol=1e-5)


@pytest.mark.parametrize('twists, named, unnamed', [
    (straight_twists, {'wheel_separation_multiplier', 'frame_x', 'frame_y'}, {'frame_yaw'}),
    (spot_twists, {'wheel_separation_multiplier', 'frame_yaw'}, {'frame_x'})])
@pytest.mark.parametrize('disturbance', [EXACT, Disturbance()])
def test_what_a_course_does_not_tell_is_refused_by_name(twists, named, unnamed, disturbance):
    truth = Truth(1.0, 1.0, 1.0)
    with pytest.raises(ValueError, match='the data do not identify') as refused:
        fit_trajectory(GEOMETRY, [drive(0, truth, disturbance, twists=twists)])
    assert all(name in str(refused.value) for name in named)
    assert not any(name in str(refused.value) for name in unnamed)


def test_a_constant_course_does_not_tell_the_time():
    steady = drive(0, twists=lambda time: np.tile([0.4, 0.5], (len(time), 1)))
    with pytest.raises(ValueError, match='do not identify.*offset of drive 1'):
        fit_trajectory(GEOMETRY, [steady])


def seen_from(centre, frame):
    """Return the poses of a frame on the robot."""
    cosine, sine = np.cos(centre[:, 2]), np.sin(centre[:, 2])
    return centre + np.stack([cosine * frame.x - sine * frame.y, sine * frame.x + cosine * frame.y,
                              np.full(len(centre), frame.theta)], axis=1)


@pytest.mark.parametrize('yaw', np.arange(-math.pi, math.pi, 0.4).round(3).tolist())
@pytest.mark.parametrize('place', [(0.3, -0.2), (-1.0, 0.0)])
def test_a_reference_that_sits_anywhere_on_the_robot_is_found(yaw, place):
    truth = CalibrationParameters(1.012, 0.991, 1.03, *place, yaw)
    bare = drive(0, disturbance=EXACT)
    centre = odometry_at(GEOMETRY, bare, truth)
    exact = replace(bare, reference=seen_from(centre, Pose(*place, yaw)))
    fit = fit_trajectory(GEOMETRY, [exact], clock=Clock.NONE)
    np.testing.assert_allclose([each.value for each in found(fit)[:6]], truth[:6], atol=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize('yaw', [-3.0, -1.6, 1.5, 3.1])
def test_a_reference_turned_on_a_real_robot_gives_the_same_wheels(yaw):
    drives, nominal = [*map(encoder_drive, RUNS)], WheelGeometry(SEPARATION, RADIUS)
    turned = [replace(each, reference=each.reference + [0.0, 0.0, yaw]) for each in drives]
    as_was, now = (found(fit_trajectory(nominal, each)) for each in (drives, turned))
    for one, other in zip(as_was[:5], now[:5]):
        assert other.value == pytest.approx(one.value, abs=1e-4)
    assert math.remainder(now[5].value - as_was[5].value - yaw, math.tau) == pytest.approx(
        0.0, abs=1e-4)


def test_a_gap_of_years_costs_nothing():
    near = drive(0)
    late = near.reference_time[-1] + 1e9
    far = replace(
        near, time=np.append(near.time, late), angles=np.vstack([near.angles, near.angles[-1:]]),
        reference_time=np.append(near.reference_time, late),
        reference=np.vstack([near.reference, near.reference[-1:]]))
    here, there = (windows_between(each, (2.0, 10.0), 0.5, 0.1) for each in (near, far))
    np.testing.assert_array_equal(here.start, there.start)
    np.testing.assert_array_equal(here.end, there.end)
    assert there.in_gaps > 1e9


def test_a_tracker_that_hangs_does_not_move_the_fit():
    whole = drive(2)
    poses = whole.reference.copy()
    poses[300:420] = poses[300]
    kept = without_frozen_poses(replace(whole, reference=poses), wheel_radius=0.04)
    clean, fit = (fit_trajectory(GEOMETRY, [each]) for each in (whole, kept))
    for one, other in zip(found(clean), found(fit)):
        assert abs(one.value - other.value) < 3.0 * one.error
    assert 110 < len(poses) - len(kept.reference) < 120
    assert without_frozen_poses(whole, wheel_radius=0.04).reference.shape == poses.shape


def test_each_step_of_the_search_is_told_and_kept():
    told = []
    fit = fit_trajectory(GEOMETRY, [drive(0)], watch=told.append)
    assert fit.trace == tuple(told[:len(fit.trace)])  # then the wheels as given are fitted
    assert len(fit.trace) > 8
    assert fit.trace[-1].step < 0.02 < fit.trace[0].step


def test_bad_requests_are_refused():
    with pytest.raises(ValueError, match='drives is empty'):
        fit_trajectory(GEOMETRY, [])
    with pytest.raises(ValueError, match='expected something to fit'):
        fit_trajectory(GEOMETRY, [drive(0)], wheels=False, clock=Clock.NONE, frame=NO_FRAME)
    with pytest.raises(ValueError, match='there are 0 windows'):
        fit_trajectory(GEOMETRY, [drive(0, seconds=8.0)], windows=Windows((30.0,)))
    with pytest.raises(ValueError, match='frame is nan'):
        fit_trajectory(GEOMETRY, [drive(0)], frame=Pose(math.nan, 0.0, 0.0))
    for bad in ({'lengths': ()}, {'lengths': (0.0,)}, {'every': -1.0}, {'trust': math.nan}):
        with pytest.raises(ValueError, match='expected'):
            Windows(**bad)


@pytest.mark.slow
def test_slip_after_the_calibration_is_that_which_was_put_in():
    drives = [drive(n, disturbance=Disturbance(2e-3, 1e-3, 3e-3)) for n in range(4)]
    fit = fit_trajectory(GEOMETRY, drives)
    slip = fit_drive_slip(GEOMETRY, drives, fit)
    assert abs(slip.k_left.value - 4e-6) < 4.0 * slip.k_left.error
    assert 0.0 < slip.k_left.error < 2e-6
    assert slip.sigma_position.value == pytest.approx(1e-3, rel=0.2)
    assert slip.sigma_heading.value == pytest.approx(3e-3, rel=0.2)
    with pytest.raises(ValueError, match='there are 3 drives, expected 4'):
        fit_drive_slip(GEOMETRY, drives[1:], fit)


def end_error(geometry, frame, recorded):
    """Return the distance [m] of odometry from the reference at the end of a run."""
    return math.dist(*predicted_end(geometry, frame, recorded))


def test_a_real_robot_calibrated_on_some_runs_ends_nearer_to_the_truth_on_others():
    drives, nominal = [*map(encoder_drive, RUNS)], WheelGeometry(SEPARATION, RADIUS)
    assert Counter(np.sign(recorded.reference[-1, 2]) for recorded in drives) == {1.0: 3, -1.0: 3}
    chosen = [drives[n] for n in (0, 1, 3, 4)]
    fit = fit_trajectory(nominal, chosen)
    before, after = (np.mean([end_error(geometry, fit.frame, drives[n]) for n in (2, 5)])
                     for geometry in (nominal, fit.corrected(nominal)))
    assert after < before / 3.0
    assert fit.after.heading < fit.before.heading
    assert fit.wheel_separation_multiplier.error < 2e-3


def test_the_course_of_these_tests_turns_both_ways_and_changes_its_speed():
    v, w = curved_twists(np.arange(0.0, 80.0, 0.1)).T
    assert w.min() < -0.5 and w.max() > 0.5 and np.ptp(v) > 0.2


@pytest.mark.slow
def test_encoders_that_start_anew_do_not_change_the_slip():
    whole = drive(1, Truth(), Disturbance())
    angles, middle = whole.angles.copy(), len(whole.angles) // 2
    angles[middle:] -= angles[middle]
    again = drive_from_positions(
        whole.time, angles, whole.reference_time, whole.reference)
    before, after = (
        fit_drive_slip(GEOMETRY, [each], fit_trajectory(GEOMETRY, [each]))
        for each in (whole, again))
    assert after.k_left.value == pytest.approx(before.k_left.value, rel=0.5)


def test_a_reference_of_another_time_is_named_as_such():
    whole = drive(1, Truth(), Disturbance())
    other = drive_from_positions(
        whole.time, whole.angles, whole.reference_time + 1e9, whole.reference)
    with pytest.raises(ValueError, match='drive 2 .* expected stamps of the same time'):
        fit_trajectory(GEOMETRY, [whole, other])


@pytest.mark.slow
def test_a_reference_in_degrees_is_not_taken_for_a_drive_that_tells_too_little():
    whole = drive(1, Truth(), Disturbance())
    degrees = drive_from_positions(
        whole.time, whole.angles, whole.reference_time,
        whole.reference * [1.0, 1.0, 180.0 / math.pi])
    with pytest.raises(ValueError, match='do not agree .* m and rad'):
        fit_trajectory(GEOMETRY, [degrees])


@pytest.mark.filterwarnings('error')
@pytest.mark.parametrize('spoil', [
    lambda poses: poses * [1e160, 1e160, 1.0], lambda poses: poses * [1e-160, 1e-160, 1.0],
    lambda poses: poses + np.where(np.arange(len(poses)) % 7, 0.0, 1e150)[:, None]])
def test_a_reference_beyond_all_bounds_is_refused_in_words(spoil):
    whole = drive(1, Truth(), Disturbance())
    with pytest.raises(ValueError, match='do not agree .* expected m and rad'):
        fit_trajectory(GEOMETRY, [drive_from_positions(
            whole.time, whole.angles, whole.reference_time, spoil(whole.reference))])
