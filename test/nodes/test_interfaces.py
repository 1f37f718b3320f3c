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
"""docs/reference/interfaces.md says what the nodes have, and all that they have."""

from importlib import import_module
import os
from pathlib import Path

import re
from typing import NamedTuple

from diffdrive_kinematics import executables
from diffdrive_kinematics.ros.parameters.tables import TABLES
from diffdrive_kinematics.ros.runtime.clocks import SteadyTimers
import pytest
from std_msgs.msg import Bool
from support.graph import KHEPERA
from support.inside import initialised
import yaml

PAGE = (Path(__file__).parents[2] / 'docs' / 'reference' / 'interfaces.md').read_text()
REQUIRED = {'command_sequence': {'commands': [0.1, 0.0, 1.0]}, 'web_view': {'port': 0},
            'diffdrive_sim': {'nodes': ['robot_description']}}
ADDING = {'enable_stamped_cmd_vel': True, 'clock_step': 0.01}
LOOKED_AT = 'somebody looks at the page'
DRAWS = 'plot_paths'  # has nothing but parameters, and ends


class Row(NamedTuple):
    """A topic of the page."""

    name: str
    types: str
    qos: str
    parameter: str
    condition: str

    def settings(self):
        return yaml.safe_load('\n'.join(re.findall('`(.+?)`', self.condition))) or {}


def sections(text, level):
    """Return the text under each heading of a level."""
    parts = re.split(f'^{"#" * level} (.*)$', text, flags=re.MULTILINE)
    return dict(zip(parts[1::2], parts[2::2]))


def rows_of(text):
    """Return the cells of each row of a table, without its head."""
    return [[cell.strip() for cell in line.strip('|').split('|')]
            for line in text.splitlines() if line.startswith('| `')]


NODES = {name: sections(text, 3) for name, text in sections(PAGE, 2).items()}
COMMON = NODES.pop('All nodes')


def rows(node, kind):
    """Return the rows of a node and those of all nodes."""
    known = {entry.name for entry in TABLES[node]}
    found = []
    for text in (COMMON.get(kind, ''), NODES[node].get(kind, '')):
        for name, types, qos, parameter, condition, _ in rows_of(text):
            row = Row(name.strip('`'), types, qos, parameter.strip('`'), condition)
            if (text == COMMON.get(kind) and row.name == '/diagnostics'
                    and 'diagnostics_rate' not in known):
                continue
            found.append(row)
    return found


def said(rows_, settings, node):
    """Return the endpoints that rows promise: (name, type, quality of service)."""
    found = set()
    for row in rows_:
        if row.settings().items() - settings.items():
            continue
        name = node.parameters.values[row.parameter] if row.parameter else row.name
        if row.parameter and row.parameter not in settings and row.parameter != 'odom_topic':
            assert name == row.name, row
        kind, *other = re.findall(r'`(\w+/\w+/\w+)`', row.types)
        for switch in re.findall(r'`(\w+: \w+)`', row.types):
            if yaml.safe_load(switch).items() <= settings.items():
                kind, = other
        found |= {(node.resolve_topic_name(name), kind, depth(qos, settings))
                  for qos in row.qos.split('; ')}
    return found


def depth(qos, settings):
    """Return a quality of service with the depth that it has with some settings."""
    match = re.fullmatch(r'(.*, )\d+ \((\d+) with `(.+)`\)', qos)
    if not match:
        return qos
    holds = yaml.safe_load(match.group(3)).items() <= settings.items()
    return match.group(1) + match.group(2) if holds else qos.partition(' (')[0]


def had(endpoints):
    """Return the endpoints that a node has: (name, type, quality of service)."""
    return {(each.topic_name, type_name(each.msg_type), quality(each.qos_profile))
            for each in endpoints}


def type_name(kind):
    """Return the name of a type of messages or services, as ROS tools show it."""
    return '/'.join((*kind.__module__.split('.')[:2], kind.__name__))


