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

"""The picture of a course: a file with what it should show, or a word on what is missing."""

import importlib.util
from pathlib import Path

from diffdrive_kinematics.core.kinematics import Pose
from diffdrive_kinematics.core.noise import PoseCovariance
from diffdrive_kinematics.nodes.plot_paths import build, picture_of
from diffdrive_kinematics.ros.parameters.tables import PLOT_PATHS
from diffdrive_kinematics.tools.drawing import along_arcs, ellipse
import numpy as np
import pytest
from support.graph import CONFIG

VALUES = {
    **{entry.name: entry.default for entry in PLOT_PATHS}, 'wheel_separation': 0.1,
    'commands': (0.1, 0.0, 2.0, 0.1, 0.5, 2.0), 'steps': 4, 'paths': 30,
    'initial_pose': (1.0, 2.0, 0.0),
    'left_slip_variance': 1e-6, 'right_slip_variance': 1e-6, 'slip_distribution': 'uniform'}
ARGS = ['--ros-args', '--params-file', str(CONFIG / 'plot_paths.yaml')]
MATPLOTLIB = pytest.mark.skipif(
    importlib.util.find_spec('matplotlib') is None, reason='matplotlib is not installed')


def test_a_picture_has_paths_mean_beliefs_and_boundaries_that_belong_together():
    picture = picture_of(build(VALUES))
    assert picture.paths.x.shape == (9, 30)
    assert picture.mean.x.shape == (9,)
    assert len(picture.beliefs) == len(picture.boundaries) == 2
    assert (picture.mean.x[0], picture.mean.y[0]) == (1.0, 2.0)
    for row, (mean, covariance) in zip((4, 8), picture.beliefs):
        assert (mean.x, mean.y) == (picture.mean.x[row], picture.mean.y[row])
        assert np.std(picture.paths.x[row]) == pytest.approx(covariance.xx**0.5, rel=0.5)
        assert np.std(picture.paths.y[row]) == pytest.approx(covariance.yy**0.5, rel=0.5)
    for row, (x, y) in zip((4, 8), picture.boundaries):
        assert x.min() <= picture.paths.x[row].min() and picture.paths.x[row].max() <= x.max()
        assert y.min() <= picture.paths.y[row].min() and picture.paths.y[row].max() <= y.max()


def test_a_picture_has_the_slip_of_the_body_in_paths_belief_and_boundary():
    picture = picture_of(build({
        **VALUES, 'paths': 2000, 'linear_slip_variance': 4e-4, 'turn_slip_variance': 0.02,
        'heading_slip_variance': 0.01}))
    for row, (_, covariance), (x, y) in zip((4, 8), picture.beliefs, picture.boundaries):
        assert covariance.tt > 0.0019
        for values, variance in zip(picture.paths, (covariance.xx, covariance.yy, covariance.tt)):
            assert np.std(values[row]) == pytest.approx(variance**0.5, rel=0.08)
        assert x.min() <= picture.paths.x[row].min() and picture.paths.x[row].max() <= x.max()
        assert y.min() <= picture.paths.y[row].min() and picture.paths.y[row].max() <= y.max()


def test_a_picture_of_unbounded_slip_has_no_boundary():
    assert not picture_of(build({**VALUES, 'slip_distribution': 'gaussian'})).boundaries


def test_paths_of_an_uncertain_heading_fan_out_as_far_as_the_covariance_says():
    values = {**VALUES, 'paths': 2000, 'initial_heading_concentration': 400.0}
    picture = picture_of(build(values))
    assert not picture.boundaries  # no heading is impossible
    mean, covariance = picture.beliefs[0]
    assert covariance.yy == pytest.approx((mean.x - 1.0)**2 / 400.0, rel=0.01)
    assert np.std(picture.paths.y[4]) == pytest.approx(covariance.yy**0.5, rel=0.06)
    assert np.std(picture.paths.theta[0]) == pytest.approx(0.05, rel=0.06)


