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

"""The nodes that are composed, as one parameter lists them."""

from typing import Collection, NamedTuple, Sequence, Tuple


class Member(NamedTuple):
    """A node to compose: its class, its name, and the namespace where the name has one."""

    kind: str
    name: str
    namespace: str


def members_of(nodes: Sequence[str], known: Collection[str]) -> Tuple[Member, ...]:
    """
    Return the nodes of a list, or raise ``ValueError``.

    Parameters
    ----------
    nodes : sequence of str
        Each ``class`` or ``class:name``, the name with its namespace.
    known : collection of str
        The classes there are.

    """
    if not nodes:
        raise ValueError(f"nodes is not set, expected 'class' or 'class:name' of {list(known)}")
    members = tuple(_member(text, known) for text in nodes)
    if len({(member.namespace, member.name) for member in members}) != len(members):
        raise ValueError(f'nodes is {list(nodes)!r}, expected different names')
    return members


def _member(text: str, known: Collection[str]) -> Member:
    kind, _, path = text.partition(':')
    namespace, _, name = (path or kind).rpartition('/')
    if kind not in known or not name:
        raise ValueError(
            f"nodes has {text!r}, expected 'class' or 'class:name', class one of {list(known)}")
    return Member(kind, name, namespace)
