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

"""What the package declares is what it has."""

import ast
from pathlib import Path
import re
import runpy
import sys
from xml.etree import ElementTree

import pytest
import setuptools

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / 'diffdrive_kinematics'
EXECUTABLES = {'calibrate', 'command_sequence', 'diff_drive_controller', 'diffdrive_sim',
               'forward_projection', 'goal_steering', 'plot_paths', 'robot_description',
               'simulated_base', 'teleop', 'web_view', 'wheel_noise', 'wheel_odometry'}
ROSDEP_KEY = {'numpy': 'python3-numpy', 'yaml': 'python3-yaml'}
# extras of setup.py, or of ROS; pytest loads its plugin by itself
OPTIONAL = {'fastapi', 'matplotlib', 'nicegui', 'pytest', 'rosbag2_py', 'rosbags', 'uvicorn'}


@pytest.fixture
def declared(monkeypatch):
    """Return the arguments that setup.py hands to setuptools."""
    arguments = {}
    monkeypatch.chdir(ROOT)
    monkeypatch.setattr(setuptools, 'setup', arguments.update)
    runpy.run_path(str(ROOT / 'setup.py'))
    return arguments


@pytest.fixture
def manifest():
    """Return the root element of package.xml."""
    return ElementTree.parse(ROOT / 'package.xml').getroot()


def imported(tree, *, lazy=True):
    """
    Return the top-level names of all modules that a syntax tree imports absolutely.

    Without ``lazy`` only the imports count that run, and may fail, when the module is loaded.
    """
    if not lazy and isinstance(tree, (ast.FunctionDef, ast.AsyncFunctionDef, ast.Try)):
        return set()
    if isinstance(tree, ast.Import):
        return {alias.name.partition('.')[0] for alias in tree.names}
    if isinstance(tree, ast.ImportFrom):
        return {tree.module.partition('.')[0]} if tree.level == 0 else set()
    return set().union(*(imported(child, lazy=lazy) for child in ast.iter_child_nodes(tree)))


def imported_by_the_package(*, lazy=True):
    """Return the names that any file of the package imports, but for Python's and its own."""
    names = set()
    for file in PACKAGE.rglob('*.py'):
        names |= imported(ast.parse(file.read_text(encoding='utf-8')), lazy=lazy)
    return names - set(sys.stdlib_module_names) - {PACKAGE.name}


def callables(tree):
    """Return the names that a module binds at its top level by a def or an assignment."""
    functions = {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}
    return functions.union(*({target.id for target in node.targets
                              if isinstance(target, ast.Name)}
                             for node in tree.body if isinstance(node, ast.Assign)))


def test_the_version_is_the_same_everywhere(declared, manifest):
    """The version of package.xml, setup.py and the newest release in the changelog agree."""
    changelog = (ROOT / 'CHANGELOG.rst').read_text(encoding='utf-8')
    newest = re.search(r'^(\d+\.\d+\.\d+) \(\d{4}-\d{2}-\d{2}\)\n-+$', changelog, re.MULTILINE)
    assert newest, 'CHANGELOG.rst has no heading of the form "1.2.3 (2026-01-31)"'
    assert manifest.findtext('version') == declared['version'] == newest[1]


def test_name_licence_and_description_are_the_same_everywhere(declared, manifest):
    """Whether installed by pip or by colcon, it is the same package."""
    assert manifest.findtext('name') == declared['name'] == PACKAGE.name
    assert manifest.findtext('license') == declared['license']
    assert manifest.findtext('export/build_type') == 'ament_python'
    maintainer = manifest.find('maintainer')
    assert maintainer.text == declared['maintainer']
    assert maintainer.get('email') == declared['maintainer_email']


def test_every_configuration_is_installed(declared):
    """The files in config/ are those that reach the share directory."""
    files = {str(path.relative_to(ROOT)) for path in (ROOT / 'config').rglob('*')
             if path.is_file()}
    installed = dict(declared['data_files'])
    assert {name for directory, names in installed.items() for name in names
            if directory == f'share/{PACKAGE.name}/{Path(name).parent}'} == files


def test_the_ament_index_knows_the_package(declared):
    """The marker and package.xml make `ros2 run` and `ros2 pkg` find the package."""
    installed = dict(declared['data_files'])
    assert installed['share/ament_index/resource_index/packages'] == [f'resource/{PACKAGE.name}']
    assert installed[f'share/{PACKAGE.name}'] == ['package.xml']
    assert (ROOT / 'resource' / PACKAGE.name).is_file()


