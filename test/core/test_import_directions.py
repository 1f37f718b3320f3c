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

"""The directions of imports, read from the syntax trees (DESIGN section 4)."""

import ast
from pathlib import Path

import pytest

PACKAGE = 'diffdrive_kinematics'
ROOT = Path(__file__).resolve().parents[2] / PACKAGE
CORE = sorted((ROOT / 'core').glob('**/*.py'))
NODES = sorted((ROOT / 'nodes').glob('**/*.py'))
PURE = {
    'abc', 'bisect', 'collections', 'dataclasses', 'enum', 'fractions', 'functools', 'itertools',
    'math', 'numbers', 'operator', 'typing',
    'concurrent'}  # threads that share one computation; the result does not depend on them
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


def graph_of(paths):
    """Return {module: modules of the same set that it imports}."""
    modules = {module_of(path) for path in paths}
    return {module_of(path): imports_in(path) & modules - {module_of(path)} for path in paths}


def cycle_in(graph):
    """Return the modules that are in a cycle, or lead to one."""
    left = dict(graph)
    while True:
        free = {module for module, imported in left.items() if not imported & left.keys()}
        if not free:
            return set(left)
        left = {module: imported for module, imported in left.items() if module not in free}


def test_the_reader_of_imports_sees_every_form_at_every_depth():
    source = (
        'import a.b\nfrom c import d\nfrom . import e\nfrom .f import g\nfrom ..h import i\n'
        'def late():\n    import j\n')
    assert imports_of(source, 'p.q') == {
        'a.b', 'c', 'c.d', 'p.q', 'p.q.e', 'p.q.f', 'p.q.f.g', 'p.h', 'p.h.i', 'j'}


def test_the_finder_of_cycles_finds_one():
    assert cycle_in({'a': {'b'}, 'b': {'c'}, 'c': {'a'}, 'd': set()}) == {'a', 'b', 'c'}
    assert cycle_in({'a': {'b', 'c'}, 'b': {'c'}, 'c': set()}) == set()


def test_every_executable_is_a_file_of_nodes():
    assert {'calibrate', 'diffdrive_sim', 'wheel_odometry'} <= set(executables())
    assert NODE_MODULES <= {module_of(path) for path in NODES}


def test_the_core_is_where_this_test_looks():
    assert {'arc', 'drive', 'odometry', 'wheel_motion'} <= {path.stem for path in CORE}


@pytest.mark.parametrize('path', CORE, ids=lambda path: path.stem)
def test_a_core_file_imports_only_pure_modules_numpy_and_core_files(path):
    core = {module_of(file) for file in CORE}
    for name in imports_in(path):
        top = name.partition('.')[0]
        inside = name in core or name.rpartition('.')[0] in core - {f'{PACKAGE}.core'}
        assert top in PURE | {'numpy'} or inside, f'{path.name} imports {name}'


@pytest.mark.parametrize('path', CORE, ids=lambda path: path.stem)
def test_a_core_file_opens_no_file_and_imports_nothing_behind_the_back(path):
    called = {
        node.func.id for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name)}
    assert not called & {'open', 'print', 'input', '__import__', 'exec', 'eval'}


def test_core_files_import_each_other_in_one_direction():
    assert cycle_in(graph_of(CORE)) == set()


def test_node_files_import_each_other_in_one_direction():
    assert cycle_in(graph_of(NODES)) == set()


@pytest.mark.parametrize('path', NODES, ids=lambda path: path.stem)
def test_no_file_of_nodes_imports_a_node_but_its_base_class_or_to_compose_it(path):
    if module_of(path) == COMPOSER:
        return
    nodes = imports_in(path) & NODE_MODULES - BASE_CLASSES.get(module_of(path), set())
    assert nodes <= {module_of(path)}, f'{path.name} imports {nodes}'


@pytest.mark.parametrize('path', NODES, ids=lambda path: path.stem)
def test_a_file_of_nodes_imports_of_the_package_only_core_and_nodes(path):
    inside = {name for name in imports_in(path) if name.startswith(PACKAGE)}
    assert all(name.startswith((f'{PACKAGE}.core', f'{PACKAGE}.nodes')) for name in inside)
