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

"""What the values of a node's parameters amount to, as the core has it."""

from dataclasses import fields
from typing import Any, List, Mapping, Sequence, Tuple

from diffdrive_kinematics.core.kinematics import Command, WheelGeometry
from diffdrive_kinematics.core.noise import BodySlip, SessionSpread, WheelSlip

Values = Mapping[str, Any]


def wheel_geometry(values: Values) -> WheelGeometry:
    """Return the wheel geometry of a node's values; ``ValueError`` if it is impossible."""
    return WheelGeometry(**{field.name: values[field.name] for field in fields(WheelGeometry)})


def wheel_radii(values: Values) -> Tuple[float, float]:
    """Return the effective radii (left, right) [m] of a node's values."""
    geometry = WheelGeometry(
        1.0, values['wheel_radius'],
        left_wheel_radius_multiplier=values['left_wheel_radius_multiplier'],
        right_wheel_radius_multiplier=values['right_wheel_radius_multiplier'])
    return geometry.left_radius, geometry.right_radius


def wheel_slips(values: Values) -> Tuple[WheelSlip, WheelSlip]:
    """Return bias and slip (left, right) of a node's values; what it has no name for is 0."""
    left, right = (
        WheelSlip(values.get(f'{side}_bias', 0.0), values[f'{side}_slip_variance'],
                  values.get('slip_model', 'travel'), values['slip_distribution'])
        for side in ('left', 'right'))
    return left, right


def body_slip(values: Values) -> BodySlip:
    """Return what slips beside the wheels, by a node's values."""
    return BodySlip(
        *(values[f'{name}_slip_variance'] for name in ('linear', 'turn', 'heading')),
        values.get('slip_distribution', 'gaussian'))


def session_spread(values: Values) -> SessionSpread:
    """Return the standard deviations, between runs, of what lasts a run."""
    return SessionSpread(*(
        values[f'session_{name}_stddev'] for name in ('scale', 'separation', 'curvature')))


def commands_from(numbers: Sequence[float]) -> List[Command]:
    """Return the commands of a flat list of v, omega, duration; ``ValueError`` if it is none."""
    each = 'command: v, omega, duration'
    return [Command(*three) for three in triples('commands', numbers, each)]


def triples(name: str, numbers: Sequence[float], each: str) -> List[Sequence[float]]:
    """Return a flat list three by three; ``ValueError`` names it, and what three are for."""
    if len(numbers) % 3:
        raise ValueError(f'{name} has {len(numbers)} numbers, expected three for each {each}')
    return [numbers[i:i + 3] for i in range(0, len(numbers), 3)]


def check_wiring(values: Values, source: str, outputs: Tuple[str, ...]) -> None:
    """Raise ``ValueError`` where a node would listen to itself."""
    for output in outputs:
        if values[output] and values[output].strip('/') == values[source].strip('/'):
            raise ValueError(
                f'{output} is {values[output]!r}, expected another topic than {source}')


def check_sides(values: Values) -> None:
    """Raise ``ValueError`` where a joint is on both sides of the robot."""
    both = set(values['left_wheel_names']) & set(values['right_wheel_names'])
    if both:
        raise ValueError(
            f'left_wheel_names and right_wheel_names both have {sorted(both)!r}, expected '
            'different joints')