def test_every_python_package_is_installed(declared):
    """A directory of sources without __init__.py would be left out silently."""
    directories = {'.'.join(file.parent.relative_to(ROOT).parts) for file in PACKAGE.rglob('*.py')}
    assert set(declared['packages']) == directories


def test_every_executable_has_its_main(declared):
    """Each entry point names something at the top level of a module of the package."""
    scripts = declared['entry_points']['console_scripts']
    entries = [re.split(r'\s*[=:]\s*', script) for script in scripts]
    assert {name for name, _, _ in entries} == EXECUTABLES
    for _, module, function in entries:
        file = ROOT.joinpath(*module.split('.')).with_suffix('.py')
        assert file.is_file(), f'{module} does not exist'
        assert function in callables(ast.parse(file.read_text(encoding='utf-8')))


def test_the_pytest_plugin_is_declared_by_the_name_of_its_module(declared):
    """So that naming it with -p, or in a conftest.py, does not load it twice."""
    plugin, = declared['entry_points']['pytest11']
    name, module = re.split(r'\s*=\s*', plugin)
    assert name == module
    assert ROOT.joinpath(*module.split('.')).with_suffix('.py').is_file()


def test_the_pytest_plugin_loads_without_ros():
    """Pytest loads it in every environment."""
    tree = ast.parse((PACKAGE / 'testing' / 'plugin.py').read_text(encoding='utf-8'))
    door = ast.parse((PACKAGE / 'testing' / '__init__.py').read_text(encoding='utf-8'))
    assert imported(tree, lazy=False) - set(sys.stdlib_module_names) == {'pytest'}
    assert imported(door, lazy=False) <= set(sys.stdlib_module_names)


def test_every_import_is_a_declared_dependency(manifest):
    """Also of the modules that are imported only where they are needed."""
    depends = {element.text for element in manifest
               if element.tag in ('depend', 'exec_depend')}
    needed = {ROSDEP_KEY.get(name, name) for name in imported_by_the_package() - OPTIONAL}
    assert 'python3-numpy' in needed
    assert needed <= depends


def test_tf2_msgs_is_imported_only_where_it_may_be_missing():
    """No wheel of tf2_msgs exists, and all but the transforms works without it."""
    assert 'tf2_msgs' not in imported_by_the_package(lazy=False)


def test_matplotlib_is_imported_only_where_it_may_be_missing(declared):
    """It is for pictures alone, so pip installs it only with the extra ``plot``."""
    assert 'matplotlib' not in imported_by_the_package(lazy=False)
    assert 'matplotlib' not in declared['install_requires']
    assert declared['extras_require']['plot'] == ['matplotlib']


def test_nicegui_is_imported_only_by_the_page():
    """Which ``web_view`` imports where it may be missing; it brings fastapi and uvicorn."""
    for file in PACKAGE.rglob('*.py'):
        names = imported(ast.parse(file.read_text(encoding='utf-8')))
        assert file.name == 'web_page.py' or not names & {'nicegui', 'fastapi', 'uvicorn'}
        if 'web_page' in file.read_text(encoding='utf-8') and file.name != 'web_page.py':
            assert file.name == 'web_view.py'


def test_what_reads_bags_is_imported_only_where_it_may_be_missing(declared):
    assert not {'rosbags', 'rosbag2_py'} & imported_by_the_package(lazy=False)
    assert declared['extras_require']['bags'] == ['rosbags>=0.11']


@pytest.mark.parametrize('source, at_load, ever', [
    ('import tf2_msgs.msg', {'tf2_msgs'}, {'tf2_msgs'}),
    ('from tf2_msgs.msg import TFMessage', {'tf2_msgs'}, {'tf2_msgs'}),
    ('def f():\n    import tf2_msgs', set(), {'tf2_msgs'}),
    ('try:\n    import tf2_msgs\nexcept ImportError:\n    pass', set(), {'tf2_msgs'}),
    ('from . import tf2_msgs', set(), set()),
])
def test_the_scan_tells_lazy_imports_from_others(source, at_load, ever):
    """The two tests above stand on this."""
    tree = ast.parse(source)
    assert imported(tree, lazy=False) == at_load
    assert imported(tree) == ever


def test_the_parameter_reference_is_what_the_tables_say(capsys):
    runpy.run_path(str(ROOT / 'docs' / 'make_parameters.py'), run_name='__main__')
    assert capsys.readouterr().out == (ROOT / 'docs' / 'reference' / 'parameters.md').read_text()
