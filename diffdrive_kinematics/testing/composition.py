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

"""Which nodes a robot under test is made of, and their parameters."""

from datetime import date, datetime
from os import fspath, PathLike
from pathlib import Path
from typing import Any, Collection, Dict, Iterator, Mapping, NamedTuple, Tuple, Union

from diffdrive_kinematics.nodes.diffdrive_sim import CLASSES
from diffdrive_kinematics.ros.parameters.from_values import Member, members_of
from diffdrive_kinematics.ros.parameters.tables import KNOWN_NAMES, TABLES
from diffdrive_kinematics.ros.parameters.unknown_names import is_understood, resembling
from diffdrive_kinematics.testing.checks import check_number, refuse
import yaml

__all__ = ['Composition', 'composition']

PARAMETERS = 'ros__parameters'
Sections = Mapping[str, Mapping[str, Any]]
NODES = ['diff_drive_controller', 'wheel_noise', 'simulated_base', 'simulated_base:ground_truth']
DEFAULT: Dict[str, Dict[str, Any]] = {
    '/**': {},
    '/**/ground_truth': {
        'wheel_motion_topic': 'noisy_wheel_rates', 'odom_topic': 'ground_truth',
        'joint_states_topic': '', 'odom_frame_id': 'map', 'enable_odom_tf': False}}
CLOCK_STEP_S = 0.02


class Composition(NamedTuple):
    """The nodes of a robot, the length of a step of its clock, and a params file."""

    members: Tuple[Member, ...]
    step_ns: int
    params: str


def composition(
        config: Union[str, Path, Sections, None], params: Mapping[str, Any],
        noise: Mapping[str, Any], clock_step: Union[float, None]) -> Composition:
    """
    Return the nodes of a robot and the text of their params file.

    Parameters
    ----------
    config : path or mapping, optional
        Params file, or what one would hold (name of a node -> ``ros__parameters`` -> values);
        ``nodes`` of ``diffdrive_sim`` is what to compose.  None: a controller, noise of the
        wheels, a base that believes (``odom``) and one that is the truth (``ground_truth``).
    params, noise : mapping
        Parameters of all nodes, and of the noise of the wheels, in place of those of the file.
    clock_step : float, optional
        Step of the clock [s]; None: that of the file, or 0.02.

    Raises
    ------
    ValueError
        If a file has no nodes to compose, the step is not above 0, something is no mapping, or
        ``params`` or ``noise`` has a name that no node of this package knows.

    """
    _check_names('params', params, KNOWN_NAMES, 'a node of this package')
    _check_names('noise', noise, {entry.name for entry in TABLES['wheel_noise']}, 'wheel_noise')
    sections = _read(config)
    values = {'nodes': NODES if config is None else [], 'clock_step': CLOCK_STEP_S}
    for name, section in sections.items():
        if name in ('/**', '/**/diffdrive_sim', '/diffdrive_sim', 'diffdrive_sim'):
            values.update({key: section[key] for key in values if section.get(key)})
    if clock_step is not None:
        values['clock_step'] = clock_step
    step = check_number(
        'clock_step', values['clock_step'], 'from 1e-9 to 1e9 s', least=1e-9, most=1e9)
    if not isinstance(values['nodes'], (list, tuple)) or not all(
            isinstance(each, str) for each in values['nodes']):
        refuse('nodes', values['nodes'], 'a list of names')
    sections.setdefault('/**', {}).update(params)
    for member in (members := members_of(values['nodes'], CLASSES)):
        if member.kind == 'wheel_noise' and noise:
            sections.setdefault(f'/**/{member.name}', {}).update(noise)
    if noise and not any(member.kind == 'wheel_noise' for member in members):
        raise ValueError(f'noise is {dict(noise)!r}, expected a wheel_noise among the nodes')
    ordered = {'/**': sections.pop('/**'), **sections}  # a later one would beat the others
    return Composition(members, round(step * 1e9), yaml.dump(
        {name: {PARAMETERS: _plain(section)} for name, section in ordered.items() if section},
        Dumper=_WithoutAliases, sort_keys=False))


def _read(config: Union[str, Path, Sections, None]) -> Dict[str, Dict[str, Any]]:
    """Return the parameters of each section."""
    if config is None:
        return {name: dict(section) for name, section in DEFAULT.items()}
    sections: Any = config
    if isinstance(config, (str, Path)):
        config = str(config)
        try:
            sections = yaml.safe_load(Path(config).read_text(encoding='utf-8'))
        except (UnicodeDecodeError, yaml.YAMLError) as error:
            refuse('config', config, f'a file of YAML: {error}')
    if not isinstance(sections, Mapping) or not all(
            isinstance(section, Mapping) for section in sections.values()):
        refuse('config', config, 'a file of, or a mapping of names of nodes to parameters')
    found: Dict[str, Dict[str, Any]] = {}
    for name, section in _flat(sections):
        found.setdefault(name, {}).update(section)
    return found


def _flat(
        sections: Mapping[Any, Any], namespace: str = '') -> Iterator[Tuple[str, Dict[str, Any]]]:
    """Yield each section by its full name, and its parameters; one may stand in its namespaces."""
    for key, section in sections.items():
        name = f'{namespace}/{key}' if namespace else key
        if not isinstance(section, Mapping):
            refuse(name, section, 'a mapping of parameters')
        nested = {part: each for part, each in section.items() if part != PARAMETERS}
        is_namespace = _has_parameters(nested)
        if PARAMETERS in section or not is_namespace:
            yield name, dict(section.get(PARAMETERS, section) or {})
        if is_namespace:
            yield from _flat(nested, name)


def _has_parameters(section: Any) -> bool:
    return isinstance(section, Mapping) and (
        PARAMETERS in section or any(map(_has_parameters, section.values())))


def _check_names(argument: str, values: Any, known: Collection[str], node: str) -> None:
    """Refuse parameters that nobody knows: the warning of a node is not seen in a test."""
    if not isinstance(values, Mapping):
        refuse(argument, values, 'a mapping of parameters')
    for name in _names(values):
        if not is_understood(name, known):
            raise ValueError(f'{argument} has {name!r}, expected a parameter of {node}'
                             f'{resembling(name, known)}')


def _names(values: Mapping[Any, Any]) -> Iterator[Any]:
    """Return the names of parameters, also of those that are written by their parts."""
    for name, value in values.items():
        if isinstance(value, Mapping):
            yield from (f'{name}.{part}' for part in _names(value))
        else:
            yield name


def _plain(value: Any, name: str = '') -> Any:
    """Return a value as a params file can hold it, or raise ``ValueError``."""
    if isinstance(value, Mapping):
        return {key: _plain(each, f'{name}.{key}' if name else key)
                for key, each in value.items()}
    if isinstance(value, PathLike):
        return fspath(value)
    if hasattr(value, 'tolist'):  # of numpy
        value = value.tolist()
    if isinstance(value, (list, tuple)):
        return [_plain(each, name) for each in value]
    if value is not None and type(value) not in (bool, int, float, str, date, datetime):
        refuse(name, value, 'a number, a text, true or false, or a list of them')
    return value


class _WithoutAliases(yaml.SafeDumper):
    """Writes a list again where it stands in two sections: rcl reads no alias."""

    def ignore_aliases(self, data: Any) -> bool:
        return True
