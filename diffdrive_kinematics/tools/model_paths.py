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

"""Pictures of the models of core/models: their paths under commands, exact or disturbed."""

from typing import Any, Callable, List, Mapping, NamedTuple, Optional, Sequence, Tuple

from diffdrive_kinematics.core.kinematics import check_non_negative, Command, Pose, WheelGeometry
from diffdrive_kinematics.core.models import (
    ackermann_car, augmented, bounded, car, check_command, ControlSystem, differential_drive,
    Disturbance, disturbed, front_drive_tricycle, reachable_boundary, rear_wheels_tricycle,
    Rolling, transition, tricycle, unicycle, Vector)
from diffdrive_kinematics.tools.drawing import Picture
import numpy as np

Values = Mapping[str, Any]

POINTS = 24
"""Of the line that is drawn for a step."""

MAKE: Mapping[str, Callable[[Values], Rolling]] = {
    'unicycle': lambda values: unicycle(),
    'differential_drive': lambda values: differential_drive(
        WheelGeometry(values['wheel_separation'], values['wheel_radius'])),
    'tricycle': lambda values: tricycle(**_steered(values)),
    'bicycle': lambda values: tricycle(**_steered(values)),
    'car': lambda values: car(**_steered(values)),
    'front_drive_tricycle': lambda values: front_drive_tricycle(**_steered(values)),
    'rear_wheels_tricycle': lambda values: rear_wheels_tricycle(track=values['wheel_separation']),
    'ackermann_car': lambda values: ackermann_car(
        track=values['wheel_separation'], **_steered(values))}


class ModelConfig(NamedTuple):
    """A model, with each bound of its steering rate, and each disturbance of its commands."""

    systems: Tuple[ControlSystem, ...]
    disturbances: Tuple[Optional[Disturbance], ...]
    commands: Tuple[Command, ...]
    values: Values


def model_config(values: Values, commands: Sequence[Command]) -> ModelConfig:
    """Return the configuration of parameter values, or raise ``ValueError``."""
    robot = MAKE[values['model']](values)
    for command in commands:
        check_command(robot, (command.v, command.w))
    bounds, distribution = values['command_bounds'], values['slip_distribution']
    if len(bounds) % 2:
        raise ValueError(
            f'command_bounds has {len(bounds)} numbers, expected two for each picture')
    disturbances = [bounded(bounds[i:i + 2], distribution=(
        'uniform' if distribution == 'gaussian' else distribution))
        for i in range(0, len(bounds), 2)]
    return ModelConfig(
        tuple(_with_rate(robot, rate) for rate in values['max_steering_rates'] or (0.0,)),
        tuple(disturbances) or (None,), tuple(commands), values)


def model_pictures(config: ModelConfig) -> List[Picture]:
    """Return a picture for each bound of the steering rate and each disturbance."""
    return [_picture(config, system, disturbance)
            for system in config.systems for disturbance in config.disturbances]


def _steered(values: Values) -> Mapping[str, float]:
    return {'wheel_base': values['wheel_base'], 'max_steering': values['max_steering_angle']}


def _with_rate(robot: Rolling, rate: float) -> ControlSystem:
    """Return the robot whose steering angle changes no faster than a rate; 0: it jumps."""
    if not check_non_negative('max_steering_rates', rate):
        return robot
    return augmented(robot, 'phi', bound=rate)


def _picture(
        config: ModelConfig, system: ControlSystem, disturbance: Optional[Disturbance]) -> Picture:
    start, steps = tuple(config.values['initial_pose']), config.values['steps']
    none = bounded([0.0, 0.0])
    mean = _followed(config, system, none, 1)
    count = config.values['paths'] if disturbance else 0
    paths = _followed(config, system, disturbance, count) if disturbance else Pose(
        *3 * (np.empty((0, 0)),))
    boundaries = []
    if disturbance and isinstance(system, Rolling):
        stages = [((u.v, u.w), u.duration / steps) for u in config.commands for _ in range(steps)]
        boundaries = [reachable_boundary(system, start, stages[:end], disturbance)
                      for end in range(steps, len(stages) + 1, steps)]
    name = config.values['model'].replace('_', ' ')
    return Picture(paths, Pose(*(column[:, 0] for column in mean)), [], boundaries,
                   ', '.join([name, *_words(system, disturbance)]))


def _followed(
        config: ModelConfig, system: ControlSystem, disturbance: Disturbance, n: int) -> Pose:
    """Return the poses on n paths, many for each step."""
    generator = np.random.default_rng(config.values['seed'])
    state: Vector = tuple(np.full(n, value) for value in (
        *config.values['initial_pose'], *(0.0 for _ in system.states[3:])))
    way = [state[:3]]
    for command in config.commands:
        time = command.duration / (config.values['steps'] * POINTS)
        for _ in range(config.values['steps']):
            asked = disturbed((command.v, command.w), disturbance, n=n, generator=generator)
            for _ in range(POINTS):
                state = transition(system, state, _towards(system, state, asked, time), time)
                way.append(state[:3])
    return Pose(*(np.stack(np.broadcast_arrays(*column)) for column in zip(*way)))


def _towards(system: ControlSystem, state: Vector, asked: Vector, time: float) -> Vector:
    """Return the command: with a bounded rate, that which brings the steering angle there."""
    if isinstance(system, Rolling):
        return asked
    return asked[0], (asked[1] - state[-1]) / time


def _words(system: ControlSystem, disturbance: Optional[Disturbance]) -> List[str]:
    """Return the bounds that there are."""
    words = [] if isinstance(system, Rolling) else [
        f'phi by {system.commands[-1].high:g} rad/s at most']
    bounds = disturbance.bounds((0.0, 0.0)) if disturbance else ()
    return words + [f'{name} ± {float(bound):g} {unit}' for (name, unit), bound in zip(
        (('s', 'm/s'), ('phi', 'rad')) if words else (each[:2] for each in system.commands),
        bounds) if bound]
