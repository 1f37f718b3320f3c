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

"""Arguments of a test that cannot be are refused: what, its value, and what was expected."""

from collections.abc import Mapping, Sequence
import math
from numbers import Real
from os import fspath, PathLike
import sys
from typing import Any, Dict, List, NoReturn

from rclpy.exceptions import NameValidationException
from rclpy.expand_topic_name import expand_topic_name
from rclpy.validate_full_topic_name import validate_full_topic_name

__all__ = [
    'check_command', 'check_condition', 'check_environment', 'check_name', 'check_number',
    'check_type', 'refuse', 'whole_steps']

ROUNDING = 1e-6  # of a step, in what is said in decimals
NAME = "a name of ROS: letters, digits, '_' and '/', of less than 248 characters"


def refuse(name: str, value: Any, expected: str) -> NoReturn:
    """Raise ``ValueError`` by the name of an argument, its value, and what was expected."""
    raise ValueError(f'{name} is {value!r}, expected {expected}')


def check_number(
        name: str, value: Any, expected: str = 'a number', *, least: float = -math.inf,
        most: float = sys.float_info.max, finite: bool = True) -> float:
    """Return a number from ``least`` to ``most``, or raise ``ValueError``."""
    if not isinstance(value, Real) or isinstance(value, bool):
        refuse(name, value, expected)
    if finite and not least <= value <= most:
        refuse(name, value, expected)
    return float(value)


def whole_steps(name: str, seconds: Any, step_ns: int) -> int:
    """Return how many steps are no less than some seconds, or raise ``ValueError``."""
    expected = f'at least a step of the clock, {step_ns / 1e9} s'
    steps = check_number(name, seconds, expected) * 1e9 / step_ns - ROUNDING
    if not 1.0 - 2.0 * ROUNDING < steps < math.inf:
        refuse(name, seconds, expected)
    return math.ceil(steps)


def check_condition(condition: Any) -> None:
    """Raise ``ValueError`` for what was asked once, and not each time."""
    if not callable(condition):
        refuse('condition', condition, 'a function, as lambda: robot.odom.x > 1.0')


def check_command(command: Any) -> List[str]:
    """Return the words of a command, or raise ``ValueError``."""
    if isinstance(command, (str, bytes, PathLike)) or not isinstance(command, Sequence) or (
            not command):
        refuse('command', command, "a list of words, as [sys.executable, 'my_node.py']")
    return [str(part) for part in command]


def check_environment(environment: Any) -> Dict[str, str]:
    """Return variables of a process, or raise ``ValueError``."""
    expected = 'a mapping of text to text'
    if not isinstance(environment, Mapping):
        refuse('environment', environment, expected)
    if not all(isinstance(name, str) and isinstance(value, (str, PathLike))
               for name, value in environment.items()):
        refuse('environment', dict(environment), expected)
    return {name: fspath(value) for name, value in environment.items()}


def check_name(name: str, value: Any, node: str) -> str:
    """Return the name of a topic or service, or raise ``ValueError``; ``node`` is its ``~``."""
    if not isinstance(value, str):
        refuse(name, value, 'a name')
    try:
        validate_full_topic_name(expand_topic_name(value, node, '/'))
    except (ValueError, NameValidationException):
        refuse(name, value, NAME)
    return value


def check_type(name: str, kind: Any, known: Sequence[str], where: str) -> None:
    """Raise ``ValueError`` for no type of ROS, or another one than a topic or service has."""
    words = kind.__module__.split('.') if isinstance(kind, type) else []
    if len(words) < 2 or words[1] not in ('msg', 'srv') or issubclass(kind, type):
        refuse(name, kind, 'a type of ROS messages or services')
    if known and f'{words[0]}/{words[1]}/{kind.__name__}' not in known:
        refuse(name, kind, f"{' or '.join(known)}, which {where!r} has")
