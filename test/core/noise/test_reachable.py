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

"""The reachable set: it holds every sample, and is hardly larger than it must be."""

import itertools
import math
import time

from diffdrive_kinematics.core.kinematics import Pose, WheelGeometry
from diffdrive_kinematics.core.noise import (
    area, BodySlip, NO_BODY_SLIP, outer_boundary, perimeter, propagate, reachable_set,
    reachable_set_from_slip, simplified, Stage, stage_from_slip, WheelSlip)
from diffdrive_kinematics.core.noise import outline
import numpy as np
import pytest

L = 0.0885
GEOMETRY = WheelGeometry(L, 0.02)
ORIGIN = Pose(0.0, 0.0, 0.0)
UNIFORM = WheelSlip(0.0, 1e-5, distribution='uniform')
NONE = WheelSlip(distribution='uniform')
BODY = BodySlip(2e-5, 4e-3, 1e-3, 'uniform')
BOUNDS = len(Stage._fields) - 2  # of a stage
COURSES = {
    'straight': (1.0, 1.0), 'arc': (1.0, 1.2), 'long_turn': (0.5, 0.9),
    'u_turn': (0.3, 0.3 + math.pi * L), 'in_place': (-0.14, 0.14), 'reverse': (-0.6, -0.5),
    'one_wheel': (0.3, 0.0)}


def stages_of(course, number, left=UNIFORM, right=UNIFORM, lateral=True, body=NO_BODY_SLIP):
    d_left, d_right = (d / number for d in COURSES[course])
    stage = stage_from_slip(d_left, d_right, GEOMETRY, left, right, body)
    return [stage if lateral else stage._replace(lateral_bound=0.0)] * number


def boundary_of(stages, pose=ORIGIN, **options):
    """Return the polygon as complex numbers, rounded to float32 as a message is."""
    x, y = reachable_set(
        pose, [stage[:2] for stage in stages], GEOMETRY, *zip(*(stage[2:] for stage in stages)),
        **options)
    return x.astype(np.float32).astype(float) + 1j * y.astype(np.float32).astype(float)


def of_stages(draws):
    return (draws[i:i + BOUNDS] for i in range(0, len(draws), BOUNDS))


def moved_by(stages, draws):
    """Return where draws in [-1, 1], shape (5 k, ...), of the disturbances lead from 0."""
    place, heading = 0.0, 0.0
    for stage, (left, right, side, along, turned) in zip(stages, of_stages(draws)):
        d_left = stage.d_left + stage.left_bound * left
        d_right = stage.d_right + stage.right_bound * right
        half = (d_right - d_left) / (2.0 * L) + 0.5 * stage.turn_bound * turned
        distance = 0.5 * (d_left + d_right) + stage.distance_bound * along
        chord = distance * np.sinc(half / np.pi)
        place = place + np.exp(1j * (heading + half)) * (chord + 1j * stage.lateral_bound * side)
        heading = heading + 2.0 * half
    return place


def draws_of(kind, stages, n, seed=1):
    """Return draws from inside of the box, from its corners, or from its low-dimensional faces."""
    generator = np.random.default_rng(seed)
    draws = generator.uniform(-1.0, 1.0, (BOUNDS * len(stages), n))
    share = {'inside': 0.0, 'faces': 0.85, 'corners': 1.0}[kind]
    return np.where(generator.random(draws.shape) < share, np.sign(draws), draws)


def outside(polygon, points):
    """Return the points that are not inside of the polygon (even-odd rule)."""
    inside = np.zeros(len(points), bool)
    for a, b in zip(polygon, np.roll(polygon, -1)):
        if a.imag != b.imag:
            crossed = (a.imag > points.imag) != (b.imag > points.imag)
            at = a.real + (points.imag - a.imag) * (b.real - a.real) / (b.imag - a.imag)
            inside ^= crossed & (points.real < at)
    return points[~inside]


