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

"""The figures of the text: each file of config/figures shows what the text says of it."""

import importlib.util
import math
from pathlib import Path

from diffdrive_kinematics.nodes.plot_paths import build
from diffdrive_kinematics.ros.parameters.parameters import coerce
from diffdrive_kinematics.ros.parameters.tables import PLOT_PATHS
from diffdrive_kinematics.ros.parameters.tables.tools import MODELS
from diffdrive_kinematics.tools.model_paths import model_pictures
import numpy as np
import pytest
import yaml

ROOT = Path(__file__).parents[2]
FIGURES = sorted((ROOT / 'config' / 'figures').glob('*.yaml'))
DEFAULTS = {entry.name: entry.default for entry in PLOT_PATHS}
TABLE = {entry.name: entry for entry in PLOT_PATHS}
MATPLOTLIB = pytest.mark.skipif(
    importlib.util.find_spec('matplotlib') is None, reason='matplotlib is not installed')


def pictures(number, **changes):
    """Return the pictures of a figure."""
    file = ROOT / 'config' / 'figures' / f'figure_{number}.yaml'
    given = yaml.safe_load(file.read_text(encoding='utf-8'))['/**']['ros__parameters']
    values = {**DEFAULTS, **given, **changes}
    return model_pictures(build({
        name: coerce(entry, values[name]) for name, entry in TABLE.items()}))


def curvatures(path):
    """Return the turn over the way between points."""
    way = np.hypot(np.diff(path.x), np.diff(path.y))
    return np.diff(path.theta) / np.where(way == 0.0, 1.0, way), way


def test_figure_2_17_has_semicircles_of_the_wheel_base():
    picture, = pictures('2_17')
    path = picture.mean
    centres = np.array([1.0, 3.0, 5.0, 7.0])
    for number, centre in enumerate(centres):
        part = slice(24 * number, 24 * number + 25)
        assert np.hypot(path.x[part], path.y[part] - centre) == pytest.approx(1.0)
        assert (path.x[part] * (-1)**number >= -1e-9).all()
    assert (path.x[-1], path.y[-1]) == pytest.approx((0.0, 8.0))


@pytest.mark.slow
def test_figure_2_21_winds_out_of_one_spiral_and_into_the_other():
    picture, = pictures('2_21')
    bends, way = curvatures(picture.mean)
    driven = bends[way > 0.0]
    assert (np.diff(driven) > -1e-6).all()
    assert driven[0] == pytest.approx(-math.tan(1.2), rel=0.02)
    assert driven[-1] == pytest.approx(math.tan(1.2), rel=0.02)


def test_figure_2_22_jumps_on_one_side_and_turns_the_wheel_at_a_bounded_rate_on_the_other():
    jumps, bounded = (np.abs(np.diff(curvatures(each.mean)[0])) for each in pictures('2_22'))
    assert jumps.max() == pytest.approx(2.0, rel=0.01)
    step = math.pi / 24.0  # of which the wheel turns by as much, tan of it by twice at most
    assert bounded.max() <= 2.1 * step


def test_figure_2_23_has_an_arc_a_bow_and_a_region_between():
    speed, steering, both = pictures('2_23')
    for picture in (speed, steering, both):
        (x, y), = picture.boundaries
        assert x.min() <= picture.paths.x[-1].min() and picture.paths.x[-1].max() <= x.max()
        assert y.min() <= picture.paths.y[-1].min() and picture.paths.y[-1].max() <= y.max()
    along = np.hypot(speed.paths.x[-1], speed.paths.y[-1])
    assert np.ptp(along) > 0.8 and np.ptp(steering.paths.theta[-1]) > 0.8
    assert np.ptp(curvatures(speed.mean)[0]) < 1e-9


def test_figure_2_25_has_a_hundred_paths_of_25_steps():
    picture, = pictures('2_25')
    assert picture.paths.x.shape == (25 * 24 + 1, 100)
    assert len(picture.boundaries) == 5
    assert len(np.unique(np.round(np.diff(picture.paths.theta[:, 0]), 12))) == 25


@pytest.mark.parametrize('model', MODELS)
def test_any_model_is_drawn(model):
    picture, = pictures('2_23', model=model, wheel_base=0.5, wheel_separation=0.4,
                        wheel_radius=0.1, commands=[1.0, 0.3, 1.0], command_bounds=[0.1, 0.1])
    assert picture.title.startswith(model.replace('_', ' '))
    assert picture.paths.x.shape == (25, 200)


@pytest.mark.parametrize(('changes', 'words'), [
    ({'commands': [1.0, 1.5, 1.0]}, 'phi is 1.5 rad, expected from -1.2 to 1.2 rad'),
    ({'command_bounds': [0.1]}, 'command_bounds has 1 numbers'),
    ({'command_bounds': [0.1, -0.1]}, 'a deviation is -0.'),
    ({'wheel_base': math.nan}, 'wheel_base is nan'),
    ({'model': 'unicycle', 'max_steering_rates': [1.0]}, "the command is 'phi'"),
    ({'max_steering_rates': [-1.0]}, 'max_steering_rates is -1.0'),
    ({'model': 'ackermann_car'}, 'track is nan')])
def test_what_makes_no_picture_is_refused_by_name_and_value(changes, words):
    with pytest.raises(ValueError) as error:
        pictures('2_23', **changes)
    assert words in str(error.value)


@MATPLOTLIB
@pytest.mark.parametrize('file', FIGURES, ids=lambda file: file.stem)
def test_the_program_draws_the_figure(graph, tmp_path, file):
    program = graph.start('plot_paths', args=['--ros-args', '--params-file', str(file)],
                          cwd=tmp_path)
    assert program.wait() == 0, program.output
    assert (tmp_path / f'{file.stem}.png').read_bytes().startswith(b'\x89PNG')


def test_every_figure_is_on_the_page():
    page = (ROOT / 'docs' / 'explanation' / 'figures.md').read_text(encoding='utf-8')
    assert len(FIGURES) == 5
    for file in FIGURES:
        picture = ROOT / 'docs' / 'explanation' / 'figures' / f'{file.stem}.png'
        assert f'figures/{file.stem}.png' in page and f'figures/{file.name}' in page
        assert picture.stat().st_size < 100_000
