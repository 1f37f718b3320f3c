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

"""The directions of imports between the rooms of the package, read from the syntax trees."""

import ast
from pathlib import Path
import re

import pytest

PACKAGE = 'diffdrive_kinematics'
ROOT = Path(__file__).resolve().parents[1] / PACKAGE
FILES = sorted(ROOT.glob('*/**/*.py'))
PURE = {
    'abc', 'bisect', 'collections', 'dataclasses', 'enum', 'fractions', 'functools', 'itertools',
    'math', 'numbers', 'operator', 'typing',
    'concurrent'}  # threads that share one computation; the result does not depend on them
CORE = {'core.kinematics': set()}
CORE['core.commands'] = CORE['core.noise'] = {'core.kinematics'}
CORE['core.odometry'] = CORE['core.models'] = {'core.kinematics', 'core.noise'}
CORE['core.calibration'] = {'core.kinematics', 'core.noise', 'core.commands'}
ROOMS = {**CORE, 'core': set(), 'ros': set()}  # what each may import, beside itself
ROOMS['ros.messages'] = ROOMS['ros.parameters'] = {*CORE}
ROOMS['ros.runtime'] = {*CORE, 'ros.messages', 'ros.parameters'}
ROOMS['ros.inputs'] = ROOMS['ros.publishers'] = {*ROOMS['ros.runtime'], 'ros.runtime'}
ROOMS['tools'] = {*CORE, 'ros.messages'}
ROOMS['nodes'] = {*ROOMS} - {'core', 'ros'}
ROOMS['testing'] = {*ROOMS} - {'core', 'ros'}
PRIVATE_RCLPY = ROOT / 'ros' / 'runtime' / 'rclpy_private.py'  # which may name all of these:
PRIVATE_MODULES = 'rclpy.impl', 'rclpy.experimental', 'rclpy._rclpy_pybind11'
PRIVATE_NAMES = {
    'handle', 'take_message', 'publish_raw', 'rclpy_implementation', 'EventsExecutor',
    'get_ros_time_override_is_enabled', 'source_timestamp', 'received_timestamp',
    'publication_sequence_number', 'reception_sequence_number', '__signature__'}
PUBLIC_IN_SPITE = {'_replace', '_asdict', '_fields', '_exit'}  # of NamedTuple and os
ASKED_OF_THE_RUNTIME = re.compile(
    '(create|destroy)_(client|guard_condition|publisher|rate|service|subscription|timer)')
COMPOSER = f'{PACKAGE}.nodes.diffdrive_sim'
BASE_CLASSES = {f'{PACKAGE}.nodes.wheel_odometry': {f'{PACKAGE}.nodes.simulated_base'}}


def executables():
    """Return the names of the entry points in setup.py."""
    scripts, = (
        ast.literal_eval(value) for node in ast.walk(ast.parse(
            (ROOT.parent / 'setup.py').read_text())) if isinstance(node, ast.Dict)
        for key, value in zip(node.keys, node.values)
        if isinstance(key, ast.Constant) and key.value == 'console_scripts')
    return [script.partition('=')[0].strip() for script in scripts]


NODE_MODULES = {f'{PACKAGE}.nodes.{name}' for name in executables()}


def module_of(path):
    parts = path.relative_to(ROOT.parent).with_suffix('').parts
    return '.'.join(parts[:-1] if parts[-1] == '__init__' else parts)


def room_of(module):
    """Return the room of a module of the package: the longest name of one that it begins with."""
    inside = module.removeprefix(f'{PACKAGE}.')
    return max((room for room in ROOMS if f'{inside}.'.startswith(f'{room}.')), key=len)


def imports_of(source, package):
    """Return the modules and names imported anywhere in the source, as dotted names."""
    found = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            found.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = package.split('.')[:1 - node.level or None] if node.level else []
            module = '.'.join(base + ([node.module] if node.module else []))
            found.update(f'{module}.{alias.name}' for alias in node.names)
            found.add(module)
    return found


