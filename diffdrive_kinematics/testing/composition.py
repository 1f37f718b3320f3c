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

from pathlib import Path
from typing import Any, Dict, Mapping, NamedTuple, Tuple, Union

from diffdrive_kinematics.nodes.diffdrive_sim import CLASSES
from diffdrive_kinematics.ros.parameters.from_values import Member, members_of
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
        If a file has no nodes to compose, the step is not above 0, or something is no mapping.

    """
    for name, given in (('params', params), ('noise', noise)):
        if not isinstance(given, Mapping):
            refuse(name, given, 'a mapping of parameters')
    sections = _read(config)
    values = {'nodes': NODES if config is None else [], 'clock_step': CLOCK_STEP_S}
    for name, section in sections.items():
        if name in ('/**', '/**/diffdrive_sim', '/diffdrive_sim', 'diffdrive_sim'):
            values.update({key: section[key] for key in values if section.get(key)})
    if clock_step is not None:
        values['clock_step'] = clock_step
    step = check_number(
        'clock_step', values['clock_step'], 'from 1e-9 to 1e9 s', least=1e-9, most=1e9)
    sections.setdefault('/**', {}).update(params)
    for member in (members := members_of(values['nodes'], CLASSES)):
        if member.kind == 'wheel_noise' and noise:
            sections.setdefault(f'/**/{member.name}', {}).update(noise)
    if noise and not any(member.kind == 'wheel_noise' for member in members):
        raise ValueError(f'noise is {dict(noise)!r}, expected a wheel_noise among the nodes')
    ordered = {'/**': sections.pop('/**'), **sections}  # a later one would beat the others
    return Composition(members, round(step * 1e9), yaml.dump(
        {name: {PARAMETERS: section} for name, section in ordered.items() if section},
        Dumper=_WithoutAliases, sort_keys=False))


def _read(config: Union[str, Path, Sections, None]) -> Dict[str, Dict[str, Any]]:
    """Return the parameters of each section."""
    if config is None:
        return {name: dict(section) for name, section in DEFAULT.items()}
    if isinstance(config, (str, Path)):
        config = yaml.safe_load(Path(config).read_text(encoding='utf-8'))
    if not isinstance(config, Mapping) or not all(
            isinstance(section, Mapping) for section in config.values()):
        refuse('config', config, 'a file of, or a mapping of names of nodes to parameters')
    return {name: dict(section.get(PARAMETERS, section) or {})
            for name, section in config.items()}


class _WithoutAliases(yaml.SafeDumper):
    """Writes a list again where it stands in two sections: rcl reads no alias."""

    def ignore_aliases(self, data: Any) -> bool:
        return True
