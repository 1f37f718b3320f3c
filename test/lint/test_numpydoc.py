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

"""The public docstrings of the core say all that a caller needs, in the form of numpydoc."""

import ast
import enum
from functools import cached_property
import importlib
import inspect
from pathlib import Path
import pkgutil
import re
import textwrap

from diffdrive_kinematics import core
import pytest

validation = pytest.importorskip('numpydoc.validate')  # no rosdep key is known
docscrape = pytest.importorskip('numpydoc.docscrape')
hook = pytest.importorskip('numpydoc.hooks.validate_docstrings')

ROOT = Path(__file__).resolve().parents[2]
MODULES = sorted(each.name for each in pkgutil.walk_packages(core.__path__, f'{core.__name__}.')
                 if not each.ispkg)


def public_objects(module):
    """Yield (name, object) of the functions, classes, methods and properties of a module."""
    for name, value in vars(module).items():
        if name.startswith('_') or getattr(value, '__module__', None) != module.__name__:
            continue
        if inspect.isfunction(value) or inspect.isclass(value):
            yield name, value
        if inspect.isclass(value):
            yield from ((f'{name}.{key}', getattr(method, '__func__', method))
                        for key, method in vars(value).items()
                        if not key.startswith('_') and is_method(method))


def is_method(value):
    """Return whether a member of a class is a function of some kind, not a field."""
    return (inspect.isfunction(value)
            or isinstance(value, (staticmethod, classmethod, property, cached_property)))


def is_computed(value):
    """Return whether it reads as a field: its class shows how it is used."""
    return isinstance(value, (property, cached_property))


def spared(value):
    """Return the codes of checks that make no sense of an object."""
    if is_computed(value):
        return {'EX01'}
    if inspect.isclass(value) and issubclass(value, enum.Enum):
        return {'PR01'}  # the signature is that of a look-up
    return set()


def refuses(value):
    """Return whether a function raises by itself, or a class or function checks its values."""
    tree = ast.parse(textwrap.dedent(inspect.getsource(value)))
    if inspect.isclass(value):
        methods = [each for each in tree.body[0].body
                   if getattr(each, 'name', None) == '__post_init__']
        tree = ast.Module(methods, [])
    return any(
        isinstance(node, ast.Raise) or (isinstance(node, ast.Call) and getattr(
            node.func, 'id', '').startswith(('check_', '_check')))
        for node in ast.walk(tree))


def findings(name, value, checks):
    """Return what lacks in the docstring of an object."""
    document = docscrape.get_doc_object(value)
    found = [f'{name}: {code} {text}' for code, text in validation.validate(document)['errors']
             if code in checks and code not in spared(value)]
    if not is_computed(value):
        if refuses(value) and not document['Raises']:
            found.append(f'{name}: it refuses values, but has no section "Raises"')
        if '>>> ' not in '\n'.join(document['Examples']) and not shown_elsewhere(name, value):
            found.append(f'{name}: the section "Examples" has nothing to run')
    return found


def lacks(name, checks):
    """Return what lacks in the docstrings of a module."""
    module = importlib.import_module(name)
    return [line for each in public_objects(module) for line in findings(*each, checks)]


def shown_elsewhere(name, value):
    """Return whether the examples refer to one of the module that uses or returns this."""
    short, module = name.rpartition('.')[2], inspect.getmodule(value)
    text = '\n'.join(docscrape.get_doc_object(value)['Examples'])
    for other in re.findall(r':(?:class|func):`(\w+)`', text):
        document = docscrape.get_doc_object(vars(module)[other])
        code = [line for line in document['Examples'] if '>>> ' in line or '... ' in line]
        returned = {each.type for each in document['Returns']}
        if code and (short in returned or any(short in line for line in code)):
            return True
    return False


@pytest.fixture(scope='module')
def checks():
    """Return the codes that setup.cfg chooses."""
    return hook.parse_config(ROOT)['checks']


@pytest.mark.quick
@pytest.mark.numpydoc
@pytest.mark.linter
@pytest.mark.parametrize('name', MODULES)
def test_public_docstrings_are_complete(name, checks):
    """What to check stands in setup.cfg."""
    found = lacks(name, checks)
    assert not found, '\n'.join(found)


def _arc(radius, turn):
    """
    Return the length of an arc.

    Parameters
    ----------
    radius : float
        Of the arc [m], above 0.
    turn : float
        Of the arc [rad].

    Returns
    -------
    float
        Length [m].

    Raises
    ------
    ValueError
        If the radius is 0 or below.

    Examples
    --------
    >>> _arc(2.0, 0.5)
    1.0

    """
    if radius <= 0.0:
        raise ValueError(f'radius is {radius!r}, expected a number above 0')
    return radius * turn


@pytest.mark.numpydoc
@pytest.mark.linter
@pytest.mark.parametrize('what, section', [
    ("PR01 Parameters {'turn'} not documented", 'turn : float\n    Of the arc [rad].\n'),
    ('RT01 No Returns section found', 'Returns\n-------\nfloat\n    Length [m].\n'),
    ('has no section "Raises"',
     'Raises\n------\nValueError\n    If the radius is 0 or below.\n'),
    ('has nothing to run', '>>> ')])
def test_what_lacks_is_found(what, section, checks, monkeypatch):
    """A parameter without an entry, an error that is not told, an example that does not run."""
    assert not findings('_arc', _arc, checks)
    text = '\n' + inspect.cleandoc(_arc.__doc__)
    assert section in text
    monkeypatch.setattr(_arc, '__doc__', text.replace(section, ''))
    found, = findings('_arc', _arc, checks)
    assert what in found
