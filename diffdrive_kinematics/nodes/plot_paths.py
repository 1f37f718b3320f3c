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

"""``plot_paths``: a list of commands in, a picture of where they lead under slip out."""

import math
import sys
from typing import Any, List, Mapping, NamedTuple, Tuple, Union

from diffdrive_kinematics.core.kinematics import Command, Pose, WheelGeometry
from diffdrive_kinematics.core.noise import (
    BodySlip, heading_moments, PoseMoments, propagated_moments, reachable_set_from_slip,
    sample_heading, sample_paths, travel_of_command, unit_bound, WheelSlip)
from diffdrive_kinematics.ros.parameters.configuration_error import refusing
from diffdrive_kinematics.ros.parameters.from_values import body_slip, commands_from, wheel_slips
from diffdrive_kinematics.ros.parameters.package_share import with_params_file
from diffdrive_kinematics.ros.parameters.tables import PLOT_PATHS
from diffdrive_kinematics.ros.runtime.node import DiffDriveNode
from diffdrive_kinematics.ros.runtime.output import exit_status, report
from diffdrive_kinematics.ros.runtime.running import run, Stop
from diffdrive_kinematics.tools.drawing import drawn, MISSING, Picture
from diffdrive_kinematics.tools.model_paths import model_config, model_pictures, ModelConfig
from diffdrive_kinematics.tools.output_files import check_writable, write_files
import numpy as np


class Config(NamedTuple):
    """What the picture is of: every command is ``steps`` equal ones in a row."""

    steps: Tuple[Command, ...]
    each: int
    geometry: WheelGeometry
    slips: Tuple[WheelSlip, WheelSlip]
    body: BodySlip
    values: Mapping[str, Any]


def build(values: Mapping[str, Any]) -> Union[Config, ModelConfig]:
    """Return the configuration of parameter values, or raise ``ValueError``."""
    commands = commands_from(values['commands'])
    if not commands:
        raise ValueError('commands is not set, expected at least one (v, omega, duration)')
    if values['model']:
        return model_config(values, commands)
    if math.isnan(values['wheel_separation']):
        raise ValueError('wheel_separation is not set, expected the distance between the wheels')
    each = values['steps']
    steps = tuple(Command(u.v, u.w, u.duration / each) for u in commands for _ in range(each))
    geometry = WheelGeometry(  # the radius does not count: commands are twists
        values['wheel_separation'], 1.0,
        wheel_separation_multiplier=values['wheel_separation_multiplier'])
    return Config(steps, each, geometry, wheel_slips(values), body_slip(values), values)


def picture_of(config: Config) -> Picture:
    """Return what there is to see."""
    start, values = Pose(*config.values['initial_pose']), config.values
    paths = sample_paths(
        _starts(start, config), config.steps, config.geometry, *config.slips, n=values['paths'],
        seed=values['seed'], body=config.body)
    poses, moments, travels = _beliefs(start, config)
    after = range(config.each, len(poses), config.each)
    nominal = [travel_of_command(command, config.geometry) for command in config.steps]
    boundaries = [
        reachable_set_from_slip(
            start, nominal[:end], config.geometry, *config.slips, body=config.body)
        for end in after] if _bounded(config) else []
    return Picture(
        paths, Pose(*map(np.array, zip(*poses))), [
            (poses[i], moments[i].second_moment()) for i in after],
        boundaries, _title(config), travels)


def _beliefs(start: Pose, config: Config) -> Tuple[List[Pose], List[PoseMoments], List[float]]:
    """Return pose and moments after each step, and its travel; the bias is part of them."""
    gains = [1.0 + slip.bias for slip in config.slips]
    variances = [slip.variance / gain for slip, gain in zip(config.slips, gains)]
    poses, moments = [start], [heading_moments(config.values['initial_heading_concentration'])]
    travels = []
    for command in config.steps:
        travel = np.multiply(gains, travel_of_command(command, config.geometry)).tolist()
        pose, after = propagated_moments(
            moments[-1], poses[-1], config.geometry, *travel, *variances, config.body)
        poses.append(pose)
        moments.append(after)
        travels.append(float(np.mean(travel)))
    return poses, moments, travels


def _starts(start: Pose, config: Config) -> Pose:
    """Return where each path starts."""
    concentration, n = config.values['initial_heading_concentration'], config.values['paths']
    if math.isnan(concentration):
        return start
    generator = np.random.default_rng([config.values['seed'], len(config.steps)])
    return Pose(np.full(n, start.x), np.full(n, start.y),
                sample_heading(start.theta, concentration, generator, n))


def _bounded(config: Config) -> bool:
    """Return whether there is a reachable set: von Mises headings have no bound."""
    return (math.isfinite(unit_bound(config.values['slip_distribution']))
            and math.isnan(config.values['initial_heading_concentration']))


def _title(config: Config) -> str:
    values = config.values
    left, right = (1000.0 * math.sqrt(slip.variance) for slip in config.slips)
    roots = f'{left:.3g}' if left == right else f'{left:.3g} (left), {right:.3g} (right)'
    return (
        f"{values['paths']} paths of {len(config.steps)} steps, "
        f"{values['slip_distribution'].replace('_', ' ')} slip: "
        rf'$\sqrt{{k}}$ = {roots} $\mathrm{{mm}}/\sqrt{{\mathrm{{m}}}}$'
        + (', and slip of the body' if config.body else ''))


class PlotPaths(DiffDriveNode[Union[Config, ModelConfig]]):
    """Has the parameters; there is nothing to hear and nothing to say."""

    def __init__(self, name: str = 'plot_paths', **composition: Any) -> None:
        super().__init__(name, PLOT_PATHS, build, **composition)


@refusing()
def work(_: Stop) -> int:
    """Draw the picture; return the exit status."""
    node = PlotPaths()
    config = node.config
    file, overwrite = (node.parameters.values[name] for name in ('output', 'overwrite'))
    try:
        check_writable(file, overwrite=overwrite)
        pictures = (model_pictures(config) if isinstance(config, ModelConfig)
                    else [picture_of(config)])
        picture = drawn(pictures, file.rpartition('.')[2])
        write_files({file: picture}, overwrite=overwrite)
    except ImportError as error:
        raise ValueError(f'plot_paths needs {MISSING} ({error})') from error
    finally:
        node.destroy_node()
    report(file)
    return exit_status()


def main() -> None:
    """Run ``plot_paths``."""
    sys.exit(run(work, with_params_file(sys.argv, 'plot_paths.yaml')))
