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

"""What the value of a parameter must satisfy, beyond its type."""

from dataclasses import dataclass
import math
from typing import Any, Callable, Tuple

from diffdrive_kinematics.core.kinematics import (
    check_above, check_duration, check_non_negative, check_positive, check_rate)
from rclpy.exceptions import InvalidTopicNameException
from rclpy.validate_topic_name import validate_topic_name

Check = Callable[[str, Any], Any]
MOST_INTEGER = 2**63 - 1


@dataclass(frozen=True)
class Within:
    """A check that a number is from ``least`` to ``most``; ``expected`` says so in the error."""

    least: float
    most: float
    expected: str

    def __call__(self, name: str, value: float) -> None:
        """Raise ``ValueError`` unless the value is within."""
        if not self.least <= value <= self.most:
            raise ValueError(f'{name} is {value!r}, expected {self.expected}')


def _integer(least: int, most: int) -> Within:
    return Within(least, most, f'an integer from {least} to {most}')


def _file(expected: str, *endings: str) -> Check:
    def check(name: str, value: str) -> None:
        if not value.endswith(endings):
            raise ValueError(f'{name} is {value!r}, expected the name of {expected}')
    return check


def _or_off(check: Check) -> Check:
    """Return a check that 0 and the empty string pass, too."""
    def optional(name: str, value: Any) -> None:
        if value:
            check(name, value)
    return optional


def _or_nan(check: Check) -> Check:
    """Return a check that NaN passes, too: the value is not set."""
    def optional(name: str, value: float) -> None:
        if not math.isnan(value):
            check(name, value)
    return optional


def check_topic(name: str, value: str) -> None:
    try:
        validate_topic_name(value)
    except InvalidTopicNameException as error:
        reason = str(error).partition(':')[2].strip().partition(':\n')[0]
        raise ValueError(f'{name} is {value!r}, expected a topic name ({reason})') from None


check_count, check_window = _integer(1, 100_000), _integer(1, 1000)
check_stages, check_rounds = _integer(1, 25), _integer(0, 1000)
check_seed = Within(0, MOST_INTEGER, 'an integer, 0 or above')
check_optional_seed = Within(-1, MOST_INTEGER, 'an integer, -1 or above')
check_port = Within(0, 65535, '0 to 65535')
check_update_rate = Within(
    10.0, 1e6, 'a rate from 10 to 1e+06 Hz, since a stop takes effect at the next step')
check_delay = Within(0.0, 10.0, 'a time from 0 to 10 s')  # of what is kept meanwhile
check_slip = Within(  # [m, rad, rad^2/m, rad/m]; with more, covariances are no numbers
    0.0, 1e3, 'a finite number from 0 to 1000')
check_gear_ratio = Within(
    1e-3, 1e6, 'turns of the motor a turn of the wheel, from 1e-3 to 1e6; where it turns the '
    'other way there is left_wheel_inverted')
check_rate_or_off, check_optional_topic = _or_off(check_rate), _or_off(check_topic)
check_resolution = _or_off(Within(1e-3, 1e9, '0, or from 1e-3 to 1e9 ticks a turn'))
check_range = _or_off(Within(1e-6, 1e12, '0, or a range from 1e-6 to 1e12 rad'))
check_step = _or_off(Within(1e-6, 1.0, '0, or a step from 1e-6 to 1 s'))
check_positive_or_nan = _or_nan(check_positive)
check_non_negative_or_nan = _or_nan(check_non_negative)
check_offset = _or_nan(Within(-1e9, 1e9, 'seconds within +-1e+09, or NaN'))
check_picture = _file('a .png or .svg file', '.png', '.svg')
check_optional_picture = _or_off(check_picture)
check_recording = _or_off(_file('an .mcap file or a .csv file', '.csv', '.mcap'))
check_description = _or_off(_file('a .urdf or .yaml file', '.urdf', '.yaml'))


def check_joint_names(name: str, value: Tuple[str, ...]) -> None:
    if not value or not all(value) or len(set(value)) != len(value):
        raise ValueError(f'{name} is {list(value)!r}, expected one or more different joint names')


def check_horizon(name: str, value: float) -> None:
    check_positive(name, value)
    check_duration(name, value)


def check_one_of(*known: str) -> Check:
    def check(name: str, value: str) -> None:
        if value not in known:
            raise ValueError(f"{name} is {value!r}, expected one of {', '.join(map(repr, known))}")
    return check


def check_radius_multiplier(name: str, value: float) -> None:
    if value < 0.0:
        raise ValueError(f'{name} is {value!r}, expected a finite number above 0; for motors that '
                         'turn the other way there are left_wheel_inverted, right_wheel_inverted')
    check_positive(name, value)


def check_pose(name: str, value: Tuple[float, ...]) -> None:
    if len(value) != 3 or not all(map(math.isfinite, value)):
        raise ValueError(f'{name} is {list(value)!r}, expected three finite numbers [x, y, yaw]')


def check_diagonal(name: str, value: Tuple[float, ...]) -> None:
    if len(value) != 6 or not all(math.isfinite(item) and item >= 0.0 for item in value):
        raise ValueError(
            f'{name} is {list(value)!r}, expected six finite numbers, 0 or above, for '
            '(x, y, z, roll, pitch, yaw)')


def check_named(name: str, value: str) -> None:
    if not value:
        raise ValueError(f'{name} is empty, expected a name')


def check_frame(name: str, value: str) -> None:
    check_named(name, value)
    _check_part_of_frame(name, value)
    if '~' in value:
        raise ValueError(f"{name} is {value!r}, expected a name without '~'")
    if value.startswith('/'):
        name_of_tf2 = value.lstrip('/')
        raise ValueError(
            f"{name} is {value!r}, expected {repr(name_of_tf2) if name_of_tf2 else 'a name'}: tf2 "
            "knows no frame that begins with '/'")


def check_prefix(name: str, value: str) -> None:
    _check_part_of_frame(name, value)
    if '~' in value[1:] or value.startswith('~') and value[1:2] not in ('', '/'):
        raise ValueError(
            f"{name} is {value!r}, expected '~' for the namespace, '~/more', or a name without "
            "'~'")


def _check_part_of_frame(name: str, value: str) -> None:
    if any(map(str.isspace, value)):
        raise ValueError(f'{name} is {value!r}, expected a name without blanks')


def check_bias(name: str, value: float) -> None:
    check_above(name, value, -1.0)