def excess(polygon, points):
    """Return how far [m] the worst of the points is outside of the polygon."""
    points = outside(polygon, points)
    nearest = np.full(len(points), np.inf)
    for a, b in zip(polygon, np.roll(polygon, -1)):
        if a != b:
            t = np.clip(((points - a) * np.conj(b - a)).real / abs(b - a)**2, 0.0, 1.0)
            nearest = np.minimum(nearest, np.abs(points - a - t * (b - a)))
    return nearest.max(initial=0.0)


def dense_area(stages, side, pixels):
    """
    Return the area of the image of the box by counting pixels.

    The image of a box in the plane is that of its faces of dimension two: points of each face
    on a dense grid mark the pixels, and those on the edge of the image count half.
    """
    used = [i for i, bound in enumerate(b for stage in stages for b in stage[2:]) if bound]
    grid = np.linspace(-1.0, 1.0, side)
    first, second = (axis.ravel() for axis in np.meshgrid(grid, grid))
    corners = moved_by(stages, draws_of('corners', stages, 20_000))
    middle = corners.mean()
    turn = np.exp(-0.5j * np.angle(np.mean((corners - middle)**2)))
    size = complex(*(1.5 * np.abs(f((corners - middle) * turn)).max() for f in (np.real, np.imag)))
    marked = np.zeros(pixels, bool)
    for i, j in itertools.combinations(used, 2):
        rest = [k for k in used if k not in (i, j)]
        for signs in itertools.product((-1.0, 1.0), repeat=len(rest)):
            draws = [0.0] * (BOUNDS * len(stages))
            for k, sign in zip(rest, signs):
                draws[k] = sign
            draws[i], draws[j] = first, second
            place = (moved_by(stages, draws) - middle) * turn
            marked[tuple(
                ((part / extent + 1.0) * 0.5 * n).astype(int) for part, extent, n in zip(
                    (place.real, place.imag), (size.real, size.imag), pixels))] = True
    inner = marked.copy()
    for axis in (0, 1):
        for step in (-1, 1):
            inner &= np.roll(marked, step, axis)
    assert not (marked[[0, -1]].any() or marked[:, [0, -1]].any())
    count = 0.5 * (np.count_nonzero(marked) + np.count_nonzero(inner))
    return count * 4.0 * size.real * size.imag / (pixels[0] * pixels[1])


@pytest.mark.parametrize('body', [NO_BODY_SLIP, BODY], ids=['wheels', 'body'])
@pytest.mark.parametrize('lateral', [True, False])
@pytest.mark.parametrize('number', [1, 2, 5])
@pytest.mark.parametrize('course', COURSES)
def test_no_sample_is_outside(course, number, lateral, body):
    """Draw inside of the box, and where it matters more: corners and faces of the box."""
    stages = stages_of(course, number, lateral=lateral, body=body)
    polygon = boundary_of(stages)
    for kind in ('inside', 'faces', 'corners'):
        assert excess(polygon, moved_by(stages, draws_of(kind, stages, 8000))) < 1e-6, kind


@pytest.mark.parametrize('distribution', ['uniform', 'triangular', 'truncated_gaussian'])
@pytest.mark.parametrize('course', ['straight', 'arc', 'in_place'])
@pytest.mark.parametrize('linear', [0.0, 2e-5])
def test_no_sample_that_propagate_draws_is_outside(course, distribution, linear):
    body = BodySlip(linear, 200.0 * linear, 50.0 * linear, distribution)
    left = WheelSlip(0.03, 2e-5, distribution=distribution)
    right = WheelSlip(-0.02, 1e-5, distribution='uniform')
    travel = tuple(d / 3.0 for d in COURSES[course])
    poses = Pose(*(np.full(60_000, value) for value in (1.0, -2.0, 2.0)))
    for step in range(3):
        poses = propagate(poses, *travel, GEOMETRY, left, right, seed=(1, step), body=body)
    x, y = reachable_set_from_slip(
        Pose(1.0, -2.0, 2.0), [travel] * 3, GEOMETRY, left, right, body=body)
    polygon = x.astype(np.float32) + 1j * y.astype(np.float32).astype(float)
    assert excess(polygon, poses.x + 1j * poses.y) < 1e-6