def imports_in(path):
    package = '.'.join(path.relative_to(ROOT.parent).parts[:-1])
    return imports_of(path.read_text(), package)


def inside(path):
    """Return what a file imports of the package."""
    return {name for name in imports_in(path) if name.startswith(f'{PACKAGE}.')}


def private_rclpy_in(source):
    """Return what a source names that is private in rclpy, or not of all its versions."""
    found = {name for name in imports_of(source, '') if name.startswith(PRIVATE_MODULES)}
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Attribute):
            others = not (isinstance(node.value, ast.Name) and node.value.id in ('self', 'cls'))
            if node.attr in PRIVATE_NAMES or (
                    others and re.match('_[a-z]', node.attr) and node.attr not in PUBLIC_IN_SPITE):
                found.add(node.attr)
        elif isinstance(node, ast.Constant) and node.value in PRIVATE_NAMES:
            found.add(node.value)
    return found


def cycle_in(graph):
    """Return the modules that are in a cycle, or lead to one."""
    left = dict(graph)
    while True:
        free = {module for module, imported in left.items() if not imported & left.keys()}
        if not free:
            return set(left)
        left = {module: imported for module, imported in left.items() if module not in free}


def name_of(path):
    return module_of(path).removeprefix(f'{PACKAGE}.')


def test_the_reader_of_imports_sees_every_form_at_every_depth():
    source = (
        'import a.b\nfrom c import d\nfrom . import e\nfrom .f import g\nfrom ..h import i\n'
        'def late():\n    import j\n')
    assert imports_of(source, 'p.q') == {
        'a.b', 'c', 'c.d', 'p.q', 'p.q.e', 'p.q.f', 'p.q.f.g', 'p.h', 'p.h.i', 'j'}


def test_the_finder_of_cycles_finds_one():
    assert cycle_in({'a': {'b'}, 'b': {'c'}, 'c': {'a'}, 'd': set()}) == {'a', 'b', 'c'}
    assert cycle_in({'a': {'b', 'c'}, 'b': {'c'}, 'c': set()}) == set()


@pytest.mark.parametrize('source, names', [
    ('from rclpy.impl.implementation_singleton import rclpy_implementation', {
        'rclpy.impl.implementation_singleton',
        'rclpy.impl.implementation_singleton.rclpy_implementation'}),
    ('def late():\n    from rclpy.experimental import EventsExecutor', {
        'rclpy.experimental', 'rclpy.experimental.EventsExecutor'}),
    ('import rclpy._rclpy_pybind11', {'rclpy._rclpy_pybind11'}),
    ('rclpy.experimental.EventsExecutor()', {'EventsExecutor'}),
    ('rclpy_implementation.RCLError', set()),  # its import is what is found
    ('node._parameter_overrides', {'_parameter_overrides'}),
    ('self._node._parameter_overrides', {'_parameter_overrides'}),
    ('publisher.handle.publish_raw(data)', {'handle', 'publish_raw'}),
    ('self._subscription.handle.take_message', {'handle', 'take_message'}),
    ("told['source_timestamp'], told.get('received_timestamp')", {
        'source_timestamp', 'received_timestamp'}),
    ('hear.__signature__ = None', {'__signature__'}),
    ('self._timer, cls._made, value.public, int.__add__', set())])
def test_the_finder_of_private_rclpy_finds_each_kind(source, names):
    assert private_rclpy_in(source) == names


@pytest.mark.parametrize('path', [
    path for path in FILES if room_of(module_of(path)).startswith(('ros', 'nodes'))], ids=name_of)
def test_one_file_knows_what_is_private_in_rclpy(path):
    found = private_rclpy_in(path.read_text())
    assert bool(found) == (path == PRIVATE_RCLPY), f'{name_of(path)} names {found}'


def past_the_runtime_in(source):
    """Return what a source asks of rclpy that a node asks of its runtime."""
    return {node.attr for node in ast.walk(ast.parse(source))
            if isinstance(node, ast.Attribute) and ASKED_OF_THE_RUNTIME.fullmatch(node.attr)}


