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

"""
Sections of params files that no node of this process has, and that one was probably meant to have.

One file for all processes is usual, so most sections are for others and nothing is said about
them.  Names are matched as rclpy does it: ``/*`` is one name, ``/**`` any number of them.
"""

from functools import lru_cache
import re
from typing import (
    AbstractSet, Any, Collection, Iterator, List, Mapping, NamedTuple, Sequence, Set, Tuple)

from diffdrive_kinematics.ros.parameters.parameter_spec import ParameterSpec
from diffdrive_kinematics.ros.parameters.tables import KNOWN_NAMES, TABLES

PARAMETERS = 'ros__parameters'
ALIKE = 0.9  # of difflib: one letter of ten


class Section(NamedTuple):
    """A section of a params file: file and key, and the parameters that it sets."""

    file: str
    key: str
    names: AbstractSet[str]

    @property
    def node(self) -> str:
        """Return the name of the node that it is for; '' where any will do."""
        name = self.key.rpartition('/')[2]
        return '' if '*' in name else name

    @property
    def in_root(self) -> bool:
        """Return whether it is for a node outside of all namespaces only."""
        return not self.key.strip('/').count('/')


def params_files(argv: Sequence[str]) -> Tuple[str, ...]:
    """Return the params files of a command line, in order."""
    files, of_ros = [], False
    for argument, following in zip(argv, [*argv[1:], '']):
        if argument in ('--ros-args', '--'):
            of_ros = argument == '--ros-args'
        elif of_ros and argument == '--params-file':
            files.append(following)
    return tuple(files)


@lru_cache(maxsize=None)
def sections_of(files: Tuple[str, ...]) -> Tuple[Section, ...]:
    """Return the sections of files; rcl has read them before, what it alone can read has none."""
    import yaml  # of rclpy; nobody else needs it
    loader = getattr(yaml, 'CSafeLoader', yaml.SafeLoader)
    found: List[Section] = []
    for file in files:
        try:
            with open(file, encoding='utf-8') as text:
                found += _sections(yaml.load(text, loader), file)
        except (OSError, ValueError, RecursionError, yaml.YAMLError):
            continue
    return tuple(found)


def _sections(tree: Any, file: str, key: str = '') -> Iterator[Section]:
    for name, below in tree.items() if isinstance(tree, dict) else ():
        if name == PARAMETERS:
            yield Section(file, key, frozenset(_names(below)))
        else:
            yield from _sections(below, file, f'{key}/{name}' if key else str(name))


def _names(tree: Any, prefix: str = '') -> Iterator[str]:
    for name, below in tree.items() if isinstance(tree, dict) else ():
        if isinstance(below, dict):
            yield from _names(below, f'{prefix}{name}.')
        else:
            yield f'{prefix}{name}'


def matches(key: str, node: str) -> bool:
    """Return whether a section with this key is for the node of this full name."""
    parts = re.split(r'(/\*\*|/\*)', key if key.startswith('/') else f'/{key}')
    wild = {'/**': r'(?:/\w+)*', '/*': r'/\w+'}
    return bool(re.fullmatch(''.join(wild.get(part, re.escape(part)) for part in parts), node))


def doubts(
        sections: Sequence[Section], node: str, table: Sequence[ParameterSpec],
        given: Mapping[str, Any], neighbours: Collection[str] = ()) -> Iterator[str]:
    """
    Yield a warning for each section that the node does not have and probably should.

    Parameters
    ----------
    sections : sequence of Section
        Of all params files.
    node : str
        Full name of the node.
    table : sequence of ParameterSpec
        What it knows.
    given : mapping
        What was set for it, by name.
    neighbours : collection of str
        Names of the nodes of this process.

    """
    name = node.rpartition('/')[2]
    with_own = {  # files
        section.file for section in sections if section.node and matches(section.key, node)}
    kin = _kin(table)
    missing = {entry.name for entry in table if entry.required and entry.name not in given}
    for section in sections:
        other = section.node
        if not other or matches(section.key, node) or other in set(neighbours) - {name}:
            continue
        if other == name:
            reason = 'is in another namespace' if not with_own and (
                section.in_root != (node == f'/{name}')) else ''
        elif _alike(other, name) and not (section.file in with_own and _siblings(other, name)):
            reason = 'has nearly this name'
        elif other in kin and section.file not in with_own:
            reason = 'takes the same parameters and has no section of its own there'
        else:
            lacking = sorted(missing & section.names) if not with_own else []
            reason = f"lacks {' and '.join(lacking)}, which it sets" if lacking else ''
        if reason:
            executable = f', or the executable {other}' if other in kin else ''
            yield (f"section '{section.key}' of {section.file} is for no node of this process, "
                   f"but {node} {reason}: was '/**/{name}' meant{executable}?")


def misplaced(sections: Sequence[Section], node: str, known: Collection[str]) -> Iterator[str]:
    """
    Yield a warning for each section of a node that sets what only other nodes know.

    Parameters
    ----------
    sections : sequence of Section
        Of all params files.
    node : str
        Full name of the node.
    known : collection of str
        Names of the parameters that it knows.

    """
    for section in sections:
        names = sorted((section.names & KNOWN_NAMES) - set(known))
        if names and section.node and matches(section.key, node):
            owners = sorted(kind for kind, table in TABLES.items()
                            if set(names) & {entry.name for entry in table})
            yield (f"section '{section.key}' of {section.file} sets {', '.join(names)}, which "
                   f"{node} does not know but {', '.join(owners)}: put it under '/**'")


def shadowed(sections: Sequence[Section], node: str, argv: Sequence[str]) -> Iterator[str]:
    """
    Yield a warning for each ``-p NAME:=VALUE`` that a node does not obey.

    It is for all nodes, as ``/**`` of a params file is, and the section of a node beats both.

    Parameters
    ----------
    sections : sequence of Section
        Of all params files.
    node : str
        Full name of the node.
    argv : sequence of str
        The command line.

    """
    rules = [rule for option, rule in zip(argv, argv[1:]) if option in ('-p', '--param')]
    name = node.rpartition('/')[2]
    for rule in rules:
        parameter = rule.partition(':=')[0]
        if any(other.startswith((f'{name}:{parameter}:=', f'{node}:{parameter}:='))
               for other in rules):
            continue
        for section in sections:
            if parameter in section.names and section.node and matches(section.key, node):
                yield (f"-p {rule} does not reach {node}, as section '{section.key}' of "
                       f'{section.file} sets {parameter} too: use -p {name}:{rule}')


def _kin(table: Sequence[ParameterSpec]) -> Set[str]:
    """Return the executables whose nodes take the parameters of the table."""
    names = {entry.name for entry in table}
    return {kind for kind, known in TABLES.items() if {entry.name for entry in known} == names}


def _alike(other: str, name: str) -> bool:
    """Return whether one may be a misspelling of the other; numbers tell siblings apart."""
    if re.sub(r'\d', '', other) == re.sub(r'\d', '', name):
        return False
    import difflib  # where there are sections of others only
    return other not in TABLES and difflib.SequenceMatcher(
        None, other.casefold(), name.casefold()).ratio() >= ALIKE


def _siblings(other: str, name: str) -> bool:
    """Return whether names differ in parts of a letter or two only, as those of wheels do."""
    parts = other.split('_'), name.split('_')
    return len(parts[0]) == len(parts[1]) and all(
        a == b or max(len(a), len(b)) <= 2 for a, b in zip(*parts))