@pytest.mark.slow
@pytest.mark.parametrize(('course', 'number', 'lateral'), [
    ('arc', 1, False), ('straight', 1, False), ('straight', 2, False), ('straight', 1, True),
    ('arc', 2, False), ('arc', 1, True), ('long_turn', 1, False), ('long_turn', 2, False),
    ('in_place', 2, False), ('in_place', 1, True), ('u_turn', 2, False), ('reverse', 2, False),
    ('arc', 2, True), ('straight', 3, False), ('long_turn', 3, False)])
def test_the_area_is_that_of_the_image_of_the_box_within_2_percent(course, number, lateral):
    stages = stages_of(course, number, lateral=lateral)
    bounds = number * (3 if lateral else 2)
    side, pixels = {2: (2400, (900, 300)), 3: (1100, (620, 210)), 4: (560, (280, 140)),
                    6: (300, (150, 80))}[bounds]
    dense = dense_area(stages, side, pixels)
    assert area(boundary_of(stages)) == pytest.approx(dense, rel=0.02)


@pytest.mark.parametrize(('course', 'wheels', 'body'), [
    ('arc', NONE, BodySlip(0.0, 4e-3, 1e-3, 'uniform')), ('straight', NONE, BODY),
    ('in_place', UNIFORM, BodySlip(0.0, 4e-3, 0.0, 'uniform')), ('arc', UNIFORM, BODY),
    ('long_turn', UNIFORM, BODY)])
def test_the_area_with_slip_of_the_body_is_that_of_the_image_of_the_box(course, wheels, body):
    stages = stages_of(course, 1, wheels, wheels, body=body)
    assert area(boundary_of(stages)) == pytest.approx(
        dense_area(stages, 500, (250, 120)), rel=0.02)


def test_the_area_of_a_turn_in_place_is_that_of_two_leaves():
    """
    One stage of bound b each: leaves b^3 / (3 L) about the origin, by integration in h.

    The chord is shorter than the distance by sin(h) / h, and h varies little.
    """
    bound = 2e-3
    stage = Stage(-0.14, 0.14, bound, bound)
    leaves = 2.0 * bound**3 / (3.0 * L) * np.sinc(0.14 / L / math.pi)**2
    assert area(boundary_of([stage])) == pytest.approx(leaves, rel=0.02)


def test_a_lateral_bound_alone_and_a_bound_alone_are_a_segment():
    for stage, ends in ((Stage(1.0, 1.0, 0.0, 0.0, 0.1), (1.0 + 0.1j, 1.0 - 0.1j)),
                        (Stage(0.0, 0.0, 0.0, 0.0, 0.1), (0.1j, -0.1j))):
        polygon = boundary_of([stage])
        assert excess(polygon, np.array(ends)) == 0.0
        assert area(polygon) < 1e-6 and perimeter(polygon) == pytest.approx(0.4, abs=1e-5)


def test_a_banana_is_not_its_hull():
    """Guard against convex hulls: the middle between the tips of a long straight is outside."""
    stages = stages_of('straight', 5, WheelSlip(0.0, 1e-4, distribution='uniform'),
                       WheelSlip(0.0, 1e-4, distribution='uniform'), lateral=False)
    polygon = boundary_of(stages)
    left, right = polygon[np.argmax(polygon.imag)], polygon[np.argmin(polygon.imag)]
    middle = np.array([0.5 * (left + right)])
    assert excess(polygon, middle) > 0.05


def test_without_disturbances_the_set_is_the_point_of_the_mean():
    polygon = boundary_of([Stage(0.3, 0.5, 0.0, 0.0), Stage(0.1, -0.1, 0.0, 0.0)])
    end = moved_by([Stage(0.3, 0.5, 0.0, 0.0)], np.zeros((BOUNDS, 1)))
    assert np.abs(polygon - end).max() < 1e-6
    assert excess(polygon, end) < 1e-6


@pytest.mark.parametrize('turns', [-2, -1, 1, 2])
@pytest.mark.parametrize('ratio', [0.0, 0.5, 3.0])
def test_whole_turns_end_where_they_start(turns, ratio):
    turn = 2.0 * math.pi * turns  # an arc of a half turn of pi has no chord, whatever its length
    travel = ratio * abs(turn) * L - 0.5 * turn * L, ratio * abs(turn) * L + 0.5 * turn * L
    for slip in (NONE, UNIFORM):
        x, y = reachable_set_from_slip(ORIGIN, [travel], GEOMETRY, NONE, slip)
        assert x.min() < 0.0 < x.max() and y.min() < 0.0 < y.max()


