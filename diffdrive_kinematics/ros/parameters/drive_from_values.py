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

"""
How a robot is driven, from values of parameters: limits, and how it follows its commands.

It is apart from :mod:`.from_values`, so that nodes without commands start without them.
"""

from dataclasses import fields
import math
from typing import Any, Mapping, Optional

from diffdrive_kinematics.core.commands import AxisLimits, CommandResponse, DriveSettings
from diffdrive_kinematics.ros.parameters.from_values import wheel_geometry
from diffdrive_kinematics.ros.parameters.tables.controller import LIMITS, SWITCHES

Values = Mapping[str, Any]


def drive_settings(values: Values) -> DriveSettings:
    """Return the settings of a controller's values; ``ValueError`` names what is wrong."""
    response = command_response(values)
    return DriveSettings(
        wheel_geometry(values), axis_limits(values, 'linear.x'), axis_limits(values, 'angular.z'),
        max_wheel_rate=values['max_wheel_rate'], cmd_vel_timeout=values['cmd_vel_timeout'],
        update_rate=values['update_rate'], response=response if values['use_response'] else None)


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
