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

"""The params file that ``calibrate`` writes."""

from typing import Any, Dict, List, Mapping

from diffdrive_kinematics.tools.calibration import Calibration, MULTIPLIERS
from diffdrive_kinematics.tools.calibration_remarks import NO_SLIP_M
from diffdrive_kinematics.tools.drawing import MISSING

HEAD = """\
# Written by calibrate ({method}: {remark}).
#
# Give it to the nodes after the params file of the robot or of the simulation:
#   --ros-args --params-file robot.yaml --params-file {name}
"""
COMPENSATION = """\
# Compensation: wheel rates and odometry with the wheels as they really are."""
ROBOT = """\
# The robot itself, where it is simulated: its wheels, measured from the nominal ones, and slip."""
STAY = """\
# The next calibration starts from this one."""
NODES = 'diff_drive_controller', 'wheel_odometry', 'simulated_base'


def rendered(calibration: Calibration, values: Mapping[str, Any]) -> Dict[str, bytes]:
    """
    Return the content of the files to write, by the names that the parameters give them.

    Raises
    ------
    ValueError
        If a picture is asked for and matplotlib is missing.

    """
    output, picture = values['output'], values['picture']
    files = {output: params_text(calibration, output).encode()}
    if picture:
        from diffdrive_kinematics.tools.calibration_drawing import picture_of
        try:
            files[picture] = picture_of(calibration, picture.rpartition('.')[2])
        except ImportError as error:
            raise ValueError(f'picture needs {MISSING} ({error})') from error
    return files


def params_text(calibration: Calibration, name: str) -> str:
    """Return the text of the params file, for a file of this name."""
    geometry, (left, right) = calibration.geometry, calibration.slips
    multipliers = {name: getattr(geometry, name) for name in MULTIPLIERS}
    slips = {'left_slip_variance': left, 'right_slip_variance': right}
    body = {f'{name}_slip_variance': getattr(calibration.body, f'{name}_variance')
            for name in ('linear', 'turn', 'heading')} if calibration.body else {}
    slips.update(body)
    if max(slips.values()) < NO_SLIP_M:  # nothing is known: what is known elsewhere stays
        slips = {}
    bias = {'left_bias': geometry.left_wheel_radius_multiplier - 1.0,
            'right_bias': geometry.right_wheel_radius_multiplier - 1.0}
    truth = {'left_wheel_radius_multiplier': 1.0, 'right_wheel_radius_multiplier': 1.0,
             'wheel_separation_multiplier': geometry.wheel_separation_multiplier,
             **dict.fromkeys(('left_slip_variance', 'right_slip_variance', *body), 0.0)}
    if calibration.sessions:
        bias['wheel_separation_multiplier'] = geometry.wheel_separation_multiplier
        truth.update(dict.fromkeys(calibration.sessions, 0.0))
    response = calibration.response
    nominal = {'wheel_radius': geometry.wheel_radius,
               'wheel_separation': geometry.wheel_separation}
    lines = [
        HEAD.format(method=calibration.method, remark=calibration.remarks[0], name=name)
        .rstrip('\n'),
        *_section('/**', {**nominal, **slips, **calibration.sessions}), '', COMPENSATION,
        *(line for node in NODES for line in _section(
            f'/**/{node}', {**multipliers, **(response if node == NODES[0] else {})})),
        '', ROBOT,
        *_section('/**/wheel_noise', {**bias, **response}),
        *_section('/**/ground_truth', truth), '', STAY,
        *_section('/**/calibrate', multipliers)]
    return '\n'.join(lines) + '\n'


def _section(key: str, values: Mapping[str, Any]) -> List[str]:
    return [f'{key}:', '  ros__parameters:', *(
        f'    {name}: {_text(value)}' for name, value in values.items())]


def _text(value: Any) -> str:
    """Return a number or a list of numbers as YAML has it."""
    if isinstance(value, list):
        return f"[{', '.join(map(_number, value))}]"
    return str(value) if isinstance(value, int) else _number(value)


def _number(value: float) -> str:
    """Return the number as YAML has it: an exponent needs a decimal point before it."""
    mantissa, exponent, power = repr(float(value)).partition('e')
    point = '' if '.' in mantissa else '.0'
    return f'{mantissa}{point if exponent else ""}{exponent}{power}'