def test_a_wider_bound_gives_a_set_around_the_narrower_one():
    narrow = boundary_of([Stage(0.5, 0.6, 0.005, 0.004, 0.002)] * 3)
    wide = boundary_of([Stage(0.5, 0.6, 0.006, 0.005, 0.003)] * 3)
    assert len(outside(wide, narrow)) == 0
    assert area(wide) > 1.2 * area(narrow)


def test_the_start_moves_and_turns_the_set():
    stages = stages_of('arc', 3)
    here, there = boundary_of(stages), boundary_of(stages, Pose(2.0, -1.0, 2.5))
    np.testing.assert_allclose(
        there, complex(2.0, -1.0) + np.exp(2.5j) * here, atol=2e-6)


def test_exchanging_the_wheels_mirrors_the_set():
    stages = [Stage(0.5, 0.6, 0.005, 0.002, 0.001)] * 2
    mirrored = [Stage(0.6, 0.5, 0.002, 0.005, 0.001)] * 2
    polygon, other = boundary_of(stages), boundary_of(mirrored)
    assert area(polygon) == pytest.approx(area(other), rel=0.005)
    assert excess(polygon, moved_by(mirrored, draws_of('corners', stages, 5000)).conj()) < 1e-6


@pytest.mark.parametrize('course', COURSES)
def test_the_polygon_is_counter_clockwise_simple_and_not_closed(course):
    polygon = boundary_of(stages_of(course, 3))
    assert area(polygon) > 0.0 and polygon[0] != polygon[-1]
    following = np.roll(polygon, -1)
    for i in range(len(polygon)):
        a, b = polygon[i], following[i]
        side_c = ((polygon - a) * np.conj(b - a)).imag
        side_d = ((following - a) * np.conj(b - a)).imag
        side_a = ((a - polygon) * np.conj(following - polygon)).imag
        side_b = ((b - polygon) * np.conj(following - polygon)).imag
        crossed = (side_c * side_d < 0.0) & (side_a * side_b < 0.0)
        if course != 'one_wheel':  # as thin as the rounding to float32
            assert not crossed.any()


@pytest.mark.parametrize('leftover', [0.0, 1e-17])
@pytest.mark.parametrize('mirrored', [False, True])
@pytest.mark.parametrize('number', [1, 4, 25])
def test_a_pivot_about_a_resting_wheel_reaches_an_arc_of_the_circle_around_it(
        number, mirrored, leftover):
    """A rounding error of travel, and the slip of that, are no motion of the resting wheel."""
    turning, resting = 0.3 / number, leftover / number
    travel = (resting, turning) if mirrored else (turning, resting)
    stages = [stage_from_slip(*travel, GEOMETRY, UNIFORM, UNIFORM)] * number
    polygon = boundary_of(stages)
    for kind in ('inside', 'faces', 'corners'):
        assert excess(polygon, moved_by(stages, draws_of(kind, stages, 20_000))) < 1e-6, kind
    centre = 0.5j * L if mirrored else -0.5j * L
    furthest = number * max(stages[0].left_bound, stages[0].right_bound) / L
    middle = (0.3 if mirrored else -0.3) / L
    angle = np.angle((polygon - centre) / (-centre) * np.exp(-1j * middle))
    assert np.abs(polygon - centre) == pytest.approx(0.5 * L, abs=1e-6)
    assert np.abs(angle).max() == pytest.approx(furthest, abs=1e-6 / (0.5 * L))