def quality(profile):
    """Return a quality of service as the page writes it."""
    assert profile.history.name == 'KEEP_LAST'
    words = [profile.reliability.name, profile.durability.name, str(profile.depth)]
    return ', '.join(
        word.lower().replace('_', ' ') for word in words if word != 'VOLATILE')


def conditions(node):
    """Return the settings that add to a node or that its rows speak of, the defaults first."""
    known = {entry.name for entry in TABLES[node]}
    found = [{}, {'use_sim_time': True}, *(
        {name: value} for name, value in ADDING.items() if name in known)]
    for kind in ('Subscribers', 'Publishers'):
        for row in rows(node, kind):
            switches = [yaml.safe_load(each) for each in re.findall(r'`(\w+: \w+)`', row.types)]
            found += [row.settings(), *({**row.settings(), **each} for each in switches)]
    return [each for index, each in enumerate(found) if each not in found[:index]]


def made(name):
    """Return a node as its executable makes it."""
    module = import_module(f'diffdrive_kinematics.nodes.{name}')
    kind = getattr(module, {'diffdrive_sim': 'DiffDriveSim'}.get(
        name, name.title().replace('_', '')))
    if name == 'diffdrive_sim':
        return kind()
    if name == 'calibrate':
        node = kind(timers=SteadyTimers())
        node.listen()
        return node
    node = kind(timers=SteadyTimers())
    if name == 'diff_drive_controller':
        node._stop._on_topic(Bool(data=False))  # it hears no commands before its stop says so
    return node


CASES = [(name, settings) for name in NODES if name != DRAWS for settings in conditions(name)]


@pytest.mark.quick
@pytest.mark.parametrize(
    ('name', 'settings'), CASES, ids=[f'{name}-{"-".join(each)}' for name, each in CASES])
def test_a_node_has_the_topics_of_the_page_and_no_others(name, settings, tmp_path, monkeypatch):
    if name == 'web_view':
        pytest.importorskip('nicegui')
    theirs = os.openpty() if name == 'teleop' else None
    if theirs:
        monkeypatch.setattr('sys.stdin', os.fdopen(theirs[1], closefd=False))
    given = {**KHEPERA, **REQUIRED.get(name, {}), **settings}
    if name == 'calibrate':
        given['output'] = str(tmp_path / 'robot.yaml')
    with initialised(given):
        node = made(name)
        try:
            subscribed = rows(name, 'Subscribers')
            assert had({*node.subscriptions, *node.polled}) == said(
                [row for row in subscribed if row.condition != LOOKED_AT], settings, node)
            if name == 'web_view':
                node._listen()
                assert had(node.subscriptions) == said(subscribed, settings, node)
            assert had(node.publishers) == said(
                rows(name, 'Publishers'), settings, node)
            for heading, ends in (('Services', node.services), ('Clients', node.clients)):
                own = {(node.resolve_service_name(each.srv_name), type_name(each.srv_type))
                       for each in ends}
                if heading == 'Services':
                    own = {each for each in own if each[1].startswith('std_srvs')}
                assert own == {
                    (node.resolve_service_name(service.strip('`')), kind.strip('`'))
                    for service, kind, _ in rows_of(NODES[name].get(heading, ''))}
        finally:
            node.destroy_node()
            if theirs:
                node._keyboard.close()
                for end in theirs:
                    os.close(end)


def test_each_executable_has_a_section_and_each_parameter_of_the_page_a_row_there():
    assert set(NODES) == set(executables.__all__) == set(TABLES)
    for name, parts in NODES.items():
        assert f'(parameters.md#{name})' in parts['Parameters']
        known = {entry.name for entry in TABLES[name]}
        rows_ = [row for kind in ('Subscribers', 'Publishers') for row in rows(name, kind)]
        assert {row.parameter for row in rows_} - {''} <= known
        topics = {each for each in known if each.endswith('_topic')}
        assert name == 'command_sequence' or topics <= {row.parameter for row in rows_}
        frames = {each for each in known if re.search('frame(_id|s|_prefix)', each)}
        assert all(f'`{each}`' in parts['Frames'] for each in frames), frames
