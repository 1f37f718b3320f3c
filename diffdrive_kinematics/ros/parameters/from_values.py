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
import math
from typing import Any, List, Mapping, Optional, Sequence, Tuple

from diffdrive_kinematics.core.commands import AxisLimits, CommandResponse, DriveSettings
from diffdrive_kinematics.core.kinematics import Command, WheelGeometry
from diffdrive_kinematics.core.noise import BodySlip, SessionSpread, WheelSlip
from diffdrive_kinematics.ros.parameters.tables import LIMITS, SWITCHES

__all__ = [
    'axis_limits', 'body_slip', 'check_sides', 'check_wiring', 'command_response',
    'commands_from', 'drive_settings', 'session_spread', 'wheel_geometry', 'wheel_radii',
    'wheel_slips']

Values = Mapping[str, Any]


def wheel_geometry(values: Values) -> WheelGeometry:
    """Return the wheel geometry of a node's values; ``ValueError`` if it is impossible."""
    return WheelGeometry(**{
        name: values[name] for name in (
            'wheel_separation', 'wheel_radius', 'wheel_separation_multiplier',
            'left_wheel_radius_multiplier', 'right_wheel_radius_multiplier')})


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
    if len(numbers) % 3:
        raise ValueError(
            f'commands has {len(numbers)} numbers, expected three for each command: v, omega, '
            'duration')
    return [Command(*numbers[i:i + 3]) for i in range(0, len(numbers), 3)]


def drive_settings(values: Values) -> DriveSettings:
    """Return the settings of a controller's values; ``ValueError`` names what is wrong."""
    response = command_response(values)
    return DriveSettings(
        wheel_geometry(values), axis_limits(values, 'linear.x'),
        axis_limits(values, 'angular.z'), max_wheel_rate=values['max_wheel_rate'],
        cmd_vel_timeout=values['cmd_vel_timeout'], update_rate=values['update_rate'],
        response=response if values['use_response'] else None)


def command_response(values: Values) -> Optional[CommandResponse]:
    """Return how the robot of a node's values follows; None where it does as it is told."""
    if not values['response_max_speed']:
        if values.get('use_response'):
            raise ValueError(
                'use_response is True and response_max_speed 0.0, expected a response, as '
                'calibrate writes it')
        return None
    numbers = {field.name: values[f'response_{field.name}'] for field in fields(CommandResponse)}
    try:
        return CommandResponse(**numbers)
    except ValueError as error:
        raise ValueError(f'response_{error}') from None


def axis_limits(values: Values, axis: str) -> AxisLimits:
    """Return the limits of an axis; ``ValueError`` names the parameter that was set."""
    limits = {limit: values[f'{axis}.{limit}'] for limit in LIMITS}
    older, from_older = limits.pop('min_acceleration'), set()
    if not math.isnan(older):  # it bounded every fall of the velocity, max_acceleration every rise
        for limit, bound in (('max_deceleration', older), ('max_acceleration_reverse', older),
                             ('max_deceleration_reverse', limits['max_acceleration'])):
            if math.isnan(limits[limit]):
                limits[limit] = bound
                from_older.add(limit)
    for switch, what in SWITCHES.items():
        if not values[f'{axis}.{switch}']:
            limits.update({limit: math.nan for limit in limits if what in limit})
    try:
        return AxisLimits(**limits)
    except ValueError as error:
        limit, _, rest = str(error).partition(' ')
        limit = 'min_acceleration' if limit in from_older else limit
        raise ValueError(f'{axis}.{limit} {rest}') from None


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