@pytest.mark.parametrize('rest', [(1, 2), (0, 1, 2), (0, 3)])
def test_pivots_and_other_stages_follow_each_other_in_any_order(rest):
    """Guard what is joined: only neighbours about the same wheel are one rotation."""
    kinds = [(0.03, 0.0), (0.02, 0.0), (0.0, 0.05), (0.04, 0.03)]
    stages = [stage_from_slip(*kinds[each], GEOMETRY, UNIFORM, UNIFORM)
              for each in (0, *rest, 0, *rest)]
    polygon = boundary_of(stages)
    for kind in ('inside', 'faces', 'corners'):
        assert excess(polygon, moved_by(stages, draws_of(kind, stages, 8000))) < 1e-6, kind
    reached = moved_by(stages, draws_of('corners', stages, 20_000))
    assert np.ptp(polygon.real) < 1.02 * np.ptp(reached.real)
    assert np.ptp(polygon.imag) < 1.02 * np.ptp(reached.imag)


@pytest.mark.parametrize('number', [4, 25])
@pytest.mark.parametrize('kind', ['one_wheel', 'in_place'])
def test_a_wheel_at_rest_or_a_turn_in_place_costs_at_most_twice_an_arc(kind, number):
    """Compare processor time, side by side: a wheel at rest took thirteen times that of an arc."""
    def cost(course):
        stages, seconds = stages_of(course, number), []
        for _ in range(3):
            began = time.thread_time()
            boundary_of(stages)
            seconds.append(time.thread_time() - began)
        return min(seconds)

    assert cost(kind) < 2.0 * cost('arc')


@pytest.mark.parametrize('most', [64, 100])
def test_the_number_of_vertices_is_bounded_and_no_sample_lost_for_it(most):
    stages = stages_of('arc', 6, lateral=False)
    polygon = boundary_of(stages, most_vertices=most)
    assert len(polygon) <= most
    assert excess(polygon, moved_by(stages, draws_of('corners', stages, 5000))) < 1e-6


def test_the_same_arguments_give_the_same_bits():
    stages = stages_of('long_turn', 4)
    np.testing.assert_array_equal(boundary_of(stages), boundary_of(stages))


def test_a_set_that_goes_all_around_is_enclosed():
    """Guard a robot that may face anywhere: an annulus, whose hole is filled."""
    stages = [Stage(-0.1, 0.1, 0.2, 0.2), Stage(1.0, 1.0, 0.01, 0.01)]
    polygon = boundary_of(stages)
    assert excess(polygon, moved_by(stages, draws_of('faces', stages, 20_000))) < 1e-6
    assert area(polygon) > 3.0


def test_the_stage_of_a_slip_by_hand():
    left = WheelSlip(0.1, 1e-4, distribution='uniform')
    right = WheelSlip(-0.1, 4e-4, distribution='triangular')
    stage = stage_from_slip(0.25, -1.0, GEOMETRY, left, right)
    assert stage[:5] == pytest.approx((
        0.275, -0.9, math.sqrt(3.0) * 0.005, math.sqrt(6.0) * 0.02,
        (math.sqrt(3.0) * 0.005 * 0.9 + math.sqrt(6.0) * 0.02 * 0.275) / (math.sqrt(12.0) * L)))


def test_the_slip_of_a_body_has_its_bounds_in_the_stage():
    body, turn = BodySlip(1e-4, 0.01, 4e-4, 'uniform'), 0.5
    stage = stage_from_slip(1.0 - 0.5 * L * turn, 1.0 + 0.5 * L * turn, GEOMETRY, NONE, NONE, body)
    assert stage[2:] == pytest.approx((
        0.0, 0.0, math.sqrt(3.0 * (5.4e-3 + 1e-4 * turn**2) / 12.0), math.sqrt(3.0) * 0.01,
        math.sqrt(3.0 * 5.4e-3)))


def test_no_wheel_rests_where_the_body_slips():
    """Guard pivots that are taken for one: the body turns about its own centre."""
    stages = stages_of('one_wheel', 4, body=BODY)
    polygon = boundary_of(stages)
    assert excess(polygon, moved_by(stages, draws_of('faces', stages, 20_000))) < 1e-6