@pytest.mark.parametrize('source, names', [
    ('self.create_timer(1.0, self._end)', {'create_timer'}),
    ("[node.create_client(Trigger, name) for name in 'ab']", {'create_client'}),
    ('self._node.destroy_subscription(subscription)', {'destroy_subscription'}),
    ('make = node.create_publisher', {'create_publisher'}),
    ('self.runtime.every(1.0, self._end); node.destroy_node()', set())])
def test_the_finder_of_ways_past_the_runtime_finds_each_kind(source, names):
    assert past_the_runtime_in(source) == names


@pytest.mark.parametrize('path', [
    path for path in FILES
    if room_of(module_of(path)) in ('nodes', 'ros.inputs', 'ros.publishers')], ids=name_of)
def test_nodes_ask_the_runtime_for_topics_timers_services_and_clients(path):
    found = past_the_runtime_in(path.read_text())
    assert not found, f'{name_of(path)} uses {found}, past the runtime of the node'


def test_every_file_is_in_a_room_and_every_room_has_files():
    assert {room_of(module_of(path)) for path in FILES} == set(ROOMS)


def test_nodes_are_the_executables_and_nothing_else():
    assert {module_of(path) for path in FILES if path.parent == ROOT / 'nodes'} == {
        *NODE_MODULES, f'{PACKAGE}.nodes'}


@pytest.mark.quick
@pytest.mark.parametrize('path', FILES, ids=name_of)
def test_a_file_imports_only_from_rooms_that_its_own_may_look_into(path):
    room = room_of(module_of(path))
    rooms = {room_of(name) for name in inside(path)}
    assert rooms <= {room, *ROOMS[room]}, f'{name_of(path)} looks into {rooms - ROOMS[room]}'


@pytest.mark.parametrize('path', FILES, ids=name_of)
def test_other_rooms_of_the_core_are_entered_by_their_door(path):
    """Names are imported from the package, unless they are of the file alone."""
    room = room_of(module_of(path))
    for name in inside(path):
        door, _, last = name.rpartition('.')
        if room_of(name) in CORE and room_of(name) != room and door.count('.') == 3:
            exported = imports_in(ROOT / Path(*door.split('.')[1:-1]) / '__init__.py')
            assert name not in exported, f'{name_of(path)} imports {last} from its file'


@pytest.mark.parametrize(
    'path', [path for path in FILES if room_of(module_of(path)) in {*CORE, 'core'}], ids=name_of)
def test_a_core_file_is_pure(path):
    """It imports pure modules and numpy, and opens, prints and executes nothing."""
    others = {name.partition('.')[0] for name in imports_in(path)} - {PACKAGE}
    assert others <= PURE | {'numpy'}
    called = {
        node.func.id for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name)}
    assert not called & {'open', 'print', 'input', '__import__', 'exec', 'eval'}


@pytest.mark.parametrize('room', sorted(CORE))
def test_what_a_room_of_the_core_exports_is_listed_by_its_door_alone(room):
    listing = {path.name for path in (ROOT / room.replace('.', '/')).glob('*.py')
               if re.search('^__all__ =', path.read_text(), re.MULTILINE)}
    assert listing == {'__init__.py'}


@pytest.mark.parametrize('room', sorted(ROOMS))
def test_the_files_of_a_room_import_each_other_in_one_direction(room):
    paths = [path for path in FILES
             if room_of(module_of(path)) == room and path.stem != '__init__']
    modules = {module_of(path) for path in paths}
    assert cycle_in({module_of(path): imports_in(path) & modules - {module_of(path)}
                     for path in paths}) == set()


@pytest.mark.parametrize('path', FILES, ids=name_of)
def test_no_file_imports_a_node_but_its_base_class_or_to_compose_it(path):
    if module_of(path) == COMPOSER:
        return
    allowed = BASE_CLASSES.get(module_of(path), set())
    if room_of(module_of(path)) == 'testing':
        allowed = {COMPOSER}
    nodes = imports_in(path) & NODE_MODULES - allowed
    assert nodes <= {module_of(path)}, f'{path.name} imports {nodes}'