def test_the_mean_has_the_bias():
    picture = picture_of(build({**VALUES, 'left_bias': 0.1, 'right_bias': 0.1}))
    assert picture.mean.x[4] - 1.0 == pytest.approx(0.22, rel=1e-12)


def test_the_ellipse_has_95_percent_of_the_positions():
    covariance = PoseCovariance(4.0, 1.5, 0.0, 1.0, 0.0, 1.0)
    x, y = ellipse(Pose(1.0, 2.0, 0.0), covariance)
    inverse = np.linalg.inv(covariance.matrix()[:2, :2])
    offsets = np.stack([x - 1.0, y - 2.0])
    assert np.sum(offsets * (inverse @ offsets), axis=0) == pytest.approx(5.991, rel=1e-9)


@MATPLOTLIB
@pytest.mark.ros
@pytest.mark.parametrize(('name', 'begins'), [('a.png', b'\x89PNG'), ('a.svg', b'<?xml')])
def test_the_program_draws_a_picture_and_writes_over_none(here, tmp_path, name, begins):
    args = [*ARGS, '-p', f'output:={tmp_path / name}']
    program = here('plot_paths', args)
    assert program.wait() == 0, program.output
    assert (tmp_path / name).read_bytes().startswith(begins)
    assert program.output.strip() == str(tmp_path / name)
    again = here('plot_paths', args)
    assert again.wait() == 2 and 'which exists' in again.output


@MATPLOTLIB
@pytest.mark.ros
def test_an_output_that_cannot_be_written_is_one_line_and_status_2(here):
    program = here('plot_paths', [*ARGS, '-p', 'output:=/no/where/a.png'])
    assert program.wait() == 2 and len(program.output.strip().splitlines()) == 1
    assert "output is '/no/where/a.png'" in program.output


def test_a_missing_matplotlib_is_one_line_that_says_how_to_get_it(graph, tmp_path):
    (tmp_path / 'matplotlib').mkdir()
    (tmp_path / 'matplotlib' / '__init__.py').write_text('raise ImportError("not here")')
    source = Path(__file__).parents[2]
    graph._environment['PYTHONPATH'] = f'{tmp_path}:{source}'
    program = graph.start('plot_paths', args=[], cwd=tmp_path)
    assert program.wait() == 2, program.output
    assert 'Traceback' not in program.output
    assert "pip install '.[plot]'" in program.output
    assert not list(tmp_path.glob('*.png'))


@pytest.mark.parametrize('turn', [1e-6, 0.3, 3.0, 2.0 * np.pi, 9.0])
@pytest.mark.parametrize('steps', [1, 3])
def test_the_mean_path_is_drawn_along_exact_arcs(turn, steps):
    values = {**VALUES, 'commands': (0.1, 0.5 * turn, 2.0), 'steps': steps, 'paths': 1,
              'slip_distribution': 'gaussian',
              'left_slip_variance': 0.0, 'right_slip_variance': 0.0}
    picture = picture_of(build(values))
    for path in (picture.mean, Pose(*(each[:, 0] for each in picture.paths))):
        drawn = along_arcs(path, picture.travels)
        turned, radius = drawn.theta - drawn.theta[0], 0.2 / turn
        assert np.max(np.diff(turned)) < 0.03 or turn < 0.02
        assert drawn.x == pytest.approx(1.0 + radius * np.sin(turned), abs=1e-9)
        assert drawn.y == pytest.approx(2.0 + radius * (1.0 - np.cos(turned)), abs=1e-9)
        assert [drawn.x[-1], drawn.y[-1]] == pytest.approx([path.x[-1], path.y[-1]], abs=1e-12)


def test_sample_paths_are_drawn_through_their_poses():
    picture = picture_of(build({**VALUES, 'commands': (0.1, 2.0, 2.0)}))
    drawn = along_arcs(picture.paths, picture.travels)
    assert drawn.x.shape[1] == 30 and drawn.x.shape[0] > 9
    for poses in zip(*picture.paths):
        gap = np.abs(np.stack(drawn) - np.stack(poses)[:, None]).sum(axis=0).min(axis=0)
        assert gap.max() < 1e-12