def test_gaussian_slip_is_refused_and_gaussian_without_slip_is_not():
    with pytest.raises(ValueError, match="^distribution of the body is 'gaussian'"):
        stage_from_slip(0.1, 0.1, GEOMETRY, UNIFORM, UNIFORM, BodySlip(1e-6))
    with pytest.raises(ValueError, match="^distribution of the right wheel is 'gaussian'"):
        stage_from_slip(0.1, 0.1, GEOMETRY, UNIFORM, WheelSlip(0.0, 1e-6))
    assert stage_from_slip(0.1, 0.1, GEOMETRY, WheelSlip(), WheelSlip()).lateral_bound == 0.0


@pytest.mark.parametrize(('change', 'message'), [
    ({'travels': []}, '^travels is empty'), ({'travels': [(math.nan, 0.1)]}, '^d_left is nan'),
    ({'travels': [(0.1, math.inf)]}, '^d_right is inf'),
    ({'pose': Pose(0.0, math.nan, 0.0)}, '^y is nan'),
    ({'left_bound': -0.1}, '^left_bound is -0.1'), ({'right_bound': math.inf}, '^right_bound'),
    ({'lateral_bound': math.nan}, '^lateral_bound is nan'),
    ({'turn_bound': -0.1}, '^turn_bound is -0.1'),
    ({'distance_bound': math.nan}, '^distance_bound is nan'),
    ({'left_bound': [0.1, 0.1]}, '^left_bound has 2 values, expected one or 1'),
    ({'most_vertices': 63}, '^most_vertices is 63')])
def test_bad_values_are_refused_by_name(change, message):
    good = {'pose': ORIGIN, 'travels': [(0.1, 0.1)], 'geometry': GEOMETRY, 'left_bound': 0.01,
            'right_bound': 0.01}
    with pytest.raises(ValueError, match=message):
        reachable_set(**{**good, **change})


def test_the_outline_of_crossing_squares_is_a_star():
    square = np.array([1 + 1j, -1 + 1j, -1 - 1j, 1 - 1j])
    points = np.concatenate([square, square * np.exp(0.25j * math.pi)])
    ring = np.array([[0, 1], [1, 2], [2, 3], [3, 0]])
    outline = outer_boundary(points, np.concatenate([ring, ring + 4]))
    assert len(outline) == 16
    assert area(outline) == pytest.approx(16.0 * (2.0 - math.sqrt(2.0)) / 2.0, rel=1e-6)


def test_the_outline_of_overlapping_and_repeated_segments_is_found():
    """Guard segments that lie on each other, as those of symmetrical stages do."""
    points = np.array([0, 2, 2 + 1j, 1j, 1, 3, 3 + 1j, 1 + 1j, 0, 2], complex)
    ring = np.array([[0, 1], [1, 2], [2, 3], [3, 0]])
    outline = outer_boundary(points, np.concatenate([ring, ring + 4, ring, [[8, 9]]]))
    assert area(outline) == pytest.approx(3.0, rel=1e-6)


@pytest.mark.parametrize('most', [1, 7, 100])
def test_the_outline_does_not_depend_on_how_many_segments_are_compared_at_once(monkeypatch, most):
    stages = stages_of('u_turn', 2)
    expected = boundary_of(stages)
    monkeypatch.setattr(outline, 'CANDIDATES', most)
    np.testing.assert_array_equal(boundary_of(stages), expected)


def test_the_outline_is_found_where_the_last_comparison_fills_its_batch(monkeypatch):
    """Guard the end of the last batch: a triangle and a bar across it are 6 pairs."""
    points = np.array([0.0, 4.0, 2.0 + 3.0j, 1.0 + 1.0j, 1.0 - 1.0j])
    segments = np.array([[0, 1], [1, 2], [2, 0], [3, 4]])
    for most in range(1, 9):
        monkeypatch.setattr(outline, 'CANDIDATES', most)
        polygon = outer_boundary(points, segments)
        assert excess(polygon, points - 1e-6 * (points - points.mean())) < 1e-6
        assert area(polygon) == pytest.approx(6.0, rel=1e-6)


def test_simplification_stays_within_its_tolerance():
    circle = np.exp(1j * np.linspace(0.0, math.tau, 1000, endpoint=False))
    for tolerance in (1e-4, 1e-2):
        smaller = simplified(circle, tolerance)
        assert len(smaller) < 0.3 * len(circle)
        assert excess(smaller, circle) <= tolerance
